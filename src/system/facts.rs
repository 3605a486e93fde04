//! What a system says of itself beside its equations, once and with its values, and what follows from that in one
//! definition for everybody: where its drift jumps, where an end of a range is a wall, whether it depends on time.

use std::collections::BTreeMap;

use super::System;

/// What is known of a system beside drift and noise. Methods trust it, and [`contract`](super::contract) tries it.
///
/// ```
/// use pbif::system::{Facts, Symmetry};
///
/// // Nothing but a reflection about the origin of the only axis.
/// let facts = Facts {
///     symmetry: Some(Symmetry { centre: vec![0.0], reflected: vec![true] }),
///     ..Facts::default()
/// };
/// assert_eq!(facts.bounds(0), None);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Facts {
    /// Values that the coordinate of an axis can never leave (for Dahl's law |z| ≤ f_c/λ), where they are known.
    pub bounds: BTreeMap<usize, (f64, f64)>,
    /// Values between which the coordinate of an axis with noise is kept by reflection, whatever drift and noise do
    /// there: no probability flows through them. Infinite where nothing reflects.
    pub reflecting: BTreeMap<usize, (f64, f64)>,
    /// Mean and standard deviation of a coordinate that is a state of a linear filter of white noise, such as η in
    /// η' = -(η - mean)/τ + b ξ with constant b and τ, upon which nothing else acts. Such coordinates are independent
    /// of one another and normal; those of one filter may turn into one another, as η' = ω ν, ν' = -ω η - γ ν + b ξ do.
    pub filtered_noise: BTreeMap<usize, (f64, f64)>,
    /// Rate λ > 0, per unit of time, at which a coordinate without noise and without bounds relaxes: its drift is
    /// g - λ x, where g depends on the other coordinates only and λ on none. The voltage of a circuit that an
    /// oscillator drives is one, and the force of a Maxwell element. Hermite modes can carry it
    /// ([`crate::space::Axis::hermite`]).
    pub relaxation_rates: BTreeMap<usize, f64>,
    /// Axes that close on themselves, each with the ends of one turn, which are one place: angles, and the phase of a
    /// forcing. Drift and noise are periodic in them.
    pub turns: BTreeMap<usize, (f64, f64)>,
    /// The axis that is the phase of a periodic forcing, in periods: its drift is the forcing's frequency (in periods
    /// per unit of time), the same everywhere.
    pub phase: Option<usize>,
    /// Planes where the drift is not smooth.
    pub switching_surfaces: Vec<SwitchingSurface>,
    /// A reflection under which the steady state is invariant.
    pub symmetry: Option<Symmetry>,
    /// Period of drift and noise in time; `None` for an autonomous system.
    pub period: Option<f64>,
}

/// What is said of a system of which nothing is known.
pub(super) static NOTHING: Facts = Facts {
    bounds: BTreeMap::new(),
    reflecting: BTreeMap::new(),
    filtered_noise: BTreeMap::new(),
    relaxation_rates: BTreeMap::new(),
    turns: BTreeMap::new(),
    phase: None,
    switching_surfaces: Vec::new(),
    symmetry: None,
    period: None,
};

/// Share of a range within which its end is at a bound.
const AT_A_BOUND: f64 = 1e-9;

impl Facts {
    /// Values that the coordinate of an axis can never leave.
    pub fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        self.bounds.get(&axis).copied()
    }

    /// Whether the lower and the upper end of a range of an axis are walls: values that the coordinate never leaves
    /// (`Facts::bounds`) or at which it is reflected, to a billionth of the range. Nothing leaves a turn through its
    /// ends either.
    pub(crate) fn walls(&self, axis: usize, (from, to): (f64, f64)) -> [bool; 2] {
        let tolerance = AT_A_BOUND * (to - from);
        if self.turns.get(&axis) == Some(&(from, to)) {
            return [true; 2];
        }
        let kept = |known: Option<(f64, f64)>| {
            known.map_or([false; 2], |(low, high)| {
                [from <= low + tolerance, to >= high - tolerance]
            })
        };
        let bounds = kept(self.bounds(axis));
        let reflecting = kept(self.reflecting.get(&axis).copied());
        [0, 1].map(|end| bounds[end] || reflecting[end])
    }

    /// Coordinates at which switching surfaces cut an axis, in the order in which they are declared.
    pub(crate) fn surfaces_on(&self, axis: usize) -> impl Iterator<Item = f64> {
        let here = self.switching_surfaces.iter();
        here.filter(move |surface| surface.axis == axis)
            .map(|surface| surface.at)
    }

    /// Nothing, if neither drift nor noise depends on time.
    ///
    /// # Errors
    /// [`PeriodicDrift`].
    pub(crate) fn autonomous(&self) -> Result<(), PeriodicDrift> {
        match self.period {
            Some(period) => Err(PeriodicDrift { period }),
            None => Ok(()),
        }
    }
}

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
    pub(crate) fn drift_jump(&self, system: &dyn System, state: &[f64], distance: f64) -> Vec<f64> {
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

impl Symmetry {
    /// The reflection of every axis about the origin.
    pub fn about_origin(dimension: usize) -> Self {
        Self {
            centre: vec![0.0; dimension],
            reflected: vec![true; dimension],
        }
    }

    /// The image of values on an axis, one value or a batch.
    pub(super) fn image(&self, axis: usize, value: f64) -> f64 {
        if self.reflected[axis] {
            2.0 * self.centre[axis] - value
        } else {
            value
        }
    }
}
