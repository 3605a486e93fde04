//! `levels.csv`: the curves in a plane of two parameters on which a number of the steady state is at a level.

use super::RunError;
use super::columns::{Columns, number, word};
use super::curve::end_labels;
use crate::continuation::curve::{CurvePoint, LevelCurve, Plane, level_name};

/// The file, in the folder of a map or of curves.
pub(super) const NAME: &str = "levels.csv";

/// A point of such a curve as a row.
struct Row<'a> {
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
        points.map(move |(label, point)| Row {
            name: level_name(index),
            label,
            curve,
            point,
        })
    });
    let rows: Vec<Row<'_>> = rows.collect();
    let [first, second] = plane.sides().each_ref().map(|side| side.parameter.clone());
    let edges = [0, 1].map(|k| format!("edge_{}", plane.sides()[k].parameter));
    let [edge_first, edge_second] = edges;
    let columns = Columns(vec![
        word("curve", |row: &Row<'_>| row.name.clone()),
        word("label", |row: &Row<'_>| row.label.clone()),
        number(first, |row: &Row<'_>| row.point.values[0]),
        number(second, |row: &Row<'_>| row.point.values[1]),
        number("error", |row: &Row<'_>| row.point.error),
        number(edge_first, |row: &Row<'_>| row.point.to_edge[0]),
        number(edge_second, |row: &Row<'_>| row.point.to_edge[1]),
        word("measure", |row: &Row<'_>| row.curve.asked.measure.clone()),
        number("level", |row: &Row<'_>| row.curve.asked.level),
        number("arclength", |row: &Row<'_>| row.point.arclength),
        word("status", |row: &Row<'_>| row.point.status().word()),
    ]);
    Ok(Some((NAME.to_owned(), columns.csv(&rows)?)))
}
