//! The captions of a comparison's figures, and the numbers behind them as CSV.

use crate::compare::{Comparison, Method, Reference};
use crate::density::Observable;

use super::caption;
use super::data::{Table, number};
use super::told::Shows;

/// The caption; empty for a figure that has none.
pub(super) fn caption(comparison: &Comparison, shows: &Shows<'_>) -> String {
    let family = &comparison.subject.family;
    let values = comparison
        .values
        .iter()
        .map(|value| value.value)
        .collect::<Vec<_>>();
    let at = caption::at_values(family, &values);
    let symbols = |observable: Observable| format!("p({})", observable.symbols(family).join(", "));
    let seen = match shows {
        Shows::ComparedMarginals => format!(
            "Steady-state marginal densities{at} by each method; of Monte Carlo with two standard errors, of the generator \
             followed between the cells by parabolas with their averages."
        ),
        Shows::ComparedJoint(observable) => {
            format!(
                "Steady-state joint density {}{at} by each method; of the generator followed between the cells by parabolas \
                 with their averages.",
                symbols(*observable)
            )
        }
        Shows::TimeToAccuracy => match &comparison.accuracy {
            Some(accuracy) => format!(
                "Total variation of {} at {} = {} to {}, over the seconds that each method took; bars are two standard errors.",
                symbols(accuracy.observable),
                family.parameter(),
                caption::number(accuracy.value),
                match accuracy.reference {
                    Reference::Exact => "the exact density",
                    Reference::Generator(_) => "that of the generator on its finest cells",
                }
            ),
            None => return String::new(),
        },
        _ => return String::new(),
    };
    let common: Vec<String> = comparison
        .common
        .shape()
        .iter()
        .map(ToString::to_string)
        .collect();
    let (system, version) = (caption::system_of(family), env!("CARGO_PKG_VERSION"));
    format!(
        "{seen} {system} Compared on {} cells. Computed with pbif {version}.\n",
        common.join(" × ")
    )
}

/// The table; empty for a figure that has none.
pub(super) fn table(comparison: &Comparison, shows: &Shows<'_>) -> String {
    match shows {
        Shows::ComparedMarginals => {
            densities(comparison, |one| matches!(one, Observable::Marginal(_)))
        }
        Shows::ComparedJoint(observable) => densities(comparison, |one| one == *observable),
        Shows::TimeToAccuracy => times(comparison),
        _ => String::new(),
    }
}

/// The densities of some observables by every method on the common cells, a row a cell: the averages that drawn ones
/// have.
fn densities(comparison: &Comparison, is_shown: impl Fn(Observable) -> bool) -> String {
    let family = &comparison.subject.family;
    let columns = [
        family.parameter(),
        "method",
        "observable",
        "coordinate",
        "coordinate_2",
        "density",
        "standard_error",
    ];
    let mut table = Table::new(&columns);
    for value in &comparison.values {
        for &observable in comparison
            .subject
            .observables
            .iter()
            .filter(|one| is_shown(**one))
        {
            for method in Method::ALL {
                let Some(estimated) = value.density(method, observable) else {
                    continue;
                };
                let centres: Vec<Vec<f64>> = estimated
                    .density
                    .axes
                    .iter()
                    .map(|axis| axis.centres())
                    .collect();
                let along = centres.get(1).map_or(1, Vec::len);
                for (cell, &density) in estimated.density.values.iter().enumerate() {
                    let error = estimated.standard_error.get(cell).copied().unwrap_or(0.0);
                    let second = centres.get(1).and_then(|centres| centres.get(cell % along));
                    table.row(&[
                        number(value.value),
                        method.name().to_owned(),
                        observable.name(family),
                        centres
                            .first()
                            .and_then(|centres| centres.get(cell / along))
                            .map_or_else(String::new, |one| number(*one)),
                        second.map_or_else(String::new, |one| number(*one)),
                        number(density),
                        if error > 0.0 {
                            number(error)
                        } else {
                            String::new()
                        },
                    ]);
                }
            }
        }
    }
    table.text
}

/// Error against time, a row a measurement.
fn times(comparison: &Comparison) -> String {
    let mut table = Table::new(&["method", "seconds", "total_variation", "standard_error"]);
    let points = comparison
        .accuracy
        .iter()
        .flat_map(|accuracy| &accuracy.points);
    for point in points {
        table.row(&[
            point.method.name().to_owned(),
            number(point.seconds),
            number(point.error.value),
            number(point.error.error),
        ]);
    }
    table.text
}
