//! A system at random states: evaluated in a batch and alone, at other times, mirrored, and on its bounds.

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::{LANES, Lanes, System};
use super::{ContractViolation, Quantity};
use crate::formula::tape::Tape;

/// Difference that is rounding, in units of the root mean square of the drift (or of the mean noise intensity) on its
/// axis.
const ROUNDING: f64 = 1e-9;

/// Times at which a system without a period is looked at beside time zero, and shares of the period of one with.
const TIMES: [f64; 3] = [0.618_033_988_749_895, 17.3, 1234.5];
const SHARES: [f64; 2] = [0.293, 0.707];

/// A system, states to try it at, and the sizes that differences are compared with.
pub(super) struct Trial<'a> {
    pub(super) system: &'a dyn System,
    /// The box of the states, one range an axis.
    pub(super) ranges: Vec<(f64, f64)>,
    /// As many states as a batch holds.
    pub(super) states: Vec<Vec<f64>>,
    /// Root mean square of the drift, one value an axis.
    pub(super) drift_size: Vec<f64>,
    /// Mean noise intensity, one value an axis.
    pub(super) noise_size: Vec<f64>,
    /// Times to look at.
    pub(super) times: Vec<f64>,
}

impl<'a> Trial<'a> {
    /// Evaluates the system in one batch and state by state.
    pub(super) fn new(
        system: &'a dyn System,
        ranges: Vec<(f64, f64)>,
    ) -> Result<Self, ContractViolation> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
        let mut place = |&(from, to): &(f64, f64)| {
            let share = (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
            from + share * (to - from)
        };
        let states: Vec<Vec<f64>> = (0..LANES)
            .map(|_| ranges.iter().map(&mut place).collect())
            .collect();
        let mut times = vec![0.0];
        let period = system.facts().period.into_iter();
        times.extend(period.flat_map(|period| SHARES.map(|share| share * period)));
        let mut trial = Self {
            system,
            drift_size: vec![0.0; ranges.len()],
            noise_size: vec![0.0; ranges.len()],
            ranges,
            states,
            times,
        };
        for &time in &trial.times {
            trial.check_batch(time)?;
        }
        for axis in 0..trial.dimension() {
            let mean = |value: &dyn Fn(&Vec<f64>) -> f64| {
                trial.states.iter().map(value).sum::<f64>() / LANES as f64
            };
            let drift = mean(&|state| system.drift_at(0.0, state)[axis].powi(2)).sqrt();
            let noise = mean(&|state| trial.intensity(0.0, state, axis));
            (trial.drift_size[axis], trial.noise_size[axis]) = (drift, noise);
            trial.check_intensity(axis)?;
        }
        Ok(trial)
    }

    fn dimension(&self) -> usize {
        self.ranges.len()
    }

    /// The squares of the amplitudes, which is what a density feels, are numbers too, and not zero where the amplitudes
    /// are not.
    fn check_intensity(&self, axis: usize) -> Result<(), ContractViolation> {
        let infinite = |state: &&Vec<f64>| !self.intensity(0.0, state, axis).is_finite();
        if let Some(state) = self.states.iter().find(infinite) {
            return Err(ContractViolation::NotFinite {
                quantity: Quantity::Noise(axis),
                state: state.clone(),
                time: 0.0,
            });
        }
        let acts = self.system.noises_on(axis).any(|noise| {
            let mut states = self.states.iter();
            states.any(|state| noise.at(0.0, state) != 0.0)
        });
        if acts && self.noise_size[axis] == 0.0 {
            return Err(ContractViolation::Vanishing { axis });
        }
        Ok(())
    }

    pub(super) fn intensity(&self, time: f64, state: &[f64], axis: usize) -> f64 {
        self.system.intensity_at(axis, time, state)
    }

    /// All states side by side.
    fn batch(&self) -> Vec<Lanes> {
        let axes = 0..self.dimension();
        axes.map(|axis| std::array::from_fn(|lane| self.states[lane][axis]))
            .collect()
    }

    /// The drift is what these formulas say.
    pub(super) fn check_formulas(&self, formulas: &Tape) -> Result<(), ContractViolation> {
        let batch = self.batch();
        let (mut compiled, mut typed) = (batch.clone(), batch.clone());
        self.system.drift(0.0, &batch, &mut compiled);
        formulas.run(0.0, &batch, &mut typed);
        for (lane, state) in self.states.iter().enumerate() {
            for axis in 0..self.dimension() {
                let (found, expected) = (compiled[axis][lane], typed[axis][lane]);
                if !same(found, expected, self.drift_size[axis]) {
                    let state = state.clone();
                    return Err(ContractViolation::Formula {
                        axis,
                        state,
                        found,
                        expected,
                    });
                }
            }
        }
        Ok(())
    }

    /// Drift and noise of all states as one batch are finite and those of each state alone.
    fn check_batch(&self, time: f64) -> Result<(), ContractViolation> {
        let batch = self.batch();
        let mut drift: Vec<Lanes> = vec![[f64::NAN; LANES]; batch.len()];
        self.system.drift(time, &batch, &mut drift);
        for (lane, state) in self.states.iter().enumerate() {
            let alone = self.system.drift_at(time, state);
            for (axis, &alone) in alone.iter().enumerate() {
                agree(Quantity::Drift(axis), state, time, alone, drift[axis][lane])?;
            }
        }
        for noise in self.system.noises() {
            for (state, in_batch) in self.states.iter().zip(noise.amplitudes(time, &batch)) {
                let (quantity, alone) = (Quantity::Noise(noise.axis), noise.at(time, state));
                agree(quantity, state, time, alone, in_batch)?;
            }
        }
        Ok(())
    }

