//! `pbif plot`: the figures of a stored run, drawn again.

use super::args::PlotArguments;
use super::output::OutputFolder;
use super::stored::Stored;
use super::sweep::draw;
use super::{CommandError, Outcome};

/// Draws into the run's `figures/` or another folder and prints the files.
///
/// # Errors
/// [`CommandError`] when the run cannot be read or a figure not be drawn.
pub(super) fn run(arguments: &PlotArguments) -> Result<Outcome, CommandError> {
    let stored = Stored::read(
        &arguments.run,
        &arguments.overrides,
        &["figures"],
        arguments.quiet,
    )?;
    let figures = arguments.run.join("figures");
    let output = OutputFolder::prepare(arguments.out.as_deref().unwrap_or(&figures))?;
    let files = draw(&stored.spec, &stored.result, output.path())?;
    if files.is_empty() {
        return super::print("no steady state in Ω at any value: nothing to draw\n");
    }
    if arguments.out.is_none() {
        stored.run.renew_figures()?;
    }
    let lines = files.iter().map(|file| format!("  {}\n", file.display()));
    let text = format!("files\n{}", lines.collect::<String>());
    super::conclude(&text, Outcome::Complete, output.path())
}
