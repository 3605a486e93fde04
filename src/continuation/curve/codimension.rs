//! Points of codimension two of several curves: cusps and degenerate splits, each once for all curves that have it, and crossings.

use super::found::{Curve, CurvePoint, EndReason};
use super::walk::apart;
use crate::continuation::BifurcationStatus;
use crate::density::Observable;

/// Two points nearer than this, in sides of the box, are one.
pub(super) const SAME: f64 = 0.01;
/// Curves at a smaller angle do not cross, but run along each other.
const SLANTED: f64 = 0.02;
/// A crossing less certain than this is none that could be told, in sides of the box.
const VAGUE: f64 = 0.05;
/// Steps of Newton's method on two cubic pieces.
const STEPS: usize = 12;

/// What happens at a point of codimension two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CodimensionTwoKind {
    /// Two folds meet and turn on the spot.
    Cusp,
    /// A split at a centre turns from births at the centre to births away from it.
    DegenerateSplit,
    /// Two curves cross.
    Crossing,
}

impl CodimensionTwoKind {
    /// The letters of its label.
    pub fn prefix(self) -> &'static str {
        match self {
            Self::Cusp => "CP",
            Self::DegenerateSplit => "DS",
            Self::Crossing => "CX",
        }
    }

    /// The words used in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cusp => "cusp",
            Self::DegenerateSplit => "degenerate split",
            Self::Crossing => "crossing",
        }
    }
}

/// A point of codimension two.
#[derive(Debug, Clone, PartialEq)]
pub struct CodimensionTwo {
    /// Letters and ordinal: `CP1`.
    pub label: String,
    /// What happens there.
    pub kind: CodimensionTwoKind,
    /// Values of both parameters.
    pub values: [f64; 2],
    /// Half-width of what it is believed to be off by, as a share of the sides of the box.
    pub error: f64,
    /// How well it is known: of a crossing as its curves beside it.
    pub status: BifurcationStatus,
    /// The observables of the curves; of a crossing there may be two.
    pub observables: Vec<Observable>,
    /// Where the density has the feature, one coordinate an axis; of a crossing nothing.
    pub place: Vec<f64>,
    /// The curves that end, or pass, there, by their places in the list.
    pub curves: Vec<usize>,
}

/// The points of codimension two of curves in one plane: of what several curves say of one, the one with the smallest error is taken.
pub fn codimension_two(curves: &[Curve]) -> Vec<CodimensionTwo> {
    let mut found: Vec<CodimensionTwo> = Vec::new();
    for (index, curve) in curves.iter().enumerate() {
        for (kind, _, point) in own(curve) {
            add(&mut found, curve, index, kind, point);
        }
    }
    for (index, curve) in curves.iter().enumerate() {
        for (number, other) in curves.iter().enumerate().skip(index + 1) {
            for (at, error, status) in crossings(curve, other) {
                let known = |one: &CodimensionTwo| {
                    let both = one.curves.contains(&index) || one.curves.contains(&number);
                    both && apart(curve.plane.place(one.values), at) <= SAME
                };
                if found.iter().any(known) {
                    continue;
                }
                let mut observables = vec![curve.observable];
                observables.extend(Some(other.observable).filter(|one| *one != curve.observable));
                found.push(CodimensionTwo {
                    label: String::new(),
                    kind: CodimensionTwoKind::Crossing,
                    values: curve.plane.values(at),
                    error,
                    status,
                    observables,
                    place: Vec::new(),
                    curves: vec![index, number],
                });
            }
        }
    }
    for index in 0..found.len() {
        let kind = found[index].kind;
        let before = found[..index].iter().filter(|one| one.kind == kind).count();
        found[index].label = format!("{}{}", kind.prefix(), before + 1);
    }
    found
}

/// The points of codimension two that a curve has by itself.
pub(super) fn own(curve: &Curve) -> impl Iterator<Item = (CodimensionTwoKind, usize, &CurvePoint)> {
    let ends = curve.ends.iter().filter_map(|end| {
        let kind = match end.reason {
            EndReason::Cusp => CodimensionTwoKind::Cusp,
            EndReason::DegenerateSplit => CodimensionTwoKind::DegenerateSplit,
            _ => return None,
        };
        Some((kind, end.point))
    });
    let within = curve.degenerate.iter();
    let within = within.map(|one| (CodimensionTwoKind::DegenerateSplit, one.point));
    ends.chain(within)
        .filter_map(|(kind, index)| Some((kind, index, curve.points.get(index)?)))
}

