//! `bifurcations.csv`, `.md`, `.tex`, `.json`: the table of labelled points.
//!
//! The CSV and JSON hold every label, end points (`EP`) included; the tables for people leave those out.

use super::columns::{Columns, number, optional, word};
use super::{
    RunError,
    doubts::doubt_in_words,
    latex::{self, escape},
    number::format_with_error,
};
use crate::continuation::{ErrorParts, Label, RowWords, SweepResult};
use crate::density::Observable;
use crate::system::Family;

/// The table's columns; numbers in full.
fn columns<'a>(family: &'a Family) -> Columns<'a, Label> {
    let words = |name: &'static str, of: fn(RowWords) -> String| {
        word(name, move |row: &Label| {
            row.words(family).map(of).unwrap_or_default()
        })
    };
    fn part(row: &Label, of: impl Fn(&ErrorParts) -> f64) -> Option<f64> {
        let zero = row.bifurcation()?.zero.as_ref()?;
        Some(of(&zero.parts))
    }
    type Row = Label;
    Columns(vec![
        word("label", |row: &Row| row.name().to_owned()),
        word("parameter", move |_| family.parameter().to_owned()),
        number("value", |row: &Row| row.value()),
        number("error", |row: &Row| row.error()),
        number("lower", |row: &Row| row.bracket().0),
        number("upper", |row: &Row| row.bracket().1),
        words("observable", |one| one.of),
        words("before", |one| one.before),
        words("after", |one| one.after),
        words("status", |one| one.status.word().to_owned()),
        words("change", |one| one.change),
        words("method", |one| one.method.to_owned()),
        optional("error_solver", |row: &Row| part(row, |parts| parts.solver)),
        optional("error_grid", |row: &Row| part(row, |parts| parts.grid)),
        optional("error_sampling", |row: &Row| {
            part(row, |parts| parts.sampling)
        }),
        optional("error_leak", |row: &Row| part(row, |parts| parts.leak)),
        word("reason", move |row: &Row| {
            row.reason()
                .map_or_else(String::new, |doubt| doubt_in_words(family, doubt))
        }),
    ])
}

/// The CSV, numbers in full.
///
/// # Errors
/// [`RunError::Table`].
pub(crate) fn bifurcations_csv(family: &Family, labels: &[Label]) -> Result<String, RunError> {
    columns(family).csv(labels)
}

/// The JSON: a list of objects with the CSV's keys, numbers as numbers, absent entries as null.
///
/// # Errors
/// [`RunError::Json`].
pub(crate) fn bifurcations_json(family: &Family, labels: &[Label]) -> Result<String, RunError> {
    let rows = columns(family).json(labels);
    Ok(serde_json::to_string_pretty(&rows)? + "\n")
}

/// What stands for the status of values without a density.
const NO_DENSITY: &str = "no steady state or not converged";

/// Value, error and bracket of a row, rounded to the error.
fn in_digits(row: &Label) -> [String; 4] {
    let (value, error) = format_with_error(row.value(), row.error());
    let (lower, upper) = row.bracket();
    let [lower, upper] = [lower, upper].map(|end| format_with_error(end, row.error()).0);
    [value, error, lower, upper]
}

/// The Markdown table, values rounded to their errors.
pub(crate) fn bifurcations_markdown(family: &Family, labels: &[Label]) -> String {
    let mut text = format!(
        "| label | {} | bracket | observable | before | after | change | status |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n",
        family.parameter()
    );
    for row in labels.iter().filter(|row| !row.is_end()) {
        let [value, error, lower, upper] = in_digits(row);
        let cells = match row.words(family) {
            Some(one) => {
                let status = one.status.word().to_owned();
                [one.of, one.before, one.after, one.change, status]
            }
            None => ["", "", "", "", NO_DENSITY].map(str::to_owned),
        };
        text += &format!(
            "| {} | {value} ± {error} | [{lower}, {upper}] | {} |\n",
            row.name(),
            cells.join(" | ")
        );
    }
    text
}

/// Names the densities that a sweep counts differently from value to value, while finer cells show that nothing
/// changes, those in which a feature may be what errors make, though no row tells of it, and those whose errors hide
/// peaks; `None` where there are none.
pub(crate) fn miscounted_in_words(result: &SweepResult) -> Option<String> {
    let sentence = |of: Vec<Observable>, words: &str| {
        let names = of.iter().map(|one| one.name(&result.subject.family));
        let names: Vec<String> = names.collect();
        (!names.is_empty()).then(|| format!("{}: {words}", names.join(", ")))
    };
    let miscounted = sentence(
        result.miscounted(),
        "the counts of the sweep differ from value to value, but finer cells show no change; its cells are too wide to \
         count by: give more",
    );
    let undecided = sentence(
        result.undecided(),
        "no row tells of a feature that the cells cannot tell from their errors (`unresolved` in features.csv): give more \
         cells, or a larger `locate.effort`",
    );
    let coarse = result.coarse().into_iter().map(|(observable, share)| {
        format!(
            "{}: errors of its cells hide peaks that stand out by less than {:.1} % of the highest one: give more cells, or \
             a larger `locate.effort`",
            observable.name(&result.subject.family),
            100.0 * share
        )
    });
    let all: Vec<String> = miscounted
        .into_iter()
        .chain(undecided)
        .chain(coarse)
        .collect();
    (!all.is_empty()).then(|| all.join("\n"))
}

/// A LaTeX table with booktabs rules, values rounded to their errors.
pub(crate) fn bifurcations_tex(family: &Family, labels: &[Label]) -> String {
    let mut text = String::from(
        "% needs \\usepackage{booktabs}\n\\begin{tabular}{lllllll}\n\\toprule\nlabel & $",
    );
    text += &latex::parameter(family);
    text += "$ & density & below & above & change & status \\\\\n\\midrule\n";
    for row in labels.iter().filter(|row| !row.is_end()) {
        let [value, error, ..] = in_digits(row);
        let of_none = || vec![String::new(); 5];
        let cells = row.words(family).map_or_else(of_none, |one| {
            let of = match row.bifurcation() {
                Some(located) => format!("$p({})$", latex::observable(family, located.observable)),
                None => escape(&one.of),
            };
            let words = [
                one.before,
                one.after,
                one.change,
                one.status.word().to_owned(),
            ];
            let words = words.iter().map(|word| escape(word));
            std::iter::once(of).chain(words).collect()
        });
        let cells = cells.join(" & ");
        text += &format!(
            "{} & ${value} \\pm {error}$ & {cells} \\\\\n",
            escape(row.name())
        );
    }
    text + "\\bottomrule\n\\end{tabular}\n"
}
