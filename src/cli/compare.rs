//! `pbif compare`: solves by every method at the values of `figures.at`, and prints tables of how they agree.

use std::path::{Path, PathBuf};

use comfy_table::{Table, presets};

use super::CommandError;
use super::args::CompareArguments;
use super::jobs::{self, Printed};
use crate::compare::Comparison;
use crate::job::{CompareJob, Done, Job as _, Outcome};
use crate::run::{ComparedRun, compare_tables, format_number, warnings_of_comparison};
use crate::sweep_file::Sweep;

/// Compares, writes, draws and prints.
///
/// # Errors
/// [`CommandError`] when the results cannot be written or a method refuses; failed solves are data.
pub(super) fn run(
    spec: &Sweep,
    name: &str,
    arguments: &CompareArguments,
) -> Result<Outcome, CommandError> {
    let default = || Path::new("output").join(format!("{name}-compare"));
    let path = arguments.out.clone().unwrap_or_else(default);
    let job = CompareJob::new(spec)?;
    jobs::run(job, &path, arguments.resume, &arguments.work)
}

impl Printed for CompareJob<'_> {
    fn planned(&self) -> Option<usize> {
        Some(2 + 3 * self.sweep().settings.figures.at.len())
    }

    fn text(&self, done: &Done<Comparison>, home: &Path) -> String {
        let mut text = text(&self.run(&done.found), &done.files);
        if done.outcome == Outcome::Interrupted {
            text += &format!("\ninterrupted: {}\n", jobs::kept(self, home));
        }
        text
    }

    fn complete(&self, home: &Path) -> Result<(String, Outcome), CommandError> {
        let home = home.display();
        let text = format!("the comparison in {home} is complete: nothing was solved\n");
        Ok((text, Outcome::Complete))
    }

    fn kept_in_words(&self) -> String {
        match self.kept() {
            1 => "1 solve that was done is kept".to_owned(),
            solves => format!("{solves} solves that were done are kept"),
        }
    }

    fn warnings(&self, found: &Comparison) -> Vec<String> {
        warnings_of_comparison(self.sweep().problem.family(), found)
    }
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
    text + "\n" + &jobs::files(files)
}
