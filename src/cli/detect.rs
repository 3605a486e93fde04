//! `pbif detect`: detection and location from the stored densities of a run, with other settings, without solving.

use std::time::Instant;

use super::args::DetectArguments;
use super::output::OutputFolder;
use super::stored::{Stored, set};
use super::sweep::{draw, outcome, summary};
use super::{CommandError, Outcome, warnings};
use crate::run::{Ending, Manifest, RunFolder, StagedRun};

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
    let staged = StagedRun::new(output.path(), &arguments.run)?;
    write(&stored, seconds, staged.folder())?;
    staged.take_place()?;
    let outcome = match outcome(&stored.result, &stored.spec.settings.locate) {
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
fn write(stored: &Stored, detect_seconds: f64, folder: &RunFolder) -> Result<(), CommandError> {
    let Stored { run, spec, result } = stored;
    let mut manifest = Manifest::start(
        &spec.to_toml(),
        spec.settings.typed(),
        run.seed(),
        run.threads(),
    )?;
    manifest.seconds = run.seconds();
    manifest.seconds.detect = Some(detect_seconds);
    let clock = Instant::now();
    folder.write_tables(result)?;
    manifest.seconds.tables = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    draw(spec, result, &folder.figures())?;
    manifest.seconds.figures = clock.elapsed().as_secs_f64();
    manifest.points = result.points.len();
    manifest.largest_distance = result.largest_distance();
    // A run that was killed has written none.
    manifest.warnings = match run.ending() {
        Ending::Running => warnings::of_points(spec.problem.family(), &result.points),
        _ => run.warnings().to_vec(),
    };
    manifest.ending = match run.ending() {
        Ending::Complete => Ending::Complete,
        Ending::Running | Ending::Interrupted => Ending::Interrupted,
    };
    folder.write_manifest(&manifest)?;
    Ok(())
}
