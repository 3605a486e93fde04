//! What a finished sweep says: the labelled points on stdout, and the files.

use std::path::Path;

use comfy_table::{Table, presets};

use crate::continuation::{LabelledPoint, Point, PointStatus, PointType, SweepResult};
use crate::run::{format_number, format_with_error};
use crate::system::Family;

/// The labelled points as a table, the signatures at both ends, and where the files are.
pub(in crate::cli) fn text(result: &SweepResult, folder: &Path) -> String {
    let family = &result.subject.family;
    let rows: Vec<&LabelledPoint> = result
        .labels
        .iter()
        .filter(|row| row.kind != PointType::EndPoint)
        .collect();
    let mut text = String::new();
    if !rows.is_empty() {
        text += &table(family, &rows);
    } else if !result.points.is_empty() {
        let so_far = if result.interrupted { " so far" } else { "" };
        text += &format!(
            "no change of topology along {}{so_far}\n",
            family.parameter()
        );
    }
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
    }
    text += "\nfiles\n";
    for name in files(folder) {
        text += &format!("  {}\n", folder.join(name).display());
    }
    text
}

/// Why there is no figure.
pub(in crate::cli) fn nothing_to_draw(result: &SweepResult) -> &'static str {
    let unsolved = [PointStatus::NotConverged, PointStatus::Failed];
    let failed = |point: &Point| unsolved.contains(&point.report.status);
    match result.points.iter().any(failed) {
        true => "no density at any value: nothing to draw\n",
        false => "no steady state in Ω at any value: nothing to draw\n",
    }
}

fn table(family: &Family, rows: &[&LabelledPoint]) -> String {
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
        let (value, error) = format_with_error(row.value, row.error);
        let (lower, _) = format_with_error(row.lower, row.error);
        let (upper, _) = format_with_error(row.upper, row.error);
        let change = match (row.before, row.after) {
            (Some(before), Some(after)) => format!("{before} → {after}, {}", row.change),
            _ => String::new(),
        };
        let observable = row.observable.map(|observable| observable.name(family));
        table.add_row([
            row.label.clone(),
            format!("{value} ± {error}"),
            format!("[{lower}, {upper}]"),
            observable.unwrap_or_default(),
            change,
            row.status
                .map_or("no steady state, or not converged", |s| s.word())
                .to_owned(),
        ]);
    }
    let lines = table.to_string();
    let trimmed: Vec<&str> = lines.lines().map(str::trim_end).collect();
    let reasons = rows.iter().filter_map(|row| {
        let reason = row.reason.as_ref()?;
        Some(format!(" {}: {reason}\n", row.label))
    });
    trimmed.join("\n") + "\n" + &reasons.collect::<String>()
}

/// The signatures at both ends of the sweep.
fn ends(result: &SweepResult) -> String {
    let family = &result.subject.family;
    let mut text = String::new();
    let solved = || {
        result
            .points
            .iter()
            .filter(|point| !point.detections.is_empty())
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
    text
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
        "checks.csv",
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
