//! Integrators of sampled trajectories: batches of [`LANES`] states advance together.
//!
//! Stochastic Heun averages the drift at the start of a step and at its Euler-Maruyama predictor, with the noise
//! amplitude taken at the start (Itô). For additive noise its weak order is 2; of an undamped oscillator it takes
//! ω⁴dt³/4 from the damping. Euler-Maruyama has weak order 1 and takes ω²dt. Where laws alone are asked for, increments
//! of four values (`four_point.rs`) do for Heun what normal ones do.

use multiversion::multiversion;

use super::random::NormalStream;
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
}

words! { Integrator, pub name: StochasticHeun: "heun", WeakHeun: "weak-heun", EulerMaruyama: "euler-maruyama" }

/// Rows of normals made at once: 8 KB, which stay in the first-level cache with everything else.
const ROWS: usize = 16;

/// A system with a fixed step.
pub(crate) struct Stepper<'a> {
    system: &'a dyn System,
    integrator: Integrator,
    time_step: f64,
    noise: Vec<Channel<'a>>,
    mirrors: Vec<Mirror>,
    turns: Vec<WholeTurn>,
    cancellation: Cancellation,
}

/// One turn of an axis that closes on itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WholeTurn {
    pub(crate) axis: usize,
    from: f64,
    pub(crate) length: f64,
}

impl WholeTurn {
    /// Those of a system.
    pub(crate) fn of(system: &dyn System) -> Vec<Self> {
        let turns = system.facts().turns.iter();
        let turn = |(&axis, &(from, to)): (&usize, &(f64, f64))| Self {
            axis,
            from,
            length: to - from,
        };
        turns.map(turn).collect()
    }

    /// Whole turns from the one that is looked at to the one in which a coordinate is.
    pub(crate) fn number(&self, x: f64) -> f64 {
        ((x - self.from) / self.length).floor()
    }

    fn fold(&self, states: &mut [Lanes]) {
        for x in &mut states[self.axis] {
            *x -= self.length * self.number(*x);
        }
    }
}

/// A noise, and its amplitude times √dt where it is constant.
struct Channel<'a> {
    noise: &'a Noise,
    increment: Option<f64>,
}

/// Walls of an axis at which paths are reflected, infinite where there is none. A path between walls is the image of a
/// free path of the system that goes on beyond them as in a mirror: folded back, with the drift turned round.
struct Mirror {
    axis: usize,
    from: f64,
    to: f64,
}

fn mirrors(system: &dyn System) -> Vec<Mirror> {
    let walls = system.facts().reflecting.iter();
    walls
        .map(|(&axis, &(from, to))| Mirror { axis, from, to })
        .collect()
}

impl Mirror {
    /// The image of a coordinate between the walls, and whether it is turned round.
    fn image(&self, x: f64) -> (f64, bool) {
        // A step that passes both walls is of no use for anything; it ends at a wall.
        if x < self.from {
            ((2.0 * self.from - x).min(self.to), true)
        } else if x > self.to {
            ((2.0 * self.to - x).max(self.from), true)
        } else {
            (x, false)
        }
    }

