//! A curve between two neighbouring points: where it meets another one, or a line of the grid.

use super::found::{Curve, CurvePoint};
use super::walked::apart;
use crate::continuation::Doubt;
use crate::numerics::bisected;

/// Curves at a smaller angle do not cross, but run along each other.
const SLANTED: f64 = 0.02;
/// A crossing less certain than this is none that could be told, in sides of the box.
const VAGUE: f64 = 0.05;
/// Steps of Newton's method on two cubic pieces.
const STEPS: usize = 12;
/// Rounding of a place, in sides of the box.
const ROUNDING: f64 = 1e-12;
/// Halvings that narrow a piece to rounding.
const HALVINGS: usize = 52;

/// A curve between two neighbouring points, as a cubic with their tangents.
pub(super) struct Piece {
    ends: [[f64; 2]; 2],
    /// Tangents times the length of the piece.
    tangents: [[f64; 2]; 2],
    pub(super) error: f64,
    /// Those of its first end, then of its last.
    pub(super) doubts: Vec<Doubt>,
}

impl Piece {
    /// The pieces of a curve, from end to end.
    pub(super) fn all_of(curve: &Curve) -> impl Iterator<Item = Self> {
        let pairs = curve.points.windows(2);
        pairs.map(|pair| Self::new(curve, &pair[0], &pair[1]))
    }

    fn new(curve: &Curve, from: &CurvePoint, to: &CurvePoint) -> Self {
        let sides = curve.plane.sides();
        let ends = [from, to].map(|point| curve.plane.place(point.values));
        let length = apart(ends[0], ends[1]);
        Self {
            ends,
            tangents: [from, to]
                .map(|point| [0, 1].map(|k| length * point.tangent[k] / sides[k].length())),
            error: from.error.max(to.error),
            doubts: from.doubts.iter().chain(&to.doubts).cloned().collect(),
        }
    }

    /// Whether two pieces may meet: by the boxes around them.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        (0..2).all(|k| {
            let range = |piece: &Self| {
                let [a, b] = [piece.ends[0][k], piece.ends[1][k]];
                let beyond = 0.25 * apart(piece.ends[0], piece.ends[1]);
                (a.min(b) - beyond, a.max(b) + beyond)
            };
            let (one, two) = (range(self), range(other));
            one.0 <= two.1 && two.0 <= one.1
        })
    }

    /// Place and derivative at a share of the piece.
    fn at(&self, t: f64) -> ([f64; 2], [f64; 2]) {
        let ([a, b], [m, n]) = (self.ends, self.tangents);
        let (t2, t3) = (t * t, t * t * t);
        let place = |k: usize| {
            (2.0 * t3 - 3.0 * t2 + 1.0) * a[k]
                + (t3 - 2.0 * t2 + t) * m[k]
                + (3.0 * t2 - 2.0 * t3) * b[k]
                + (t3 - t2) * n[k]
        };
        let rate = |k: usize| {
            6.0 * (t2 - t) * (a[k] - b[k])
                + (3.0 * t2 - 4.0 * t + 1.0) * m[k]
                + (3.0 * t2 - 2.0 * t) * n[k]
        };
        ([0, 1].map(place), [0, 1].map(rate))
    }

    /// Where it meets another one, and how certain that is.
    pub(super) fn meets(&self, other: &Self) -> Option<([f64; 2], f64)> {
        let (mut t, mut u) = (0.5, 0.5);
        for _ in 0..STEPS {
            let ((p, dp), (q, dq)) = (self.at(t), other.at(u));
            let gap = [q[0] - p[0], q[1] - p[1]];
            let across = dp[0] * dq[1] - dp[1] * dq[0];
            t += (gap[0] * dq[1] - gap[1] * dq[0]) / across;
            u += (gap[0] * dp[1] - gap[1] * dp[0]) / across;
            // Far off there is nothing to be found; a number that is none is caught below.
            (t, u) = (t.clamp(-1.0, 2.0), u.clamp(-1.0, 2.0));
        }
        let ((p, dp), (q, dq)) = (self.at(t), other.at(u));
        let lengths = dp[0].hypot(dp[1]) * dq[0].hypot(dq[1]);
        let sine = (dp[0] * dq[1] - dp[1] * dq[0]).abs() / lengths;
        let error = (self.error + other.error) / sine;
        let inside = [t, u]
            .iter()
            .all(|share| (-1e-9..=1.0 + 1e-9).contains(share));
        let met = inside && apart(p, q) < 1e-9 && sine > SLANTED && error <= VAGUE;
        met.then_some((p, error))
    }

    /// How far a place lies to the left of it, negative to the right; `None` where its nearest point is no inner one.
    fn aside(&self, place: [f64; 2]) -> Option<f64> {
        let chord = [0, 1].map(|k| self.ends[1][k] - self.ends[0][k]);
        let from = [0, 1].map(|k| place[k] - self.ends[0][k]);
        let mut t =
            (from[0] * chord[0] + from[1] * chord[1]) / (chord[0] * chord[0] + chord[1] * chord[1]);
        // A piece bends little: each step leaves a small share of what is left.
        for _ in 0..STEPS {
            let (p, dp) = self.at(t.clamp(-1.0, 2.0));
            let gap = [place[0] - p[0], place[1] - p[1]];
            t += (gap[0] * dp[0] + gap[1] * dp[1]) / (dp[0] * dp[0] + dp[1] * dp[1]);
        }
        if !(-1e-9..=1.0 + 1e-9).contains(&t) {
            return None;
        }
        let (p, dp) = self.at(t);
        let gap = [place[0] - p[0], place[1] - p[1]];
        Some((dp[0] * gap[1] - dp[1] * gap[0]) / dp[0].hypot(dp[1]))
    }

    /// Where it has this value of one coordinate, 0 or 1, with its direction there, of length one; `None` where its
    /// ends do not lie on either side of it.
    pub(super) fn crosses(&self, coordinate: usize, value: f64) -> Option<([f64; 2], [f64; 2])> {
        let beyond = |share: f64| self.at(share).0[coordinate] - value;
        let (begins, ends) = (beyond(0.0), beyond(1.0));
        // What lies on a border of the box does so up to rounding.
        let on_it = [(begins, 0.0), (ends, 1.0)];
        let end = on_it.into_iter().find(|(gap, _)| gap.abs() <= ROUNDING);
        let share = match end {
            Some((_, share)) => share,
            None if begins * ends > 0.0 || !(begins * ends).is_finite() => return None,
            None => bisected((0.0, 1.0), HALVINGS, |share| beyond(share) * begins > 0.0),
        };
        let (at, along) = self.at(share);
        let length = along[0].hypot(along[1]);
        (length > 0.0).then(|| (at, along.map(|part| part / length)))
    }
}

