//! A map of regimes on disk: `map.csv`, `curves.csv`, `map.json`, and the folder they go to.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::RunError;
use super::atomic::{sync_all, write_atomically};
use super::columns::{Columns, count, number, word};
use super::curve::{columns, ends_json, rows};
use super::number::format_number;
use super::staging::Staging;
use crate::continuation::map::{CodimensionTwo, MapNode, RegimeMap};

/// Everything a map leaves in its folder, the file that marks it as one first.
const ENTRIES: [&str; 5] = [
    "map.json",
    "map.csv",
    "curves.csv",
    "codimension_two.csv",
    "figures",
];
/// Columns and rows of the picture that regions are measured in.
const PICTURE: [usize; 2] = [300, 300];

/// The table of a map's nodes, by the second parameter and then the first, numbers in full.
///
/// # Errors
/// [`RunError::Table`].
pub fn map_csv(map: &RegimeMap) -> Result<String, RunError> {
    let family = &map.subject.family;
    let [first, second] = parameters(map);
    let mut columns = vec![
        number(first, |node: &MapNode| node.values[0]),
        number(second, |node: &MapNode| node.values[1]),
    ];
    for (index, observable) in map.subject.observables.iter().enumerate() {
        let name = format!("signature_{}", observable.name(family));
        columns.push(word(name, move |node: &MapNode| {
            let signature = node.signatures.get(index);
            signature.map_or_else(String::new, ToString::to_string)
        }));
    }
    columns.push(word("status", |node: &MapNode| {
        node.status.word().to_owned()
    }));
    columns.push(count("level", |node: &MapNode| node.level));
    columns.push(word("reason", |node: &MapNode| {
        node.reason.clone().unwrap_or_default()
    }));
    Columns(columns).csv(&map.nodes)
}

/// The table of all curves of a map; the first column has the curve's name.
fn curves_csv(map: &RegimeMap) -> Result<String, RunError> {
    let family = &map.subject.family;
    let mut text = String::new();
    for (index, curve) in map.curves.iter().enumerate() {
        let mut all = vec![word("curve", move |_| curve_name(index))];
        all.extend(columns(family, &map.plane));
        let columns = Columns(all);
        if index == 0 {
            text += &columns.header()?;
        }
        text += &columns.lines(&rows(curve, "start"))?;
    }
    if map.curves.is_empty() {
        let mut all = vec![word("curve", |_| String::new())];
        all.extend(columns(family, &map.plane));
        text = Columns(all).header()?;
    }
    Ok(text)
}

/// Names of both parameters.
fn parameters(map: &RegimeMap) -> [String; 2] {
    let sides = map.plane.sides();
    sides.each_ref().map(|side| side.parameter.clone())
}

/// The table of the points of codimension two.
fn codimension_two_csv(map: &RegimeMap) -> Result<String, RunError> {
    let family = &map.subject.family;
    let [first, second] = parameters(map);
    let columns = vec![
        word("label", |one: &CodimensionTwo| one.label.clone()),
        number(first, |one: &CodimensionTwo| one.values[0]),
        number(second, |one: &CodimensionTwo| one.values[1]),
        number("error", |one: &CodimensionTwo| one.error),
        word("observable", |one: &CodimensionTwo| {
            let observable = map.subject.observables.get(one.observable);
            observable.map(|one| one.name(family)).unwrap_or_default()
        }),
        word("place", |one: &CodimensionTwo| {
            joined(one.place.iter().map(|&x| format_number(x)))
        }),
        word("curves", |one: &CodimensionTwo| {
            joined(one.curves.iter().map(|&index| curve_name(index)))
        }),
    ];
    Columns(columns).csv(&map.codimension_two())
}

fn joined(words: impl Iterator<Item = String>) -> String {
    words.collect::<Vec<_>>().join(" ")
}

/// What a curve of a map is called, by its place.
fn curve_name(index: usize) -> String {
    format!("C{}", index + 1)
}

/// What there is to know of a map beside its tables, as JSON.
fn map_json(map: &RegimeMap, sweep: &str, seconds: f64) -> Result<String, RunError> {
    let family = &map.subject.family;
    let name = |index: usize| {
        let observable = map.subject.observables.get(index);
        observable.map(|one| one.name(family)).unwrap_or_default()
    };
    let sides = map.plane.sides().iter();
    let curves = map.curves.iter().enumerate().map(|(index, curve)| {
        json!({
            "name": curve_name(index),
            "observable": curve.observable.name(family),
            "method": curve.kind.name(),
            "points": curve.points.len(),
            "ends": ends_json(curve),
        })
    });
    let untraced = map.untraced.iter().map(|one| {
        json!({
            "observable": name(one.observable),
            "pairs": one.pairs,
            "near": one.near,
            "reason": one.reason,
        })
    });
    let observables = 0..map.subject.observables.len();
    let regions = observables
        .map(|index| json!({ "observable": name(index), "regions": regions_json(map, index) }));
    let text = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "ending": if map.interrupted { "interrupted" } else { "complete" },
        "box": sides
            .map(|side| json!({ "parameter": side.parameter, "from": side.from, "to": side.to }))
            .collect::<Vec<_>>(),
        "nodes": map.nodes.len(),
        "regions": regions.collect::<Vec<_>>(),
        "curves": curves.collect::<Vec<_>>(),
        "not_followed": untraced.collect::<Vec<_>>(),
        "seconds": seconds,
        "sweep_file": sweep,
    });
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

/// A map's folder in the making. Dropped before it is in place, it leaves what was there.
#[derive(Debug)]
pub struct MapFolder {
    staging: Staging,
}

impl MapFolder {
    /// Prepares to write to `home`, an existing folder; other processes are kept away from it.
    ///
    /// # Errors
    /// [`RunError::InUse`], [`RunError::NotOurs`], [`RunError::Write`].
    pub fn new(home: &Path) -> Result<Self, RunError> {
        let staging = Staging::new(home, &ENTRIES)?;
        Ok(Self { staging })
    }

    /// Where figures are drawn to.
    pub fn figures(&self) -> PathBuf {
        self.staging.fresh().join("figures")
    }

    /// Writes the tables; `sweep` is the resolved sweep file, `seconds` what the map took.
    ///
    /// # Errors
    /// [`RunError`] when a file cannot be composed or written.
    pub fn write(&self, map: &RegimeMap, sweep: &str, seconds: f64) -> Result<(), RunError> {
        for (name, text) in [
            ("map.csv", map_csv(map)?),
            ("curves.csv", curves_csv(map)?),
            ("codimension_two.csv", codimension_two_csv(map)?),
            ("map.json", map_json(map, sweep, seconds)?),
        ] {
            write_atomically(&self.staging.fresh().join(name), text.as_bytes())?;
        }
        Ok(())
    }

    /// Puts the map in its place and returns its files; what an earlier one left goes below `previous/`.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub fn take_place(self) -> Result<Vec<PathBuf>, RunError> {
        sync_all(&[self.staging.fresh()])?;
        Ok(self.staging.take_place(&[])?.files)
    }
}
