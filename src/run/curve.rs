//! A curve in a plane of two parameters on disk: `curves.csv`, `curve.json`, and the folder they go to.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::RunError;
use super::atomic::{sync_all, write_atomically};
use super::checksums;
use super::codimension::{codimension_two_csv, codimension_two_tex, curve_name, several_csv};
use super::columns::{Column, flag, number, word};
use super::journal::{Journal, came_to_its_end};
use super::plane_file;
use super::staging::Staging;
use crate::continuation::curve::{Curve, CurveOrigin, CurvePoint, CurveTree, CurveWork, Plane};
use crate::system::Family;

/// Everything a curve leaves in its folder, the file that marks it as one first.
pub(super) const ENTRIES: [&str; 7] = [
    "curve.json",
    checksums::NAME,
    plane_file::NAME,
    "curves.csv",
    "codimension_two.csv",
    "codimension_two.tex",
    "figures",
];

/// Folder of a run below which its curves have a folder each.
pub const FOLDER: &str = "curves";

/// What unfinished curves have solved.
pub(super) const PART: &str = "curve.part.bin";

/// The table of the points of curves in one plane, each from end to end, numbers in full; `start` is the label of the
/// row that the first was begun at.
///
/// # Errors
/// [`RunError::Table`].
pub fn curves_csv(
    family: &Family,
    plane: &Plane,
    curves: &[Curve],
    start: &str,
) -> Result<String, RunError> {
    several_csv(family, plane, curves, &[start])
}

/// A point of a curve as a row of a table.
pub(super) struct CurveRow<'a> {
    pub(super) label: String,
    pub(super) curve: &'a Curve,
    pub(super) point: &'a CurvePoint,
}

/// The rows of a curve, from end to end.
pub(super) fn rows<'a>(curve: &'a Curve, start: &str) -> Vec<CurveRow<'a>> {
    let label = |index: usize| {
        let mut ends = curve.ends.iter();
        match ends.find(|end| end.point == index) {
            _ if index == curve.start => start.to_owned(),
            Some(end) => end.label.clone(),
            None => {
                let mut splits = curve.degenerate.iter();
                let split = splits.find(|split| split.point == index);
                split.map_or_else(String::new, |split| split.label.clone())
            }
        }
    };
    let points = curve.points.iter().enumerate();
    let row = |(index, point)| CurveRow {
        label: label(index),
        curve,
        point,
    };
    points.map(row).collect()
}

