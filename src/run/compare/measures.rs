//! `measures.csv`: numbers beside densities by all methods, in full.

use serde_json::Value;

use super::ComparedRun;
use crate::compare::{ComparedMeasure, ComparedValue};
use crate::run::RunError;
use crate::run::columns::{Columns, number, optional, word};
use crate::system::Family;

/// Numbers by all methods, a row a value and measure.
pub(super) fn measures<'a>(family: &Family) -> Columns<'a, (f64, ComparedMeasure)> {
    type Row = (f64, ComparedMeasure);
    Columns(vec![
        number(family.parameter(), |(value, _): &Row| *value),
        word("measure", |(_, one): &Row| one.name.clone()),
        number("generator", |(_, one): &Row| one.generator.0),
        number("generator_error", |(_, one): &Row| one.generator.1),
        number("monte_carlo", |(_, one): &Row| one.monte_carlo.0),
        number("monte_carlo_error", |(_, one): &Row| one.monte_carlo.1),
        number("errors_apart", |(_, one): &Row| one.apart()),
        optional("sgcm", |(_, one): &Row| one.sgcm.map(|found| found.0)),
        optional("sgcm_error", |(_, one): &Row| one.sgcm.map(|found| found.1)),
        optional("sgcm_errors_apart", |(_, one): &Row| one.sgcm_apart()),
    ])
}

/// The numbers of all values.
fn records(run: &ComparedRun<'_>) -> Vec<(f64, ComparedMeasure)> {
    let values = run.comparison.values.iter();
    let at = |value: &ComparedValue| {
        let all = value.measures().into_iter();
        all.map(|one| (value.value, one)).collect::<Vec<_>>()
    };
    values.flat_map(at).collect()
}

/// `measures.csv`: numbers by all methods, a row a value and measure.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn measures_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    measures(run.family()).csv(&records(run))
}

/// The same as JSON.
pub(super) fn measures_json(run: &ComparedRun<'_>) -> Value {
    measures(run.family()).json(&records(run))
}
