//! `spectra.csv` and `correlations.csv`: how what is watched fluctuates, a row a frequency or a lag, written and read
//! back.

use std::path::Path;

use super::RunError;
use super::columns::{Columns, number, optional, word};
use crate::continuation::{Fluctuations, Point};
use crate::system::Family;

/// The table of spectra.
pub(super) const SPECTRA: &str = "spectra.csv";
/// The table of correlations.
pub(super) const CORRELATIONS: &str = "correlations.csv";

/// A row of either table.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    parameter: f64,
    of: String,
    /// The frequency or the lag.
    at: f64,
    known: (f64, f64),
    imaginary: Option<(f64, f64)>,
}

/// The columns that both tables have.
fn shared<'a>(family: &'a Family, names: [&str; 3]) -> Columns<'a, Row> {
    let [at, value, error] = names;
    Columns(vec![
        number(family.parameter(), |row: &Row| row.parameter)
            .read(|cell| cell.number(), |row, value| row.parameter = value),
        word("of", |row: &Row| row.of.clone())
            .read(|cell| Ok(cell.text.to_owned()), |row, of| row.of = of),
        number(at, |row: &Row| row.at).read(|cell| cell.number(), |row, at| row.at = at),
        number(value, |row: &Row| row.known.0).read(
            |cell| cell.number_or_nan(),
            |row, value| row.known.0 = value,
        ),
        number(error, |row: &Row| row.known.1).read(
            |cell| cell.number_or_nan(),
            |row, error| row.known.1 = error,
        ),
    ])
}

/// The columns of `spectra.csv`: power in the unit of the observable squared times that of time, its error, and the
/// imaginary part of a cross spectrum.
pub(super) fn spectra_columns(family: &Family) -> Columns<'_, Row> {
    let mut columns = shared(family, ["frequency", "power", "power_error"]);
    let part = |row: &mut Row| *row.imaginary.get_or_insert((0.0, 0.0));
    columns.0.push(
        optional("imaginary", |row: &Row| row.imaginary.map(|known| known.0)).read(
            |cell| cell.optional(),
            move |row, value: Option<f64>| {
                if let Some(value) = value {
                    row.imaginary = Some((value, part(row).1));
                }
            },
        ),
    );
    columns.0.push(
        optional("imaginary_error", |row: &Row| {
            row.imaginary.map(|known| known.1)
        })
        .read(
            |cell| cell.optional(),
            move |row, error: Option<f64>| {
                if let Some(error) = error {
                    row.imaginary = Some((part(row).0, error));
                }
            },
        ),
    );
    columns
}

/// The columns of `correlations.csv`.
pub(super) fn correlations_columns(family: &Family) -> Columns<'_, Row> {
    shared(family, ["lag", "covariance", "covariance_error"])
}

/// Both tables with their names, as far as there is anything in them.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn fluctuation_files(
    family: &Family,
    points: &[Point],
) -> Result<Vec<(&'static str, String)>, RunError> {
    let Some(question) = &family.questions.spectrum else {
        return Ok(Vec::new());
    };
    let frequencies = question.band.frequencies();
    let (step, count) = question.lags();
    let lags: Vec<f64> = (0..count).map(|lag| step * lag as f64).collect();
    let all = || {
        points.iter().flat_map(|point| {
            point
                .report
                .fluctuations
                .iter()
                .map(move |one| (point, one))
        })
    };
    let row = |(point, one): (&Point, &Fluctuations), at: f64, known: (f64, f64), imaginary| Row {
        parameter: point.value,
        of: one.of.clone(),
        at,
        known,
        imaginary,
    };
    let spectra = all().flat_map(|(point, one)| {
        let places = frequencies.iter().zip(&one.power).enumerate();
        places.map(move |(place, (&at, &known))| {
            row((point, one), at, known, one.imaginary.get(place).copied())
        })
    });
    let spectra: Vec<Row> = spectra.collect();
    let correlations = all().flat_map(|(point, one)| {
        let places = lags.iter().zip(&one.correlation);
        places.map(move |(&at, &known)| row((point, one), at, known, None))
    });
    let correlations: Vec<Row> = correlations.collect();
    let mut files = Vec::new();
    if !spectra.is_empty() {
        files.push((SPECTRA, spectra_columns(family).csv(&spectra)?));
    }
    if !correlations.is_empty() {
        files.push((
            CORRELATIONS,
            correlations_columns(family).csv(&correlations)?,
        ));
    }
    Ok(files)
}

/// Gives points what the tables in a folder have of them; nothing where there are no tables.
///
/// # Errors
/// [`RunError::Read`], [`RunError::Column`], [`RunError::Row`].
pub(super) fn read_fluctuations(
    folder: &Path,
    family: &Family,
    points: &mut [Point],
) -> Result<(), RunError> {
    if family.questions.spectrum.is_none() {
        return Ok(());
    }
    let tables = [
        (SPECTRA, spectra_columns(family)),
        (CORRELATIONS, correlations_columns(family)),
    ];
    for (name, columns) in tables {
        let path = folder.join(name);
        if !path.is_file() {
            continue;
        }
        let rows = columns.read(&path, true, Row::default)?;
        // Rows of a point, and of an observable, stand together.
        let mut rows = rows.into_iter().peekable();
        for point in points.iter_mut() {
            while let Some(row) = rows.next_if(|row| row.parameter == point.value) {
                take(&mut point.report.fluctuations, row, name == SPECTRA);
            }
        }
    }
    Ok(())
}

fn take(known: &mut Vec<Fluctuations>, row: Row, is_spectrum: bool) {
    let place = known.iter().position(|one| one.of == row.of);
    let place = place.unwrap_or_else(|| {
        known.push(Fluctuations {
            of: row.of.clone(),
            ..Fluctuations::default()
        });
        known.len() - 1
    });
    let one = &mut known[place];
    if is_spectrum {
        one.power.push(row.known);
        one.imaginary.extend(row.imaginary);
    } else {
        one.correlation.push(row.known);
    }
}
