//! `features.csv`: a row a peak, valley or crater. It is not read back: features follow from the densities.

use super::RunError;
use super::columns::{Columns, number, optional, word};
use super::points_table::ascending;
use crate::continuation::{Point, Subject};
use crate::density::Observable;
use crate::system::Family;
use crate::topology::{Feature, FeatureKind, Verdict};

/// A feature with where it was found.
pub(super) struct FeatureRow<'p> {
    value: f64,
    observable: Observable,
    feature: &'p Feature,
}

/// The table's columns.
pub(super) fn columns<'a>(family: &'a Family) -> Columns<'a, FeatureRow<'a>> {
    let coordinate =
        |axis: usize| move |row: &FeatureRow<'_>| row.feature.position.get(axis).copied();
    let error_along =
        |axis: usize| move |row: &FeatureRow<'_>| row.feature.errors.position.get(axis).copied();
    Columns(vec![
        number(family.parameter(), |row: &FeatureRow<'_>| row.value),
        word("observable", move |row: &FeatureRow<'_>| {
            row.observable.name(family)
        }),
        word("kind", |row: &FeatureRow<'_>| kind_word(row.feature.kind)),
        optional("position", coordinate(0)),
        number("density", |row: &FeatureRow<'_>| row.feature.density),
        number("persistence", |row: &FeatureRow<'_>| {
            row.feature.persistence
        }),
        number("significance", |row: &FeatureRow<'_>| {
            row.feature.significance
        }),
        optional("position_2", coordinate(1)),
        number("standard_error", |row: &FeatureRow<'_>| {
            row.feature.standard_error
        }),
        word("verdict", |row: &FeatureRow<'_>| {
            verdict_word(row.feature.verdict)
        }),
        optional("position_error", error_along(0)),
        optional("density_error", |row: &FeatureRow<'_>| {
            row.feature.errors.density
        }),
        optional("position_2_error", error_along(1)),
    ])
}

/// The features of a point that are present or unresolved, by observable.
pub(super) fn found<'p>(
    observables: &[Observable],
    point: &'p Point,
) -> impl Iterator<Item = FeatureRow<'p>> {
    let detections = observables.iter().zip(&point.detections);
    detections.flat_map(move |(&observable, detection)| {
        let features = detection.features.iter();
        let listed = features.filter(|feature| feature.verdict != Verdict::Absent);
        listed.map(move |feature| FeatureRow {
            value: point.value,
            observable,
            feature,
        })
    })
}

/// The table: a row a feature that is present or unresolved, by parameter and observable.
///
/// # Errors
/// [`RunError::Table`].
pub(crate) fn features_csv(subject: &Subject, points: &[Point]) -> Result<String, RunError> {
    let points = ascending(points).into_iter();
    let observables = &subject.observables;
    let rows: Vec<FeatureRow<'_>> = points.flat_map(|point| found(observables, point)).collect();
    columns(&subject.family).csv(&rows)
}

fn kind_word(kind: FeatureKind) -> &'static str {
    match kind {
        FeatureKind::Peak => "peak",
        FeatureKind::Valley => "valley",
        FeatureKind::Crater => "crater",
        FeatureKind::Ring => "ring",
    }
}

fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Present => "present",
        Verdict::Unresolved => "unresolved",
        Verdict::Absent => "absent",
    }
}
