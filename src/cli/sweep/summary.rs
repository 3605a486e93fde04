//! What a finished sweep says: the labelled points on stdout, and the files.

use std::path::Path;

use comfy_table::{Table, presets};

use crate::continuation::{Finding, Label, Point, PointStatus, RowWords, SweepResult};
use crate::job::QUICK_POINTS;
use crate::run::{doubt_in_words, format_number, format_with_error, miscounted_in_words};
use crate::system::{Family, MeasureLevel};

/// The labelled points as a table, the signatures at both ends, and where the files are.
pub(in crate::cli) fn text(result: &SweepResult, folder: &Path) -> String {
    let family = &result.subject.family;
    let rows = result.labels.iter().filter(|row| !row.is_end());
    let rows: Vec<&Label> = rows.collect();
    let mut text = String::new();
    if !rows.is_empty() {
        text += &table(family, &rows);
    } else if !result.points.is_empty() {
        text += &no_change(result);
    }
    text += &levels(result);
    let solved = |point: &Point| !point.densities.is_empty();
    if !result.points.is_empty() && !result.points.iter().any(solved) {
        text += nothing_to_draw(result);
    }
    text += &ends(result);
    if let Some(distance) = result.largest_distance() {
        text += &format!("largest Hellinger distance between neighbours: {distance:.2}\n");
    }
    if result.interrupted {
        text += &match result.points.len() {
            0 => "interrupted before the first point was done\n".to_owned(),
            points => format!("interrupted: the tables hold the {points} points that were done\n"),
        };
        if result.points.len() > QUICK_POINTS {
            let folder = folder.display();
            text += &format!("to end at once no figures were drawn: `pbif plot {folder}` does\n");
        }
    }
    text += "\nfiles\n";
    for name in files(folder) {
        text += &format!("  {}\n", folder.join(name).display());
    }
    text
}

/// That nothing was found, and how much that means.
fn no_change(result: &SweepResult) -> String {
    let so_far = if result.interrupted { " so far" } else { "" };
    let parameter = result.subject.family.parameter();
    let mut text = format!("no change of topology along {parameter}{so_far}\n");
    let findings = |point: &Point| point.report.findings.iter().any(Finding::is_too_negative);
    let negative = result.points.iter().filter(|point| findings(point)).count();
    if negative > 0 {
        text += &format!(
            "this proves little: at {negative} of {} values densities have a negative part too large for their shape \
             to be read, and more cells are needed\n",
            result.points.len()
        );
    }
    text
}

/// Why there is no figure.
pub(in crate::cli) fn nothing_to_draw(result: &SweepResult) -> &'static str {
    let unsolved = [PointStatus::NotConverged, PointStatus::Failed];
    let failed = |point: &Point| unsolved.contains(&point.report.status);
    if result.points.iter().any(failed) {
        "no density at any value: nothing to draw\n"
    } else {
        "no steady state in Ω at any value: nothing to draw\n"
    }
}

fn table(family: &Family, rows: &[&Label]) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header([
        "label",
        family.parameter(),
        "bracket",
        "observable",
        "before → after, what happens",
        "status",
    ]);
    for row in rows {
        let rounded = |value: f64| format_with_error(value, row.error());
        let ((value, error), bracket) = (rounded(row.value()), row.bracket());
        let words = row.words(family);
        let of = |cell: &dyn Fn(&RowWords) -> String| words.as_ref().map(cell);
        let change = |one: &RowWords| format!("{} → {}, {}", one.before, one.after, one.change);
        let status = of(&|one| one.status.word().to_owned());
        table.add_row([
            row.name().to_owned(),
            format!("{value} ± {error}"),
            format!("[{}, {}]", rounded(bracket.0).0, rounded(bracket.1).0),
            of(&|one| one.of.clone()).unwrap_or_default(),
            of(&change).unwrap_or_default(),
            status.unwrap_or_else(|| "no steady state, or not converged".to_owned()),
        ]);
    }
    let lines = table.to_string();
    let trimmed: Vec<&str> = lines.lines().map(str::trim_end).collect();
    let reasons = rows.iter().filter_map(|row| {
        let reason = doubt_in_words(family, row.reason()?);
        Some(format!(" {}: {reason}\n", row.name()))
    });
    trimmed.join("\n") + "\n" + &reasons.collect::<String>()
}

/// Which levels no value crosses, and what the numbers are instead.
fn levels(result: &SweepResult) -> String {
    let left = result.uncrossed_levels().into_iter();
    // To three digits or so.
    let rounded = |value: f64| format_with_error(value, 1e-3 * value.abs()).0;
    let line = |(asked, span): (MeasureLevel, Option<[f64; 2]>)| {
        let (name, level) = (&asked.measure, format_number(asked.level));
        match span {
            Some([low, high]) => format!(
                "no value crosses the level {name} = {level}: the number is from {} to {}\n",
                rounded(low),
                rounded(high)
            ),
            None => format!("the level {name} = {level} is not crossed: no value has the number\n"),
        }
    };
    left.map(line).collect()
}

/// The signatures at both ends of the sweep.
fn ends(result: &SweepResult) -> String {
    let family = &result.subject.family;
    let mut text = String::new();
    let solved = || {
        result
            .points
            .iter()
            .filter(|point| !point.detections.is_empty() && point.report.status.is_resolved())
    };
    for point in [solved().next(), solved().next_back()]
        .into_iter()
        .flatten()
    {
        let words: Vec<String> = result
            .subject
            .observables
            .iter()
            .zip(&point.detections)
            .map(|(&observable, detection)| {
                format!("{} {}", observable.name(family), detection.signature)
            })
            .collect();
        let value = format_number(point.value);
        text += &format!(
            "at {} = {value}: {}\n",
            family.parameter(),
            words.join(", ")
        );
    }
    text + &miscounted_in_words(result).map_or_else(String::new, |words| words + "\n")
}

/// The files of a run that are there, in a fixed order.
fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = [
        "bifurcations.csv",
        "bifurcations.md",
        "bifurcations.tex",
        "bifurcations.json",
        "points.csv",
        "features.csv",
        "densities.zarr",
        "spectra.csv",
        "correlations.csv",
        "checks.csv",
        "closer_looks.json",
        "run.json",
    ]
    .map(str::to_owned)
    .to_vec();
    if let Ok(entries) = std::fs::read_dir(folder.join("figures")) {
        let mut figures: Vec<String> = entries
            .flatten()
            .map(|entry| format!("figures/{}", entry.file_name().to_string_lossy()))
            .collect();
        figures.sort();
        names.extend(figures);
    }
    names.retain(|name| folder.join(name).exists());
    names
}
