//! Integrators of sampled trajectories: batches of [`LANES`] states advance together.
//!
//! Stochastic Heun averages the drift at the start of a step and at its Euler-Maruyama predictor, with the noise
//! amplitude taken at the start (Itô). For additive noise its weak order is 2; of an undamped oscillator it takes
//! ω⁴dt³/4 from the damping. Euler-Maruyama has weak order 1 and takes ω²dt. Splitting (`splitting.rs`) moves positions
//! by half a step before and after a step of Heun's of everything else, and takes nothing from the damping. Where laws
//! alone are asked for, increments of four values (`four_point.rs`) do what normal ones do.
//!
//! Steps are passes over a batch, one a stage, with the drift called between them (`steps.rs`): that serves every
//! system. A built-in oscillator has the same steps compiled in one loop with its drift (`compiled.rs`), to the same
//! bits.

use compiled::Compiled;
pub(crate) use folds::WholeTurn;
use folds::{Mirror, mirrors};
use splitting::rows_of;
pub(crate) use splitting::{Position, positions};
use steps::{Scratch, euler_maruyama, heun};

use super::random::{NormalStream, ROWS};
use crate::MAX_DIMENSION;
use crate::cancellation::{Cancellation, Cancelled};
use crate::system::{LANES, Lanes, Noise, System};

/// Integrators by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integrator {
    /// Heun's predictor-corrector for the drift with Itô noise: weak order 2 for additive noise, 1 otherwise.
    StochasticHeun,
    /// The same with increments of four values in place of normal ones: the same weak orders, and twice the speed. Laws
    /// alone are right, not paths.
    WeakHeun,
    /// Euler-Maruyama: weak order 1; takes ω² dt away from the damping of an oscillator.
    EulerMaruyama,
    /// Positions move by half a step with their velocities, all other coordinates by a step of Heun's, positions by
    /// half a step again (Strang 1968): weak orders as of Heun, and nothing is taken from the damping of an oscillator.
    /// A system without positions is integrated by Heun's.
    Splitting,
    /// The same with increments of four values in place of normal ones.
    WeakSplitting,
}

words! {
    Integrator, pub name:
    StochasticHeun: "heun",
    WeakHeun: "weak-heun",
    EulerMaruyama: "euler-maruyama",
    Splitting: "splitting",
    WeakSplitting: "weak-splitting",
}

impl Integrator {
    /// Whether increments of four values are drawn in place of normal ones.
    pub(crate) fn is_for_laws(self) -> bool {
        matches!(self, Self::WeakHeun | Self::WeakSplitting)
    }

    /// Whether positions move apart from everything else.
    pub(crate) fn splits(self) -> bool {
        matches!(self, Self::Splitting | Self::WeakSplitting)
    }
}

/// A system with a fixed step.
pub(crate) struct Stepper<'a> {
    system: &'a dyn System,
    integrator: Integrator,
    time_step: f64,
    noise: Vec<Channel<'a>>,
    /// What moves apart from the rest; nothing unless the integrator splits.
    positions: Vec<Position>,
    /// Axes of the rest.
    rest: Vec<usize>,
    /// Whether noise acts on an axis.
    is_noisy: [bool; MAX_DIMENSION],
    /// Amplitude times √dt and number of the noise of an axis, where it is the only one and constant.
    only_increments: [Option<(f64, usize)>; MAX_DIMENSION],
    mirrors: Vec<Mirror>,
    turns: Vec<WholeTurn>,
    /// Steps in one loop with the drift, which do the same.
    compiled: Option<Compiled<'a>>,
    cancellation: Cancellation,
}

/// A noise, and its amplitude times √dt where it is constant.
struct Channel<'a> {
    noise: &'a Noise,
    increment: Option<f64>,
}

