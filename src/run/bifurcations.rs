//! `bifurcations.csv`, `.md`, `.tex`, `.json`: the table of labelled points.
//!
//! The CSV and JSON hold every label, end points (`EP`) included; the tables for people leave those out.

use super::{
    Naming, RunError,
    latex::escape,
    number::{format_number, format_with_error},
    tables::Table,
};
use crate::continuation::{LabelledPoint, PointType};

/// Columns of the table, in order.
const COLUMNS: [&str; 15] = [
    "label",
    "parameter",
    "value",
    "error",
    "lower",
    "upper",
    "observable",
    "before",
    "after",
    "status",
    "change",
    "method",
    "error_solver",
    "error_grid",
    "error_sampling",
];

/// Columns that are numbers.
const NUMBERS: [usize; 7] = [2, 3, 4, 5, 12, 13, 14];

/// One row as words, in the order of [`COLUMNS`]; numbers in full.
fn words(naming: &Naming<'_>, row: &LabelledPoint) -> [String; 15] {
    let text = |text: Option<String>| text.unwrap_or_default();
    [
        row.label.clone(),
        naming.parameter.to_owned(),
        format_number(row.value),
        format_number(row.error),
        format_number(row.lower),
        format_number(row.upper),
        text(
            row.observable
                .map(|observable| naming.observable(observable)),
        ),
        text(row.before.map(|signature| signature.to_string())),
        text(row.after.map(|signature| signature.to_string())),
        text(row.status.map(|status| status.word().to_owned())),
        row.change.to_owned(),
        row.method.to_owned(),
        text(row.parts.map(|parts| format_number(parts.solver))),
        text(row.parts.map(|parts| format_number(parts.grid))),
        text(row.parts.map(|parts| format_number(parts.sampling))),
    ]
}

/// The CSV, numbers in full.
///
/// # Errors
/// [`RunError::Table`].
pub fn bifurcations_csv(naming: &Naming<'_>, labels: &[LabelledPoint]) -> Result<String, RunError> {
    let mut table = Table::new(&COLUMNS.map(str::to_owned))?;
    for row in labels {
        table.row(&words(naming, row))?;
    }
    table.finish()
}

/// The JSON: a list of objects with the CSV's keys, numbers as numbers, absent entries as null.
///
/// # Errors
/// [`RunError::Json`].
pub fn bifurcations_json(
    naming: &Naming<'_>,
    labels: &[LabelledPoint],
) -> Result<String, RunError> {
    let rows: Vec<serde_json::Value> = labels
        .iter()
        .map(|row| {
            let words = words(naming, row);
            let entries = COLUMNS.iter().zip(words).enumerate();
            let object: serde_json::Map<_, _> = entries
                .map(|(index, (key, word))| {
                    let value = match word.parse::<f64>() {
                        _ if word.is_empty() => serde_json::Value::Null,
                        Ok(number) if NUMBERS.contains(&index) => serde_json::json!(number),
                        _ => word.into(),
                    };
                    ((*key).to_owned(), value)
                })
                .collect();
            object.into()
        })
        .collect();
    Ok(serde_json::to_string_pretty(&rows)? + "\n")
}

/// The Markdown table, values rounded to their errors.
pub fn bifurcations_markdown(naming: &Naming<'_>, labels: &[LabelledPoint]) -> String {
    let mut text = format!(
        "| label | {} | bracket | observable | before | after | change | status |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n",
        naming.parameter
    );
    for row in labels.iter().filter(|row| row.kind != PointType::EndPoint) {
        let (value, error) = format_with_error(row.value, row.error);
        let (lower, _) = format_with_error(row.lower, row.error);
        let (upper, _) = format_with_error(row.upper, row.error);
        let [
            label,
            _,
            _,
            _,
            _,
            _,
            observable,
            before,
            after,
            status,
            change,
            ..,
        ] = words(naming, row);
        let status = if row.kind == PointType::NoConvergence {
            "no steady state or not converged".to_owned()
        } else {
            status
        };
        text += &format!(
            "| {label} | {value} ± {error} | [{lower}, {upper}] | {observable} | {before} | {after} | {change} | {status} |\n"
        );
    }
    text
}

/// A LaTeX table with booktabs rules, values rounded to their errors.
pub fn bifurcations_tex(naming: &Naming<'_>, labels: &[LabelledPoint]) -> String {
    let mut text = String::from(
        "% needs \\usepackage{booktabs}\n\\begin{tabular}{lllllll}\n\\toprule\nlabel & $",
    );
    text += &naming.parameter_latex();
    text += "$ & density & below & above & change & status \\\\\n\\midrule\n";
    for row in labels.iter().filter(|row| row.kind != PointType::EndPoint) {
        let (value, error) = format_with_error(row.value, row.error);
        let density = row.observable.map_or(String::new(), |observable| {
            format!(
                "$p({})$",
                naming.observable_latex(observable).trim_matches(['(', ')'])
            )
        });
        let [label, _, _, _, _, _, _, before, after, status, change, ..] =
            words(naming, row).map(|word| escape(&word));
        text += &format!(
            "{label} & ${value} \\pm {error}$ & {density} & {before} & {after} & {change} & {status} \\\\\n"
        );
    }
    text + "\\bottomrule\n\\end{tabular}\n"
}
