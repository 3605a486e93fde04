//! The numbers behind a figure, as CSV: one row a number that is drawn, with everything that places it.

use crate::continuation::{Point, SweepResult};
use crate::density::{EstimatedDensity, Observable};

use super::view;

/// A table with a header.
pub(crate) fn table(columns: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut text = columns.join(",") + "\n";
    for row in rows {
        text += &line(&row);
    }
    text
}

fn line(row: &[String]) -> String {
    row.join(",") + "\n"
}

/// The shortest text that reads back as the same number; empty for values that are none.
pub(crate) fn number(value: f64) -> String {
    match value {
        value if !value.is_finite() => String::new(),
        0.0 => "0".to_owned(),
        value if (1e-4..1e15).contains(&value.abs()) => format!("{value}"),
        value => format!("{value:e}"),
    }
}

/// The standard error of a cell; empty for densities without sampling.
pub(crate) fn error(estimated: &EstimatedDensity, cell: usize) -> String {
    match estimated.standard_error.get(cell) {
        Some(&error) if error > 0.0 => number(error + estimated.truncated(cell)),
        _ => String::new(),
    }
}

/// Coordinate, density and standard error of the cells of a marginal.
pub(crate) fn cells(estimated: &EstimatedDensity) -> Vec<(f64, f64, String)> {
    let centres = estimated.density.axes[0].centres().into_iter();
    let values = centres.zip(&estimated.density.values).enumerate();
    values
        .map(|(cell, (centre, &value))| (centre, value, error(estimated, cell)))
        .collect()
}

/// Marginals at points in that order: numbers of their observables, and the rows of each density.
pub(crate) fn of_marginals(
    result: &SweepResult,
    (observables, points): (&[usize], &[&Point]),
    rows: impl Fn(&EstimatedDensity, usize) -> Vec<(f64, f64, String)>,
) -> String {
    let family = &result.subject.family;
    let parameter = family.parameter();
    let columns = [parameter, "axis", "coordinate", "density", "standard_error"];
    // Line by line: together their fields would take ten times as much as the text.
    let mut text = table(&columns, None);
    for point in points {
        for &observable in observables {
            let (Some(estimated), Observable::Marginal(axis)) = (
                view::density(point, observable),
                result.subject.observables[observable],
            ) else {
                continue;
            };
            let (at, axis) = (number(point.value), family.axis(axis).to_owned());
            for (place, value, error) in rows(estimated, observable) {
                let [place, value] = [place, value].map(number);
                text += &line(&[at.clone(), axis.clone(), place, value, error]);
            }
        }
    }
    text
}

/// The cells of a joint density at some points.
pub(crate) fn of_joint(result: &SweepResult, observable: usize, points: &[&Point]) -> String {
    let family = &result.subject.family;
    let Observable::Joint(first, second) = result.subject.observables[observable] else {
        return String::new();
    };
    let axes = (family.axis(first), family.axis(second));
    let columns = [
        family.parameter(),
        axes.0,
        axes.1,
        "density",
        "standard_error",
    ];
    let mut text = table(&columns, None);
    for point in points {
        let Some(estimated) = view::density(point, observable) else {
            continue;
        };
        let [across, along] = &estimated.density.axes[..] else {
            continue;
        };
        let (across, along) = (across.centres(), along.centres());
        for (cell, &value) in estimated.density.values.iter().enumerate() {
            let (i, j) = (cell / along.len(), cell % along.len());
            let numbers = [point.value, across[i], along[j], value].map(number);
            text += &line(&[&numbers[..], &[error(estimated, cell)]].concat());
        }
    }
    text
}
