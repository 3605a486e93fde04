//! What several curves say of one point of codimension two, brought together: an end is where the curve that knows it
//! best has it.

use super::codimension::{CodimensionTwo, SAME, codimension_two, own_points};
use super::found::{CodimensionTwoKind, Curve, CurvePoint, EndReason};
use super::walked::apart;
use crate::continuation::ErrorParts;
use crate::topology::IndicatorKind;

/// How near to its point of codimension two a curve that begins there must have been met, in sides of the box: there
/// its feature is of the size of cells.
const MEETS: f64 = 0.03;

/// Moves ends in points that another curve knows better there, and ends the curves that begin at a degenerate split in
/// it.
pub(in crate::continuation) fn agree(curves: &mut [Curve]) {
    for known in codimension_two(curves) {
        for (index, curve) in curves.iter_mut().enumerate() {
            if known.curves.contains(&index) {
                move_ends(curve, &known);
            } else if begins_there(curve.kind, known.kind) {
                lengthen(curve, &known);
            }
        }
    }
}

fn move_ends(curve: &mut Curve, known: &CodimensionTwo) {
    let at = curve.plane.place(known.values);
    let places: Vec<usize> = own_points(curve)
        .filter(|(kind, _, point)| {
            let gap = apart(curve.plane.place(point.values), at);
            *kind == known.kind && point.error > known.error && gap <= SAME
        })
        .map(|(_, place, _)| place)
        .collect();
    for place in places {
        if let Some(point) = curve.points.get_mut(place) {
            adopt(point, known);
        }
    }
}

/// The point is what is known.
fn adopt(point: &mut CurvePoint, known: &CodimensionTwo) {
    let share = known.error / point.error;
    point.to_edge = point.to_edge.map(|part| share * part);
    point.values = known.values;
    point.error = known.error;
    point.parts = ErrorParts {
        solver: known.error,
        ..ErrorParts::default()
    };
    point.doubts.clone_from(&known.doubts);
}

/// Whether curves of an indicator begin at such a point, and are lost before they come to it: those of joint densities
/// at a degenerate split, and folds at a kink.
fn begins_there(kind: IndicatorKind, known: CodimensionTwoKind) -> bool {
    match known {
        CodimensionTwoKind::DegenerateSplit => {
            kind == IndicatorKind::RING || kind == IndicatorKind::FOLD
        }
        CodimensionTwoKind::DegenerateKink => kind.traits().rising.is_some(),
        _ => false,
    }
}

/// A curve that was lost just before the point at which it begins ends there.
fn lengthen(curve: &mut Curve, known: &CodimensionTwo) {
    if known.observables != [curve.observable] {
        return;
    }
    let at = curve.plane.place(known.values);
    let count_of_ends = curve.ends.len();
    for index in 0..count_of_ends {
        let end = &curve.ends[index];
        let lost = matches!(end.reason, EndReason::FeatureLost | EndReason::NotConverged);
        let Some(last) = curve.points.get(end.point).filter(|_| lost) else {
            continue;
        };
        if apart(curve.plane.place(last.values), at) > MEETS {
            continue;
        }
        let is_first = index == 0 && count_of_ends > 1;
        // What lies within a hair of the meeting is of the size of cells.
        let plane = curve.plane.clone();
        let is_beside = |point: &&CurvePoint| apart(plane.place(point.values), at) <= SAME;
        let beside = if is_first {
            curve.points.iter().take_while(is_beside).count()
        } else {
            curve.points.iter().rev().take_while(is_beside).count()
        };
        let count = curve.points.len();
        let kept = if is_first {
            beside
        } else {
            (count - 1).saturating_sub(beside)
        };
        let Some(mut point) = curve.points.get(kept).cloned() else {
            continue;
        };
        let gap = apart(plane.place(point.values), at);
        adopt(&mut point, known);
        point.place.clone_from(&known.place);
        point.arclength += if is_first { -gap } else { gap };
        point.checked = false;
        if is_first {
            curve.points.splice(..beside, [point]);
            curve.start = (curve.start + 1).saturating_sub(beside);
        } else {
            curve.points.truncate(count - beside);
            curve.start = curve.start.min(curve.points.len());
            curve.points.push(point);
        }
        let last = curve.points.len() - 1;
        for (number, end) in curve.ends.iter_mut().enumerate() {
            end.point = if number == 0 && count_of_ends > 1 {
                0
            } else {
                last
            };
        }
        let end = &mut curve.ends[index];
        end.reason = match known.kind {
            CodimensionTwoKind::DegenerateKink => EndReason::DegenerateKink,
            _ => EndReason::DegenerateSplit,
        };
        end.label = format!("{}1", known.kind.prefix());
    }
}