    fn fold(&self, states: &mut [Lanes]) {
        for x in &mut states[self.axis] {
            *x = self.image(*x).0;
        }
    }
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
        Self {
            system,
            integrator,
            time_step,
            noise: system.noises().iter().map(channel).collect(),
            mirrors: mirrors(system),
            turns: Vec::new(),
            cancellation: cancellation.clone(),
        }
    }

    /// The same with coordinates that close on themselves brought back to one turn after every step. Without it whole
    /// turns add up.
    pub(crate) fn within_a_turn(self) -> Self {
        Self {
            turns: WholeTurn::of(self.system),
            ..self
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
        let mut rows = [[0.0; LANES]; ROWS];
        let mut more = Vec::new();
        let buffer: &mut [Lanes] = if chunk * channels <= ROWS {
            &mut rows
        } else {
            more.resize(chunk * channels, [0.0; LANES]);
            &mut more
        };
        let mut done = 0;
        while done < steps {
            self.cancellation.check()?;
            let count = chunk.min(steps - done);
            let normals = &mut buffer[..count * channels];
            match self.integrator {
                Integrator::WeakHeun => stream.fill_for_laws(normals),
                Integrator::StochasticHeun | Integrator::EulerMaruyama => stream.fill(normals),
            }
            self.advance_with(states, first + done, count, normals);
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
        match self.integrator {
            Integrator::StochasticHeun | Integrator::WeakHeun => {
                heun(self, states, first, steps, normals);
            }
            Integrator::EulerMaruyama => euler_maruyama(self, states, first, steps, normals),
        }
    }

    /// Folds states back between the walls, and into the turn.
    #[inline(always)]
    fn fold(&self, states: &mut [Lanes]) {
        for mirror in &self.mirrors {
            mirror.fold(states);
        }
        for turn in &self.turns {
            turn.fold(states);
        }
    }

    /// The drift at states that may be beyond walls: that of their images, turned round along the axis of the wall.
    #[inline(always)]
    fn drift_beyond(&self, time: f64, states: &mut [Lanes], drift: &mut [Lanes]) {
        if self.mirrors.is_empty() {
            return self.system.drift(time, states, drift);
        }
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

    /// Σ_k b_k ΔW_k of one step on every axis.
    #[inline(always)]
    fn increments(&self, time: f64, states: &[Lanes], normals: &[Lanes], sums: &mut [Lanes]) {
        for sum in sums.iter_mut() {
            sum.fill(0.0);
        }
        for (channel, normal) in self.noise.iter().zip(normals) {
            let sum = &mut sums[channel.noise.axis];
            if let Some(increment) = channel.increment {
                for lane in 0..LANES {
                    sum[lane] += increment * normal[lane];
                }
            } else {
                let amplitude = channel.noise.amplitudes(time, states);
                let root = self.time_step.sqrt();
                for lane in 0..LANES {
                    sum[lane] += amplitude[lane] * root * normal[lane];
                }
            }
        }
    }
}

#[multiversion(targets = "simd")]
fn heun(
    stepper: &Stepper<'_>,
    states: &mut [Lanes],
    first: usize,
    steps: usize,
    normals: &[Lanes],
) {
    let (dimension, channels) = (states.len(), stepper.noise.len());
    let (step, half) = (stepper.time_step, 0.5 * stepper.time_step);
    let mut work = [[[0.0; LANES]; MAX_DIMENSION]; 4];
    let [increments, predictor, start, end] = &mut work;
    let (increments, predictor) = (&mut increments[..dimension], &mut predictor[..dimension]);
    let (start, end) = (&mut start[..dimension], &mut end[..dimension]);
    for number in 0..steps {
        let time = (first + number) as f64 * step;
        let normals = &normals[number * channels..(number + 1) * channels];
        stepper.increments(time, states, normals, increments);
        stepper.system.drift(time, states, start);
        for axis in 0..dimension {
            for lane in 0..LANES {
                predictor[axis][lane] =
                    states[axis][lane] + (step * start[axis][lane] + increments[axis][lane]);
            }
        }
        stepper.drift_beyond(time + step, predictor, end);
        for axis in 0..dimension {
            for lane in 0..LANES {
                let drift = half * (start[axis][lane] + end[axis][lane]);
                states[axis][lane] += drift + increments[axis][lane];
            }
        }
        stepper.fold(states);
    }
}

#[multiversion(targets = "simd")]
fn euler_maruyama(
    stepper: &Stepper<'_>,
    states: &mut [Lanes],
    first: usize,
    steps: usize,
    normals: &[Lanes],
) {
    let (dimension, channels) = (states.len(), stepper.noise.len());
    let step = stepper.time_step;
    let mut work = [[[0.0; LANES]; MAX_DIMENSION]; 2];
    let [increments, start] = &mut work;
    let (increments, start) = (&mut increments[..dimension], &mut start[..dimension]);
    for number in 0..steps {
        let time = (first + number) as f64 * step;
        let normals = &normals[number * channels..(number + 1) * channels];
        stepper.increments(time, states, normals, increments);
        stepper.system.drift(time, states, start);
        for axis in 0..dimension {
            for lane in 0..LANES {
                states[axis][lane] += step * start[axis][lane] + increments[axis][lane];
            }
        }
        stepper.fold(states);
    }
}

#[cfg(test)]
mod tests;
