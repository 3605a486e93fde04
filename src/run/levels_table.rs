//! `levels.csv`: the curves in a plane of two parameters on which a number of the steady state is at a level.

use super::RunError;
use super::columns::{Columns, number, word};
use super::curve::end_labels;
use crate::continuation::curve::{CurvePoint, LevelCurve, Plane, level_name};

/// The file, in the folder of a map or of curves.
pub(super) const NAME: &str = "levels.csv";

/// A point of such a curve as a row.
pub(super) struct LevelRow<'a> {
    name: String,
    label: String,
    curve: &'a LevelCurve,
    point: &'a CurvePoint,
}

/// The table with its name; none without such a curve. `starts` are the labels of their starts; those without one are
/// called `start`.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn levels_file(
    plane: &Plane,
    curves: &[LevelCurve],
    starts: &[&str],
) -> Result<Option<(String, String)>, RunError> {
    if curves.is_empty() {
        return Ok(None);
    }
    let rows = curves.iter().enumerate().flat_map(|(index, curve)| {
        let start = starts.get(index).copied().unwrap_or("start");
        let labels = end_labels(&curve.ends, (curve.start, start), curve.points.len());
        let points = labels.into_iter().zip(&curve.points);
        points.map(move |(label, point)| LevelRow {
            name: level_name(index),
            label,
            curve,
            point,
        })
    });
    let rows: Vec<LevelRow<'_>> = rows.collect();
    let columns = columns(plane);
    Ok(Some((NAME.to_owned(), columns.csv(&rows)?)))
}

/// The columns of that table for curves in this plane.
pub(super) fn columns<'a>(plane: &Plane) -> Columns<'a, LevelRow<'a>> {
    let [first, second] = plane.sides().each_ref().map(|side| side.parameter.clone());
    let edges = [0, 1].map(|k| format!("edge_{}", plane.sides()[k].parameter));
    let [edge_first, edge_second] = edges;
    Columns(vec![
        word("curve", |row: &LevelRow<'_>| row.name.clone()),
        word("label", |row: &LevelRow<'_>| row.label.clone()),
        number(first, |row: &LevelRow<'_>| row.point.values[0]),
        number(second, |row: &LevelRow<'_>| row.point.values[1]),
        number("error", |row: &LevelRow<'_>| row.point.error),
        number(edge_first, |row: &LevelRow<'_>| row.point.to_edge[0]),
        number(edge_second, |row: &LevelRow<'_>| row.point.to_edge[1]),
        word("measure", |row: &LevelRow<'_>| {
            row.curve.asked.measure.clone()
        }),
        number("level", |row: &LevelRow<'_>| row.curve.asked.level),
        number("arclength", |row: &LevelRow<'_>| row.point.arclength),
        word("status", |row: &LevelRow<'_>| row.point.status().word()),
    ])
}
