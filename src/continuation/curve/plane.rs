//! A plane of two parameters, and the path that a curve is followed along in it.
//!
//! A session solves along a path. In a plane the path is not known before it is walked: it is laid leg by leg, each a
//! straight line from where the last one ended. What is laid stays as it is, so that a value of the path's coordinate
//! means the same for every session.

use std::sync::{Arc, PoisonError, RwLock};

use super::CurveError;
use crate::system::Path;

/// One side of a plane.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneSide {
    /// The parameter.
    pub parameter: String,
    /// Its lowest value.
    pub from: f64,
    /// Its highest value.
    pub to: f64,
}

impl PlaneSide {
    /// Its length, in units of the parameter.
    pub fn length(&self) -> f64 {
        self.to - self.from
    }
}

/// A box in the plane of two parameters, in which curves are followed. Clones are the same plane; `Plane::afresh` is
/// another one.
///
/// A [`Family`](crate::system::Family) along [`Plane::path`] is what a source is made for.
///
/// ```
/// use pbif::continuation::curve::Plane;
///
/// let plane = Plane::new(("f_c", -0.02, 0.01), ("sigma2", 0.005, 0.02)).unwrap();
/// assert_eq!(plane.path().moved(), ["f_c", "sigma2"]);
/// assert!(Plane::new(("f_c", -0.02, 0.01), ("f_c", 0.0, 1.0)).is_err());
/// ```
#[derive(Debug, Clone)]
pub struct Plane {
    sides: [PlaneSide; 2],
    legs: Arc<RwLock<Vec<Leg>>>,
}

/// A straight line in the plane, both sides of the box of length one.
#[derive(Debug, Clone, Copy)]
struct Leg {
    /// The path's coordinate where it begins.
    begins: f64,
    from: [f64; 2],
    /// Of length one.
    direction: [f64; 2],
    length: f64,
}

impl Leg {
    /// The path's coordinate where it ends.
    fn ends(&self) -> f64 {
        self.begins + self.length
    }

    fn at(&self, coordinate: f64) -> [f64; 2] {
        let along = coordinate - self.begins;
        [0, 1].map(|k| self.from[k] + along * self.direction[k])
    }
}

/// Coordinates of the path up to this one are not those of a curve: from the first to the second of [`DIAGONAL`] they
/// cross the box from its lower to its upper corner, where methods look at what is chosen once for the whole plane.
const BEFORE: f64 = -0.5;
const DIAGONAL: (f64, f64) = (-2.0, -1.0);
/// Length of the leg before a beginning, so that the path is straight on either side of it.
const RUN_UP: f64 = 0.1;

impl Plane {
    /// A plane by the names of two parameters and the lowest and highest value of each.
    ///
    /// # Errors
    /// [`CurveError::SameParameter`], and [`CurveError::EmptySide`] where the second value is not above the first.
    pub fn new(first: (&str, f64, f64), second: (&str, f64, f64)) -> Result<Self, CurveError> {
        let side = |(name, from, to): (&str, f64, f64)| {
            let parameter = name.to_owned();
            let length = to - from;
            if length.is_finite() && length > 0.0 {
                Ok(PlaneSide {
                    parameter,
                    from,
                    to,
                })
            } else {
                Err(CurveError::EmptySide {
                    parameter,
                    from,
                    to,
                })
            }
        };
        if first.0 == second.0 {
            return Err(CurveError::SameParameter {
                parameter: first.0.to_owned(),
            });
        }
        Ok(Self {
            sides: [side(first)?, side(second)?],
            legs: Arc::default(),
        })
    }

    /// The same box with a path of its own, of which nothing is laid yet.
    #[must_use]
    pub(crate) fn afresh(&self) -> Self {
        Self {
            sides: self.sides.clone(),
            legs: Arc::default(),
        }
    }

    /// Its two sides.
    pub fn sides(&self) -> &[PlaneSide; 2] {
        &self.sides
    }

    /// The path that a family is made along. Its ends are opposite corners of the box.
    pub fn path(&self) -> Path {
        let plane = self.clone();
        let names = self.sides.each_ref().map(|side| side.parameter.clone());
        Path::curve("path", "s", names, DIAGONAL, move |coordinate| {
            plane.values(plane.place_of(coordinate)).to_vec()
        })
    }

