//! `checks.csv`: the indicators that were seen in the checks of located values, on finer cells and between closed ends
//! of Ω.
//!
//! With them `pbif detect` repeats the checks without solving. A row without a `value` says that there was no such
//! indicator, or why the solve failed.

use std::path::Path;

use super::RunError;
use super::columns::{Columns, number, optional, word};
use crate::continuation::{CheckedBy, CheckedIndicator, Subject};
use crate::density::Observable;
use crate::system::Family;
use crate::topology::IndicatorKind;

/// The table's columns. An observable that is not watched has a number beyond all of those that are.
pub(super) fn columns<'a>(
    family: &'a Family,
    observables: &'a [Observable],
) -> Columns<'a, CheckedIndicator> {
    let name = move |number: usize| {
        let observable = observables.get(number);
        observable.map_or(String::new(), |&one| one.name(family))
    };
    let numbered = move |text: &str| {
        let mut known = observables.iter();
        let number = known.position(|&one| one.name(family) == text);
        number.unwrap_or(observables.len())
    };
    let coordinate = |axis: usize| move |one: &CheckedIndicator| one.place.get(axis).copied();
    Columns(vec![
        number(family.parameter(), |one: &CheckedIndicator| one.value)
            .read(|cell| cell.number(), |one, value| one.value = value),
        word("observable", move |one: &CheckedIndicator| {
            name(one.observable)
        })
        .read(
            move |cell| Ok(numbered(cell.text)),
            |one, number| one.observable = number,
        ),
        word("by", |one: &CheckedIndicator| one.by.name()).read(
            |cell| cell.choice(&CheckedBy::ALL, CheckedBy::name),
            |one, by| one.by = by,
        ),
        word("indicator", |one: &CheckedIndicator| one.kind.code()).read(
            |cell| cell.choice(&IndicatorKind::ALL, |kind| kind.code()),
            |one, kind| one.kind = kind,
        ),
        optional("position", coordinate(0))
            .read(|cell| cell.optional(), |one, value| one.place.extend(value)),
        optional("position_2", coordinate(1))
            .read(|cell| cell.optional(), |one, value| one.place.extend(value)),
        optional("value", |one: &CheckedIndicator| one.indicator)
            .read(|cell| cell.optional(), |one, value| one.indicator = value),
        optional("error", |one: &CheckedIndicator| {
            one.indicator.map(|_| one.error)
        })
        .read(
            |cell| cell.optional(),
            |one, error| one.error = error.unwrap_or(0.0),
        )
        .newer(),
        word("failure", |one: &CheckedIndicator| {
            one.failure.clone().unwrap_or_default()
        })
        .read(
            |cell| Ok(Some(cell.text.to_owned()).filter(|text| !text.is_empty())),
            |one, failure| one.failure = failure,
        ),
    ])
}

/// The table, in the order in which the values were solved.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn checks_csv(subject: &Subject, seen: &[CheckedIndicator]) -> Result<String, RunError> {
    let Subject {
        family,
        observables,
        ..
    } = subject;
    let watched = seen.iter().filter(|one| one.observable < observables.len());
    columns(family, observables).csv(watched)
}

/// Reads the table back; rows of other observables are left out.
///
/// # Errors
/// [`RunError::Read`], [`RunError::Column`], [`RunError::Row`].
pub(super) fn read_checks(
    path: &Path,
    subject: &Subject,
) -> Result<Vec<CheckedIndicator>, RunError> {
    let Subject {
        family,
        observables,
        ..
    } = subject;
    let blank = || CheckedIndicator {
        value: f64::NAN,
        observable: observables.len(),
        by: CheckedBy::FinerCells(1),
        kind: IndicatorKind::CURVATURE,
        place: Vec::new(),
        indicator: None,
        error: 0.0,
        failure: None,
    };
    let mut seen = columns(family, observables).read(path, true, blank)?;
    seen.retain(|one| one.observable < observables.len());
    Ok(seen)
}