fn add(
    found: &mut Vec<CodimensionTwo>,
    curve: &Curve,
    index: usize,
    kind: CodimensionTwoKind,
    point: &CurvePoint,
) {
    let at = curve.plane.place(point.values);
    let known = found.iter_mut().find(|one| {
        let is_near = apart(at, curve.plane.place(one.values)) <= SAME;
        is_near && one.kind == kind && one.observables == [curve.observable]
    });
    let Some(known) = known else {
        found.push(CodimensionTwo {
            label: String::new(),
            kind,
            values: point.values,
            error: point.error,
            status: point.status,
            observables: vec![curve.observable],
            place: point.place.clone(),
            curves: vec![index],
        });
        return;
    };
    if !known.curves.contains(&index) {
        known.curves.push(index);
    }
    if point.error < known.error {
        known.values = point.values;
        known.error = point.error;
        known.status = point.status;
        known.place = point.place.clone();
    }
}

/// Where two curves cross, in the box with sides of length one, with the error there.
fn crossings(first: &Curve, second: &Curve) -> Vec<([f64; 2], f64, BifurcationStatus)> {
    let mut found: Vec<([f64; 2], f64, BifurcationStatus)> = Vec::new();
    let pieces = |curve: &Curve| {
        let pairs = curve.points.windows(2);
        let pieces = pairs.map(|pair| Piece::new(curve, &pair[0], &pair[1]));
        pieces.collect::<Vec<_>>()
    };
    let others = pieces(second);
    for piece in pieces(first) {
        for other in others.iter().filter(|other| piece.is_near(other)) {
            let Some((at, error)) = piece.meets(other) else {
                continue;
            };
            if found.iter().all(|one| apart(one.0, at) > SAME) {
                let worse = match piece.status {
                    BifurcationStatus::Located => other.status,
                    status => status,
                };
                found.push((at, error, worse));
            }
        }
    }
    found
}

/// A curve between two neighbouring points, as a cubic with their tangents.
struct Piece {
    ends: [[f64; 2]; 2],
    /// Tangents times the length of the piece.
    tangents: [[f64; 2]; 2],
    error: f64,
    status: BifurcationStatus,
}

impl Piece {
    fn new(curve: &Curve, from: &CurvePoint, to: &CurvePoint) -> Self {
        let sides = curve.plane.sides();
        let ends = [from, to].map(|point| curve.plane.place(point.values));
        let length = apart(ends[0], ends[1]);
        Self {
            ends,
            tangents: [from, to]
                .map(|point| [0, 1].map(|k| length * point.tangent[k] / sides[k].length())),
            error: from.error.max(to.error),
            status: match from.status {
                BifurcationStatus::Located => to.status,
                status => status,
            },
        }
    }

    /// Whether two pieces may meet: by the boxes around them.
    fn is_near(&self, other: &Self) -> bool {
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
    fn meets(&self, other: &Self) -> Option<([f64; 2], f64)> {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubic_pieces_meet_where_the_curves_do() {
        // Of a circle of radius one about the origin, from 0 to 0.5; and the line through the origin at an angle of 0.3.
        let on = |angle: f64| [angle.cos(), angle.sin()];
        let length = apart(on(0.0), on(0.5));
        let tangent = |angle: f64| [-length * angle.sin(), length * angle.cos()];
        let arc = Piece {
            ends: [on(0.0), on(0.5)],
            tangents: [tangent(0.0), tangent(0.5)],
            error: 1e-3,
            status: BifurcationStatus::Located,
        };
        let [x, y] = on(0.3);
        let line = Piece {
            ends: [[0.9 * x, 0.9 * y], [1.1 * x, 1.1 * y]],
            tangents: [[0.2 * x, 0.2 * y]; 2],
            error: 2e-3,
            status: BifurcationStatus::Located,
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
            status: BifurcationStatus::Located,
        };
        assert!(arc.meets(&beside).is_none());
        assert!(arc.meets(&arc).is_none());
    }
}
