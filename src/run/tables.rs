//! `points.csv` and `features.csv`.

use super::findings::findings_cell;
use super::sentences::sentences;
use super::{Naming, RunError, number::format_number};
use crate::continuation::Point;
use crate::density::Observable;
use crate::topology::{FeatureKind, Verdict};

/// `points.csv`: a row a parameter value, ascending. A point without a density has empty cells, never a NaN.
///
/// `edge_mass` is the largest over the axes of the mass in cells at an end of that axis' range.
///
/// # Errors
/// [`RunError::Table`].
pub fn points_csv(
    naming: &Naming<'_>,
    observables: &[Observable],
    points: &[Point],
) -> Result<String, RunError> {
    let mut table = Table::new(&points_header(naming, observables))?;
    for point in sorted(points) {
        table.row(&points_row(naming, observables, point))?;
    }
    table.finish()
}

fn points_header(naming: &Naming<'_>, observables: &[Observable]) -> Vec<String> {
    let axes = || (0..naming.model.axes.len()).map(|axis| naming.axis(axis));
    let mut header: Vec<String> = [
        naming.parameter,
        "status",
        "method",
        "iterations",
        "residual",
        "escape_rate",
        "negative_mass",
        "edge_mass",
    ]
    .map(str::to_owned)
    .to_vec();
    for axis in axes() {
        header.push(format!("mean_{axis}"));
        header.push(format!("sd_{axis}"));
    }
    for &observable in observables {
        header.push(format!("peaks_{}", naming.observable(observable)));
    }
    for &observable in observables {
        if matches!(observable, Observable::Joint(..)) {
            header.push(format!("craters_{}", naming.observable(observable)));
        }
    }
    header.extend(["distance", "seconds", "map_step", "factorisations"].map(str::to_owned));
    header.extend(axes().map(|axis| format!("numerical_diffusion_{axis}")));
    header.extend(["solver_error", "time_step_bias", "warnings", "findings"].map(str::to_owned));
    header
}

fn points_row(naming: &Naming<'_>, observables: &[Observable], point: &Point) -> Vec<String> {
    let report = &point.report;
    let edge_mass = report.edge_mass.iter().copied().reduce(f64::max);
    let mut row = vec![
        format_number(point.value),
        report.status.word().to_owned(),
        report.method.to_owned(),
        report.iterations.to_string(),
        format_number(report.residual),
        format_number(report.escape_rate),
        format_number(report.own.negative_mass),
        optional(edge_mass),
    ];
    for axis in 0..naming.model.axes.len() {
        let moments = point.moments.get(axis);
        row.push(optional(moments.map(|m| m.mean)));
        row.push(optional(moments.map(|m| m.standard_deviation)));
    }
    let signature = |index: usize| point.detections.get(index).map(|d| d.signature);
    let count = |count: Option<usize>| count.map_or(String::new(), |count| count.to_string());
    for index in 0..observables.len() {
        row.push(count(signature(index).map(|s| s.peaks)));
    }
    for (index, observable) in observables.iter().enumerate() {
        if matches!(observable, Observable::Joint(..)) {
            row.push(count(signature(index).map(|s| s.craters)));
        }
    }
    row.push(optional(point.distance));
    row.push(format!("{:.3}", point.seconds));
    row.push(optional(report.own.map_step));
    row.push(report.own.factorisations.to_string());
    for axis in 0..naming.model.axes.len() {
        row.push(optional(report.own.numerical_diffusion.get(axis).copied()));
    }
    row.push(format_number(report.solver_error));
    row.push(optional(report.own.time_step_bias));
    row.push(sentences(naming, &report.findings));
    row.push(findings_cell(naming, &report.findings));
    row
}

/// `features.csv`: a row a feature that is present or unresolved, by parameter and observable.
///
/// # Errors
/// [`RunError::Table`].
pub fn features_csv(
    naming: &Naming<'_>,
    observables: &[Observable],
    points: &[Point],
) -> Result<String, RunError> {
    let header = [
        naming.parameter,
        "observable",
        "kind",
        "position",
        "density",
        "persistence",
        "significance",
        "position_2",
        "standard_error",
        "verdict",
    ];
    let mut table = Table::new(&header.map(str::to_owned))?;
    for point in sorted(points) {
        for (&observable, detection) in observables.iter().zip(&point.detections) {
            let features = detection.features.iter();
            for feature in features.filter(|feature| feature.verdict != Verdict::Absent) {
                table.row(&[
                    format_number(point.value),
                    naming.observable(observable),
                    kind_word(feature.kind).to_owned(),
                    optional(feature.position.first().copied()),
                    format_number(feature.density),
                    format_number(feature.persistence),
                    format_number(feature.significance),
                    optional(feature.position.get(1).copied()),
                    format_number(feature.standard_error),
                    verdict_word(feature.verdict).to_owned(),
                ])?;
            }
        }
    }
    table.finish()
}

fn kind_word(kind: FeatureKind) -> &'static str {
    match kind {
        FeatureKind::Peak => "peak",
        FeatureKind::Valley => "valley",
        FeatureKind::Crater => "crater",
    }
}

fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Present => "present",
        Verdict::Unresolved => "unresolved",
        Verdict::Absent => "absent",
    }
}

fn optional(value: Option<f64>) -> String {
    value.map_or(String::new(), format_number)
}

fn sorted(points: &[Point]) -> Vec<&Point> {
    let mut sorted: Vec<&Point> = points.iter().collect();
    sorted.sort_by(|a, b| a.value.total_cmp(&b.value));
    sorted
}

/// A CSV text in the making.
pub(super) struct Table(csv::Writer<Vec<u8>>);

impl Table {
    pub(super) fn new(header: &[String]) -> Result<Self, RunError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(header)?;
        Ok(Self(writer))
    }

    pub(super) fn row(&mut self, row: &[String]) -> Result<(), RunError> {
        Ok(self.0.write_record(row)?)
    }

    pub(super) fn finish(self) -> Result<String, RunError> {
        let bytes = self
            .0
            .into_inner()
            .map_err(|error| csv::Error::from(error.into_error()))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}
