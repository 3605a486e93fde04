//! Points of a sweep at which a density is level where a crater becomes a peak.

use super::Point;
use super::events::{Event, events};
use crate::topology::{FeatureKind, Signature};

/// Leaves out points at which a density is level where a crater is on one side of them and a peak on the other: they
/// count neither.
pub(super) fn without_level(
    mut seen: Vec<usize>,
    points: &[&Point],
    observable: usize,
) -> Vec<usize> {
    let signature = |index: usize| points[index].detections[observable].signature;
    let mut first = 1;
    while first < seen.len() {
        let own = signature(seen[first]);
        let run = seen[first..].iter().take_while(|&&at| signature(at) == own);
        let next = first + run.count();
        let around = seen.get(next).map(|&above| (seen[first - 1], above));
        let is_level = around.is_some_and(|(below, above)| {
            signature(below) != own && turns_over(points[below], points[above], observable, &own)
        });
        if is_level {
            seen.drain(first..next);
        } else {
            first = next;
        }
    }
    seen
}

/// Whether a crater becomes a peak between two points, or a peak a crater, and this signature has neither.
fn turns_over(a: &Point, b: &Point, observable: usize, between: &Signature) -> bool {
    let least = |of: fn(&Signature) -> usize| {
        let counts = [a, b].map(|point| of(&point.detections[observable].signature));
        counts[0].min(counts[1])
    };
    let is_turn = |one: &Event| one.feature == FeatureKind::Crater && one.was_peak;
    between.peaks <= least(|one| one.peaks)
        && between.craters <= least(|one| one.craters)
        && events(a, b, observable).iter().any(is_turn)
}