    /// Values of both parameters at a place of the box with sides of length one.
    pub(in crate::continuation) fn values(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| {
            let side = &self.sides[k];
            // Both ends exact.
            (1.0 - place[k]) * side.from + place[k] * side.to
        })
    }

    /// Where two values lie in the box, as shares of its sides.
    pub(crate) fn shares(&self, values: [f64; 2]) -> [f64; 2] {
        self.place(values)
    }

    /// The place of two values in the box with sides of length one.
    pub(in crate::continuation) fn place(&self, values: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (values[k] - self.sides[k].from) / self.sides[k].length())
    }

    fn place_of(&self, coordinate: f64) -> [f64; 2] {
        if coordinate <= BEFORE {
            let share = (coordinate - DIAGONAL.0) / (DIAGONAL.1 - DIAGONAL.0);
            return [share, share];
        }
        // A poisoned lock holds legs as whole as any other.
        let legs = self.legs.read().unwrap_or_else(PoisonError::into_inner);
        let after = legs.partition_point(|leg| leg.begins <= coordinate);
        let leg = legs.get(after.saturating_sub(1));
        leg.map_or([0.5, 0.5], |leg| leg.at(coordinate))
    }

    /// Begins a line at a place, wherever the path stood before; returns the path's coordinate there.
    pub(in crate::continuation) fn begin(&self, place: [f64; 2]) -> f64 {
        let mut legs = self.legs.write().unwrap_or_else(PoisonError::into_inner);
        let begins = legs.last().map_or(0.0, Leg::ends) + RUN_UP;
        legs.push(Leg {
            begins,
            from: [place[0] - RUN_UP, place[1]],
            direction: [1.0, 0.0],
            length: RUN_UP,
        });
        begins + RUN_UP
    }

    /// Lays a leg from where the path stands to a place; returns the path's coordinate there.
    pub(in crate::continuation) fn lay(&self, to: [f64; 2]) -> f64 {
        let mut legs = self.legs.write().unwrap_or_else(PoisonError::into_inner);
        let (begins, from) = legs
            .last()
            .map_or((0.0, to), |leg| (leg.ends(), leg.at(leg.ends())));
        let step = [to[0] - from[0], to[1] - from[1]];
        let length = step[0].hypot(step[1]);
        if length > 0.0 {
            legs.push(Leg {
                begins,
                from,
                direction: step.map(|step| step / length),
                length,
            });
        }
        begins + length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_goes_where_it_is_laid_and_what_is_laid_stays() {
        let plane = Plane::new(("a", -1.0, 1.0), ("b", 0.0, 10.0)).unwrap();
        assert_eq!(plane.place([0.0, 10.0]), [0.5, 1.0]);
        assert_eq!(plane.values(plane.place_of(DIAGONAL.0)), [-1.0, 0.0]);
        assert_eq!(plane.values(plane.place_of(DIAGONAL.1)), [1.0, 10.0]);
        let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-14;
        let first = plane.begin([0.5, 0.5]);
        assert!(near(plane.place_of(first), [0.5, 0.5]));
        let second = plane.lay([0.8, 0.9]);
        let third = plane.lay([0.8, 0.2]);
        assert!((second - first - 0.5).abs() < 1e-14 && (third - second - 0.7).abs() < 1e-14);
        assert!(near(plane.place_of(first), [0.5, 0.5]));
        assert!(near(plane.place_of(0.5 * (first + second)), [0.65, 0.7]));
        assert!(near(plane.place_of(second), [0.8, 0.9]));
        assert!(near(plane.place_of(third), [0.8, 0.2]));
        // Beyond its end it goes straight on.
        assert!(near(plane.place_of(third + 0.1), [0.8, 0.1]));
        let other = plane.begin([0.1, 0.1]);
        assert!(other > third && near(plane.place_of(other), [0.1, 0.1]));
        assert!(near(plane.place_of(other + 0.05), [0.15, 0.1]));
        assert!(near(plane.place_of(third), [0.8, 0.2]));
    }

    #[test]
    fn sides_without_length_are_refused() {
        for side in [("b", 1.0, 1.0), ("b", 1.0, 0.0), ("b", f64::NAN, 1.0)] {
            let error = Plane::new(("a", 0.0, 1.0), side).unwrap_err();
            assert!(matches!(error, CurveError::EmptySide { .. }), "{error}");
        }
    }
}