impl<'a> Stepper<'a> {
    /// Steps of `time_step`, until cancelled.
    pub(crate) fn new(
        system: &'a dyn System,
        integrator: Integrator,
        time_step: f64,
        cancellation: &Cancellation,
    ) -> Self {
        let channel = |noise: &'a Noise| Channel {
            noise,
            increment: (noise.additive()).map(|amplitude| amplitude * time_step.sqrt()),
        };
        let positions = match integrator.splits() {
            true => positions(system),
            false => Vec::new(),
        };
        let is_position = |axis: &usize| positions.iter().any(|one| one.axis == *axis);
        let rest = (0..system.dimension()).filter(|axis| !is_position(axis));
        let noise: Vec<Channel<'a>> = system.noises().iter().map(channel).collect();
        let (mut is_noisy, mut only_increments) = ([false; MAX_DIMENSION], [None; MAX_DIMENSION]);
        for (number, channel) in noise.iter().enumerate() {
            let axis = channel.noise.axis;
            let only = channel.increment.map(|increment| (increment, number));
            only_increments[axis] = only.filter(|_| !is_noisy[axis]);
            is_noisy[axis] = true;
        }
        let stepper = Self {
            system,
            integrator,
            time_step,
            noise,
            is_noisy,
            only_increments,
            rest: rest.collect(),
            positions,
            mirrors: mirrors(system),
            turns: Vec::new(),
            compiled: None,
            cancellation: cancellation.clone(),
        };
        Self {
            compiled: Compiled::of(&stepper),
            ..stepper
        }
    }

    /// The same with coordinates that close on themselves brought back to one turn after every step. Without it whole
    /// turns add up.
    pub(crate) fn within_a_turn(self) -> Self {
        let stepper = Self {
            turns: WholeTurn::of(self.system),
            ..self
        };
        Self {
            compiled: Compiled::of(&stepper),
            ..stepper
        }
    }

    /// Advances a batch, `states[axis][lane]`, by `steps` steps from the step of number `first`; cancelled, by fewer.
    pub(crate) fn advance(
        &self,
        states: &mut [Lanes],
        first: usize,
        steps: usize,
        stream: &mut NormalStream,
    ) -> Result<(), Cancelled> {
        let channels = self.noise.len();
        // Whole pairs of rows, so that no normal is dropped but at the very end.
        let chunk = (ROWS / channels.max(1)).max(2) & !1;
        let (mut done, mut scratch) = (0, None);
        while done < steps {
            self.cancellation.check()?;
            let count = chunk.min(steps - done);
            let normals = stream.draw(count * channels, self.integrator.is_for_laws());
            self.work_through(states, first + done, count, normals, &mut scratch);
            done += count;
        }
        Ok(())
    }

    /// Advances by `steps` steps with the given standard normals (or numbers that stand for them), one row a step and
    /// Wiener process.
    pub(crate) fn advance_with(
        &self,
        states: &mut [Lanes],
        first: usize,
        steps: usize,
        normals: &[Lanes],
    ) {
        self.work_through(states, first, steps, normals, &mut None);
    }

    fn work_through(
        &self,
        states: &mut [Lanes],
        first: usize,
        steps: usize,
        normals: &[Lanes],
        scratch: &mut Option<Scratch>,
    ) {
        if let Some(compiled) = &self.compiled {
            return compiled.advance(self.time_step, states, &normals[..steps]);
        }
        let scratch = scratch.get_or_insert_with(Scratch::new);
        match self.integrator {
            Integrator::EulerMaruyama => {
                euler_maruyama(self, states, first, steps, normals, scratch)
            }
            _ => heun(self, states, first, steps, normals, scratch),
        }
    }

    /// Folds states back between the walls.
    #[inline(always)]
    fn reflect(&self, states: &mut [Lanes]) {
        for mirror in &self.mirrors {
            mirror.fold(states);
        }
    }

    /// Folds states back into the turn.
    #[inline(always)]
    fn turn_back(&self, states: &mut [Lanes]) {
        for turn in &self.turns {
            turn.fold(states);
        }
    }

    /// Moves positions for a time.
    #[inline(always)]
    fn move_positions(&self, states: &mut [Lanes], time: f64) {
        for position in &self.positions {
            position.advance(states, time);
        }
    }

    /// Adds dt F(x) + b ΔW to all coordinates but positions.
    #[inline(always)]
    fn predict(
        &self,
        states: &mut [Lanes],
        drift: &[Lanes],
        normals: &[Lanes],
        increments: &[Lanes],
    ) {
        let step = self.time_step;
        for &axis in &self.rest {
            let (states, drift) = (&mut states[axis], &drift[axis]);
            if let Some((increment, channel)) = self.only_increments[axis] {
                let normal = &normals[channel];
                for lane in 0..LANES {
                    states[lane] += step * drift[lane] + increment * normal[lane];
                }
            } else if self.is_noisy[axis] {
                let increments = &increments[axis];
                for lane in 0..LANES {
                    states[lane] += step * drift[lane] + increments[lane];
                }
            } else {
                for lane in 0..LANES {
                    states[lane] += step * drift[lane];
                }
            }
        }
    }

    /// The drift at states that may be beyond walls: that of their images, turned round along the axis of the wall.
    #[inline(always)]
    fn drift_beyond(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        if self.mirrors.is_empty() {
            return self.system.drift(time, states, drift);
        }
        let mut images = rows_of(states);
        let states = &mut images[..states.len()];
        let mut signs = [[1.0; LANES]; MAX_DIMENSION];
        for mirror in &self.mirrors {
            for (x, sign) in states[mirror.axis].iter_mut().zip(&mut signs[mirror.axis]) {
                let (image, is_turned) = mirror.image(*x);
                *x = image;
                *sign = if is_turned { -1.0 } else { 1.0 };
            }
        }
        self.system.drift(time, states, drift);
        for (drift, signs) in drift.iter_mut().zip(&signs) {
            for (drift, sign) in drift.iter_mut().zip(signs) {
                *drift *= sign;
            }
        }
    }

    /// Σ_k b_k ΔW_k of one step on every axis with noise but those of `only_increments`, and nothing on the others.
    #[inline(always)]
    fn increments(&self, time: f64, states: &[Lanes], normals: &[Lanes], sums: &mut [Lanes]) {
        let mut is_begun = [false; MAX_DIMENSION];
        for (channel, normal) in self.noise.iter().zip(normals) {
            let axis = channel.noise.axis;
            if self.only_increments[axis].is_some() {
                continue;
            }
            let (sum, is_more) = (&mut sums[axis], is_begun[axis]);
            is_begun[axis] = true;
            if let Some(increment) = channel.increment {
                for lane in 0..LANES {
                    let before = if is_more { sum[lane] } else { 0.0 };
                    sum[lane] = before + increment * normal[lane];
                }
            } else {
                let amplitude = channel.noise.amplitudes(time, states);
                let root = self.time_step.sqrt();
                for lane in 0..LANES {
                    let before = if is_more { sum[lane] } else { 0.0 };
                    sum[lane] = before + amplitude[lane] * root * normal[lane];
                }
            }
        }
    }
}

mod compiled;
#[cfg(test)]
mod compiled_tests;
mod folds;
mod splitting;
#[cfg(test)]
mod splitting_tests;
mod steps;
#[cfg(test)]
mod tests;
