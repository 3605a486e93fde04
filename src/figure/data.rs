//! The numbers behind a figure of a sweep, as CSV: one row a number that is drawn, with everything that places it.

use crate::continuation::{Point, SweepResult};
use crate::density::{Density, EstimatedDensity, Observable};

use super::shown::Shown;
use super::told::Shows;
use super::{homology, select};

/// A table as it grows.
pub(super) struct Table {
    pub(super) text: String,
}

impl Table {
    pub(super) fn new(columns: &[&str]) -> Self {
        Self {
            text: columns.join(",") + "\n",
        }
    }

    pub(super) fn row(&mut self, cells: &[String]) {
        self.text.push_str(&cells.join(","));
        self.text.push('\n');
    }
}

/// The shortest text that reads back as the same number; empty for values that are none.
pub(super) fn number(value: f64) -> String {
    match value {
        value if !value.is_finite() => String::new(),
        0.0 => "0".to_owned(),
        value if (1e-4..1e15).contains(&value.abs()) => format!("{value}"),
        value => format!("{value:e}"),
    }
}

/// The table of a figure; empty for one that has none.
pub(super) fn table(result: &SweepResult, shows: &Shows<'_>) -> String {
    let every: Vec<&Point> = result.points.iter().collect();
    match shows {
        Shows::Nothing
        | Shows::ComparedMarginals
        | Shows::ComparedJoint(_)
        | Shows::TimeToAccuracy => String::new(),
        Shows::Diagram(observable) => marginals(result, &[*observable], &every, by_cells),
        Shows::Marginals(points) => {
            let observables = result.subject.observables.iter().enumerate();
            let numbers: Vec<usize> = observables
                .filter(|(_, observable)| matches!(observable, Observable::Marginal(_)))
                .map(|(number, _)| number)
                .collect();
            marginals(result, &numbers, points, as_drawn)
        }
        Shows::Joint(observable, points, _) => joint(result, *observable, points),
        Shows::Peaks(observable) => peaks(result, *observable),
        Shows::Indicators(observable) => indicators(result, *observable),
        Shows::Homology(observable) => levels(result, *observable),
        Shows::Health => health(result),
    }
}

/// The standard error of a cell; empty for densities without sampling.
fn error(estimated: &EstimatedDensity, cell: usize) -> String {
    match estimated.standard_error.get(cell) {
        Some(&error) if error > 0.0 => number(error),
        _ => String::new(),
    }
}

/// Coordinate, density and standard error of a row.
type Row = (f64, f64, String);

/// A marginal as its cells have it.
fn by_cells(estimated: &EstimatedDensity, _window: (f64, f64)) -> Vec<Row> {
    let centres = estimated.density.axes[0].centres().into_iter();
    let values = centres.zip(&estimated.density.values).enumerate();
    values
        .map(|(cell, (centre, &value))| (centre, value, error(estimated, cell)))
        .collect()
}

/// The points of a marginal's curve; with sampling noise its cells.
fn as_drawn(estimated: &EstimatedDensity, window: (f64, f64)) -> Vec<Row> {
    let shown = Shown::new(estimated);
    if shown.between.is_none() {
        return by_cells(estimated, window);
    }
    let curve = shown.curve(window).into_iter();
    curve
        .map(|(place, value)| (place, value, String::new()))
        .collect()
}

fn marginals(
    result: &SweepResult,
    observables: &[usize],
    points: &[&Point],
    rows: fn(&EstimatedDensity, (f64, f64)) -> Vec<Row>,
) -> String {
    let family = &result.subject.family;
    let parameter = family.parameter();
    let mut table = Table::new(&[parameter, "axis", "coordinate", "density", "standard_error"]);
    for point in points {
        for &observable in observables {
            let (Some(estimated), Observable::Marginal(axis)) = (
                select::density(point, observable),
                result.subject.observables[observable],
            ) else {
                continue;
            };
            let all = points
                .iter()
                .filter_map(|point| select::density(point, observable));
            let all: Vec<&Density> = all.map(|one| &one.density).collect();
            let Some(window) = select::window(&all, 0) else {
                continue;
            };
            for (place, value, error) in rows(estimated, window) {
                table.row(&[
                    number(point.value),
                    family.axis(axis).to_owned(),
                    number(place),
                    number(value),
                    error,
                ]);
            }
        }
    }
    table.text
}

