//! `plane.json`: all that figures of a map, or of curves, are drawn from, so that they can be drawn again without
//! solving.

mod read;

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::place::{FIGURES, folder_in, read_text};
use super::placing::finish_after_kill;
use super::{RunError, checksums};
use crate::continuation::curve::{
    Curve, CurveEnd, CurveOrigin, CurvePoint, CurveTree, EndReason, LevelCurve, Plane,
};
use crate::continuation::map::{RegimeMap, UntracedChange};
use crate::method::Problem;
use read::{curve, level, list, map, origin};

/// The file, in the folder of a map or of curves.
pub(super) const NAME: &str = "plane.json";

/// The file of a map.
pub(super) fn of_map(map: &RegimeMap, sweep: &str) -> String {
    let samples = map.samples.iter().map(|one| {
        json!({ "observable": one.observable, "values": one.values, "density": one.density.values })
    });
    let untraced = map.untraced.iter().map(|one| {
        let mut told = json!({
            "pairs": one.pairs,
            "near": one.near,
            "reason": one.reason,
        });
        match &one.of {
            UntracedChange::Signature(observable) => told["observable"] = json!(observable),
            UntracedChange::Level(asked) => told["level"] = json!([asked.measure, asked.level]),
        }
        told
    });
    let map_json = json!({
        "nodes": map.nodes,
        "cells": map.cells,
        "samples": samples.collect::<Vec<_>>(),
        "not_followed": untraced.collect::<Vec<_>>(),
        "interrupted": map.interrupted,
    });
    compose(
        &map.plane,
        (&map.curves, &map.levels),
        sweep,
        ("map", map_json),
    )
}

/// The file of curves that were begun at a row.
pub(super) fn of_curves(
    plane: &Plane,
    tree: &CurveTree,
    origin: &CurveOrigin,
    sweep: &str,
) -> String {
    let row = json!({
        "label": origin.label,
        "value": origin.value,
        "sides": origin.sides,
    });
    compose(plane, (&tree.curves, &tree.levels), sweep, ("row", row))
}

fn compose(
    plane: &Plane,
    (curves, levels): (&[Curve], &[LevelCurve]),
    sweep: &str,
    (key, value): (&str, Value),
) -> String {
    let sides = plane.sides().iter();
    let sides = sides.map(|side| json!([side.parameter, side.from, side.to]));
    let mut all = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "box": sides.collect::<Vec<_>>(),
        "curves": curves.iter().map(curve_json).collect::<Vec<_>>(),
        "sweep_file": sweep,
    });
    all[key] = value;
    if !levels.is_empty() {
        all["levels"] = levels.iter().map(level_json).collect();
    }
    all.to_string() + "\n"
}

fn level_json(curve: &LevelCurve) -> Value {
    json!({
        "measure": curve.asked.measure,
        "level": curve.asked.level,
        "start": curve.start,
        "ends": ends_json(&curve.ends),
        "points": curve.points.iter().map(point_json).collect::<Vec<_>>(),
    })
}

fn ends_json(ends: &[CurveEnd]) -> Vec<Value> {
    let ends = ends.iter().map(|end| {
        let (word, detail) = reason_words(&end.reason);
        json!([end.label, end.point, word, detail])
    });
    ends.collect()
}

fn curve_json(curve: &Curve) -> Value {
    let splits = curve.degenerate.iter();
    let splits = splits.map(|one| json!([one.label, one.point, one.kind.name()]));
    json!({
        "observable": curve.observable.axes(),
        "kind": curve.kind.code(),
        "start": curve.start,
        "ends": ends_json(&curve.ends),
        "degenerate": splits.collect::<Vec<_>>(),
        "points": curve.points.iter().map(point_json).collect::<Vec<_>>(),
    })
}

fn point_json(point: &CurvePoint) -> Value {
    let parts = &point.parts;
    json!({
        "values": point.values,
        "error": point.error,
        "parts": [parts.solver, parts.grid, parts.sampling, parts.leak],
        "to_edge": point.to_edge,
        "indicator": point.indicator,
        "gradient": point.gradient,
        "place": point.place,
        "arclength": point.arclength,
        "tangent": point.tangent,
        "checked": point.checked,
        "status": point.status().word(),
    })
}

/// The words for why a curve ends, where there is nothing else to know of it.
static REASONS: [(EndReason, &str); 13] = [
    (EndReason::Closed, "closed"),
    (EndReason::Cusp, "cusp"),
    (EndReason::DegenerateSplit, "degenerate split"),
    (EndReason::DegenerateKink, "degenerate kink"),
    (EndReason::KinkCorner, "corner at a kink"),
    (EndReason::FeatureLost, "feature lost"),
    (EndReason::SymmetryLost, "symmetry lost"),
    (EndReason::NumberLost, "number lost"),
    (EndReason::Singular, "singular"),
    (EndReason::NotConverged, "not converged"),
    (EndReason::Sampling, "sampling"),
    (EndReason::TooManyPoints, "too many points"),
    (EndReason::Interrupted, "interrupted"),
];
const BORDER: &str = "border";
const NO_DENSITY: &str = "no density";

