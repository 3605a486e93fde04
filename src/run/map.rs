//! A map of regimes on disk: `map.csv`, `curves.csv`, `map.json`, and the folder they go to.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::RunError;
use super::atomic::{sync_all, write_atomically};
use super::checksums;
use super::codimension::{codimension_two_csv, codimension_two_tex, several_csv};
use super::columns::{Columns, count, number, word};
use super::curve::{one_json, work_json};
use super::journal::{Journal, differences};
use super::number::format_number;
use super::plane_file;
use super::staging::Staging;
use crate::continuation::map::{MapNode, RegimeMap};
use crate::space::Axis;

/// Everything a map leaves in its folder, the file that marks it as one first.
pub(super) const ENTRIES: [&str; 9] = [
    "map.json",
    checksums::NAME,
    plane_file::NAME,
    "map.csv",
    "curves.csv",
    "codimension_two.csv",
    "codimension_two.tex",
    "densities",
    "figures",
];

/// What an unfinished map, or a shard of one, has solved.
pub(super) const PART: &str = "map.part.bin";

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

/// Names of both parameters.
fn parameters(map: &RegimeMap) -> [String; 2] {
    let sides = map.plane.sides();
    sides.each_ref().map(|side| side.parameter.clone())
}

/// The densities of an observable that were kept of its regions, a row a cell; `None` without any.
fn densities_csv(map: &RegimeMap, index: usize) -> Option<String> {
    let family = &map.subject.family;
    let samples = map.samples.iter().filter(|one| one.observable == index);
    let axes = map.subject.observables.get(index)?.axes();
    let axes: Vec<&str> = axes.into_iter().map(|axis| family.axis(axis)).collect();
    let [first, second] = parameters(map);
    let mut text = format!("{first},{second},{},density\n", axes.join(","));
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
        "work": {
            "nodes": work_json(&map.work.nodes),
            "curves": work_json(&map.work.curves),
        },
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

    /// How the map in a folder ended, by the word in its `map.json`; `None` where there is none.
    ///
    /// # Errors
    /// [`RunError::OtherSweep`], with every difference, where it is of another sweep or version.
    pub fn ending(home: &Path, sweep: &str) -> Result<Option<String>, RunError> {
        let Ok(text) = std::fs::read_to_string(home.join(ENTRIES[0])) else {
            return Ok(None);
        };
        let all: Value = serde_json::from_str(&text)?;
        let word = |key: &str| all[key].as_str().unwrap_or("").to_owned();
        let differences = differences(&word("version"), &word("sweep_file"), sweep);
        match differences.is_empty() {
            true => Ok(Some(word("ending"))),
            false => Err(RunError::OtherSweep {
                path: home.to_owned(),
                differences,
            }),
        }
    }

    /// Whether the folder holds solves of a map that did not come to its end.
    pub fn has_journal(home: &Path) -> bool {
        home.join(PART).is_file()
    }

    /// A new journal for what a map of a resolved sweep asks to be solved; that of an unfinished one is kept below
    /// `previous/`.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub fn begin(&self, sweep: &str) -> Result<Journal, RunError> {
        self.staging.keep_aside(&[PART])?;
        Journal::create(&self.staging.home().join(PART), sweep)
    }

    /// The journal of the unfinished map in the folder.
    ///
    /// # Errors
    /// [`RunError::NoJournal`], [`RunError::OtherSweep`], [`RunError::Journal`], [`RunError::Read`].
    pub fn go_on(&self, sweep: &str) -> Result<Journal, RunError> {
        Journal::open(&self.staging.home().join(PART), sweep)
    }

    /// Removes the journal: what it has is written elsewhere, or nothing is in it.
    pub fn close_journal(&self) {
        // One that stays is of a map that is complete, which is looked at first.
        let _ = std::fs::remove_file(self.staging.home().join(PART));
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
        let (family, plane) = (&map.subject.family, &map.plane);
        let curves = map.curves.as_slice();
        for (name, text) in [
            ("map.csv", map_csv(map)?),
            ("curves.csv", several_csv(family, plane, curves, &[])?),
            (
                "codimension_two.csv",
                codimension_two_csv(family, plane, curves)?,
            ),
            (
                "codimension_two.tex",
                codimension_two_tex(family, plane, curves),
            ),
            ("map.json", map_json(map, sweep, seconds)?),
            (plane_file::NAME, plane_file::of_map(map, sweep)),
        ] {
            write_atomically(&self.staging.fresh().join(name), text.as_bytes())?;
        }
        for (index, observable) in map.subject.observables.iter().enumerate() {
            let name = format!("{}.csv", observable.name(family));
            let place = self.staging.fresh().join("densities").join(name);
            if let Some(text) = densities_csv(map, index) {
                write_atomically(&place, text.as_bytes())?;
            }
        }
        Ok(())
    }

    /// Puts the map in its place and returns its files; what an earlier one left goes below `previous/`. The journal
    /// goes, unless the map was interrupted.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub fn take_place(self, interrupted: bool) -> Result<Vec<PathBuf>, RunError> {
        let fresh = self.staging.fresh();
        checksums::write_listed(&fresh, &ENTRIES)?;
        sync_all(&[fresh])?;
        let part = self.staging.home().join(PART);
        let placed = self.staging.take_place(&[])?;
        if !interrupted {
            // One that stays is of a map that is complete, which is looked at first.
            let _ = std::fs::remove_file(part);
        }
        Ok(placed.files)
    }
}
