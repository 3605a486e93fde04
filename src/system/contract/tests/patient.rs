//! A system of which one thing at a time can be made wrong.

use std::collections::BTreeMap;

use crate::system::{Facts, LANES, Lanes, Noise, SwitchingSurface, Symmetry, System};

/// Drift at a time and a state.
pub(super) type Drift = fn(f64, [f64; 3]) -> [f64; 3];

/// As it is, x' = y, y' = -y - x - sgn(y)/2 + ξ, z' = (y - |y| z)/2, and all that it declares holds.
#[derive(Clone)]
pub(super) struct Patient {
    pub(super) dimension: usize,
    pub(super) noises: Vec<Noise>,
    pub(super) facts: Facts,
    pub(super) density: Option<fn(&[f64]) -> f64>,
    pub(super) drift: Drift,
}

pub(super) const WELL: Drift = |_, [x, y, z]| {
    let friction = if y == 0.0 { 0.0 } else { 0.5 * y.signum() };
    [y, -y - x - friction, 0.5 * (y - y.abs() * z)]
};

pub(super) fn healthy() -> Patient {
    Patient {
        dimension: 3,
        noises: vec![Noise::constant(1, 0.5)],
        facts: Facts {
            bounds: BTreeMap::from([(2, (-1.0, 1.0))]),
            switching_surfaces: vec![SwitchingSurface { axis: 1, at: 0.0 }],
            symmetry: Some(Symmetry::about_origin(3)),
            ..Facts::default()
        },
        density: None,
        drift: WELL,
    }
}

/// A noise by its amplitude at a state of the three axes.
pub(super) fn noise(axis: usize, amplitude: fn([f64; 3]) -> f64) -> Vec<Noise> {
    vec![Noise::of_state(axis, move |_, states, lanes| {
        for (lane, value) in lanes.iter_mut().enumerate() {
            *value = amplitude(std::array::from_fn(|axis| states[axis][lane]));
        }
    })]
}

impl System for Patient {
    fn dimension(&self) -> usize {
        self.dimension
    }
    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        for lane in 0..LANES {
            let state = std::array::from_fn(|axis| states[axis][lane]);
            for (axis, value) in (self.drift)(time, state).into_iter().enumerate() {
                drift[axis][lane] = value;
            }
        }
    }
    fn noises(&self) -> &[Noise] {
        &self.noises
    }
    fn facts(&self) -> &Facts {
        &self.facts
    }
    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        self.density.map(|density| density(state))
    }
}
