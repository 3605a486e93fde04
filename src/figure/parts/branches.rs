//! Branches of peaks and valleys along a parameter: features of neighbouring points that belong together.

use crate::continuation::Point;
use crate::numerics::sort_ascending;
use crate::topology::{Feature, FeatureKind, Verdict};

/// Largest step of a branch between near points, as a share of the window; longer ones are jumps.
const JUMP: f64 = 0.06;
/// The same per share of the parameter's range: a branch that crosses the window 1.8 times as the parameter crosses
/// its range is still smooth. Between distant points it may thus go farther than [`JUMP`].
const SLOPE: f64 = 1.8;
/// Largest step between however distant points, as a share of the window.
pub(super) const FARTHEST: f64 = 0.25;
/// The next candidate must be this many times as far away for a link to be beyond doubt.
const CLEAR: f64 = 2.0;
/// A step that no eye sees, as a share of the window.
const STILL: f64 = 0.005;

/// A branch: one or more places, in ascending parameter.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Branch {
    /// Whether it is one of peaks or of valleys.
    pub(crate) kind: FeatureKind,
    /// Parameter and coordinate.
    pub(crate) places: Vec<(f64, f64)>,
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
    sort_ascending(&mut by_distance, |one| one.0);
    let &(distance, index) = by_distance.first()?;
    let clear = by_distance
        .get(1)
        .is_none_or(|next| next.0 > CLEAR * distance);
    (distance <= farthest && clear).then_some(index)
}

/// For each feature the one of the point before that it continues. A link is mutual, short and beyond doubt. As many
/// features as before that all but stand still are linked in their order, however near each other they are: a pair just
/// born.
fn links(last: &[f64], found: &[f64], farthest: f64, still: f64) -> Vec<Option<usize>> {
    let moved = || last.iter().zip(found).map(|(a, b)| (a - b).abs());
    if last.len() == found.len() && moved().all(|step| step <= still) {
        return (0..found.len()).map(Some).collect();
    }
    let mutual = |(index, &position): (usize, &f64)| {
        let back = link(position, last, farthest);
        back.filter(|&branch| link(last[branch], found, farthest) == Some(index))
    };
    found.iter().enumerate().map(mutual).collect()
}

/// Follows the features of one kind of a marginal. Branches end where features jump, split or merge, and at points
/// without a density.
pub(crate) fn branches(
    points: &[Point],
    observable: usize,
    kind: FeatureKind,
    window: (f64, f64),
) -> Vec<Branch> {
    let range = match (points.first(), points.last()) {
        (Some(first), Some(last)) if last.value > first.value => last.value - first.value,
        _ => f64::INFINITY,
    };
    let height = window.1 - window.0;
    let mut before = points.first().map_or(0.0, |first| first.value);
    let mut finished: Vec<Branch> = Vec::new();
    let mut open: Vec<Branch> = Vec::new();
    for point in points {
        let spacing = (point.value - before) / range;
        before = point.value;
        let farthest = (SLOPE * spacing).clamp(JUMP, FARTHEST) * height;
        let Some(found) = positions(point, observable, kind) else {
            finished.append(&mut open);
            continue;
        };
        let places = open.iter().filter_map(|branch| branch.places.last());
        let last: Vec<f64> = places.map(|place| place.1).collect();
        let links = links(&last, &found, farthest, STILL * height);
        let mut earlier: Vec<Option<Branch>> = open.drain(..).map(Some).collect();
        for (&position, link) in found.iter().zip(links) {
            let continued = link.and_then(|branch| earlier[branch].take());
            let mut branch = continued.unwrap_or_else(|| Branch {
                kind,
                places: Vec::new(),
            });
            branch.places.push((point.value, position));
            open.push(branch);
        }
        finished.extend(earlier.into_iter().flatten());
    }
    finished.append(&mut open);
    finished
}

#[cfg(test)]
pub(in crate::figure) mod tests {
    use super::*;
    use crate::continuation::SolveReport;
    use crate::topology::FeatureErrors;
    use crate::topology::{Detection, Signature};

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
        // A pair that is nearer to its mirror image than to where it was.
        let (last, found) = ([-0.006, 0.006], [-0.001, 0.001]);
        assert_eq!(links(&last, &found, 0.2, 0.004), [None, None]);
        assert_eq!(links(&last, &found, 0.2, 0.01), [Some(0), Some(1)]);
        assert_eq!(links(&last, &[0.0], 0.2, 0.01), [None]);
    }

    /// A point with peaks at the given places; without a density for `None`.
    pub(in crate::figure) fn point(value: f64, peaks: Option<&[f64]>) -> Point {
        let feature = |&at: &f64| Feature {
            kind: FeatureKind::Peak,
            position: vec![at],
            density: 1.0,
            persistence: 1.0,
            standard_error: 0.0,
            significance: 9.0,
            verdict: Verdict::Present,
            partner: None,
            errors: FeatureErrors::default(),
        };
        let detection = |places: &[f64]| Detection {
            indicators: Vec::new(),
            is_seen: true,
            signature: Signature::of_peaks(places.len()),
            features: places.iter().map(feature).collect(),
        };
        Point {
            value,
            report: SolveReport::solved("exact"),
            densities: Vec::new(),
            detections: peaks.into_iter().map(detection).collect(),
            distance: None,
            seconds: 0.0,
        }
    }

    #[test]
    fn distant_points_are_linked_farther_than_near_ones() {
        // 0.4 of a window of 2 is 0.2 of it: within reach over a third of the range, not over a thirtieth.
        let places = |value: f64| point(value, Some(&[0.4 * value]));
        let few: Vec<Point> = (0..4).map(|i| places(f64::from(i))).collect();
        assert_eq!(branches(&few, 0, FeatureKind::Peak, (-1.0, 1.0)).len(), 1);
        let jump = |i: i32| point(f64::from(i), Some(&[if i < 15 { 0.0 } else { 0.4 }]));
        let many: Vec<Point> = (0..31).map(jump).collect();
        assert_eq!(branches(&many, 0, FeatureKind::Peak, (-1.0, 1.0)).len(), 2);
    }

    #[test]
    fn branches_end_at_splits_jumps_and_gaps() {
        let points = [
            point(0.0, Some(&[0.0])),
            point(1.0, None),
            point(2.0, Some(&[0.01])),
            point(3.0, Some(&[0.02])),
            point(4.0, Some(&[-0.08, 0.12])),
            point(5.0, Some(&[-0.10, 0.14, 0.9])),
            point(6.0, Some(&[-0.12, 0.5])),
        ];
        let found = branches(&points, 0, FeatureKind::Peak, (-1.0, 1.0));
        let mut lengths: Vec<Vec<(f64, f64)>> =
            found.into_iter().map(|branch| branch.places).collect();
        lengths.sort_by(|a, b| a[0].partial_cmp(&b[0]).unwrap());
        let expected = [
            vec![(0.0, 0.0)],
            vec![(2.0, 0.01), (3.0, 0.02)],
            vec![(4.0, -0.08), (5.0, -0.10), (6.0, -0.12)],
            vec![(4.0, 0.12), (5.0, 0.14)],
            vec![(5.0, 0.9)],
            vec![(6.0, 0.5)],
        ];
        assert_eq!(lengths, expected);
    }
}
