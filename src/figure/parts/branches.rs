//! Branches of peaks and valleys along a parameter: features of neighbouring points that belong together.

use crate::continuation::{BifurcationStatus, Point, SweepResult};
use crate::density::Observable;
use crate::topology::{Feature, FeatureKind, Verdict};

/// Largest step of a branch between near points, as a share of the window; longer ones are jumps.
const JUMP: f64 = 0.06;
/// The same per share of the parameter's range: a branch that crosses the window 1.8 times as the parameter crosses
/// its range is still smooth. Between distant points it may thus go farther than [`JUMP`].
const SLOPE: f64 = 1.8;
/// Largest step between however distant points, as a share of the window.
const FARTHEST: f64 = 0.25;
/// The next candidate must be this many times as far away for a link to be beyond doubt.
const CLEAR: f64 = 2.0;
/// A step that no eye sees, as a share of the window.
const STILL: f64 = 0.005;

/// Points by which a branch is drawn to where it meets another.
const STEPS: usize = 12;
/// Values nearer to a change than this share of the longest step were added to narrow it.
const NEAR: f64 = 0.35;
/// Powers of the distance to a change with which places may go to where they meet: a root at a smooth change, about a
/// straight line at a kink.
const POWERS: (f64, f64) = (0.35, 1.1);
const ROOT: f64 = 0.5;

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
    by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
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

/// The values at which the shape of an observable was located to change.
pub(crate) fn located(result: &SweepResult, observable: Observable) -> Vec<f64> {
    let rows = result.bifurcations();
    let own = rows
        .filter(|row| row.observable == observable && row.status() == BifurcationStatus::Located);
    own.map(|row| row.value).collect()
}

/// The end of a branch beside a change.
#[derive(Debug, Clone, Copy)]
struct End {
    /// Which of the lists of branches, and its number there.
    branch: (usize, usize),
    kind: FeatureKind,
    /// Parameter and coordinate.
    place: (f64, f64),
    /// The place before it, going away from the change.
    before: Option<(f64, f64)>,
    is_below: bool,
}

impl End {
    /// The way from it to where it meets others: as a power of the distance to the change, which its last two places
    /// tell.
    fn way(&self, meeting: (f64, f64)) -> Vec<(f64, f64)> {
        let off = self.place.1 - meeting.1;
        let power = self.before.and_then(|before| {
            let times = (before.1 - meeting.1) / off;
            let longer = (before.0 - meeting.0) / (self.place.0 - meeting.0);
            (times > 1.0 && longer > 1.0).then(|| times.ln() / longer.ln())
        });
        let power = power.unwrap_or(ROOT).clamp(POWERS.0, POWERS.1);
        let step = |number: usize| {
            let share = number as f64 / STEPS as f64;
            let value = self.place.0 + share * (meeting.0 - self.place.0);
            (value, meeting.1 + off * (1.0 - share).powf(power))
        };
        (1..=STEPS).map(step).collect()
    }
}

/// What lies about a change: its value, and how far from it the ends of branches are looked for.
#[derive(Debug, Clone, Copy)]
struct Around {
    change: f64,
    gap: f64,
}

impl Around {
    /// Whether a value is one of those that were added to narrow the change.
    fn is_near(&self, value: f64) -> bool {
        (value - self.change).abs() <= NEAR * self.gap
    }

    /// Whether a branch holds nothing but such values: pieces that no link has joined.
    fn is_piece(&self, branch: &Branch) -> bool {
        branch.places.iter().all(|place| self.is_near(place.0))
    }

    /// Whether a branch lies on one side, but for such values.
    fn is_on_side(&self, branch: &Branch, is_below: bool) -> bool {
        let is_here = |value: f64| (value < self.change) == is_below || self.is_near(value);
        branch.places.iter().all(|place| is_here(place.0))
    }

    /// The places of a branch on one side, the nearest one first.
    fn on_side(&self, branch: &Branch, is_below: bool) -> Vec<(f64, f64)> {
        let places = branch.places.iter().copied();
        let mut own: Vec<(f64, f64)> = places
            .filter(|place| place.0 != self.change && (place.0 < self.change) == is_below)
            .collect();
        if is_below {
            own.reverse();
        }
        own
    }

    /// The ends of branches on one side, in the order of their coordinates.
    fn ends(&self, branches: &[Vec<Branch>; 2], is_below: bool) -> Vec<End> {
        let mut ends = Vec::new();
        for (list, found) in branches.iter().enumerate() {
            for (number, branch) in found.iter().enumerate() {
                if self.is_piece(branch) || !self.is_on_side(branch, is_below) {
                    continue;
                }
                let places = self.on_side(branch, is_below);
                let Some(&place) = places.first() else {
                    continue;
                };
                if (place.0 - self.change).abs() <= self.gap {
                    ends.push(End {
                        branch: (list, number),
                        kind: branch.kind,
                        place,
                        before: places.get(1).copied(),
                        is_below,
                    });
                }
            }
        }
        ends.sort_by(|a, b| a.place.1.total_cmp(&b.place.1));
        ends
    }
}

