//! A system between walls: the same drift and noise, and nothing leaves given ranges. What the densities of the two
//! differ by is what the mass that leaves the ranges does.

use std::sync::Arc;

use super::{Lanes, SwitchingSurface, Symmetry, System};

/// A system whose coordinates stay within given ranges.
pub(crate) struct Enclosed {
    /// The system.
    pub(crate) system: Arc<dyn System>,
    /// Lower and upper wall of each axis.
    pub(crate) ranges: Vec<(f64, f64)>,
}

impl System for Enclosed {
    fn dimension(&self) -> usize {
        self.system.dimension()
    }
    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        self.system.drift(time, states, drift);
    }
    fn noise_axes(&self) -> &[usize] {
        self.system.noise_axes()
    }
    fn additive_amplitude(&self, channel: usize) -> Option<f64> {
        self.system.additive_amplitude(channel)
    }
    fn amplitude(&self, channel: usize, time: f64, states: &[Lanes], amplitude: &mut Lanes) {
        self.system.amplitude(channel, time, states, amplitude);
    }
    fn period(&self) -> Option<f64> {
        self.system.period()
    }
    fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        self.ranges.get(axis).copied()
    }
    fn filtered_noise(&self, axis: usize) -> Option<(f64, f64)> {
        self.system.filtered_noise(axis)
    }
    fn relaxation_rate(&self, axis: usize) -> Option<f64> {
        self.system.relaxation_rate(axis)
    }
    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        self.system.switching_surfaces()
    }
    fn symmetry(&self) -> Option<Symmetry> {
        self.system.symmetry()
    }
}