/// The columns of curves in a plane.
pub(super) fn columns<'a>(family: &'a Family, plane: &Plane) -> Vec<Column<'a, CurveRow<'a>>> {
    type Row<'a> = CurveRow<'a>;
    let [first, second] = plane.sides().each_ref().map(|side| side.parameter.clone());
    vec![
        word("label", |row: &Row<'_>| row.label.clone()),
        number(first.clone(), |row: &Row<'_>| row.point.values[0]),
        number(second.clone(), |row: &Row<'_>| row.point.values[1]),
        number("error", |row: &Row<'_>| row.point.error),
        number(format!("edge_{first}"), |row: &Row<'_>| {
            row.point.to_edge[0]
        }),
        number(format!("edge_{second}"), |row: &Row<'_>| {
            row.point.to_edge[1]
        }),
        word("observable", |row: &Row<'_>| {
            row.curve.observable.name(family)
        }),
        word("method", |row: &Row<'_>| row.curve.kind.name().to_owned()),
        number("indicator", |row: &Row<'_>| row.point.indicator),
        number(format!("indicator_by_{first}"), |row: &Row<'_>| {
            row.point.gradient[0]
        }),
        number(format!("indicator_by_{second}"), |row: &Row<'_>| {
            row.point.gradient[1]
        }),
        number("arclength", |row: &Row<'_>| row.point.arclength),
        number("slope", |row: &Row<'_>| {
            row.point.tangent[1] / row.point.tangent[0]
        }),
        flag("checked", |row: &Row<'_>| row.point.checked),
        word("status", |row: &Row<'_>| row.point.status.word().to_owned()),
        number("error_solver", |row: &Row<'_>| row.point.parts.solver),
        number("error_grid", |row: &Row<'_>| row.point.parts.grid),
        number("error_sampling", |row: &Row<'_>| row.point.parts.sampling),
        number("error_leak", |row: &Row<'_>| row.point.parts.leak),
    ]
}

/// What there is to know of curves beside their points, as JSON.
fn curve_json(
    family: &Family,
    plane: &Plane,
    tree: &CurveTree,
    start: &str,
    (sweep, of): (&str, &str),
) -> Result<String, RunError> {
    let interrupted = tree.curves.iter().any(Curve::is_interrupted);
    let sides = plane.sides().iter();
    let curves = tree.curves.iter().enumerate();
    let missed = tree.missed.iter().map(|missed| {
        json!({
            "method": missed.start.kind.name(),
            "near": missed.start.values,
            "reason": missed.reason,
        })
    });
    let text = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "ending": if interrupted { "interrupted" } else { "complete" },
        "row": start,
        "box": sides
            .map(|side| json!({ "parameter": side.parameter, "from": side.from, "to": side.to }))
            .collect::<Vec<_>>(),
        "curves": curves
            .map(|(index, curve)| one_json(family, index, curve))
            .collect::<Vec<_>>(),
        "not_followed": missed.collect::<Vec<_>>(),
        "sweep_file": sweep,
        "made_of": of,
    });
    Ok(serde_json::to_string_pretty(&text)? + "\n")
}

/// A curve without its points.
pub(super) fn one_json(family: &Family, index: usize, curve: &Curve) -> serde_json::Value {
    json!({
        "name": curve_name(index),
        "observable": curve.observable.name(family),
        "method": curve.kind.name(),
        "points": curve.points.len(),
        "start": curve.start,
        "ends": ends_json(curve),
        "codimension_two": curve
            .degenerate
            .iter()
            .map(|one| json!({ "label": one.label, "kind": one.kind.name(), "point": one.point }))
            .collect::<Vec<_>>(),
        "work": work_json(&curve.work),
        "check_work": work_json(&curve.check_work),
    })
}

/// What solves took.
pub(super) fn work_json(work: &CurveWork) -> serde_json::Value {
    json!({
        "solves": work.solves,
        "iterations": work.iterations,
        "factorisations": work.factorisations,
    })
}

/// The ends of a curve with their reasons.
fn ends_json(curve: &Curve) -> Vec<serde_json::Value> {
    let ends = curve.ends.iter().map(|end| {
        json!({
            "label": end.label,
            "reason": end.reason.words(&curve.plane),
            "point": end.point,
        })
    });
    ends.collect()
}

/// A curve's folder in the making. Dropped before it is in place, it leaves what was there.
#[derive(Debug)]
pub struct CurveFolder {
    staging: Staging,
}

impl CurveFolder {
    /// Prepares to write to `home`, an existing folder; other processes are kept away from it.
    ///
    /// # Errors
    /// [`RunError::InUse`], [`RunError::NotOurs`], [`RunError::Write`].
    pub fn new(home: &Path) -> Result<Self, RunError> {
        let staging = Staging::new(home, &ENTRIES)?;
        Ok(Self { staging })
    }

    /// Whether the folder holds curves that came to their end, and are of what `of` describes.
    ///
    /// # Errors
    /// [`RunError::OtherSweep`], with every difference, where they are of something else; [`RunError::Json`].
    pub fn is_complete(home: &Path, of: &str) -> Result<bool, RunError> {
        came_to_its_end(home, ENTRIES[0], of)
    }

    /// Whether the folder holds solves of curves that did not come to their end.
    pub fn has_journal(home: &Path) -> bool {
        home.join(PART).is_file()
    }

    /// A new journal for what the curves ask to be solved, which `of` describes as TOML; that of unfinished ones is
    /// kept below `previous/`.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub fn begin(&self, of: &str) -> Result<Journal, RunError> {
        self.staging.keep_aside(&[PART])?;
        Journal::create(&self.staging.home().join(PART), of)
    }

    /// The journal of the unfinished curves in the folder.
    ///
    /// # Errors
    /// [`RunError::NoJournal`], [`RunError::OtherSweep`], [`RunError::Journal`], [`RunError::Read`].
    pub fn go_on(&self, of: &str) -> Result<Journal, RunError> {
        Journal::open(&self.staging.home().join(PART), of)
    }

    /// Where figures are drawn to.
    pub fn figures(&self) -> PathBuf {
        self.staging.fresh().join("figures")
    }

    /// Writes the tables; `origin` is the row that the first curve was begun at, `sweep` the resolved sweep as TOML,
    /// `of` what describes the curves besides.
    ///
    /// # Errors
    /// [`RunError`] when a file cannot be composed or written.
    pub fn write(
        &self,
        family: &Family,
        plane: &Plane,
        tree: &CurveTree,
        (origin, sweep, of): (&CurveOrigin, &str, &str),
    ) -> Result<(), RunError> {
        let start = origin.label.as_str();
        let curves = tree.curves.as_slice();
        for (name, text) in [
            ("curves.csv", curves_csv(family, plane, curves, start)?),
            (
                "codimension_two.csv",
                codimension_two_csv(family, plane, curves)?,
            ),
            (
                "codimension_two.tex",
                codimension_two_tex(family, plane, curves),
            ),
            (
                "curve.json",
                curve_json(family, plane, tree, start, (sweep, of))?,
            ),
            (
                plane_file::NAME,
                plane_file::of_curves(plane, curves, origin, sweep),
            ),
        ] {
            write_atomically(&self.staging.fresh().join(name), text.as_bytes())?;
        }
        Ok(())
    }

    /// Puts the curve in its place and returns its files; what an earlier one left goes below `previous/`. The journal
    /// goes, unless the curves were interrupted.
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
            // One that stays is of curves that are complete, which are looked at first.
            let _ = std::fs::remove_file(part);
        }
        Ok(placed.files)
    }
}
