//! What a system declares beside its equations, and what follows from that in one definition for everybody: where its
//! drift jumps, where an end of a range is a wall, whether it depends on time.

use super::System;

/// A plane `state[axis] = at` on which the drift jumps or has a kink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwitchingSurface {
    /// Axis whose coordinate is constant on the surface.
    pub axis: usize,
    /// Value of that coordinate.
    pub at: f64,
}

impl SwitchingSurface {
    /// Jump of every component of the drift from below to above the surface, beside a state whose own coordinate on the
    /// axis does not count. The drift is taken at `distance` and at twice that on either side, and the part of its
    /// change that is proportional to the distance is taken off: what is left of a smooth drift is rounding.
    pub fn drift_jump(&self, system: &dyn System, state: &[f64], distance: f64) -> Vec<f64> {
        let mut state = state.to_vec();
        let mut across = |distance: f64| {
            state[self.axis] = self.at + distance;
            let above = system.drift_at(0.0, &state);
            state[self.axis] = self.at - distance;
            let below = system.drift_at(0.0, &state);
            above
                .into_iter()
                .zip(below)
                .map(|(above, below)| above - below)
        };
        let near = across(distance);
        let far = across(2.0 * distance);
        near.zip(far).map(|(near, far)| 2.0 * near - far).collect()
    }
}

/// Share of a range within which its end is at a bound.
const AT_A_BOUND: f64 = 1e-9;

impl dyn System + '_ {
    /// Whether the lower and the upper end of a range of an axis are walls: values that the coordinate never leaves
    /// ([`System::bounds`]), to a billionth of the range.
    pub fn walls(&self, axis: usize, (from, to): (f64, f64)) -> [bool; 2] {
        let tolerance = AT_A_BOUND * (to - from);
        self.bounds(axis).map_or([false; 2], |(low, high)| {
            [from <= low + tolerance, to >= high - tolerance]
        })
    }

    /// Nothing, if neither drift nor noise depends on time.
    ///
    /// # Errors
    /// [`PeriodicDrift`].
    pub fn autonomous(&self) -> Result<(), PeriodicDrift> {
        match self.period() {
            Some(period) => Err(PeriodicDrift { period }),
            None => Ok(()),
        }
    }
}

/// A system with a period, where a method looks for a density that does not change with time.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the drift depends on time with period {period}; densities are computed of systems whose drift does not"
)]
pub struct PeriodicDrift {
    /// The period.
    pub period: f64,
}

/// A reflection that maps the law of the process onto itself: coordinates marked in `reflected`
/// change sign about `centre`, the others stay.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetry {
    /// Centre of the reflection, one value an axis.
    pub centre: Vec<f64>,
    /// Which axes are reflected.
    pub reflected: Vec<bool>,
}
