//! Trials of states that relax: that they are filters of noise, or relax linearly, as is declared.

use super::ContractViolation;
use super::trial::{Trial, same};

impl Trial<'_> {
    /// The drift of filtered noise is -rate (x - mean), the rate from its noise and its deviation, and the same at all
    /// states. Beside it is only what turns the states of filters into one another and keeps their joint normal
    /// density: Σ u c/deviation = 0, where u = (x - mean)/deviation and c, which does not depend on x, is what the
    /// drift has beside.
    pub(super) fn check_filters(&self) -> Result<(), ContractViolation> {
        let declared = self.system.facts().filtered_noise.iter();
        let filters: Vec<(usize, f64, f64)> = declared
            .map(|(&axis, &(mean, deviation))| (axis, mean, deviation))
            .collect();
        let Some(&(first, ..)) = filters.first() else {
            return Ok(());
        };
        let violation = |axis: usize, state: &[f64]| {
            let of_axis = filters.iter().find(|one| one.0 == axis);
            let (mean, deviation) = of_axis.map_or((0.0, 1.0), |&(_, mean, size)| (mean, size));
            let state = state.to_vec();
            ContractViolation::Filter {
                axis,
                mean,
                deviation,
                state,
            }
        };
        let is_noisy = |&(axis, ..): &(usize, f64, f64)| self.noise_size[axis] > 0.0;
        if !filters.iter().any(is_noisy) {
            return Err(violation(first, &self.states[0]));
        }
        for state in &self.states {
            let mut turned = (0.0, 0.0);
            for &(axis, mean, deviation) in &filters {
                let u = (state[axis] - mean) / deviation;
                let beside = self.beside_filter(state, (axis, mean, deviation));
                // Elsewhere along the axis it is the same.
                let mut moved = state.clone();
                moved[axis] += deviation;
                let there = self.beside_filter(&moved, (axis, mean, deviation));
                let size = self.drift_size[axis];
                if !same(beside, there, size) || !self.is_constant_noise(axis, &moved) {
                    return Err(violation(axis, state));
                }
                turned.0 += u * beside / deviation;
                turned.1 += (u * size / deviation).abs();
            }
            if !same(turned.0, 0.0, turned.1) {
                return Err(violation(first, state));
            }
        }
        Ok(())
    }

    /// The drift of a coordinate that relaxes falls with it at the declared rate, and no noise acts on it.
    pub(super) fn check_relaxations(&self) -> Result<(), ContractViolation> {
        for (&axis, &rate) in &self.system.facts().relaxation_rates {
            let length = self.ranges[axis].1 - self.ranges[axis].0;
            for state in &self.states {
                let mut moved = state.clone();
                moved[axis] += length;
                let at = |state: &[f64]| self.system.drift_at(self.times[0], state)[axis];
                let fallen = at(state) - at(&moved);
                let size = self.drift_size[axis] + rate.abs() * length;
                let holds = rate > 0.0 && self.noise_size[axis] == 0.0;
                if !holds || !same(fallen, rate * length, size) {
                    let state = state.clone();
                    return Err(ContractViolation::Relaxation { axis, rate, state });
                }
            }
        }
        Ok(())
    }

    /// What the drift of filtered noise has beside its own relaxation.
    fn beside_filter(&self, state: &[f64], (axis, mean, deviation): (usize, f64, f64)) -> f64 {
        let rate = 0.5 * self.intensity(self.times[0], state, axis) / deviation.powi(2);
        self.system.drift_at(self.times[0], state)[axis] + rate * (state[axis] - mean)
    }

    /// Whether the noise on an axis is at a state what it is at the first one.
    fn is_constant_noise(&self, axis: usize, state: &[f64]) -> bool {
        let at = |state: &[f64]| self.intensity(self.times[0], state, axis);
        let first = at(&self.states[0]);
        same(at(state), first, first.abs())
    }
}
