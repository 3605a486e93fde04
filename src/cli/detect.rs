//! `pbif detect`: detection and location from the stored densities of a run, with other settings, without solving.

use std::time::Instant;

use super::args::DetectArguments;
use super::output::OutputFolder;
use super::stored::{Stored, set};
use super::sweep::summary;
use super::{CommandError, Outcome};
use crate::figure::write_figures;
use crate::job::{draw_sweep, sweep_outcome};
use crate::run::{Ending, Manifest, StagedRun, warnings_of_points};

/// Sections of a sweep file that do not concern the densities.
const SECTIONS: [&str; 3] = ["detect", "locate", "figures"];

/// Detects again, writes tables, figures and manifest, and prints what was found.
///
/// # Errors
/// [`CommandError`] when the run cannot be read or the results not be written; then everything is as it was.
pub(super) fn run(arguments: &DetectArguments) -> Result<Outcome, CommandError> {
    let clock = Instant::now();
    let stored = Stored::read(
        &arguments.run,
        &set(&arguments.overrides),
        &SECTIONS,
        arguments.quiet,
    )?;
    let seconds = clock.elapsed().as_secs_f64();
    let out = arguments.out.as_deref().unwrap_or(&arguments.run);
    let output = OutputFolder::prepare(out)?;
    let staged = StagedRun::new(output.path(), &stored.run)?;
    write(&stored, seconds, &staged)?;
    staged.take_place()?;
    let outcome = match sweep_outcome(&stored.result, &stored.spec.settings.locate) {
        // It was the run that was interrupted, not this command.
        Outcome::Interrupted => Outcome::Partial,
        outcome => outcome,
    };
    super::conclude(
        &summary::text(&stored.result, output.path()),
        outcome,
        output.path(),
    )
}

/// Writes tables, figures, and last the manifest.
fn write(stored: &Stored, detect_seconds: f64, staged: &StagedRun) -> Result<(), CommandError> {
    let Stored { run, spec, result } = stored;
    let settings = &spec.settings;
    let (seed, threads) = (run.seed(), run.threads());
    let mut manifest = Manifest::start(&spec.to_toml(), settings.typed(), seed, threads)?;
    manifest.seconds = run.seconds();
    manifest.seconds.detect = Some(detect_seconds);
    let clock = Instant::now();
    staged.write(result)?;
    manifest.seconds.tables = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let formats = &settings.figures.formats;
    let figures = match formats.is_empty() {
        true => Vec::new(),
        false => draw_sweep(spec, result),
    };
    write_figures(&figures, formats, &staged.figures())?;
    manifest.seconds.figures = clock.elapsed().as_secs_f64();
    manifest.points = result.points.len();
    manifest.largest_distance = result.largest_distance();
    // A run that was killed has written none.
    manifest.warnings = match run.ending() {
        Ending::Running => warnings_of_points(spec.problem.family(), &result.points),
        _ => run.warnings().to_vec(),
    };
    manifest.ending = match run.ending() {
        Ending::Complete => Ending::Complete,
        Ending::Running | Ending::Interrupted => Ending::Interrupted,
    };
    Ok(staged.write_manifest(&manifest)?)
}
