//! Tables for programs: every number in full.

use serde_json::json;

use super::measures::{measures, measures_json};
use super::{ComparedRun, partner};
use crate::compare::{
    Accuracy, AccuracyPoint, Agreement, ComparedValue, Distance, Distances, Method, Pair,
    Reference, Solved,
};
use crate::continuation::MeasureKind;
use crate::continuation::measure::{
    ESCAPE_RATE, FACTORISATIONS, MAP_STEP, NUMERICAL_DIFFUSION, TIME_STEP_BIAS,
};
use crate::density::{EstimatedDensity, Observable};
use crate::run::columns::{Column, Columns, Named, count, digits, flag, number, optional, word};
use crate::run::sentences::sentences;
use crate::run::{RunError, format_number, manifest::hash};
use crate::system::Family;

/// A record that belongs to a parameter value.
type At<'r, T> = (&'r ComparedValue, &'r T);

/// The column of the parameter's values.
fn parameter<'a, T>(family: &Family) -> Column<'a, At<'a, T>> {
    number(family.parameter(), |(at, _): &At<'a, T>| at.value)
}

/// The records that a list of each value holds.
fn records<'a, T>(run: &ComparedRun<'a>, of: fn(&ComparedValue) -> &[T]) -> Vec<At<'a, T>> {
    let values = run.comparison.values.iter();
    let at = |value: &'a ComparedValue| of(value).iter().map(move |one| (value, one));
    values.flat_map(at).collect()
}

fn seconds(value: f64) -> String {
    format!("{value:.4}")
}

/// A count that is left out where there is nothing to count.
fn unless_zero(count: u64) -> String {
    match count {
        0 => String::new(),
        count => count.to_string(),
    }
}

/// Factorisations that were made, as a number of a table.
pub(super) fn factorisations(solved: &Solved) -> String {
    let count = solved.report.of(&FACTORISATIONS, "");
    format_number(count.unwrap_or(0.0))
}

/// A column of a measure.
fn of_measure<'a>(kind: &'static MeasureKind, of: &str) -> Column<'a, At<'a, Solved>> {
    let name = kind.name(of);
    optional(name.clone(), move |(_, one): &At<'a, Solved>| {
        one.report.measure(&name)
    })
}

/// Work in the unit of the method.
fn work(solved: &Solved) -> (String, &'static str) {
    match solved.work.steps {
        0 => (factorisations(solved), "factorisations"),
        steps => (steps.to_string(), "integrator steps"),
    }
}

/// What the bytes rest on.
fn bytes_from(solved: &Solved) -> &'static str {
    match solved.method {
        _ if solved.work.bytes.is_none() => "unknown",
        Method::Generator => "estimated from the elimination order",
        Method::Sgcm | Method::SgcmSlope => "estimated from the transitions that were counted",
        Method::MonteCarlo => "estimated from cells and blocks",
    }
}

