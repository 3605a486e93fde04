//! Branches of peaks and valleys led on to the located changes at which they meet.

use super::branches::{Branch, FARTHEST};
use crate::continuation::{BifurcationStatus, Point, SweepResult};
use crate::density::Observable;
use crate::numerics::sort_ascending;
use crate::topology::FeatureKind;

/// Points by which a branch is drawn to where it meets another.
const STEPS: usize = 12;
/// Values nearer to a change than this share of the longest step were added to narrow it.
const NEAR: f64 = 0.35;
/// Powers of the distance to a change with which places may go to where they meet: a root at a smooth change, about a
/// straight line at a kink.
const POWERS: (f64, f64) = (0.35, 1.1);
const ROOT: f64 = 0.5;

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

/// The way from the end of a line to where it meets others: as a power of the distance to the change, which its last
/// two places tell.
fn way(
    place: (f64, f64),
    before: Option<(f64, f64)>,
    meeting: (f64, f64),
) -> impl Iterator<Item = (f64, f64)> {
    let off = place.1 - meeting.1;
    let power = before.and_then(|before| {
        let times = (before.1 - meeting.1) / off;
        let longer = (before.0 - meeting.0) / (place.0 - meeting.0);
        (times > 1.0 && longer > 1.0).then(|| times.ln() / longer.ln())
    });
    let power = power.unwrap_or(ROOT).clamp(POWERS.0, POWERS.1);
    (1..=STEPS).map(move |number| {
        let share = number as f64 / STEPS as f64;
        let value = place.0 + share * (meeting.0 - place.0);
        (value, meeting.1 + off * (1.0 - share).powf(power))
    })
}

/// Leads lines, each of ascending values, on to the changes at which they begin or end as one of a pair of which
/// nothing else is known, so that their last two places alone tell where: they go like the root of the distance.
/// `values` are those that were solved, ascending; a line that has places on both sides of a change goes on.
pub(crate) fn meet_births(lines: &mut [Vec<(f64, f64)>], changes: &[f64], values: &[f64]) {
    for &change in changes {
        let after = values.partition_point(|value| *value <= change);
        let beside = [after.checked_sub(1), Some(after)];
        let beside = beside.map(|index| values.get(index?).copied());
        for line in lines.iter_mut() {
            let to_birth = |place: (f64, f64), before: (f64, f64)| {
                let [near, far] = [place, before].map(|one| (one.0 - change).abs().sqrt());
                let meeting = (far * place.1 - near * before.1) / (far - near);
                way(place, Some(before), (change, meeting))
            };
            match line[..] {
                [.., before, last] if Some(last.0) == beside[0] => {
                    line.extend(to_birth(last, before))
                }
                [first, after, ..] if Some(first.0) == beside[1] => {
                    let ahead: Vec<(f64, f64)> = to_birth(first, after).collect();
                    line.splice(0..0, ahead.into_iter().rev());
                }
                _ => {}
            }
        }
    }
}

/// What lies about a change: its value, how far from it the ends of branches are looked for, and up to where values
/// count as added to narrow it.
#[derive(Debug, Clone, Copy)]
struct Around {
    change: f64,
    gap: f64,
    near: f64,
}

impl Around {
    /// Whether a value is one of those that were added to narrow the change.
    fn is_near(&self, value: f64) -> bool {
        (value - self.change).abs() <= self.near
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
        sort_ascending(&mut ends, |one| one.place.1);
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
        // What lies beyond the middle of two changes belongs to the other one.
        let others = changes.iter().map(|other| 0.5 * (other - change).abs());
        let near = others.filter(|&half| half > 0.0).fold(NEAR * gap, f64::min);
        let around = Around { change, gap, near };
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
                places.extend(way(end.place, end.before, (change, place)));
                sort_ascending(&mut places, |one| one.0);
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
    use crate::figure::parts::branches::{branches, tests::point};

    #[test]
    fn lines_are_led_on_to_where_they_are_born_like_a_root() {
        let values: Vec<f64> = (0..6).map(f64::from).collect();
        let frequency = |value: f64| 0.7 + 0.5 * (value - 1.6).sqrt();
        let born = |&value: &f64| (value > 1.6).then(|| (value, frequency(value)));
        let dies = |&value: &f64| (value < 1.6).then_some((value, 0.3));
        let mut lines: [Vec<(f64, f64)>; 3] = [
            values.iter().filter_map(born).collect(),
            values.iter().filter_map(dies).collect(),
            values.iter().map(|&value| (value, 1.0)).collect(),
        ];
        meet_births(&mut lines, &[1.6], &values);
        assert_eq!(lines[0].len(), 4 + STEPS);
        for (value, place) in &lines[0] {
            assert!((place - frequency(*value)).abs() < 1e-12, "{value} {place}");
        }
        assert_eq!((lines[0][0].0, lines[1][1 + STEPS]), (1.6, (1.6, 0.3)));
        assert!(lines[0].is_sorted_by(|a, b| a.0 < b.0) && lines[2].len() == values.len());
    }

    #[test]
    fn branches_meet_where_the_change_is() {
        // Peaks at ± √(-value/4) below zero and at zero above, at values ± 0.1, ± 0.3, …; a valley between the two.
        let values: Vec<f64> = (-5..5).map(|i| 0.1 + 0.2 * f64::from(i)).collect();
        let peak = |value: f64| (-0.25 * value).max(0.0).sqrt();
        let of = |value: &f64| {
            if *value < 0.0 {
                point(*value, Some(&[-peak(*value), peak(*value)]))
            } else {
                point(*value, Some(&[0.0]))
            }
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
    fn branches_reach_two_changes_that_are_near_each_other() {
        // A pair is born at 0.809, and the other peak and the valley meet at 0.821: far nearer than the longest step.
        let (birth, death) = (0.809f64, 0.821f64);
        let values = [0.6, 0.7, 0.8, 0.81, 0.813, 0.817, 0.82, 0.83, 0.9, 1.0];
        let upper = |value: f64| 0.2 + 0.5 * (value - birth).sqrt();
        let lower = |value: f64| -0.2 - 0.5 * (death - value).sqrt();
        let middle = |value: f64| {
            let share = (value - birth) / (death - birth);
            0.2 - 0.4 * share
        };
        let of = |&value: &f64| {
            let mut peaks = Vec::new();
            peaks.extend((value < death).then(|| lower(value)));
            peaks.extend((value > birth).then(|| upper(value)));
            point(value, Some(&peaks))
        };
        let points: Vec<Point> = values.iter().map(of).collect();
        let window = (-1.0, 1.0);
        let between = values.iter().filter(|value| (birth..death).contains(value));
        let valley = Branch {
            kind: FeatureKind::Valley,
            places: between.map(|&value| (value, middle(value))).collect(),
        };
        let peaks = branches(&points, 0, FeatureKind::Peak, window);
        assert_eq!(peaks.len(), 2);
        let mut all = [peaks, vec![valley]];
        meet(&mut all, &[birth, death], &points, window);
        let ends = |list: &[Branch]| -> Vec<[f64; 2]> {
            let ends = list
                .iter()
                .map(|one| [one.places.first(), one.places.last()]);
            ends.map(|ends| ends.map(|end| end.unwrap().0)).collect()
        };
        let mut found = ends(&all[0]);
        found.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert_eq!(found, [[0.6, death], [birth, 1.0]]);
        assert_eq!(ends(&all[1]), [[birth, death]]);
    }
}
