//! `checks.csv`: the indicators that were seen on the finer grid on which located values are checked.
//!
//! With them `pbif detect` repeats the check without solving. A row without a `value` says that there was no such indicator.

use std::path::Path;

use super::stored_points::read_rows;
use super::tables::Table;
use super::{Naming, RunError, number::format_number};
use crate::continuation::FinerIndicator;
use crate::density::Observable;

/// The table, in the order in which the values were solved.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn checks_csv(
    naming: &Naming<'_>,
    observables: &[Observable],
    seen: &[FinerIndicator],
) -> Result<String, RunError> {
    let header = [
        naming.parameter,
        "observable",
        "indicator",
        "position",
        "position_2",
        "value",
    ];
    let mut table = Table::new(&header.map(str::to_owned))?;
    for one in seen {
        let Some(&observable) = observables.get(one.observable) else {
            continue;
        };
        let number = |value: Option<f64>| value.map_or(String::new(), format_number);
        table.row(&[
            format_number(one.value),
            naming.observable(observable),
            one.kind.clone(),
            number(one.place.first().copied()),
            number(one.place.get(1).copied()),
            number(one.indicator),
        ])?;
    }
    table.finish()
}

/// Reads the table back; rows of other observables are left out.
///
/// # Errors
/// [`RunError::Read`], [`RunError::Column`], [`RunError::Row`].
pub(super) fn read_checks(
    path: &Path,
    naming: &Naming<'_>,
    observables: &[Observable],
) -> Result<Vec<FinerIndicator>, RunError> {
    let rows = read_rows(path, |row| {
        let name = row.text("observable")?;
        let mut known = observables.iter();
        let Some(observable) = known.position(|&one| naming.observable(one) == name) else {
            return Ok(None);
        };
        let place = [row.optional("position")?, row.optional("position_2")?];
        Ok(Some(FinerIndicator {
            value: row.number(naming.parameter)?,
            observable,
            kind: row.text("indicator")?.to_owned(),
            place: place.into_iter().flatten().collect(),
            indicator: row.optional("value")?,
        }))
    })?;
    Ok(rows.into_iter().flatten().collect())
}
