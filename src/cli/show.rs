//! `pbif show`: what a run is, how it ended, and what was found, from what it says of itself.

use comfy_table::{Table, presets};

use super::args::ShowArguments;
use super::{CommandError, Outcome, print, print_file};
use crate::run::{FoundRow, RunSummary, find_runs, format_number, format_with_error};
use crate::sweep_file::{Diagnostic, SweepText};

/// Prints a run, or its sweep file alone.
///
/// # Errors
/// [`CommandError::Run`] when it cannot be read.
pub(super) fn run(arguments: &ShowArguments) -> Result<Outcome, CommandError> {
    let summary = RunSummary::read(&arguments.run)?;
    if arguments.sweep {
        return print_file(summary.run.resolved());
    }
    if arguments.typed {
        let typed = summary.run.typed();
        return match typed {
            Some(typed) => print_file(&as_typed(&typed)),
            None => Err(super::CommandError::Input(
                Diagnostic::new(
                    "the run does not say how its sweep file was typed: it is of an early version",
                )
                .remedy("`--sweep` prints the complete sweep file")
                .into(),
            )),
        };
    }
    print(&text(&summary))
}

/// The text, and what was set on top of it as comments behind it.
fn as_typed(typed: &SweepText) -> String {
    let mut text = typed.text.clone();
    if !text.ends_with('\n') && !typed.set.is_empty() {
        text.push('\n');
    }
    for set in &typed.set {
        text += &format!("# --set {set}\n");
    }
    text
}

fn text(summary: &RunSummary) -> String {
    let run = &summary.run;
    let (parameter, from, to) = &summary.parameter;
    let (from, to) = (format_number(*from), format_number(*to));
    let mut text = format!("{}\n  {}\n", run.path().display(), summary.title);
    let mut line = |name: &str, words: String| text += &format!("  {name:10} {words}\n");
    line("system", summary.model.clone());
    line("parameters", parameters(summary));
    line(
        "sweep",
        format!(
            "{parameter} from {from} to {to}, {} given values",
            summary.given
        ),
    );
    if let Some(shard) = run.shard() {
        line("shard", format!("{shard}; `pbif merge` puts all together"));
    }
    if let Some(merged) = run.merged() {
        line("shards", format!("put together of {merged}"));
    }
    line("method", method(summary));
    line("cells", cells(summary));
    line(
        "state",
        format!(
            "{}, written {} UTC",
            summary.state(),
            super::list::when(summary)
        ),
    );
    line(
        "by",
        format!(
            "pbif {}{}, seed {}, {} threads",
            run.version(),
            run.commit()
                .map_or_else(String::new, |commit| format!(" of commit {commit}")),
            run.seed(),
            run.threads()
        ),
    );
    let seconds = run.seconds();
    line(
        "time",
        format!(
            "{:.1} s of sweep, {:.1} s of tables, {:.1} s of figures",
            seconds.sweep, seconds.tables, seconds.figures
        ),
    );
    text += &others(summary);
    text += &rows(parameter, summary.rows.as_deref());
    for warning in run.warnings() {
        text += &format!("warning: {warning}\n");
    }
    text += &format!(
        "\nThe complete sweep file: pbif show {} --sweep\n",
        run.path().display()
    );
    text
}

/// The held parameters.
fn parameters(summary: &RunSummary) -> String {
    let held = summary.run.sweep()["system"]["parameters"].as_object();
    let each = held.into_iter().flatten();
    let words: Vec<String> = each
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    if words.is_empty() {
        "none held".to_owned()
    } else {
        words.join(", ")
    }
}

fn method(summary: &RunSummary) -> String {
    let method = &summary.run.sweep()["method"]["kind"];
    method.as_str().unwrap_or("generator").to_owned()
}

/// The axes with their cells, as the sweep file has them.
fn cells(summary: &RunSummary) -> String {
    let cells = summary.run.sweep()["cells"].as_object();
    let axes = cells
        .into_iter()
        .flatten()
        .filter(|(_, axis)| axis.is_object());
    let words: Vec<String> = axes
        .map(|(name, axis)| {
            let number = |key: &str| axis[key].as_f64().map_or("auto".to_owned(), format_number);
            let count = match (axis["modes"].as_u64(), axis["count"].as_u64()) {
                (Some(modes), _) => format!("{modes} modes"),
                (None, Some(count)) => count.to_string(),
                (None, None) => "auto".to_owned(),
            };
            format!("{name} {count} from {} to {}", number("from"), number("to"))
        })
        .collect();
    words.join(", ")
}

/// Earlier versions and shards in the run's folder.
fn others(summary: &RunSummary) -> String {
    let home = summary.run.path();
    let mut text = String::new();
    for path in find_runs(home).iter().filter(|path| *path != home) {
        if let Ok(other) = RunSummary::read(path) {
            let name = path.strip_prefix(home).unwrap_or(path).display();
            text += &format!("  {name}: {}\n", other.state());
        }
    }
    text
}

/// What was found.
fn rows(parameter: &str, rows: Option<&[FoundRow]>) -> String {
    let Some(rows) = rows else {
        return "\nno changes looked for yet\n".to_owned();
    };
    if rows.is_empty() {
        return format!("\nno change of topology along {parameter}\n");
    }
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header([
        "label",
        parameter,
        "observable",
        "before → after, what happens",
        "status",
    ]);
    for row in rows {
        let value = match (row.value, row.error) {
            (Some(value), Some(error)) => {
                let (value, error) = format_with_error(value, error);
                format!("{value} ± {error}")
            }
            (value, _) => value.map_or(String::new(), format_number),
        };
        let change = match (&row.before, &row.after) {
            (Some(before), Some(after)) => {
                let change = row.change.as_deref().unwrap_or_default();
                format!("{before} → {after}, {change}")
            }
            _ => String::new(),
        };
        let status = row.status.as_deref();
        table.add_row([
            row.label.clone(),
            value,
            row.observable.clone().unwrap_or_default(),
            change,
            status
                .unwrap_or("no steady state, or not converged")
                .to_owned(),
        ]);
    }
    let lines = table.to_string();
    let trimmed: Vec<&str> = lines.lines().map(str::trim_end).collect();
    format!("\n{}\n", trimmed.join("\n"))
}