/// Where the ends on one side of a change meet, with those that do: two of one kind meet the other kind between them,
/// neighbours of different kinds meet half-way. Empty where it is not clear.
fn meetings(ends: &[End]) -> Vec<(f64, Vec<End>)> {
    let alternate = ends.windows(2).all(|pair| pair[0].kind != pair[1].kind);
    match ends.len() {
        3 if alternate => vec![(ends[1].place.1, ends.to_vec())],
        2 | 4 if alternate || ends.len() == 4 => {
            let pairs = ends.chunks(2).filter(|pair| pair[0].kind != pair[1].kind);
            let middle = |pair: &[End]| 0.5 * (pair[0].place.1 + pair[1].place.1);
            pairs.map(|pair| (middle(pair), pair.to_vec())).collect()
        }
        _ => Vec::new(),
    }
}

/// Leads the branches of peaks and of valleys that end beside located changes on to where these are. Between computed
/// values, and where features are too near to each other to be told apart, a diagram would end them short of the change
/// that it marks.
pub(crate) fn meet(
    branches: &mut [Vec<Branch>; 2],
    changes: &[f64],
    points: &[Point],
    window: (f64, f64),
) {
    let farthest = FARTHEST * (window.1 - window.0);
    let steps = points.windows(2).map(|pair| pair[1].value - pair[0].value);
    let gap = 1.01 * steps.fold(0.0, f64::max);
    for &change in changes {
        let around = Around { change, gap };
        let [lower, upper] = [true, false].map(|is_below| around.ends(branches, is_below));
        let (many, few) = if lower.len() > upper.len() {
            (lower, upper)
        } else {
            (upper, lower)
        };
        let mut met = Vec::new();
        for (place, mut group) in meetings(&many) {
            let near = |end: &&End| (end.place.1 - place).abs() <= farthest;
            if !group.iter().all(|end| near(&end)) {
                continue;
            }
            // Three become one of the kind of the outer two.
            if group.len() == 3 && few.len() == 1 {
                group.extend(few.iter().filter(near).copied());
            }
            for end in group {
                let branch = &mut branches[end.branch.0][end.branch.1];
                let mut places = around.on_side(branch, end.is_below);
                places.extend(end.way((change, place)));
                places.sort_by(|a, b| a.0.total_cmp(&b.0));
                branch.places = places;
            }
            met.push(place);
        }
        // The places of pieces are on the ways now.
        let is_on_way = |branch: &Branch| {
            let is_near = |one: &(f64, f64)| met.iter().any(|at| (one.1 - at).abs() <= farthest);
            around.is_piece(branch) && branch.places.iter().all(is_near)
        };
        for list in branches.iter_mut() {
            list.retain(|branch| !is_on_way(branch));
        }
    }
}

#[cfg(test)]
mod tests {
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
    fn point(value: f64, peaks: Option<&[f64]>) -> Point {
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
    fn branches_meet_where_the_change_is() {
        // Peaks at ± √(-value/4) below zero and at zero above, at values ± 0.1, ± 0.3, …; a valley between the two.
        let values: Vec<f64> = (-5..5).map(|i| 0.1 + 0.2 * f64::from(i)).collect();
        let peak = |value: f64| (-0.25 * value).max(0.0).sqrt();
        let of = |value: &f64| match *value < 0.0 {
            true => point(*value, Some(&[-peak(*value), peak(*value)])),
            false => point(*value, Some(&[0.0])),
        };
        let points: Vec<Point> = values.iter().map(of).collect();
        let window = (-1.0, 1.0);
        let valley = Branch {
            kind: FeatureKind::Valley,
            places: values[..5].iter().map(|value| (*value, 0.0)).collect(),
        };
        let peaks = branches(&points, 0, FeatureKind::Peak, window);
        let mut all = [peaks, vec![valley]];
        meet(&mut all, &[0.0], &points, window);
        assert_eq!(all[0].len(), 3);
        for branch in all.iter().flatten() {
            let met = branch
                .places
                .iter()
                .any(|place| place.0.abs() < 1e-12 && place.1 == 0.0);
            assert!(met, "{branch:?}");
            assert!(branch.places.is_sorted_by(|a, b| a.0 < b.0), "{branch:?}");
            for place in branch
                .places
                .iter()
                .filter(|place| branch.kind == FeatureKind::Peak && place.0 < 0.0)
            {
                assert!((place.1.abs() - peak(place.0)).abs() < 1e-9, "{place:?}");
            }
        }
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
