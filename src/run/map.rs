//! A map of regimes on disk: `map.csv`, `curves.csv`, `map.json`.

use serde_json::{Value, json};

use super::RunError;
use super::codimension::plane_files;
use super::columns::{Columns, count, number, word};
use super::curve::{levels_json, one_json, work_json};
use super::findings::rounded_findings_cell;
use super::number::format_number;
use super::plane_file;
use super::warnings::warnings_of_nodes;
use crate::continuation::Subject;
use crate::continuation::map::{MapNode, RegimeMap, UntracedChange};
use crate::density::Observable;
use crate::space::Axis;
use crate::system::Family;

/// Columns and rows of the picture that regions are measured in.
const PICTURE: [usize; 2] = [300, 300];

/// The table of a map's nodes, by the second parameter and then the first, numbers in full.
///
/// # Errors
/// [`RunError::Table`].
pub(crate) fn map_csv(map: &RegimeMap) -> Result<String, RunError> {
    let Subject {
        family,
        observables,
        ..
    } = &map.subject;
    let names = parameters(map);
    columns(family, observables, names.each_ref().map(String::as_str)).csv(&map.nodes)
}

/// The columns of that table.
pub(super) fn columns<'a>(
    family: &Family,
    observables: &[Observable],
    [first, second]: [&str; 2],
) -> Columns<'a, MapNode> {
    let mut columns = vec![
        number(first, |node: &MapNode| node.values[0]),
        number(second, |node: &MapNode| node.values[1]),
    ];
    for (index, observable) in observables.iter().enumerate() {
        let name = format!("signature_{}", observable.name(family));
        columns.push(word(name, move |node: &MapNode| {
            let signature = node.signatures.get(index);
            signature.map_or_else(String::new, ToString::to_string)
        }));
    }
    columns.push(word("status", |node: &MapNode| node.status.word()));
    columns.push(count("level", |node: &MapNode| node.level));
    columns.push(word("reason", |node: &MapNode| {
        node.reason.clone().unwrap_or_default()
    }));
    let owned = family.clone();
    columns.push(word("findings", move |node: &MapNode| {
        rounded_findings_cell(&owned, &node.findings)
    }));
    let mut known: Vec<&str> = Vec::new();
    for (index, asked) in family.questions.levels.iter().enumerate() {
        if known.contains(&asked.measure.as_str()) {
            continue;
        }
        known.push(&asked.measure);
        columns.push(number(asked.measure.clone(), move |node: &MapNode| {
            node.numbers
                .get(index)
                .copied()
                .flatten()
                .unwrap_or(f64::NAN)
        }));
    }
    Columns(columns)
}

/// Names of both parameters.
fn parameters(map: &RegimeMap) -> [String; 2] {
    let sides = map.plane.sides();
    sides.each_ref().map(|side| side.parameter.clone())
}

/// The densities of an observable that were kept of its regions, a row a cell; `None` without any.
fn densities_csv(map: &RegimeMap, index: usize) -> Option<String> {
    let family = &map.subject.family;
    let samples = map.samples.iter().filter(|one| one.observable == index);
    let observable = *map.subject.observables.get(index)?;
    let names = parameters(map);
    let names = density_columns(family, observable, names.each_ref().map(String::as_str));
    let mut text = names.join(",") + "\n";
    let before = text.len();
    for sample in samples {
        let [a, b] = sample.values.map(format_number);
        let density = &sample.density;
        let columns = density.axes.get(1).map_or(1, Axis::count);
        for (cell, &value) in density.values.iter().enumerate() {
            let places = density.axes.iter().zip([cell / columns, cell % columns]);
            let places = places.map(|(axis, cell)| format_number(axis.centre(cell)));
            let places: Vec<String> = places.collect();
            text += &format!("{a},{b},{},{}\n", places.join(","), format_number(value));
        }
    }
    (text.len() > before).then_some(text)
}

/// The columns of that table.
pub(super) fn density_columns<'a>(
    family: &'a Family,
    observable: Observable,
    [first, second]: [&'a str; 2],
) -> Vec<&'a str> {
    let axes = observable.axes().into_iter();
    let axes = axes.map(|axis| family.axis(axis));
    [first, second]
        .into_iter()
        .chain(axes)
        .chain(["density"])
        .collect()
}

/// What there is to know of a map beside its tables, as JSON.
fn map_json(map: &RegimeMap, sweep: &str, seconds: f64) -> Result<String, RunError> {
    let family = &map.subject.family;
    let name = |index: usize| {
        let observable = map.subject.observables.get(index);
        observable.map(|one| one.name(family)).unwrap_or_default()
    };
    let sides = map.plane.sides().iter();
    let curves = map.curves.iter().enumerate();
    let curves = curves.map(|(index, curve)| one_json(family, index, curve));
    let untraced = map.untraced.iter().map(|one| {
        let mut told = json!({
            "pairs": one.pairs,
            "near": one.near,
            "reason": one.reason,
        });
        match &one.of {
            UntracedChange::Signature(index) => told["observable"] = json!(name(*index)),
            UntracedChange::Level(asked) => {
                told["measure"] = json!(asked.measure);
                told["level"] = json!(asked.level);
            }
        }
        told
    });
    let observables = 0..map.subject.observables.len();
    let regions = observables
        .map(|index| json!({ "observable": name(index), "regions": regions_json(map, index) }));
    let mut text = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "ending": if map.interrupted { "interrupted" } else { "complete" },
        "box": sides
            .map(|side| json!({ "parameter": side.parameter, "from": side.from, "to": side.to }))
            .collect::<Vec<_>>(),
        "nodes": map.nodes.len(),
        "nodes_with_wide_cells": map.nodes_with_wide_cells(),
        "warnings": warnings_of_nodes(map),
        "regions": regions.collect::<Vec<_>>(),
        "curves": curves.collect::<Vec<_>>(),
        "not_followed": untraced.collect::<Vec<_>>(),
        "work": {
            "nodes": work_json(&map.work.nodes),
            "curves": work_json(&map.work.curves),
        },
        "seconds": seconds,
        "sweep_file": sweep,
    });
    if !map.levels.is_empty() {
        text["levels"] = levels_json(&map.plane, &map.levels);
    }
    Ok(serde_json::to_string_pretty(&text)? + "\n")
}

fn regions_json(map: &RegimeMap, observable: usize) -> Vec<Value> {
    let picture = map.regions(observable, PICTURE);
    let regions = picture.map(|picture| picture.regions).unwrap_or_default();
    let each = regions.iter().map(|region| {
        json!({
            "signature": region.signature.map(|signature| signature.to_string()),
            "share": region.share,
            "inside": region.inside,
        })
    });
    each.collect()
}

/// The files of a map by their names; `sweep` is the resolved sweep file, `seconds` what the map took.
///
/// # Errors
/// [`RunError`] when a file cannot be composed.
pub(crate) fn map_files(
    map: &RegimeMap,
    sweep: &str,
    seconds: f64,
) -> Result<Vec<(String, String)>, RunError> {
    let (family, plane) = (&map.subject.family, &map.plane);
    let mut files = plane_files(family, plane, (&map.curves, &map.levels), &[])?;
    files.extend([
        ("map.csv".to_owned(), map_csv(map)?),
        ("map.json".to_owned(), map_json(map, sweep, seconds)?),
        (plane_file::NAME.to_owned(), plane_file::of_map(map, sweep)),
    ]);
    for (index, observable) in map.subject.observables.iter().enumerate() {
        let name = format!("densities/{}.csv", observable.name(family));
        files.extend(densities_csv(map, index).map(|text| (name, text)));
    }
    Ok(files)
}