    /// Drift and noise repeat after the period, or do not change with time.
    pub(super) fn check_time(&self) -> Result<(), ContractViolation> {
        let period = self.system.facts().period;
        let pairs: Vec<(f64, f64)> = match period {
            Some(period) => self.times.iter().map(|&t| (t, t + period)).collect(),
            None => TIMES.iter().map(|&time| (0.0, time)).collect(),
        };
        for (from, to) in pairs {
            for state in &self.states {
                for axis in 0..self.dimension() {
                    let drift = |time: f64| self.system.drift_at(time, state)[axis];
                    let noise = |time: f64| self.intensity(time, state, axis);
                    let noise = (noise(from), noise(to));
                    for (quantity, first, second, size) in [
                        (
                            Quantity::Drift(axis),
                            drift(from),
                            drift(to),
                            self.drift_size[axis],
                        ),
                        (
                            Quantity::Noise(axis),
                            noise.0,
                            noise.1,
                            self.noise_size[axis],
                        ),
                    ] {
                        if !same(first, second, size) {
                            return Err(ContractViolation::Time {
                                quantity,
                                state: state.clone(),
                                from,
                                to,
                                first,
                                second,
                                period,
                            });
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// The image of every state has the image of its drift, its noise and its density.
    pub(super) fn check_symmetry(&self) -> Result<(), ContractViolation> {
        let Some(symmetry) = &self.system.facts().symmetry else {
            return Ok(());
        };
        for state in &self.states {
            let axes = state.iter().enumerate();
            let image: Vec<f64> = axes.map(|(axis, &x)| symmetry.image(axis, x)).collect();
            let check = |quantity, expected: f64, found: f64, size: f64| {
                if same(expected, found, size) {
                    return Ok(());
                }
                Err(ContractViolation::Asymmetric {
                    quantity,
                    state: state.clone(),
                    image: image.clone(),
                    expected,
                    found,
                })
            };
            for &time in &self.times {
                let drift = self.system.drift_at(time, state);
                let mirrored = self.system.drift_at(time, &image);
                for axis in 0..state.len() {
                    let sign = if symmetry.reflected[axis] { -1.0 } else { 1.0 };
                    let size = self.drift_size[axis];
                    check(
                        Quantity::Drift(axis),
                        sign * drift[axis],
                        mirrored[axis],
                        size,
                    )?;
                    let noise = self.intensity(time, state, axis);
                    let mirrored = self.intensity(time, &image, axis);
                    check(
                        Quantity::Noise(axis),
                        noise,
                        mirrored,
                        self.noise_size[axis],
                    )?;
                }
            }
            let log_density = |state: &[f64]| self.system.exact_log_density(state);
            if let (Some(there), Some(mirrored)) = (log_density(state), log_density(&image)) {
                check(Quantity::Density, there, mirrored, 1.0 + there.abs())?;
            }
        }
        Ok(())
    }

    /// On a bound the drift does not point outward, and no noise acts across.
    pub(super) fn check_bounds(&self) -> Result<(), ContractViolation> {
        for (&axis, &(low, high)) in &self.system.facts().bounds {
            for (bound, outward) in [(low, -1.0), (high, 1.0)] {
                if bound.is_finite() {
                    self.check_bound(axis, bound, outward)?;
                }
            }
        }
        Ok(())
    }

    fn check_bound(&self, axis: usize, bound: f64, outward: f64) -> Result<(), ContractViolation> {
        for state in &self.states {
            let mut state = state.clone();
            state[axis] = bound;
            for &time in &self.times {
                let speed = outward * self.system.drift_at(time, &state)[axis];
                if speed.is_nan() || speed > ROUNDING * self.drift_size[axis] {
                    return Err(ContractViolation::BoundLeft {
                        axis,
                        bound,
                        state,
                        speed,
                    });
                }
                let intensity = self.intensity(time, &state, axis);
                if intensity.is_nan() || intensity > ROUNDING * self.noise_size[axis] {
                    let amplitude = intensity.sqrt();
                    return Err(ContractViolation::BoundNoise {
                        axis,
                        bound,
                        state,
                        amplitude,
                    });
                }
            }
        }
        Ok(())
    }
}

/// Whether two values differ by rounding at most; no value that is not a number does.
pub(super) fn same(one: f64, other: f64, size: f64) -> bool {
    (one - other).abs() <= ROUNDING * size
}

fn agree(
    quantity: Quantity,
    state: &[f64],
    time: f64,
    alone: f64,
    in_batch: f64,
) -> Result<(), ContractViolation> {
    let state = state.to_vec();
    if !(alone.is_finite() && in_batch.is_finite()) {
        return Err(ContractViolation::NotFinite {
            quantity,
            state,
            time,
        });
    }
    if alone == in_batch {
        return Ok(());
    }
    Err(ContractViolation::BatchMixes {
        quantity,
        state,
        alone,
        in_batch,
    })
}