/// Whether a curve leaves another one to both sides by more than the errors of both, before it ends: seen from the
/// piece with this place in its list. Where one touches the other, or ends beside it, errors alone make a crossing.
pub(super) fn passes_through(curve: &[Piece], at: usize, other: &[Piece]) -> bool {
    let is_left = |place: [f64; 2], error: f64| {
        let gaps = other.iter().filter_map(|piece| {
            let gap = piece.aside(place)?;
            Some((gap, error + piece.error))
        });
        let (gap, error) = gaps.min_by(|one, two| one.0.abs().total_cmp(&two.0.abs()))?;
        (gap.abs() > error).then_some(gap > 0.0)
    };
    let (mut behind, mut ahead) = (curve[..=at].iter().rev(), curve[at..].iter());
    let behind = behind.find_map(|piece| is_left(piece.ends[0], piece.error));
    let ahead = ahead.find_map(|piece| is_left(piece.ends[1], piece.error));
    behind.zip(ahead).is_some_and(|(one, two)| one != two)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubic_pieces_meet_where_the_curves_do() {
        // Of a circle of radius one about the origin, from 0 to 0.5; and the line through the origin at an angle of
        // 0.3.
        let on = |angle: f64| [angle.cos(), angle.sin()];
        let length = apart(on(0.0), on(0.5));
        let tangent = |angle: f64| [-length * angle.sin(), length * angle.cos()];
        let arc = Piece {
            ends: [on(0.0), on(0.5)],
            tangents: [tangent(0.0), tangent(0.5)],
            error: 1e-3,
            doubts: Vec::new(),
        };
        let [x, y] = on(0.3);
        let line = Piece {
            ends: [[0.9 * x, 0.9 * y], [1.1 * x, 1.1 * y]],
            tangents: [[0.2 * x, 0.2 * y]; 2],
            error: 2e-3,
            doubts: Vec::new(),
        };
        assert!(arc.is_near(&line));
        let (at, error) = arc.meets(&line).unwrap();
        assert!(apart(at, on(0.3)) < 1e-3, "{at:?}");
        // At a right angle.
        assert!((error - 3e-3).abs() < 1e-4, "{error}");
        let beside = Piece {
            ends: [[0.9, 0.6], [1.1, 0.6]],
            tangents: [[0.2, 0.0]; 2],
            error: 0.0,
            doubts: Vec::new(),
        };
        assert!(arc.meets(&beside).is_none());
        assert!(arc.meets(&arc).is_none());
        // The line leaves the arc by a tenth on either side, the arc the line by three tenths and two.
        let (line, arc) = ([line], [arc]);
        assert!(passes_through(&line, 0, &arc) && passes_through(&arc, 0, &line));
        let vague = [Piece {
            ends: line[0].ends,
            tangents: line[0].tangents,
            error: 0.11,
            doubts: Vec::new(),
        }];
        assert!(!passes_through(&vague, 0, &arc));
        let arc = &arc[0];
        // A line at one height.
        let (at, along) = arc.crosses(1, y).unwrap();
        assert!(apart(at, on(0.3)) < 1e-3, "{at:?}");
        assert!((along[0] + y).abs() < 1e-2 && (along[1] - x).abs() < 1e-2);
        assert_eq!(arc.crosses(1, 0.0).unwrap().0, on(0.0));
        assert!(arc.crosses(1, 0.6).is_none());
    }
}
