//! Tables for programs: every number in full.

use serde_json::{Value, json};

use super::{ComparedRun, partner};
use crate::compare::{Distance, Reference, Solved};
use crate::run::sentences::sentences;
use crate::run::tables::Table;
use crate::run::{RunError, format_number, stored_run::hash};

/// A table: header and rows of words.
struct Rows {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Rows {
    fn new(header: &[&str]) -> Self {
        Self {
            header: header.iter().map(|&name| name.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    fn csv(&self) -> Result<String, RunError> {
        let mut table = Table::new(&self.header)?;
        for row in &self.rows {
            table.row(row)?;
        }
        table.finish()
    }

    /// Objects with the header's names; numbers as numbers, empty cells as null.
    fn json(&self) -> Value {
        let object = |row: &Vec<String>| {
            let cells = self.header.iter().zip(row);
            let value = |word: &String| match (word.as_str(), word.parse::<f64>()) {
                ("", _) => Value::Null,
                ("true", _) => json!(true),
                ("false", _) => json!(false),
                (_, Ok(number)) if number.is_finite() => json!(number),
                _ => json!(word),
            };
            Value::Object(
                cells
                    .map(|(key, word)| (key.clone(), value(word)))
                    .collect(),
            )
        };
        self.rows.iter().map(object).collect()
    }
}

fn optional(value: Option<f64>) -> String {
    value.map_or(String::new(), format_number)
}

fn seconds(value: f64) -> String {
    format!("{value:.4}")
}

/// Work in the unit of the method.
fn work(solved: &Solved) -> (String, &'static str) {
    match solved.work.steps {
        0 => (
            solved.report.own.factorisations.to_string(),
            "factorisations",
        ),
        steps => (steps.to_string(), "integrator steps"),
    }
}

fn methods(run: &ComparedRun<'_>) -> Rows {
    let mut rows = Rows::new(&[
        run.naming.parameter,
        "method",
        "status",
        "seconds",
        "sampling_seconds",
        "solve_seconds",
        "preparation_seconds",
        "work",
        "work_unit",
        "iterations",
        "bytes",
        "bytes_from",
        "cells",
        "samples",
        "map_step",
        "time_step",
        "time_step_bias",
        "escape_rate",
        "share_outside",
    ]);
    let observables = &run.comparison.observables;
    let axes = 0..run.comparison.common.dimension();
    let names = axes
        .clone()
        .map(|axis| format!("numerical_diffusion_{}", run.naming.axis(axis)));
    rows.header.extend(names);
    for &observable in observables {
        let name = run.naming.observable(observable);
        rows.header.extend([
            format!("tv_exact_{name}"),
            format!("hellinger_exact_{name}"),
        ]);
    }
    rows.header.push("warnings".to_owned());
    for value in &run.comparison.values {
        for solved in &value.solved {
            let (report, cost) = (&solved.report, &solved.work);
            let (bytes, from) = (run.bytes)(solved);
            let (work, unit) = work(solved);
            let mut row = vec![
                format_number(value.value),
                solved.method.name().to_owned(),
                solved.status.word().to_owned(),
                seconds(cost.seconds()),
                seconds(cost.sampling_seconds),
                seconds(cost.solve_seconds),
                seconds(cost.preparation_seconds),
                work,
                unit.to_owned(),
                report.iterations.to_string(),
                format!("{bytes:.0}"),
                from.to_owned(),
                cost.cells.to_string(),
                match cost.samples {
                    0 => String::new(),
                    samples => samples.to_string(),
                },
                optional(report.own.map_step),
                optional(solved.time_step),
                optional(report.own.time_step_bias),
                format_number(report.escape_rate),
                optional(solved.share_outside),
            ];
            let diffusion = |axis: usize| report.own.numerical_diffusion.get(axis).copied();
            row.extend(axes.clone().map(|axis| optional(diffusion(axis))));
            for &observable in observables {
                let exact = value.pair(solved.method, None, observable);
                row.push(optional(exact.map(|found| found.total_variation.value)));
                row.push(optional(exact.map(|found| found.hellinger.value)));
            }
            row.push(sentences(&run.naming, &report.findings));
            rows.rows.push(row);
        }
    }
    rows
}

fn distance_words(distance: &Distance) -> [String; 5] {
    [
        format_number(distance.value),
        format_number(distance.error),
        format_number(distance.systematic),
        format_number(distance.noise),
        distance.is_significant().to_string(),
    ]
}

fn distances(run: &ComparedRun<'_>) -> Rows {
    let mut rows = Rows::new(&[run.naming.parameter, "first", "second", "observable"]);
    for name in ["tv", "hellinger"] {
        let columns = ["", "_error", "_systematic", "_noise", "_significant"];
        rows.header
            .extend(columns.map(|column| format!("{name}{column}")));
    }
    for value in &run.comparison.values {
        for pair in &value.pairs {
            let mut row = vec![
                format_number(value.value),
                pair.first.name().to_owned(),
                partner(pair.second).to_owned(),
                run.naming.observable(pair.observable),
            ];
            row.extend(distance_words(&pair.distances.total_variation));
            row.extend(distance_words(&pair.distances.hellinger));
            rows.rows.push(row);
        }
    }
    rows
}

fn agreement(run: &ComparedRun<'_>) -> Rows {
    let mut rows = Rows::new(&[
        run.naming.parameter,
        "observable",
        "bins",
        "within_3_errors",
        "share",
        "beyond_all_errors",
        "worst",
    ]);
    for value in &run.comparison.values {
        for one in &value.agreement {
            rows.rows.push(vec![
                format_number(value.value),
                run.naming.observable(one.observable),
                one.bins.to_string(),
                one.within.to_string(),
                format_number(one.share()),
                one.beyond.to_string(),
                format_number(one.worst),
            ]);
        }
    }
    rows
}

fn accuracy(run: &ComparedRun<'_>) -> Rows {
    let mut rows = Rows::new(&[
        run.naming.parameter,
        "observable",
        "reference",
        "method",
        "cells",
        "samples",
        "seconds",
        "tv",
        "tv_error",
        "tv_noise",
    ]);
    if let Some(accuracy) = &run.comparison.accuracy {
        let reference = match accuracy.reference {
            Reference::Exact => "exact".to_owned(),
            Reference::Generator(cells) => format!("generator on {cells} cells"),
        };
        for point in &accuracy.points {
            rows.rows.push(vec![
                format_number(accuracy.value),
                run.naming.observable(accuracy.observable),
                reference.clone(),
                point.method.name().to_owned(),
                point.cells.to_string(),
                match point.samples {
                    0 => String::new(),
                    samples => samples.to_string(),
                },
                seconds(point.seconds),
                format_number(point.error.value),
                format_number(point.error.error),
                format_number(point.error.noise),
            ]);
        }
    }
    rows
}

fn densities(run: &ComparedRun<'_>) -> Rows {
    let mut rows = Rows::new(&[
        run.naming.parameter,
        "method",
        "observable",
        "position",
        "position_2",
        "density",
        "standard_error",
    ]);
    for value in &run.comparison.values {
        for solved in &value.solved {
            for estimated in &solved.densities {
                let axes = &estimated.density.axes;
                let second = axes.get(1).map_or(1, |axis| axis.count());
                let cells = estimated.density.values.iter();
                for (cell, (p, error)) in cells.zip(&estimated.standard_error).enumerate() {
                    rows.rows.push(vec![
                        format_number(value.value),
                        solved.method.name().to_owned(),
                        run.naming.observable(estimated.observable),
                        format_number(axes[0].centre(cell / second)),
                        optional(axes.get(1).map(|axis| axis.centre(cell % second))),
                        format_number(*p),
                        format_number(*error),
                    ]);
                }
            }
        }
    }
    rows
}

/// `compare.csv`: a row a value and method.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn compare_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    methods(run).csv()
}

/// `distances.csv`: a row a value, pair (two methods, or a method and the exact density) and observable.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn distances_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    distances(run).csv()
}

/// `agreement.csv`: generator and Monte Carlo bin by bin, a row a value and marginal.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn agreement_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    agreement(run).csv()
}

/// `accuracy.csv`: error against time, a row a method and grid or number of samples.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn accuracy_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    accuracy(run).csv()
}

/// `densities.csv`: the densities on the common cells.
///
/// # Errors
/// [`RunError::Table`].
pub(super) fn densities_csv(run: &ComparedRun<'_>) -> Result<String, RunError> {
    densities(run).csv()
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
        "threads": run.threads,
        "common_cells": run.comparison.common.shape(),
        "agrees": run.comparison.agrees(),
        "methods": methods(run).json(),
        "distances": distances(run).json(),
        "agreement": agreement(run).json(),
        "accuracy": accuracy(run).json(),
    });
    Ok(serde_json::to_string_pretty(&object)? + "\n")
}
