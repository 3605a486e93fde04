//! What a map gives: nodes with their signatures, the curves between them, and what no curve explains.

use crate::continuation::curve::{Curve, EndReason, Plane};
use crate::continuation::{PointStatus, Subject};
use crate::topology::Signature;

/// A solved place of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapNode {
    /// Values of both parameters.
    pub values: [f64; 2],
    /// How often the coarse grid was halved for it.
    pub level: usize,
    /// How the solve went.
    pub status: PointStatus,
    /// The signature of every watched density, in the order of [`Subject::observables`]; empty without a density.
    pub signatures: Vec<Signature>,
    /// Why there is no density, where a sentence is known.
    pub reason: Option<String>,
}

/// Places where a signature changes and no curve was followed.
#[derive(Debug, Clone, PartialEq)]
pub struct Untraced {
    /// The observable, by its place in [`Subject::observables`].
    pub observable: usize,
    /// How many pairs of neighbouring nodes show it.
    pub pairs: usize,
    /// Values of both parameters between one of these pairs.
    pub near: [f64; 2],
    /// Why.
    pub reason: String,
}

/// Two cusps nearer than this, in sides of the box, are one point that two curves end in.
const SAME: f64 = 0.01;

/// A point of codimension two: a cusp, in which curves of folds meet.
#[derive(Debug, Clone, PartialEq)]
pub struct CodimensionTwo {
    /// Letters and ordinal: `CP1`.
    pub label: String,
    /// Values of both parameters.
    pub values: [f64; 2],
    /// Half-width of what it is believed to be off by, as a share of the sides of the box.
    pub error: f64,
    /// The observable, by its place in [`Subject::observables`].
    pub observable: usize,
    /// Where its density has the feature, one coordinate an axis.
    pub place: Vec<f64>,
    /// The curves that end there, by their places in [`RegimeMap::curves`].
    pub curves: Vec<usize>,
}

/// A map of regimes.
#[derive(Debug, Clone)]
pub struct RegimeMap {
    /// What was watched.
    pub subject: Subject,
    /// The box.
    pub plane: Plane,
    /// The solved nodes, by the second parameter and then the first.
    pub nodes: Vec<MapNode>,
    /// The cells whose corners they are, lower and upper corner of each in the box with sides of length one.
    pub cells: Vec<[[f64; 2]; 2]>,
    /// The curves, in the order in which they were followed.
    pub curves: Vec<Curve>,
    /// Changes that no curve explains.
    pub untraced: Vec<Untraced>,
    /// Whether it was interrupted before it was complete.
    pub interrupted: bool,
}

impl RegimeMap {
    /// The points of codimension two, one for all curves that end in it: of what these say, the one with the smallest error is taken.
    pub fn codimension_two(&self) -> Vec<CodimensionTwo> {
        let mut found: Vec<CodimensionTwo> = Vec::new();
        for (index, curve) in self.curves.iter().enumerate() {
            let cusps = curve
                .ends
                .iter()
                .filter(|end| end.reason == EndReason::Cusp);
            for point in cusps.filter_map(|end| curve.points.get(end.point)) {
                let Some(observable) = self.place_of(curve.observable) else {
                    continue;
                };
                let at = self.plane.place(point.values);
                let known = found.iter_mut().find(|one| {
                    let other = self.plane.place(one.values);
                    one.observable == observable
                        && (at[0] - other[0]).hypot(at[1] - other[1]) <= SAME
                });
                let mut new = CodimensionTwo {
                    label: String::new(),
                    values: point.values,
                    error: point.error,
                    observable,
                    place: point.place.clone(),
                    curves: vec![index],
                };
                match known {
                    Some(known) => {
                        new.curves.splice(0..0, known.curves.clone());
                        if new.error < known.error {
                            *known = new;
                        } else {
                            known.curves = new.curves;
                        }
                    }
                    None => found.push(new),
                }
            }
        }
        for (number, one) in found.iter_mut().enumerate() {
            one.label = format!("CP{}", number + 1);
        }
        found
    }

    /// The place of an observable among those that are watched; `None` for one that is not.
    pub(crate) fn place_of(&self, observable: crate::density::Observable) -> Option<usize> {
        let mut observables = self.subject.observables.iter();
        observables.position(|&one| one == observable)
    }
}
