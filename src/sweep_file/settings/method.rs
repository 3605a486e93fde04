//! Conditions between the settings of methods.

use crate::method::{SgcmOptions, StepChoice};
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::MethodSettings;
use crate::sweep_file::reader::Reader;

/// Checks the settings of all methods, chosen or not, so that a file can hold them all and one word switches.
pub(super) fn check(reader: &mut Reader<'_>, method: &MethodSettings) {
    check_sgcm(reader, &method.sgcm);
    check_times(reader, method);
}

/// Longest time that trajectories run: beyond, steps could not be counted, and no sweep would see the end of it.
const LONGEST: f64 = 1e12;

fn check_times(reader: &mut Reader<'_>, method: &MethodSettings) {
    let times = [
        ("map_step", method.sgcm.map_step),
        ("burn_in", method.monte_carlo.burn_in),
        ("length", method.monte_carlo.length),
    ];
    for (key, time) in times {
        if let StepChoice::Fixed(time) = time
            && time > LONGEST
        {
            let title = format!("`method.{key}` of {time:e} is longer than any trajectory can be");
            let diagnostic = Diagnostic::new(title).allowed(format!("at most {LONGEST:e}"));
            report_at(reader, diagnostic, [key, key]);
        }
    }
}

fn check_sgcm(reader: &mut Reader<'_>, options: &SgcmOptions) {
    if options.replicates > options.samples {
        let title = format!(
            "{} replicates cannot be made of {} samples a cell",
            options.replicates, options.samples
        );
        let diagnostic =
            Diagnostic::new(title).allowed("`method.replicates` at most `method.samples`");
        report_at(reader, diagnostic, ["replicates", "samples"]);
    }
    if let (StepChoice::Fixed(time_step), StepChoice::Fixed(map_step)) =
        (options.time_step, options.map_step)
        && time_step > map_step
    {
        let title = format!("time step {time_step} is longer than map step {map_step}");
        let diagnostic =
            Diagnostic::new(title).allowed("`method.time_step` at most `method.map_step`");
        report_at(reader, diagnostic, ["time_step", "map_step"]);
    }
}

/// Reports at the first of two keys of `[method]` that is given.
fn report_at(reader: &mut Reader<'_>, diagnostic: Diagnostic, keys: [&str; 2]) {
    let place = keys.iter().find_map(|key| reader.place(&["method", key]));
    reader.report(diagnostic.at(place, "given here"));
}
