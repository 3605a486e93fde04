//! `stability.csv`: the curves of a fixed point in a plane of two parameters.

use super::RunError;
use super::columns::{Columns, number, word};
use crate::continuation::curve::{Plane, StabilityCurve, StabilityPoint, stability_curves};
use crate::system::Family;

/// The file, in the folder of a map or of curves.
pub(super) const NAME: &str = "stability.csv";

type Row<'a> = (&'a StabilityCurve, &'a StabilityPoint);

/// The table with its name; none of a family that asks for no fixed point.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn stability_file(
    family: &Family,
    plane: &Plane,
) -> Result<Option<(String, String)>, RunError> {
    if family.questions.fixed_point.is_none() {
        return Ok(None);
    }
    let curves = stability_curves(family, plane);
    let rows = curves.iter().flat_map(|curve| {
        let points = curve.points.iter();
        points.map(move |point| (curve, point))
    });
    let rows: Vec<Row<'_>> = rows.collect();
    let [first, second] = plane.sides().each_ref().map(|side| side.parameter.clone());
    let columns = Columns(vec![
        word("curve", |row: &Row<'_>| row.0.name.clone()),
        number(first, |row: &Row<'_>| row.1.values[0]),
        number(second, |row: &Row<'_>| row.1.values[1]),
        number("error", |row: &Row<'_>| row.1.error),
        word("method", |row: &Row<'_>| row.0.kind.name()),
    ]);
    Ok(Some((NAME.to_owned(), columns.csv(&rows)?)))
}
