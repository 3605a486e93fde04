//! A system whose coordinate along one axis is measured from another origin. Where a place at which the drift is not
//! smooth moves along a sweep, such as the velocity of a belt, a family that is seen from it has that place on one face
//! of its cells at every value.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{Amplitude, Facts, Lanes, Noise, System};
use crate::MAX_DIMENSION;

/// A system in the coordinate u = x - by of an axis that is a line.
pub(super) struct Displaced {
    system: Arc<dyn System>,
    axis: usize,
    by: f64,
    noises: Vec<Noise>,
    facts: Facts,
}

impl Displaced {
    /// The system seen from an origin at `by`, from which its first switching surface across the axis lies at `at`.
    pub(super) fn new(system: Arc<dyn System>, axis: usize, by: f64, at: f64) -> Self {
        let noises = system.noises().iter();
        let noises = noises.map(|noise| displaced_noise(noise, axis, by));
        Self {
            noises: noises.collect(),
            facts: displaced_facts(system.facts(), axis, by, at),
            system,
            axis,
            by,
        }
    }

    /// A state in the coordinates of the system itself.
    fn state(&self, state: &[f64]) -> Vec<f64> {
        let mut state = state.to_vec();
        state[self.axis] += self.by;
        state
    }
}

/// A batch of states in the coordinates of the system itself.
fn moved_back(states: &[Lanes], axis: usize, by: f64) -> [Lanes; MAX_DIMENSION] {
    let mut moved = [[0.0; super::LANES]; MAX_DIMENSION];
    moved[..states.len()].copy_from_slice(states);
    moved[axis].iter_mut().for_each(|value| *value += by);
    moved
}

fn displaced_noise(noise: &Noise, axis: usize, by: f64) -> Noise {
    match &noise.amplitude {
        Amplitude::Constant(_) => noise.clone(),
        Amplitude::OfState(amplitude) => {
            let amplitude = amplitude.clone();
            Noise::of_state(noise.axis, move |time, states, lanes| {
                let moved = moved_back(states, axis, by);
                amplitude(time, &moved[..states.len()], lanes);
            })
        }
    }
}

fn displaced_facts(facts: &Facts, axis: usize, by: f64, at: f64) -> Facts {
    let mut facts = facts.clone();
    let ends = |ranges: &mut BTreeMap<usize, (f64, f64)>| {
        if let Some((low, high)) = ranges.get_mut(&axis) {
            *low -= by;
            *high -= by;
        }
    };
    ends(&mut facts.bounds);
    ends(&mut facts.reflecting);
    if let Some((mean, _)) = facts.filtered_noise.get_mut(&axis) {
        *mean -= by;
    }
    let surfaces = facts.switching_surfaces.iter_mut();
    let across = surfaces.filter(|surface| surface.axis == axis);
    for (place, surface) in across.enumerate() {
        // Without rounding, so that it lies at one place for all systems.
        surface.at = if place == 0 { at } else { surface.at - by };
    }
    if let Some(symmetry) = &mut facts.symmetry {
        symmetry.centre[axis] -= by;
    }
    facts
}

impl System for Displaced {
    fn dimension(&self) -> usize {
        self.system.dimension()
    }
    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        let moved = moved_back(states, self.axis, self.by);
        self.system.drift(time, &moved[..states.len()], drift);
    }
    fn noises(&self) -> &[Noise] {
        &self.noises
    }
    fn facts(&self) -> &Facts {
        &self.facts
    }
    fn friction_force(&self, state: &[f64]) -> Option<f64> {
        self.system.friction_force(&self.state(state))
    }
    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        self.system.exact_log_density(&self.state(state))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::SwitchingSurface;

    /// x' = y, y' = -sgn(y - 1) - x, with the noise 0.1 (1 + y²) on y.
    struct OnABelt([Noise; 1], Facts);

    impl System for OnABelt {
        fn dimension(&self) -> usize {
            2
        }
        fn drift(&self, _: f64, states: &[Lanes], drift: &mut [Lanes]) {
            for lane in 0..super::super::LANES {
                let [x, y] = [states[0][lane], states[1][lane]];
                drift[0][lane] = y;
                drift[1][lane] = -(y - 1.0).signum() - x;
            }
        }
        fn noises(&self) -> &[Noise] {
            &self.0
        }
        fn facts(&self) -> &Facts {
            &self.1
        }
    }

    #[test]
    fn a_displaced_system_is_the_same_at_the_same_place() {
        let noise = Noise::of_state(1, |_, states, lanes| {
            for (lane, value) in lanes.iter_mut().enumerate() {
                *value = 0.1 * (1.0 + states[1][lane].powi(2));
            }
        });
        let facts = Facts {
            switching_surfaces: vec![SwitchingSurface { axis: 1, at: 1.0 }],
            bounds: BTreeMap::from([(1, (-4.0, 4.0))]),
            ..Facts::default()
        };
        let system: Arc<dyn System> = Arc::new(OnABelt([noise], facts));
        let displaced = Displaced::new(system.clone(), 1, 0.75, 0.25);
        for (x, u) in [(0.5, 0.2), (-0.3, 0.3), (0.1, -2.0)] {
            let (here, there) = ([x, u], [x, u + 0.75]);
            assert_eq!(displaced.drift_at(0.0, &here), system.drift_at(0.0, &there));
            let amplitudes = [
                displaced.noises()[0].at(0.0, &here),
                system.noises()[0].at(0.0, &there),
            ];
            assert_eq!(amplitudes[0], amplitudes[1]);
        }
        assert_eq!(displaced.facts().switching_surfaces[0].at, 0.25);
        assert_eq!(displaced.facts().bounds[&1], (-4.75, 3.25));
    }
}
