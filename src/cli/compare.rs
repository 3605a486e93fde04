//! `pbif compare`: solves by every method at the values of `figures.at`, and writes tables and figures of how they agree.

use std::path::{Path, PathBuf};

use comfy_table::{Table, presets};

use super::args::CompareArguments;
use super::output::OutputFolder;
use super::sweep::progress::Progress;
use super::{CommandError, Outcome, warnings};
use crate::cancellation::Cancellation;
use crate::compare::{CompareError, Task, compare};
use crate::figure::{Figures, write_figures};
use crate::run::{CompareFolder, ComparedRun, compare_tables, format_number};
use crate::sweep_file::{Diagnostic, Sweep};

/// Compares, writes, draws and prints.
///
/// # Errors
/// [`CommandError`] when the results cannot be written or a method refuses; failed solves are data.
pub(super) fn run(
    spec: &Sweep,
    name: &str,
    arguments: &CompareArguments,
) -> Result<Outcome, CommandError> {
    if spec.settings.figures_at.is_empty() {
        let diagnostic = Diagnostic::new("`figures.at` is empty: there is no value to compare at")
            .remedy("leave `figures.at` out, or give values of the swept parameter");
        return Err(CommandError::Input(diagnostic.into()));
    }
    let default = || Path::new("output").join(format!("{name}-compare"));
    let path = arguments.out.clone().unwrap_or_else(default);
    let output = OutputFolder::prepare(&path)?;
    let (threads, cancellation) = super::interruptible(arguments.work.threads)?;
    let quiet = arguments.work.quiet;
    threads.install(|| carry_out(spec, output.path(), quiet, &cancellation))
}

fn carry_out(
    spec: &Sweep,
    path: &Path,
    quiet: bool,
    cancellation: &Cancellation,
) -> Result<Outcome, CommandError> {
    let mut at: Vec<f64> = Vec::new();
    for &value in &spec.settings.figures_at {
        if !at.contains(&value) {
            at.push(value);
        }
    }
    let task = Task {
        problem: &spec.problem,
        at: &at,
        generator: spec.settings.method.generator.clone(),
        sgcm: spec.settings.method.sgcm.clone(),
        monte_carlo: spec.settings.method.monte_carlo.clone(),
    };
    // What would be refused is refused before hours of work, and another process is kept away.
    let folder = CompareFolder::new(path)?;
    let progress = Progress::new(2 + 3 * at.len(), quiet);
    let compared = compare(&task, cancellation, &mut |step| {
        progress.step(&step.next, step.done, step.total);
    });
    let comparison = match compared {
        Ok(comparison) => comparison,
        Err(CompareError::Interrupted) => {
            progress.finish();
            super::print("interrupted: nothing was written\n")?;
            return Ok(Outcome::Interrupted);
        }
        Err(error) => return Err(error.into()),
    };
    let resolved = spec.to_toml();
    let run = ComparedRun {
        comparison: &comparison,
        sweep: &resolved,
        threads: rayon::current_num_threads(),
    };
    folder.write(&run)?;
    progress.say("drawing");
    let figures = Figures::of_comparison(&comparison, &spec.settings.title)
        .with_style(&spec.settings.figure_style)
        .draw_all()?;
    write_figures(&figures, &spec.settings.figure_formats, &folder.figures())?;
    let files = folder.take_place()?;
    progress.finish();
    progress.warn(&warnings::of_comparison(run.family(), &comparison));
    let outcome = match comparison.is_complete() && comparison.agrees() {
        true => Outcome::Complete,
        false => Outcome::Partial,
    };
    super::conclude(&text(&run, &files), outcome, path)
}

/// The tables, the verdict and the files.
fn text(run: &ComparedRun<'_>, files: &[PathBuf]) -> String {
    let mut text = String::new();
    for table in compare_tables(run) {
        let mut lines = Table::new();
        lines
            .load_style(presets::NOTHING)
            .set_header(&table.header)
            .add_rows(&table.rows);
        text += &format!("{}\n", table.caption);
        for line in lines.to_string().lines() {
            text += &format!("{}\n", line.trim_end());
        }
        text.push('\n');
    }
    let (bins, beyond) = run.comparison.bins();
    let verdict = match run.comparison.agrees() {
        _ if bins == 0 => "generator and Monte Carlo have no value in common",
        true => "generator and Monte Carlo agree",
        false => "generator and Monte Carlo DISAGREE beyond their stated uncertainties",
    };
    text += &format!("{verdict}: {beyond} of {bins} marginal bins are beyond all errors\n");
    for value in &run.comparison.values {
        for observable in value.disagreements() {
            let name = observable.name(run.family());
            let at = format_number(value.value);
            text += &format!("  {} = {at}: {name}\n", run.family().parameter());
        }
    }
    text += "\nfiles\n";
    for file in files {
        text += &format!("  {}\n", file.display());
    }
    text
}
