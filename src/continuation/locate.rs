//! The rows of a sweep: every change of signature with its value, error, bracket and status.

use super::change::{Change, changes};
use super::grid::{Checked, GridCheck, SHARE_OF_DISTANCE};
use super::label::{self, BifurcationStatus, LabelledPoint, PointType};
use super::root::{Root, root};
use super::{LocateOptions, Point, persistence, words};
use crate::density::Observable;
use crate::topology::{Detector, IndicatorKind};

/// The check on a finer grid: takes what is checked, `None` when there is no finer grid.
pub(super) type Check<'a> = &'a mut dyn FnMut(&Checked<'_>) -> Option<GridCheck>;

/// All labelled points of a sweep, in ascending parameter. `points` must be ascending.
pub(super) fn label_points(
    points: &[Point],
    observables: &[Observable],
    detector: &dyn Detector,
    options: &LocateOptions,
    check: Check<'_>,
) -> Vec<LabelledPoint> {
    let mut labels = label::end_points(points);
    labels.extend(label::failures(points));
    let solved: Vec<&Point> = points.iter().filter(|p| !p.detections.is_empty()).collect();
    let mut rows: Vec<LabelledPoint> = Vec::new();
    for change in changes(&solved, detector) {
        let row = match &change.crossing {
            Some(_) => by_indicator(&solved, observables, &change, detector, options, check),
            None => by_persistence(&solved, observables, &change, options),
        };
        // Two indicators whose zeros cannot be told apart make one change.
        let same = rows.last_mut().filter(|last| inseparable(last, &row));
        match same {
            Some(last) => merge(last, &row),
            None => rows.push(row),
        }
    }
    labels.extend(rows);
    label::number(labels)
}

/// A row with all but value, error and status.
fn blank(observables: &[Observable], change: &Change) -> LabelledPoint {
    let crossing = change.crossing.as_ref();
    let kind = crossing.map(|crossing| crossing.kind());
    let rises = crossing.is_some_and(|crossing| crossing.ends[1].value > crossing.ends[0].value);
    LabelledPoint {
        label: String::new(),
        kind: PointType::Bifurcation,
        value: 0.0,
        error: 0.0,
        lower: 0.0,
        upper: 0.0,
        observable: observables.get(change.observable).copied(),
        before: Some(change.before),
        after: Some(change.after),
        status: None,
        change: words::change(kind, rises, change.before, change.after),
        method: kind.map_or("persistence", IndicatorKind::name),
        parts: None,
    }
}

fn by_persistence(
    points: &[&Point],
    observables: &[Observable],
    change: &Change,
    options: &LocateOptions,
) -> LabelledPoint {
    let band = persistence::band(points, change.observable, change.left);
    let located = band.upper - band.lower <= options.tolerance * (1.0 + 1e-9);
    LabelledPoint {
        value: band.value,
        error: (band.value - band.lower).max(band.upper - band.value),
        lower: band.lower,
        upper: band.upper,
        status: Some(match (band.resolved_by_cells, located) {
            (false, _) => BifurcationStatus::Unconfirmed,
            (true, true) => BifurcationStatus::Located,
            (true, false) => BifurcationStatus::Unresolved,
        }),
        ..blank(observables, change)
    }
}

fn by_indicator(
    points: &[&Point],
    observables: &[Observable],
    change: &Change,
    detector: &dyn Detector,
    options: &LocateOptions,
    check: Check<'_>,
) -> LabelledPoint {
    let mut row = blank(observables, change);
    let Some(crossing) = &change.crossing else {
        return row;
    };
    let mut found: Root = root(points, crossing, detector.confidence());
    let bracket = (points[crossing.left].value, points[crossing.left + 1].value);
    // The slope at a kink follows from the equations: no grid takes part.
    let checked = match crossing.kind() {
        IndicatorKind::KinkSlope => None,
        kind => check(&Checked {
            observable: change.observable,
            kind,
            place: &crossing.ends[0].place,
            root: found,
        }),
    };
    if let Some(GridCheck::Confirmed(value)) = checked {
        found.error.grid = SHARE_OF_DISTANCE * (value - found.value).abs();
        found.value = value;
    }
    let error = found.error.total();
    let narrow = bracket.1 - bracket.0 <= options.tolerance * (1.0 + 1e-9);
    row.value = found.value;
    row.error = error;
    row.lower = bracket.0.min(found.value - error);
    row.upper = bracket.1.max(found.value + error);
    row.parts = Some(found.error);
    // The diffusion that the cells of a sampled map add moves values; without a finer grid nobody knows by how much.
    let diffused = !points[crossing.left]
        .report
        .own
        .numerical_diffusion
        .is_empty();
    let depends_on_cells = crossing.kind() != IndicatorKind::KinkSlope;
    row.status = Some(match checked {
        Some(GridCheck::Unconfirmed) => BifurcationStatus::Unconfirmed,
        _ if !narrow || error > options.tolerance => BifurcationStatus::Unresolved,
        None if diffused && depends_on_cells => BifurcationStatus::Unconfirmed,
        _ => BifurcationStatus::Located,
    });
    row
}

/// Whether two changes of one observable follow each other so closely that the stage between them is not certain.
fn inseparable(first: &LabelledPoint, second: &LabelledPoint) -> bool {
    let both = first.parts.is_some() && second.parts.is_some();
    let apart = (second.value - first.value).abs();
    both && first.observable == second.observable
        && first.after == second.before
        && first.before != second.after
        && apart <= first.error + second.error
}

/// Makes one row of two that cannot be told apart.
fn merge(first: &mut LabelledPoint, second: &LabelledPoint) {
    first.lower = first.lower.min(second.lower);
    first.upper = first.upper.max(second.upper);
    let value = 0.5 * (first.value + second.value);
    let half = 0.5 * (second.value - first.value).abs();
    first.error = first.error.max(second.error) + half;
    if let Some(parts) = &mut first.parts {
        parts.grid += half;
    }
    first.value = value;
    first.after = second.after;
    if first.status == Some(BifurcationStatus::Located) {
        first.status = second.status;
    }
    if let (Some(before), Some(after)) = (first.before, first.after) {
        let kind = Some(IndicatorKind::LowerCurvature);
        first.change = words::change(kind, second.value > first.value, before, after);
    }
}