/// What a method took.
fn costs<'a>() -> Vec<Column<'a, At<'a, Solved>>> {
    type Row<'a> = At<'a, Solved>;
    vec![
        digits("seconds", |(_, one): &Row<'a>| seconds(one.work.seconds())),
        digits("sampling_seconds", |(_, one): &Row<'a>| {
            seconds(one.work.sampling_seconds)
        }),
        digits("solve_seconds", |(_, one): &Row<'a>| {
            seconds(one.work.solve_seconds)
        }),
        digits("preparation_seconds", |(_, one): &Row<'a>| {
            seconds(one.work.preparation_seconds)
        }),
        digits("work", |(_, one): &Row<'a>| work(one).0),
        word("work_unit", |(_, one): &Row<'a>| work(one).1),
        count("iterations", |(_, one): &Row<'a>| one.report.iterations),
        digits("bytes", |(_, one): &Row<'a>| {
            let bytes = one.work.bytes;
            bytes.map_or_else(String::new, |bytes| format!("{bytes:.0}"))
        }),
        word("bytes_from", |(_, one): &Row<'a>| bytes_from(one)),
        count("cells", |(_, one): &Row<'a>| one.work.cells),
        digits("samples", |(_, one): &Row<'a>| {
            unless_zero(one.work.samples as u64)
        }),
    ]
}

/// A row a value and method.
fn methods<'a>(family: &'a Family, observables: &[Observable]) -> Columns<'a, At<'a, Solved>> {
    type Row<'a> = At<'a, Solved>;
    let mut columns = vec![
        parameter(family),
        word("method", |(_, one): &Row<'a>| one.method.name()),
        word("status", |(_, one): &Row<'a>| one.status.word()),
    ];
    columns.extend(costs());
    columns.extend([
        of_measure(&MAP_STEP, ""),
        optional("time_step", |(_, one): &Row<'a>| one.time_step),
        of_measure(&TIME_STEP_BIAS, ""),
        number("escape_rate", |(_, one): &Row<'a>| {
            one.report.of(&ESCAPE_RATE, "").unwrap_or(0.0)
        }),
        optional("share_outside", |(_, one): &Row<'a>| one.share_outside),
    ]);
    for axis in 0..family.model().axes.len() {
        columns.push(of_measure(&NUMERICAL_DIFFUSION, family.axis(axis)));
    }
    for &observable in observables {
        let exact = move |(at, one): &Row<'a>| at.pair(one.method, None, observable).copied();
        let name = observable.name(family);
        columns.push(optional(format!("tv_exact_{name}"), move |row| {
            exact(row).map(|found| found.total_variation.value)
        }));
        columns.push(optional(format!("hellinger_exact_{name}"), move |row| {
            exact(row).map(|found| found.hellinger.value)
        }));
    }
    columns.push(word("warnings", move |(_, one): &Row<'a>| {
        sentences(family, &one.report.findings)
    }));
    Columns(columns)
}

fn methods_of<'a>(run: &ComparedRun<'a>) -> Columns<'a, At<'a, Solved>> {
    methods(run.family(), &run.comparison.subject.observables)
}

/// A row a value, pair (two methods, or a method and the exact density) and observable.
fn distances<'a>(family: &'a Family) -> Columns<'a, At<'a, Pair>> {
    type Row<'a> = At<'a, Pair>;
    let mut columns = vec![
        parameter(family),
        word("first", |(_, one): &Row<'a>| one.first.name()),
        word("second", |(_, one): &Row<'a>| partner(one.second)),
        word("observable", move |(_, one): &Row<'a>| {
            one.observable.name(family)
        }),
    ];
    let total_variation = |one: &Distances| one.total_variation;
    let hellinger = |one: &Distances| one.hellinger;
    for (name, of) in [
        ("tv", total_variation as fn(&Distances) -> Distance),
        ("hellinger", hellinger),
    ] {
        let of = move |row: &Row<'a>| of(&row.1.distances);
        columns.extend([
            number(name, move |row: &Row<'a>| of(row).value),
            number(format!("{name}_error"), move |row| of(row).error),
            number(format!("{name}_systematic"), move |row| of(row).systematic),
            number(format!("{name}_noise"), move |row| of(row).noise),
            flag(format!("{name}_significant"), move |row| {
                of(row).is_significant()
            }),
        ]);
    }
    Columns(columns)
}

/// Generator and Monte Carlo bin by bin, a row a value and marginal.
fn agreement<'a>(family: &'a Family) -> Columns<'a, At<'a, Agreement>> {
    type Row<'a> = At<'a, Agreement>;
    Columns(vec![
        parameter(family),
        word("observable", move |(_, one): &Row<'a>| {
            one.observable.name(family)
        }),
        count("bins", |(_, one): &Row<'a>| one.bins),
        count("within_3_errors", |(_, one): &Row<'a>| one.within),
        number("share", |(_, one): &Row<'a>| one.share()),
        count("beyond_all_errors", |(_, one): &Row<'a>| one.beyond),
        number("worst", |(_, one): &Row<'a>| one.worst),
    ])
}

/// Error against time, a row a method and grid or number of samples.
fn accuracy<'a>(family: &'a Family) -> Columns<'a, (&'a Accuracy, &'a AccuracyPoint)> {
    type Row<'a> = (&'a Accuracy, &'a AccuracyPoint);
    Columns(vec![
        number(family.parameter(), |(all, _): &Row<'a>| all.value),
        word("observable", move |(all, _): &Row<'a>| {
            all.observable.name(family)
        }),
        word("reference", |(all, _): &Row<'a>| match all.reference {
            Reference::Exact => "exact".to_owned(),
            Reference::Generator(cells) => format!("generator on {cells} cells"),
        }),
        word("method", |(_, one): &Row<'a>| one.method.name()),
        count("cells", |(_, one): &Row<'a>| one.cells),
        digits("samples", |(_, one): &Row<'a>| unless_zero(one.samples)),
        digits("seconds", |(_, one): &Row<'a>| seconds(one.seconds)),
        number("tv", |(_, one): &Row<'a>| one.error.value),
        number("tv_error", |(_, one): &Row<'a>| one.error.error),
        number("tv_noise", |(_, one): &Row<'a>| one.error.noise),
    ])
}

/// What was measured of error against time.
fn accuracy_points<'a>(run: &ComparedRun<'a>) -> Vec<(&'a Accuracy, &'a AccuracyPoint)> {
    let all = run.comparison.accuracy.iter();
    all.flat_map(|all| all.points.iter().map(move |one| (all, one)))
        .collect()
}

/// A density at a cell.
struct AtCell<'a> {
    solved: At<'a, Solved>,
    estimated: &'a EstimatedDensity,
    cell: usize,
}

impl AtCell<'_> {
    /// Centre of the cell along an axis of the density.
    fn centre(&self, axis: usize) -> Option<f64> {
        let axes = &self.estimated.density.axes;
        let second = axes.get(1).map_or(1, |axis| axis.count());
        let number = [self.cell / second, self.cell % second];
        Some(axes.get(axis)?.centre(number[axis]))
    }
}

/// The densities on the common cells.
fn densities<'a>(family: &'a Family) -> Columns<'a, AtCell<'a>> {
    type Row<'a> = AtCell<'a>;
    Columns(vec![
        number(family.parameter(), |row: &Row<'a>| row.solved.0.value),
        word("method", |row: &Row<'a>| row.solved.1.method.name()),
        word("observable", move |row: &Row<'a>| {
            row.estimated.observable.name(family)
        }),
        optional("position", |row: &Row<'a>| row.centre(0)),
        optional("position_2", |row: &Row<'a>| row.centre(1)),
        number("density", |row: &Row<'a>| {
            row.estimated.density.values[row.cell]
        }),
        number("standard_error", |row: &Row<'a>| {
            row.estimated.standard_error[row.cell] + row.estimated.truncated(row.cell)
        }),
    ])
}

/// The names of the columns of each table.
pub(in crate::run) fn column_names(
    family: &Family,
    observables: &[Observable],
) -> Vec<(&'static str, Vec<Named>)> {
    vec![
        (
            "columns of compare.csv",
            methods(family, observables).names(),
        ),
        ("columns of distances.csv", distances(family).names()),
        ("columns of agreement.csv", agreement(family).names()),
        ("columns of measures.csv", measures(family).names()),
        ("columns of accuracy.csv", accuracy(family).names()),
        ("columns of densities.csv", densities(family).names()),
    ]
}

/// `compare.csv`: a row a value and method.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn compare_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    methods_of(run).csv(&records(run, |value| &value.solved))
}

/// `distances.csv`: a row a value, pair (two methods, or a method and the exact density) and observable.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn distances_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    distances(run.family()).csv(&records(run, |value| &value.pairs))
}

/// `agreement.csv`: generator and Monte Carlo bin by bin, a row a value and marginal.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn agreement_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    agreement(run.family()).csv(&records(run, |value| &value.agreement))
}

/// `accuracy.csv`: error against time, a row a method and grid or number of samples.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn accuracy_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    accuracy(run.family()).csv(&accuracy_points(run))
}

/// `densities.csv`: the densities on the common cells.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn densities_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    let mut rows = Vec::new();
    for solved in records(run, |value| &value.solved) {
        for estimated in &solved.1.densities {
            let cells = 0..estimated.density.values.len();
            rows.extend(cells.map(|cell| AtCell {
                solved,
                estimated,
                cell,
            }));
        }
    }
    densities(run.family()).csv(&rows)
}

/// `compare.json`: program, sweep, and all tables but the densities.
///
/// # Errors
/// [`RunError::Json`].
pub(super) fn compare_json(run: &ComparedRun<'_>) -> Result<String, RunError> {
    let object = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "sweep_file": run.sweep,
        "hash": hash(run.sweep),
        "made_of": run.of,
        "threads": run.threads,
        "ending": if run.comparison.interrupted { "interrupted" } else { "complete" },
        "common_cells": run.comparison.common.shape(),
        "agrees": run.comparison.agrees(),
        "methods": methods_of(run).json(&records(run, |value| &value.solved)),
        "distances": distances(run.family()).json(&records(run, |value| &value.pairs)),
        "agreement": agreement(run.family()).json(&records(run, |value| &value.agreement)),
        "measures": measures_json(run),
        "accuracy": accuracy(run.family()).json(&accuracy_points(run)),
    });
    Ok(serde_json::to_string_pretty(&object)? + "\n")
}
