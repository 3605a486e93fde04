//! Points of codimension two of several curves: those that a curve knows of itself, each once for all curves that have
//! it, and crossings.

use super::found::{CodimensionTwoKind, Curve, CurvePoint, EndReason};
use super::piece::{Piece, passes_through};
use super::walked::apart;
use crate::continuation::doubt::status_of;
use crate::continuation::{BifurcationStatus, Doubt};
use crate::density::Observable;

/// Two points nearer than this, in sides of the box, are one.
pub(super) const SAME: f64 = 0.01;

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
    /// Why it may not be where it says, of a crossing as its curves beside it; the first decides its status.
    pub doubts: Vec<Doubt>,
    /// The observables of the curves; of a crossing there may be two.
    pub observables: Vec<Observable>,
    /// Where the density has the feature, one coordinate an axis; of a crossing that its curves show together nothing.
    pub place: Vec<f64>,
    /// The curves that end, or pass, there, by their places in the list.
    pub curves: Vec<usize>,
}

impl CodimensionTwo {
    /// How well it is known.
    pub fn status(&self) -> BifurcationStatus {
        status_of(&self.doubts)
    }
}

/// The points of codimension two of curves in one plane: of what several curves say of one, the one with the smallest
/// error is taken.
pub fn codimension_two(curves: &[Curve]) -> Vec<CodimensionTwo> {
    let mut found: Vec<CodimensionTwo> = Vec::new();
    for (index, curve) in curves.iter().enumerate() {
        for (kind, _, point) in own_points(curve) {
            add(&mut found, curve, index, kind, point);
        }
    }
    for (index, curve) in curves.iter().enumerate() {
        for (number, other) in curves.iter().enumerate().skip(index + 1) {
            for (at, error, doubts) in crossings(curve, other) {
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
                    doubts,
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
pub(super) fn own_points(
    curve: &Curve,
) -> impl Iterator<Item = (CodimensionTwoKind, usize, &CurvePoint)> {
    let ends = curve.ends.iter().filter_map(|end| {
        let kind = match end.reason {
            EndReason::Cusp => CodimensionTwoKind::Cusp,
            EndReason::DegenerateSplit => CodimensionTwoKind::DegenerateSplit,
            EndReason::DegenerateKink => CodimensionTwoKind::DegenerateKink,
            EndReason::KinkCorner => CodimensionTwoKind::KinkCorner,
            _ => return None,
        };
        Some((kind, end.point))
    });
    let within = curve.degenerate.iter();
    let within = within.map(|one| (one.kind, one.point));
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
            doubts: point.doubts.clone(),
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
        known.doubts.clone_from(&point.doubts);
        known.place = point.place.clone();
    }
}

/// Where two curves cross, in the box with sides of length one, with the error there. A curve that touches another one,
/// as folds do where they begin at a split, is beside it by less than both errors on one side, and does not cross it.
fn crossings(first: &Curve, second: &Curve) -> Vec<([f64; 2], f64, Vec<Doubt>)> {
    let mut found: Vec<([f64; 2], f64, Vec<Doubt>)> = Vec::new();
    let [own, others] = [first, second].map(|curve| Piece::all_of(curve).collect::<Vec<Piece>>());
    for (place, piece) in own.iter().enumerate() {
        for (place_there, other) in others.iter().enumerate() {
            let met = piece.is_near(other).then(|| piece.meets(other)).flatten();
            let Some((at, error)) = met else {
                continue;
            };
            let is_clear =
                passes_through(&own, place, &others) || passes_through(&others, place_there, &own);
            if is_clear && found.iter().all(|one| apart(one.0, at) > SAME) {
                let doubts = piece.doubts.iter().chain(&other.doubts);
                found.push((at, error, doubts.cloned().collect()));
            }
        }
    }
    found
}
