//! The tables of the points of codimension two, as CSV and for LaTeX, and the table of several curves.

use super::columns::{Columns, number, word};
use super::curve::{self, CurveRow, curve_json, curve_name, rows};
use super::levels_table::levels_file;
use super::number::{format_number, format_with_error};
use super::stability::stability_file;
use super::{RunError, latex, plane_file};
use crate::continuation::curve::{
    CodimensionTwo, Curve, CurveOrigin, CurveTree, LevelCurve, Plane, codimension_two,
};
use crate::system::Family;

/// The table of several curves in a plane; the first column has the curve's name. `starts` are the labels of their
/// starts; those without one are called `start`.
fn several_csv(
    family: &Family,
    plane: &Plane,
    curves: &[Curve],
    starts: &[&str],
) -> Result<String, RunError> {
    let mut text = several_columns(family, plane, 0).header()?;
    for (index, curve) in curves.iter().enumerate() {
        let start = starts.get(index).copied().unwrap_or("start");
        text += &several_columns(family, plane, index).lines(&rows(curve, start))?;
    }
    Ok(text)
}

/// The tables of curves in a plane by the names of their files; `starts` are the labels of their starts.
pub(super) fn plane_files(
    family: &Family,
    plane: &Plane,
    (curves, levels): (&[Curve], &[LevelCurve]),
    starts: &[&str],
) -> Result<Vec<(String, String)>, RunError> {
    let points = codimension_two_csv(family, plane, curves)?;
    let rounded = codimension_two_tex(family, plane, curves);
    let mut files = vec![
        (
            "curves.csv".to_owned(),
            several_csv(family, plane, curves, starts)?,
        ),
        ("codimension_two.csv".to_owned(), points),
        ("codimension_two.tex".to_owned(), rounded),
    ];
    files.extend(stability_file(family, plane)?);
    files.extend(levels_file(plane, levels, starts)?);
    Ok(files)
}

/// The columns of the table of several curves, for the rows of one of them.
pub(super) fn several_columns<'a>(
    family: &'a Family,
    plane: &Plane,
    index: usize,
) -> Columns<'a, CurveRow<'a>> {
    let mut all = vec![word("curve", move |_| curve_name(index))];
    all.extend(curve::columns(family, plane));
    Columns(all)
}

/// The files of curves in a plane by their names; `origin` is the row that the first was begun at, `sweep` the resolved
/// sweep as TOML, `of` what describes the curves besides.
///
/// # Errors
/// [`RunError`] when a file cannot be composed.
pub(crate) fn curve_files(
    family: &Family,
    plane: &Plane,
    tree: &CurveTree,
    (origin, sweep, of): (&CurveOrigin, &str, &str),
) -> Result<Vec<(String, String)>, RunError> {
    let start = origin.label.as_str();
    let curves = (tree.curves.as_slice(), tree.levels.as_slice());
    let mut files = plane_files(family, plane, curves, &[start])?;
    files.extend([
        (
            "curve.json".to_owned(),
            curve_json(family, plane, tree, start, (sweep, of))?,
        ),
        (
            plane_file::NAME.to_owned(),
            plane_file::of_curves(plane, tree, origin, sweep),
        ),
    ]);
    Ok(files)
}

/// The table of the points of codimension two of curves.
fn codimension_two_csv(
    family: &Family,
    plane: &Plane,
    curves: &[Curve],
) -> Result<String, RunError> {
    columns(family, plane).csv(&codimension_two(curves))
}

/// The columns of that table.
pub(super) fn columns<'a>(family: &'a Family, plane: &Plane) -> Columns<'a, CodimensionTwo> {
    let [first, second] = parameters(plane);
    Columns(vec![
        word("label", |one: &CodimensionTwo| one.label.clone()),
        word("kind", |one: &CodimensionTwo| one.kind.name()),
        number(first, |one: &CodimensionTwo| one.values[0]),
        number(second, |one: &CodimensionTwo| one.values[1]),
        number("error", |one: &CodimensionTwo| one.error),
        word("status", |one: &CodimensionTwo| one.status().word()),
        word("observable", move |one: &CodimensionTwo| {
            observables(family, one)
        }),
        word("place", |one: &CodimensionTwo| {
            join(one.place.iter().map(|&x| format_number(x)))
        }),
        word("curves", |one: &CodimensionTwo| {
            join(one.curves.iter().map(|&index| curve_name(index)))
        }),
    ])
}

/// The same for LaTeX (with the package `booktabs`), values rounded to their errors.
fn codimension_two_tex(family: &Family, plane: &Plane, curves: &[Curve]) -> String {
    let [first, second] = parameters(plane).map(|name| latex::mathematics(family.symbol_of(&name)));
    let mut text = format!(
        "\\begin{{tabular}}{{llrrll}}\n\\toprule\n & & ${first}$ & ${second}$ & density & curves \\\\\n\\midrule\n"
    );
    for one in codimension_two(curves) {
        let values = [0, 1].map(|k| {
            let error = one.error * plane.sides()[k].length();
            let (value, error) = format_with_error(one.values[k], error);
            format!("${value} \\pm {error}$")
        });
        let curves = join(one.curves.iter().map(|&index| curve_name(index)));
        let observables = one.observables.iter();
        let observables: Vec<String> = observables
            .map(|&observable| latex::observable(family, observable))
            .collect();
        text += &format!(
            "{} & {} & {} & {} & ${}$ & {curves} \\\\\n",
            one.label,
            one.kind.name(),
            values[0],
            values[1],
            observables.join("$ and $"),
        );
    }
    text + "\\bottomrule\n\\end{tabular}\n"
}

fn parameters(plane: &Plane) -> [String; 2] {
    plane.sides().each_ref().map(|side| side.parameter.clone())
}

fn observables(family: &Family, one: &CodimensionTwo) -> String {
    join(
        one.observables
            .iter()
            .map(|observable| observable.name(family)),
    )
}

fn join(words: impl Iterator<Item = String>) -> String {
    words.collect::<Vec<_>>().join(" ")
}
