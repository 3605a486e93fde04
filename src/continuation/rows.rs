//! Rows of a sweep beside each other: in which order they come, and which of them are one because nothing tells them
//! apart.

use super::Point;
use super::change::Change;
use super::label::{BifurcationStatus, LabelledPoint};
use crate::density::Observable;
use crate::topology::{IndicatorKind, Step};

/// So many rows in a row that are not located are one.
const FLICKER: usize = 3;

/// The rows of changes between the same two points, ascending, each from the signature that the one before leaves;
/// those whose values cannot be told apart are one.
pub(super) fn in_order(mut found: Vec<(LabelledPoint, &Change)>) -> Vec<LabelledPoint> {
    found.sort_by(|a, b| a.0.value.total_cmp(&b.0.value));
    let Some(last) = found.last().map(|one| one.1.after) else {
        return Vec::new();
    };
    let mut rows: Vec<LabelledPoint> = Vec::new();
    for (mut row, change) in found {
        let before = rows
            .last()
            .map_or(change.before, |row| row.after.unwrap_or(change.before));
        row.before = Some(before);
        row.after = Some(change.step(before));
        match rows.last_mut() {
            Some(last) if row.value - last.value <= last.error + row.error => merge(last, &row),
            _ => rows.push(row),
        }
    }
    if let Some(row) = rows.last_mut() {
        row.after = Some(last);
    }
    rows
}

/// Where features come and go from point to point, one row says from where to where, instead of one a point. What has a
/// place of its own keeps its row, however wide its error.
pub(super) fn without_flicker(rows: Vec<LabelledPoint>) -> Vec<LabelledPoint> {
    let mut kept = Vec::new();
    for run in rows.chunk_by(is_one_doubt) {
        let (first, last) = (&run[0], &run[run.len() - 1]);
        let returns = run.len() > 1 && first.before == last.after;
        if run.len() < FLICKER && !returns {
            kept.extend_from_slice(run);
            continue;
        }
        let lower = run
            .iter()
            .map(|row| row.lower)
            .fold(f64::INFINITY, f64::min);
        let upper = run
            .iter()
            .map(|row| row.upper)
            .fold(f64::NEG_INFINITY, f64::max);
        kept.push(LabelledPoint {
            value: 0.5 * (lower + upper),
            error: 0.5 * (upper - lower),
            lower,
            upper,
            after: last.after,
            status: Some(BifurcationStatus::Unresolved),
            method: "persistence",
            indicator: None,
            parts: None,
            reason: Some(match returns {
                true => "what is there at both ends cannot be told between them".to_owned(),
                false => "the stages between cannot be told apart".to_owned(),
            }),
            place: Vec::new(),
            slope: None,
            ..first.clone()
        });
    }
    kept
}

/// Whether two rows that follow each other are not located and cannot be kept apart: their intervals overlap, or, where
/// one of them is no zero of an indicator, the stage between them is no wider than they are.
fn is_one_doubt(first: &LabelledPoint, second: &LabelledPoint) -> bool {
    let in_doubt = |row: &LabelledPoint| row.status != Some(BifurcationStatus::Located);
    let is_zero = |row: &LabelledPoint| {
        row.parts.is_some() && row.status != Some(BifurcationStatus::Unconfirmed)
    };
    let between = second.lower - first.upper;
    let width = match is_zero(first) && is_zero(second) {
        true => 0.0,
        false => (first.upper - first.lower).max(second.upper - second.lower),
    };
    first.observable == second.observable && in_doubt(first) && in_doubt(second) && between <= width
}

/// The reason of a row beside which something is missing, or too much.
const DOES_NOT_CONTINUE: &str = "what is counted on one side of it is not what is counted beside the next change: a change between them was \
     missed, or one of the two is none; more cells may show which";

/// Takes the status of being located from rows that contradict each other: what is counted after one row must be
/// what is counted before the next one of its observable, and at the ends of the sweep what is counted there.
pub(super) fn doubt_what_does_not_continue(
    rows: &mut [LabelledPoint],
    points: &[&Point],
    observables: &[Observable],
) {
    for (place, observable) in observables.iter().enumerate() {
        let signature = |point: &&Point| Some(point.detections.get(place)?.signature);
        let mut own: Vec<usize> = (0..rows.len())
            .filter(|&row| rows[row].observable == Some(*observable))
            .collect();
        own.sort_by(|&a, &b| rows[a].value.total_cmp(&rows[b].value));
        let mut last = points.first().and_then(signature);
        let mut contradicting = Vec::new();
        for (number, &row) in own.iter().enumerate() {
            if rows[row].before != last {
                contradicting.extend(number.checked_sub(1).map(|before| own[before]));
                contradicting.push(row);
            }
            last = rows[row].after;
        }
        if last != points.last().and_then(signature) {
            contradicting.extend(own.last());
        }
        for row in contradicting {
            let row = &mut rows[row];
            if row.status == Some(BifurcationStatus::Located) {
                row.status = Some(BifurcationStatus::Unresolved);
                row.reason = Some(DOES_NOT_CONTINUE.to_owned());
            }
        }
    }
}

/// Says what happens, once it is known between which signatures.
pub(super) fn say(row: &mut LabelledPoint) {
    if let (Some(before), Some(after)) = (row.before, row.after) {
        let step = Step {
            rises: row.rises,
            before,
            after,
        };
        row.change = step.words(row.indicator.as_slice());
    }
}

/// Whether two changes of one observable follow each other so closely that the stage between them is not certain.
pub(super) fn inseparable(first: &LabelledPoint, second: &LabelledPoint) -> bool {
    let both = first.parts.is_some() && second.parts.is_some();
    let apart = (second.value - first.value).abs();
    both && first.observable == second.observable
        && first.after == second.before
        && first.before != second.after
        && apart <= first.error + second.error
}

/// Makes one row of two that cannot be told apart.
pub(super) fn merge(first: &mut LabelledPoint, second: &LabelledPoint) {
    first.lower = first.lower.min(second.lower);
    first.upper = first.upper.max(second.upper);
    let value = 0.5 * (first.value + second.value);
    let half = 0.5 * (second.value - first.value).abs();
    first.error = first.error.max(second.error) + half;
    if let Some(parts) = &mut first.parts {
        parts.grid += half;
    }
    let later = second.value > first.value;
    first.value = value;
    first.after = second.after;
    if first.status == Some(BifurcationStatus::Located) {
        first.status = second.status;
    }
    let of_flank = |row: &LabelledPoint| {
        let is_one = |kind: IndicatorKind| kind.rising().is_some() || kind == IndicatorKind::FOLD;
        row.indicator.is_some_and(is_one)
    };
    if first.indicator != second.indicator && !(of_flank(first) && of_flank(second)) {
        first.indicator = Some(IndicatorKind::LOWER_CURVATURE);
        first.rises = later;
    }
}
