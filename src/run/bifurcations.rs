//! `bifurcations.csv`, `.md`, `.tex`, `.json`: the table of labelled points.
//!
//! The CSV and JSON hold every label, end points (`EP`) included; the tables for people leave those out.

use super::columns::{Columns, number, optional, word};
use super::{
    RunError,
    latex::{self, escape},
    number::format_with_error,
};
use crate::continuation::{LabelledPoint, PointType};
use crate::system::Family;
use crate::topology::Signature;

/// The table's columns; numbers in full.
fn columns<'a>(family: &'a Family) -> Columns<'a, LabelledPoint> {
    type Row = LabelledPoint;
    Columns(vec![
        word("label", |row: &Row| row.label.clone()),
        word("parameter", move |_| family.parameter().to_owned()),
        number("value", |row: &Row| row.value),
        number("error", |row: &Row| row.error),
        number("lower", |row: &Row| row.lower),
        number("upper", |row: &Row| row.upper),
        word("observable", move |row: &Row| observable(family, row)),
        word("before", |row: &Row| words(row.before)),
        word("after", |row: &Row| words(row.after)),
        word("status", |row: &Row| status(row).to_owned()),
        word("change", |row: &Row| row.change.to_owned()),
        word("method", |row: &Row| row.method.to_owned()),
        optional("error_solver", |row: &Row| {
            row.parts.map(|parts| parts.solver)
        }),
        optional("error_grid", |row: &Row| row.parts.map(|parts| parts.grid)),
        optional("error_sampling", |row: &Row| {
            row.parts.map(|parts| parts.sampling)
        }),
        optional("error_leak", |row: &Row| row.parts.map(|parts| parts.leak)),
        word("reason", |row: &Row| row.reason.clone().unwrap_or_default()),
    ])
}

fn observable(family: &Family, row: &LabelledPoint) -> String {
    let observable = row.observable;
    observable.map_or(String::new(), |one| one.name(family))
}

fn words(signature: Option<Signature>) -> String {
    signature.map_or(String::new(), |signature| signature.to_string())
}

fn status(row: &LabelledPoint) -> &'static str {
    row.status.map_or("", |status| status.word())
}

/// The CSV, numbers in full.
///
/// # Errors
/// [`RunError::Table`].
pub fn bifurcations_csv(family: &Family, labels: &[LabelledPoint]) -> Result<String, RunError> {
    columns(family).csv(labels)
}

/// The JSON: a list of objects with the CSV's keys, numbers as numbers, absent entries as null.
///
/// # Errors
/// [`RunError::Json`].
pub fn bifurcations_json(family: &Family, labels: &[LabelledPoint]) -> Result<String, RunError> {
    let rows = columns(family).json(labels);
    Ok(serde_json::to_string_pretty(&rows)? + "\n")
}

/// The Markdown table, values rounded to their errors.
pub fn bifurcations_markdown(family: &Family, labels: &[LabelledPoint]) -> String {
    let mut text = format!(
        "| label | {} | bracket | observable | before | after | change | status |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n",
        family.parameter()
    );
    for row in labels.iter().filter(|row| row.kind != PointType::EndPoint) {
        let (value, error) = format_with_error(row.value, row.error);
        let (lower, _) = format_with_error(row.lower, row.error);
        let (upper, _) = format_with_error(row.upper, row.error);
        let (observable, before, after) =
            (observable(family, row), words(row.before), words(row.after));
        let status = match row.kind {
            PointType::NoConvergence => "no steady state or not converged",
            _ => status(row),
        };
        text += &format!(
            "| {} | {value} ± {error} | [{lower}, {upper}] | {observable} | {before} | {after} | {} | {status} |\n",
            row.label, row.change
        );
    }
    text
}

/// A LaTeX table with booktabs rules, values rounded to their errors.
pub fn bifurcations_tex(family: &Family, labels: &[LabelledPoint]) -> String {
    let mut text = String::from(
        "% needs \\usepackage{booktabs}\n\\begin{tabular}{lllllll}\n\\toprule\nlabel & $",
    );
    text += &latex::parameter(family);
    text += "$ & density & below & above & change & status \\\\\n\\midrule\n";
    for row in labels.iter().filter(|row| row.kind != PointType::EndPoint) {
        let (value, error) = format_with_error(row.value, row.error);
        let density = row.observable.map_or(String::new(), |observable| {
            format!("$p({})$", latex::observable(family, observable))
        });
        let (before, after) = (words(row.before), words(row.after));
        let [label, before, after, change, status] =
            [&row.label, &before, &after, row.change, status(row)].map(escape);
        text += &format!(
            "{label} & ${value} \\pm {error}$ & {density} & {before} & {after} & {change} & {status} \\\\\n"
        );
    }
    text + "\\bottomrule\n\\end{tabular}\n"
}
