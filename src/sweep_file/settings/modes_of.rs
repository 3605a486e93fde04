//! What modes of an axis are made of, and when they serve without being asked for.

use super::along::{SweptSystems, filter};
use crate::space::{Axis, SpaceError};
use crate::system::AxisDescription;

/// What an axis is of, if modes carry it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModesOf {
    /// A state between bounds: Legendre's.
    Bounded,
    /// Coloured noise with this mean and standard deviation: Hermite's.
    Noise {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
    /// What closes on itself: sines and cosines over a turn.
    Turn,
    /// A state without noise and bounds that relaxes linearly: Hermite's, as wide as the range says.
    Relaxing,
}

impl ModesOf {
    /// Of an axis all along a sweep.
    pub(super) fn new(along: Option<&SweptSystems<'_>>, axis: usize) -> Self {
        let Some(along) = along else {
            return Self::Bounded;
        };
        match filter(along.family, axis) {
            _ if along.turn(axis).is_some() => Self::Turn,
            Some((mean, deviation)) => Self::Noise { mean, deviation },
            None if along.relaxes(axis) => Self::Relaxing,
            None => Self::Bounded,
        }
    }

    /// The axis with a number of modes.
    pub(super) fn axis(self, (from, to): (f64, f64), count: usize) -> Result<Axis, SpaceError> {
        match self {
            Self::Bounded => Axis::modes(from, to, count),
            Self::Noise { mean, deviation } => Axis::hermite(mean, deviation, count),
            Self::Turn => Axis::fourier(from, to, count),
            Self::Relaxing => Axis::hermite_over(from, to, count),
        }
    }

    /// Whether modes carry the axis where the file says nothing of it: the model marks it. A typed axis is marked by
    /// the form of its equation, of a state that relaxes linearly or has hysteresis; the values of the parameters
    /// decide.
    pub(super) fn serve(
        self,
        (axis, described): (usize, &AxisDescription),
        along: Option<&SweptSystems<'_>>,
    ) -> bool {
        let is_typed = along.is_some_and(|along| along.family.model().typed().is_some());
        // A range that moves along the sweep is too wide at one of its ends for modes.
        let has_bounds = along.is_some_and(|along| along.has_still_bounds(axis));
        let fit = !is_typed || self != Self::Bounded || has_bounds;
        described.by_modes && fit
    }
}
