//! Branches of peaks and valleys along a parameter: features of neighbouring points that belong together.

use crate::continuation::Point;
use crate::topology::{Feature, FeatureKind, Verdict};

/// Largest step of a branch from one point to the next, as a share of the window; longer ones are jumps.
const JUMP: f64 = 0.06;
/// The next candidate must be this many times as far away for a link to be beyond doubt.
const CLEAR: f64 = 2.0;

/// A branch: one or more places, in ascending parameter.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Branch {
    /// Whether it is one of peaks or of valleys.
    pub(super) kind: FeatureKind,
    /// Parameter and coordinate.
    pub(super) places: Vec<(f64, f64)>,
}

/// Positions of the present features of a kind at a point, ascending; `None` without a density.
fn positions(point: &Point, observable: usize, kind: FeatureKind) -> Option<Vec<f64>> {
    let detection = point.detections.get(observable)?;
    let wanted = |feature: &&Feature| feature.kind == kind && feature.verdict == Verdict::Present;
    let features = detection.features.iter().filter(wanted);
    let mut positions: Vec<f64> = features
        .filter_map(|feature| feature.position.first().copied())
        .collect();
    positions.sort_by(f64::total_cmp);
    Some(positions)
}

/// The one of `candidates` that is nearest to `at`, if it is near and the next one is clearly farther.
fn link(at: f64, candidates: &[f64], farthest: f64) -> Option<usize> {
    let mut by_distance: Vec<(f64, usize)> = candidates
        .iter()
        .enumerate()
        .map(|(index, &candidate)| ((candidate - at).abs(), index))
        .collect();
    by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(distance, index) = by_distance.first()?;
    let clear = by_distance
        .get(1)
        .is_none_or(|next| next.0 > CLEAR * distance);
    (distance <= farthest && clear).then_some(index)
}

/// Follows the features of one kind of a marginal. A link is mutual, short and beyond doubt; branches end
/// where features jump, split or merge, and at points without a density.
pub(super) fn branches(
    points: &[Point],
    observable: usize,
    kind: FeatureKind,
    window: (f64, f64),
) -> Vec<Branch> {
    let farthest = JUMP * (window.1 - window.0);
    let mut finished: Vec<Branch> = Vec::new();
    let mut open: Vec<Branch> = Vec::new();
    for point in points {
        let Some(found) = positions(point, observable, kind) else {
            finished.append(&mut open);
            continue;
        };
        let last: Vec<f64> = open
            .iter()
            .filter_map(|branch| branch.places.last())
            .map(|place| place.1)
            .collect();
        let mut next: Vec<Branch> = Vec::new();
        let mut continued = vec![false; open.len()];
        for (index, &position) in found.iter().enumerate() {
            let back = link(position, &last, farthest);
            let mutual = back.filter(|&branch| link(last[branch], &found, farthest) == Some(index));
            let mut branch = match mutual {
                Some(branch) => {
                    continued[branch] = true;
                    open[branch].clone()
                }
                None => Branch {
                    kind,
                    places: Vec::new(),
                },
            };
            branch.places.push((point.value, position));
            next.push(branch);
        }
        let ended = open
            .into_iter()
            .zip(continued)
            .filter(|(_, continued)| !continued);
        finished.extend(ended.map(|(branch, _)| branch));
        open = next;
    }
    finished.append(&mut open);
    finished
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_short_and_beyond_doubt() {
        assert_eq!(link(0.0, &[0.1, 1.0], 0.2), Some(0));
        assert_eq!(link(0.0, &[0.5], 0.2), None);
        assert_eq!(
            link(0.0, &[-0.1, 0.1], 0.2),
            None,
            "a symmetric split has no favourite"
        );
        assert_eq!(link(0.0, &[], 0.2), None);
    }
}
