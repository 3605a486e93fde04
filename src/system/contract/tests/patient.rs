//! A system of which one thing at a time can be made wrong.

use crate::system::{Lanes, SwitchingSurface, Symmetry, System};

/// As it is, x' = y, y' = -y - x - sgn(y)/2 + ξ, z' = (y - |y| z)/2, and all that it declares holds.
#[derive(Clone)]
pub(super) struct Patient {
    pub(super) dimension: usize,
    pub(super) noise_axis: usize,
    pub(super) period: Option<f64>,
    pub(super) bounds: (f64, f64),
    pub(super) surfaces: Vec<SwitchingSurface>,
    pub(super) centre: Vec<f64>,
    pub(super) density: Option<fn(&[f64]) -> f64>,
    pub(super) constant: f64,
    pub(super) amplitude: fn(&[f64]) -> f64,
    pub(super) drift: fn(f64, [f64; 3]) -> [f64; 3],
}

pub(super) const WELL: fn(f64, [f64; 3]) -> [f64; 3] = |_, [x, y, z]| {
    let friction = if y == 0.0 { 0.0 } else { 0.5 * y.signum() };
    [y, -y - x - friction, 0.5 * (y - y.abs() * z)]
};

pub(super) fn healthy() -> Patient {
    Patient {
        dimension: 3,
        noise_axis: 1,
        period: None,
        bounds: (-1.0, 1.0),
        surfaces: vec![SwitchingSurface { axis: 1, at: 0.0 }],
        centre: vec![0.0; 3],
        density: None,
        constant: 0.5,
        amplitude: |_| 0.5,
        drift: WELL,
    }
}

impl System for Patient {
    fn dimension(&self) -> usize {
        self.dimension
    }
    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        for lane in 0..states[0].len() {
            let state = [states[0][lane], states[1][lane], states[2][lane]];
            for (axis, value) in (self.drift)(time, state).into_iter().enumerate() {
                drift[axis][lane] = value;
            }
        }
    }
    fn noise_axes(&self) -> &[usize] {
        std::slice::from_ref(&self.noise_axis)
    }
    fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
        (!self.constant.is_nan()).then_some(self.constant)
    }
    fn amplitude(&self, _channel: usize, _time: f64, states: &[Lanes], amplitude: &mut Lanes) {
        for (lane, value) in amplitude.iter_mut().enumerate() {
            *value = (self.amplitude)(&[states[0][lane], states[1][lane], states[2][lane]]);
        }
    }
    fn period(&self) -> Option<f64> {
        self.period
    }
    fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        (axis == 2).then_some(self.bounds)
    }
    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        self.surfaces.clone()
    }
    fn symmetry(&self) -> Option<Symmetry> {
        (!self.centre.is_empty()).then(|| Symmetry {
            centre: self.centre.clone(),
            reflected: vec![true; 3],
        })
    }
    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        self.density.map(|density| density(state))
    }
}