/// A word for why a curve ends, and what else there is to know of it.
fn reason_words(reason: &EndReason) -> (&'static str, Value) {
    match reason {
        EndReason::Border(side) => (BORDER, json!(side)),
        EndReason::NoDensity(why) => (NO_DENSITY, json!(why)),
        reason => {
            let known = REASONS.iter().find(|(known, _)| known == reason);
            (known.map_or("", |(_, word)| word), Value::Null)
        }
    }
}

/// What a folder holds that figures of a plane are drawn from.
#[derive(Debug, Clone)]
pub enum StoredPlaneContent {
    /// A map of regimes.
    Map(Box<RegimeMap>),
    /// Curves that were begun at a row of a sweep.
    Curves(Box<Plane>, Box<CurveTree>, CurveOrigin),
}

/// The file of a map's folder, or of that of curves.
#[derive(Debug, Clone)]
pub struct StoredPlane {
    path: PathBuf,
    all: Value,
}

impl StoredPlane {
    /// Opens the file of a folder; `None` where the folder is of no map and of no curves.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Plane`], [`RunError::Version`] where it is of another version, and
    /// [`RunError::Damaged`] by the checksums of the folder.
    pub fn open(folder: &Path) -> Result<Option<Self>, RunError> {
        finish_after_kill(folder);
        let marks = ["map.json", "curve.json"].into_iter();
        let Some(mark) = marks.into_iter().find(|mark| folder.join(mark).is_file()) else {
            return Ok(None);
        };
        let path = folder.join(NAME);
        let text = read_text(&path);
        let text = text.map_err(RunError::reading(&path))?;
        let broken = |message: String| RunError::Plane {
            path: path.clone(),
            message,
        };
        let all: Value = serde_json::from_str(&text).map_err(|error| broken(error.to_string()))?;
        let word = |key: &str| all[key].as_str().unwrap_or("nothing").to_owned();
        let found = format!("{} {}", word("program"), word("version"));
        let wanted = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")).to_owned();
        if found != wanted {
            return Err(RunError::Version {
                path,
                found,
                wanted,
            });
        }
        checksums::require(folder, &[mark, NAME])?;
        Ok(Some(Self { path, all }))
    }

    /// Where its figures are drawn.
    ///
    /// # Errors
    /// [`RunError::Elsewhere`].
    pub(crate) fn figures(&self) -> Result<PathBuf, RunError> {
        folder_in(self.path.parent().unwrap_or(&self.path), FIGURES)
    }

    /// Notes in the checksums of the folder that these figures were drawn again.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Write`], [`RunError::Checksums`].
    pub(crate) fn renew_figures(&self, drawn: &[PathBuf]) -> Result<(), RunError> {
        let folder = self.path.parent().unwrap_or(&self.path);
        checksums::renew(folder, FIGURES, drawn)
    }

    /// The resolved sweep file as TOML.
    pub fn resolved(&self) -> &str {
        self.all["sweep_file"].as_str().unwrap_or_default()
    }

    /// The map, or the curves; `problem` is that of the sweep file.
    ///
    /// # Errors
    /// [`RunError::Plane`].
    pub fn content(&self, problem: &Problem) -> Result<StoredPlaneContent, RunError> {
        let broken = |message: &str| RunError::Plane {
            path: self.path.clone(),
            message: message.to_owned(),
        };
        let plane = self.plane().ok_or_else(|| broken("it has no box"))?;
        let curves = list(&self.all["curves"], |one| curve(one, &plane));
        let curves = curves.ok_or_else(|| broken("a curve cannot be understood"))?;
        let levels = match &self.all["levels"] {
            Value::Null => Some(Vec::new()),
            levels => list(levels, level),
        };
        let levels = levels.ok_or_else(|| broken("the curve of a level cannot be understood"))?;
        if self.all["map"].is_null() {
            let origin = origin(&self.all["row"]);
            let origin = origin.ok_or_else(|| broken("its row cannot be understood"))?;
            let tree = CurveTree {
                curves,
                levels,
                missed: Vec::new(),
            };
            let (plane, tree) = (Box::new(plane), Box::new(tree));
            return Ok(StoredPlaneContent::Curves(plane, tree, origin));
        }
        let map = map(&self.all["map"], problem, plane, (curves, levels));
        let map = map.ok_or_else(|| broken("its map cannot be understood"))?;
        Ok(StoredPlaneContent::Map(Box::new(map)))
    }

    /// The box; `None` where the file has none.
    pub fn plane(&self) -> Option<Plane> {
        let side = |index: usize| {
            let side = &self.all["box"][index];
            Some((side[0].as_str()?, side[1].as_f64()?, side[2].as_f64()?))
        };
        Plane::new(side(0)?, side(1)?).ok()
    }
}
