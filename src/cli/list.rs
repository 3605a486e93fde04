//! `pbif list`: the runs of a folder with their earlier versions and shards.

use comfy_table::{Table, presets};

use super::args::ListArguments;
use super::{CommandError, Outcome, print};
use crate::run::{RunSummary, date_in_utc, find_runs, format_number};
use crate::sweep_file::Diagnostic;

/// Prints a row a run.
///
/// # Errors
/// [`CommandError::Input`] when there is none.
pub(super) fn run(arguments: &ListArguments) -> Result<Outcome, CommandError> {
    let folder = &arguments.folder;
    let runs = find_runs(folder);
    if runs.is_empty() {
        let words = if folder.is_dir() {
            "holds no runs"
        } else {
            "is not a folder"
        };
        let found = Diagnostic::new(format!("`{}` {words}", folder.display()))
            .remedy("give the folder that holds runs, as `pbif list DIR`; `pbif sweep FILE` makes one in output/");
        return Err(found.into());
    }
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(["run", "written (UTC)", "sweep", "state", "found"]);
    for path in &runs {
        let name = path.display().to_string();
        match RunSummary::read(path) {
            Ok(summary) => table.add_row([
                name,
                when(&summary),
                sweep(&summary),
                summary.state(),
                summary.found(),
            ]),
            Err(error) => table.add_row([name, String::new(), String::new(), error.to_string()]),
        };
    }
    let lines = table.to_string();
    let trimmed: Vec<&str> = lines.lines().map(str::trim_end).collect();
    print(&format!(
        "{}\n\nOne run in full: pbif show RUN\n",
        trimmed.join("\n")
    ))
}

/// When it was last written, to the minute.
pub(super) fn when(summary: &RunSummary) -> String {
    let date = summary.written.map(date_in_utc);
    date.map_or(String::new(), |date| {
        date.chars().take(16).collect::<String>().replace('T', " ")
    })
}

/// What is swept, and which shard of it.
fn sweep(summary: &RunSummary) -> String {
    let (parameter, from, to) = &summary.parameter;
    let (from, to) = (format_number(*from), format_number(*to));
    let mut text = format!("{}: {parameter} {from} to {to}", summary.model);
    if let Some(shard) = summary.run.shard() {
        text += &format!(", shard {shard}");
    }
    if let Some(merged) = summary.run.merged() {
        text += &format!(", of {merged} shards");
    }
    text
}
