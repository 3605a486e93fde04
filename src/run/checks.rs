//! `checks.csv`: the indicators that were seen on the finer grid on which located values are checked.
//!
//! With them `pbif detect` repeats the check without solving. A row without a `value` says that there was no such indicator.

use std::path::Path;

use super::RunError;
use super::columns::{Columns, number, optional, word};
use crate::continuation::{FinerIndicator, Subject};
use crate::density::Observable;
use crate::system::Family;

/// The table's columns. An observable that is not watched has a number beyond all of those that are.
fn columns<'a>(family: &'a Family, observables: &'a [Observable]) -> Columns<'a, FinerIndicator> {
    let name = move |number: usize| {
        let observable = observables.get(number);
        observable.map_or(String::new(), |&one| one.name(family))
    };
    let numbered = move |text: &str| {
        let mut known = observables.iter();
        let number = known.position(|&one| one.name(family) == text);
        number.unwrap_or(observables.len())
    };
    let coordinate = |axis: usize| move |one: &FinerIndicator| one.place.get(axis).copied();
    Columns(vec![
        number(family.parameter(), |one: &FinerIndicator| one.value)
            .read(|cell| cell.number(), |one, value| one.value = value),
        word("observable", move |one: &FinerIndicator| {
            name(one.observable)
        })
        .read(
            move |cell| Ok(numbered(cell.text)),
            |one, number| one.observable = number,
        ),
        word("indicator", |one: &FinerIndicator| one.kind.clone())
            .read(|cell| Ok(cell.text.to_owned()), |one, kind| one.kind = kind),
        optional("position", coordinate(0))
            .read(|cell| cell.optional(), |one, value| one.place.extend(value)),
        optional("position_2", coordinate(1))
            .read(|cell| cell.optional(), |one, value| one.place.extend(value)),
        optional("value", |one: &FinerIndicator| one.indicator)
            .read(|cell| cell.optional(), |one, value| one.indicator = value),
    ])
}

/// The table, in the order in which the values were solved.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn checks_csv(subject: &Subject, seen: &[FinerIndicator]) -> Result<String, RunError> {
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
pub(super) fn read_checks(path: &Path, subject: &Subject) -> Result<Vec<FinerIndicator>, RunError> {
    let Subject {
        family,
        observables,
        ..
    } = subject;
    let blank = || FinerIndicator {
        value: f64::NAN,
        observable: observables.len(),
        kind: String::new(),
        place: Vec::new(),
        indicator: None,
    };
    let mut seen = columns(family, observables).read(path, blank)?;
    seen.retain(|one| one.observable < observables.len());
    Ok(seen)
}