fn joint(result: &SweepResult, observable: usize, points: &[&Point]) -> String {
    let family = &result.subject.family;
    let Observable::Joint(first, second) = result.subject.observables[observable] else {
        return String::new();
    };
    let (first, second) = (family.axis(first), family.axis(second));
    let mut table = Table::new(&[
        family.parameter(),
        first,
        second,
        "density",
        "standard_error",
    ]);
    for point in points {
        let Some(estimated) = select::density(point, observable) else {
            continue;
        };
        let [across, along] = &estimated.density.axes[..] else {
            continue;
        };
        let (across, along) = (across.centres(), along.centres());
        for (cell, &value) in estimated.density.values.iter().enumerate() {
            table.row(&[
                number(point.value),
                number(across[cell / along.len()]),
                number(along[cell % along.len()]),
                number(value),
                error(estimated, cell),
            ]);
        }
    }
    table.text
}

fn peaks(result: &SweepResult, observable: usize) -> String {
    let parameter = result.subject.family.parameter();
    let columns = [
        parameter,
        "kind",
        "position",
        "density",
        "persistence",
        "significance",
    ];
    let mut table = Table::new(&columns);
    for point in &result.points {
        let Some(detection) = point.detections.get(observable) else {
            continue;
        };
        let present = |feature: &&crate::topology::Feature| {
            feature.verdict == crate::topology::Verdict::Present
        };
        for feature in detection.features.iter().filter(present) {
            table.row(&[
                number(point.value),
                format!("{:?}", feature.kind).to_lowercase(),
                feature
                    .position
                    .first()
                    .copied()
                    .map(number)
                    .unwrap_or_default(),
                number(feature.density),
                number(feature.persistence),
                number(feature.significance),
            ]);
        }
    }
    table.text
}

fn indicators(result: &SweepResult, observable: usize) -> String {
    let parameter = result.subject.family.parameter();
    let columns = [
        parameter,
        "indicator",
        "value",
        "systematic_error",
        "sampling_error",
    ];
    let mut table = Table::new(&columns);
    for point in &result.points {
        let detection = point.detections.get(observable);
        for one in detection.iter().flat_map(|detection| &detection.indicators) {
            table.row(&[
                number(point.value),
                one.kind.name().to_owned(),
                number(one.value),
                number(one.systematic_error),
                number(one.sampling_error),
            ]);
        }
    }
    table.text
}

/// Levels are shares of the highest peak, as they are drawn.
fn levels(result: &SweepResult, observable: usize) -> String {
    let parameter = result.subject.family.parameter();
    let mut table = Table::new(&[parameter, "level_from", "level_to", "pieces", "holes"]);
    for point in &result.points {
        for slab in homology::slabs(homology::features(point, observable)) {
            table.row(&[
                number(point.value),
                number(slab.from),
                number(slab.to),
                slab.pieces.to_string(),
                slab.holes.to_string(),
            ]);
        }
    }
    table.text
}

fn health(result: &SweepResult) -> String {
    let mut table = Table::new(&[
        result.subject.family.parameter(),
        "status",
        "residual",
        "solver_error",
        "escape_rate",
        "negative_mass",
        "edge_mass",
        "distance",
    ]);
    for point in &result.points {
        let report = &point.report;
        table.row(&[
            number(point.value),
            report.status.word().to_owned(),
            number(report.residual),
            number(report.solver_error),
            number(report.measure("escape_rate").unwrap_or(0.0)),
            number(report.measure("negative_mass").unwrap_or(0.0)),
            number(report.edge_mass().unwrap_or(0.0).max(0.0)),
            point.distance.map(number).unwrap_or_default(),
        ]);
    }
    table.text
}
