//! The curves of a map as lines in its box: which crossings they pass, and are one with.

use super::crossing::Crossing;
use crate::continuation::curve::{CurveStart, ON_IT, distance};
use crate::topology::IndicatorKind;

/// How far beyond its two nodes a crossing may be passed, as a share of their distance: errors of nodes and curve.
const BEYOND: f64 = 0.25;

/// Farthest from a curve that another one of its indicator may begin and be the same, in sides of the box.
pub(super) const IDENTICAL: f64 = 1e-3;

/// How near a curve of another indicator must pass for a crossing to be the same change, in sides of the box.
pub(super) const SAME: f64 = 4e-3;

/// A curve as a line in the box with sides of length one.
pub(super) struct CurveLine {
    pub(super) observable: usize,
    pub(super) kind: IndicatorKind,
    pub(super) line: Vec<[f64; 2]>,
}

impl CurveLine {
    /// Whether a crossing is one with this curve.
    pub(super) fn explains(&self, crossing: &Crossing) -> bool {
        if self.observable != crossing.observable {
            return false;
        }
        let passed = self.passes(&crossing.ends);
        let is_passed = passed.is_some_and(|at| {
            let apart = (at[0] - crossing.at[0]).hypot(at[1] - crossing.at[1]);
            self.kind == crossing.kind || apart < SAME
        });
        // Neighbours along a curve that runs through nodes have indicators of rounding's size, and of either sign.
        is_passed || distance(&self.line, crossing.at) <= IDENTICAL
    }

    /// Whether a start lies on this curve; `at` is its place in the box.
    pub(super) fn has(&self, start: &CurveStart, at: [f64; 2]) -> bool {
        (self.observable, self.kind) == (start.observable, start.kind)
            && distance(&self.line, at) <= ON_IT
    }

    /// Where the curve passes between two nodes, or a little beyond them.
    pub(super) fn passes(&self, ends: &[[f64; 2]; 2]) -> Option<[f64; 2]> {
        let [a, b] = *ends;
        let wider =
            |from: [f64; 2], to: [f64; 2]| [0, 1].map(|k| to[k] + BEYOND * (to[k] - from[k]));
        let (from, to) = (wider(b, a), wider(a, b));
        let mut pieces = self.line.windows(2);
        pieces.find_map(|piece| meeting([from, to], [piece[0], piece[1]]))
    }
}

/// Where two straight lines meet, if they do.
fn meeting([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let minus = |u: [f64; 2], v: [f64; 2]| [u[0] - v[0], u[1] - v[1]];
    let (first, second, gap) = (minus(b, a), minus(d, c), minus(c, a));
    let across = cross(first, second);
    let (along, beside) = (cross(gap, second) / across, cross(gap, first) / across);
    // Parallel lines give numbers that are no shares.
    let inside = (0.0..=1.0).contains(&along) && (-1e-9..=1.0 + 1e-9).contains(&beside);
    inside.then(|| [0, 1].map(|k| a[k] + along * first[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_meet_where_they_cross() {
        let met = meeting([[0.0, 0.0], [1.0, 0.0]], [[0.25, -1.0], [0.25, 1.0]]);
        assert_eq!(met, Some([0.25, 0.0]));
        assert_eq!(
            meeting([[0.0, 0.0], [1.0, 0.0]], [[1.25, -1.0], [1.25, 1.0]]),
            None
        );
        assert_eq!(
            meeting([[0.0, 0.0], [1.0, 0.0]], [[0.0, 1.0], [1.0, 1.0]]),
            None
        );
    }
}
