//! Curves in a plane of two parameters on disk: `curves.csv`, `curve.json`.

use serde_json::json;

use super::RunError;
use super::columns::{Column, flag, number, word};
use crate::continuation::curve::{
    Curve, CurveEnd, CurvePoint, CurveTree, CurveWork, LevelCurve, Plane, level_name,
};
use crate::system::Family;

/// Folder of a run below which its curves have a folder each.
pub const FOLDER: &str = "curves";

/// What a curve is called, by its place among several.
pub(crate) fn curve_name(index: usize) -> String {
    format!("C{}", index + 1)
}

/// A point of a curve as a row of a table.
pub(super) struct CurveRow<'a> {
    pub(super) label: String,
    pub(super) curve: &'a Curve,
    pub(super) point: &'a CurvePoint,
}

/// The labels of the points of a curve, from end to end, most of them empty; `start` is that of its start.
pub(crate) fn point_labels(curve: &Curve, start: &str) -> Vec<String> {
    let mut labels = end_labels(&curve.ends, (curve.start, start), curve.points.len());
    for split in &curve.degenerate {
        if let Some(label) = labels.get_mut(split.point).filter(|label| label.is_empty()) {
            label.clone_from(&split.label);
        }
    }
    labels
}

/// Those of the start and the ends alone, of so many points; the start goes before an end.
pub(crate) fn end_labels(
    ends: &[CurveEnd],
    (start, label): (usize, &str),
    points: usize,
) -> Vec<String> {
    let of_point = |index: usize| {
        let end = ends.iter().find(|end| end.point == index);
        match end {
            _ if index == start => label.to_owned(),
            Some(end) => end.label.clone(),
            None => String::new(),
        }
    };
    (0..points).map(of_point).collect()
}

/// The rows of a curve, from end to end.
pub(super) fn rows<'a>(curve: &'a Curve, start: &str) -> Vec<CurveRow<'a>> {
    let points = point_labels(curve, start).into_iter().zip(&curve.points);
    let row = |(label, point)| CurveRow {
        label,
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
        word("method", |row: &Row<'_>| row.curve.kind.name()),
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
        word("status", |row: &Row<'_>| row.point.status().word()),
        number("error_solver", |row: &Row<'_>| row.point.parts.solver),
        number("error_grid", |row: &Row<'_>| row.point.parts.grid),
        number("error_sampling", |row: &Row<'_>| row.point.parts.sampling),
        number("error_leak", |row: &Row<'_>| row.point.parts.leak),
    ]
}

/// What there is to know of curves beside their points, as JSON.
pub(super) fn curve_json(
    family: &Family,
    plane: &Plane,
    tree: &CurveTree,
    start: &str,
    (sweep, of): (&str, &str),
) -> Result<String, RunError> {
    let interrupted = tree.curves.iter().any(Curve::is_interrupted)
        || tree.levels.iter().any(LevelCurve::is_interrupted);
    let sides = plane.sides().iter();
    let curves = tree.curves.iter().enumerate();
    let missed = tree.missed.iter().map(|missed| {
        json!({
            "method": missed.start.kind.name(),
            "near": missed.start.values,
            "reason": missed.reason,
        })
    });
    let mut text = json!({
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
    if !tree.levels.is_empty() {
        text["levels"] = levels_json(plane, &tree.levels);
    }
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
        "ends": ends_json(&curve.plane, &curve.ends),
        "codimension_two": curve
            .degenerate
            .iter()
            .map(|one| json!({ "label": one.label, "kind": one.kind.name(), "point": one.point }))
            .collect::<Vec<_>>(),
        "work": work_json(&curve.work),
        "check_work": work_json(&curve.check_work),
    })
}

/// Curves of levels without their points.
pub(super) fn levels_json(plane: &Plane, levels: &[LevelCurve]) -> serde_json::Value {
    let curves = levels.iter().enumerate();
    let one = |(index, curve): (usize, &LevelCurve)| {
        json!({
            "name": level_name(index),
            "measure": curve.asked.measure,
            "level": curve.asked.level,
            "points": curve.points.len(),
            "start": curve.start,
            "ends": ends_json(plane, &curve.ends),
            "work": work_json(&curve.work),
        })
    };
    curves.map(one).collect()
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
fn ends_json(plane: &Plane, ends: &[CurveEnd]) -> Vec<serde_json::Value> {
    let ends = ends.iter().map(|end| {
        json!({
            "label": end.label,
            "reason": end.reason.words(plane),
            "point": end.point,
        })
    });
    ends.collect()
}
