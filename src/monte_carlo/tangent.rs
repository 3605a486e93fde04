//! The largest Lyapunov exponent along free trajectories: beside each path goes a small deviation from it, by the
//! derivative of the very step that moves the path, and is made short again before it grows large; the mean rate at
//! which its logarithm grows is the exponent (G. Benettin, L. Galgani, A. Giorgilli and J.-M. Strelcyn, Meccanica 15,
//! 1980).
//!
//! Every trajectory is followed twice under the same noise, with a step and with half of it: what that changes is the
//! error of the step. The means of the trajectories, which know nothing of each other, tell the standard error. A mean
//! over time has weights that are small at both ends, 1 - cos 2πt/T, so that what turns evenly averages out; and if its
//! halves differ by more than by chance, deviations had not settled, which is an error too.

use super::batch::{Limits, Purpose, key};
use super::ergodic::Starts;
use super::halving::over_two_steps;
use super::{MonteCarloError, Relaxation};
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::in_parallel;
use crate::sampling::{Integrator, NormalStream};
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System, Tangent};

/// Batches of trajectories.
const BATCHES: usize = 4;

/// Steps, of the longer kind, between two renewals of the deviations' length; even, because normals come in pairs.
const CHUNK: usize = 8;

/// Share of the time in which paths and deviations settle and nothing is counted.
const SETTLE: f64 = 0.2;

/// Largest share of the damping that a step may take.
const STEP_SHARE: f64 = 2e-3;

/// Standard errors that a stated error has.
const STANDARD_ERRORS: f64 = 3.0;

/// How often a difference of halves is taken: what settles like 1/t is off by 1.3 times as much.
const SLOW: f64 = 2.0;

/// How trajectories are followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TangentRun {
    /// The longer of the two steps.
    pub time_step: f64,
    /// Such steps of a trajectory.
    pub steps: usize,
    /// Seed of the random streams.
    pub seed: u64,
}

impl TangentRun {
    /// A run of so many steps of all trajectories together, half steps included.
    pub(crate) fn of_steps(all: f64, relaxation: &Relaxation, seed: u64) -> Self {
        let of_one = all / (3 * BATCHES * LANES * CHUNK) as f64;
        Self {
            time_step: relaxation.time_step(Integrator::StochasticHeun, STEP_SHARE),
            steps: CHUNK * (of_one.ceil().clamp(8.0, 1e9) as usize),
            seed,
        }
    }
}

/// A mean growth rate along trajectories, in 1/t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MeanRate {
    /// With the half step.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// What the half step changes, and the standard error of that.
    pub by_step: [f64; 2],
    /// By how much the second half of the time differs from the first one beyond chance.
    pub by_time: f64,
}

/// Means over the time of a trajectory: all of it, its first and its second half.
type OverTime = [f64; 3];

impl MeanRate {
    /// Half-width of the interval that is believed to hold the true rate. With a weak order of one or more the half
    /// step is off by no more than it differs from the whole one.
    pub(crate) fn error(&self) -> f64 {
        let [change, of_change] = self.by_step;
        let by_step = change.abs() + of_change;
        STANDARD_ERRORS * self.standard_error + by_step + SLOW * self.by_time
    }

    /// Of the rates of all trajectories, with the whole and with the half step.
    fn of(pairs: &[[OverTime; 2]]) -> Option<Self> {
        let count = pairs.len() as f64;
        let mean = |of: &dyn Fn(&[OverTime; 2]) -> f64| pairs.iter().map(of).sum::<f64>() / count;
        let error = |of: &dyn Fn(&[OverTime; 2]) -> f64| {
            let middle = mean(of);
            let squares = pairs.iter().map(|pair| (of(pair) - middle).powi(2));
            (squares.sum::<f64>() / (count * (count - 1.0))).sqrt()
        };
        let fine = |pair: &[OverTime; 2]| pair[1][0];
        let change = |pair: &[OverTime; 2]| pair[0][0] - pair[1][0];
        let halves = |pair: &[OverTime; 2]| pair[1][2] - pair[1][1];
        let beyond = mean(&halves).abs() - STANDARD_ERRORS * error(&halves);
        let found = Self {
            value: mean(&fine),
            standard_error: error(&fine),
            by_step: [mean(&change), error(&change)],
            by_time: beyond.max(0.0),
        };
        found.error().is_finite().then_some(found)
    }
}

/// Exponent and divergence along the trajectories of a system, from `starts` as those of
/// [`ergodic`](super::ergodic()); `None` where a trajectory ran away. They do not depend on the number of threads.
///
/// # Errors
/// [`MonteCarloError`].
pub(crate) fn exponent_along_trajectories(
    (system, tangent): (&dyn System, &Tangent),
    space: &CellSpace,
    starts: &[Vec<f64>],
    run: &TangentRun,
    cancellation: &Cancellation,
) -> Result<Option<[MeanRate; 2]>, MonteCarloError> {
    MonteCarloError::check(system, space)?;
    let follower = Follower {
        system,
        tangent,
        starts: Starts::among(starts, space),
        limits: Limits::new(space),
        run,
        cancellation,
    };
    let batches = in_parallel(BATCHES, |number| follower.batch(number))?;
    let Some(lanes) = batches.into_iter().collect::<Option<Vec<_>>>() else {
        return Ok(None);
    };
    let lanes = lanes.concat();
    let rate = |which: usize| {
        let pairs: Vec<[OverTime; 2]> = lanes.iter().map(|rates| rates[which]).collect();
        MeanRate::of(&pairs)
    };
    Ok(rate(0)
        .zip(rate(1))
        .map(|(exponent, divergence)| [exponent, divergence]))
}

/// What follows batches.
struct Follower<'a> {
    system: &'a dyn System,
    tangent: &'a Tangent,
    starts: Starts<'a>,
    limits: Limits,
    run: &'a TangentRun,
    cancellation: &'a Cancellation,
}

/// Paths with deviations from them, one kind of step.
struct Bundle {
    states: Vec<Lanes>,
    deviations: Vec<Lanes>,
    /// Growth of the logarithm of the volume since the last renewal.
    swollen: Lanes,
    /// Of the logarithm of the deviation, and of volumes: weighted sums of their growth.
    grown: [[Lanes; 3]; 2],
}

impl Bundle {
    fn new(states: Vec<Lanes>) -> Self {
        // No direction of an axis or between two is special.
        let part = |axis: usize| [1.0 / (1.0 + 0.618 * axis as f64); LANES];
        Self {
            deviations: (0..states.len()).map(part).collect(),
            states,
            swollen: [0.0; LANES],
            grown: [[[0.0; LANES]; 3]; 2],
        }
    }

    /// Makes deviations short, and counts how long they have become with these weights.
    fn renew(&mut self, weights: OverTime) {
        for lane in 0..LANES {
            let parts = self.deviations.iter().map(|part| part[lane] * part[lane]);
            let length = parts.sum::<f64>().sqrt();
            let growths = [length.ln(), self.swollen[lane]];
            for (grown, growth) in self.grown.iter_mut().zip(growths) {
                for (sum, weight) in grown.iter_mut().zip(weights) {
                    sum[lane] += weight * growth;
                }
            }
            for part in &mut self.deviations {
                part[lane] /= length;
            }
        }
        self.swollen = [0.0; LANES];
    }
}

/// Weights of a chunk among so many, over all of the time and its halves; those of each have the mean 1.
fn weights(chunk: usize, chunks: usize) -> OverTime {
    let of = |first: usize, count: usize| match chunk.checked_sub(first) {
        Some(place) if place < count => {
            1.0 - (std::f64::consts::TAU * (place as f64 + 0.5) / count as f64).cos()
        }
        _ => 0.0,
    };
    let half = chunks / 2;
    [of(0, chunks), of(0, half), of(half, chunks - half)]
}

impl Follower<'_> {
    /// Exponent and divergence of each trajectory of a batch, each with both steps; `None` where one ran away.
    fn batch(&self, number: usize) -> Result<Option<Vec<[[OverTime; 2]; 2]>>, Cancelled> {
        let dimension = self.system.dimension();
        let states = self.starts.batch(self.run.seed, number, dimension);
        let mut bundles = [Bundle::new(states.clone()), Bundle::new(states)];
        let mut stream = NormalStream::new(key(self.run.seed, Purpose::Tangent, number as u64));
        let channels = self.system.noises().len();
        let mut fine = vec![[0.0; LANES]; 2 * CHUNK * channels];
        let step = self.run.time_step;
        let chunks = self.run.steps.div_ceil(CHUNK);
        let settle = (SETTLE * chunks as f64).ceil() as usize;
        for chunk in 0..chunks + settle {
            self.cancellation.check()?;
            let weights = chunk
                .checked_sub(settle)
                .map(|counted| weights(counted, chunks));
            let weights = weights.unwrap_or_default();
            stream.fill(&mut fine);
            let coarse = over_two_steps(&fine, channels);
            let [whole, half] = &mut bundles;
            self.advance(whole, step, &coarse);
            self.advance(half, 0.5 * step, &fine);
            bundles.iter_mut().for_each(|one| one.renew(weights));
        }
        let time = |count: usize| (count * CHUNK) as f64 * step;
        let half = chunks / 2;
        let times = [chunks, half, chunks - half].map(time);
        let is_lost = |bundle: &Bundle| {
            (0..LANES).any(|lane| {
                let state: Vec<f64> = bundle.states.iter().map(|part| part[lane]).collect();
                !self.limits.hold(&state)
            })
        };
        if bundles.iter().any(is_lost) {
            return Ok(None);
        }
        let mean = |one: &Bundle, which: usize, lane: usize| {
            [0, 1, 2].map(|part| one.grown[which][part][lane] / times[part])
        };
        let of_lane =
            |lane: usize| [0, 1].map(|which| bundles.each_ref().map(|one| mean(one, which, lane)));
        Ok(Some((0..LANES).map(of_lane).collect()))
    }

    /// Steps with these normals, one row a step and noise.
    fn advance(&self, bundle: &mut Bundle, step: f64, normals: &[Lanes]) {
        let channels = self.system.noises().len();
        let steps = match channels {
            0 => ((self.run.time_step / step).round() as usize) * CHUNK,
            _ => normals.len() / channels,
        };
        for number in 0..steps {
            let row = number * channels..(number + 1) * channels;
            self.step(bundle, step, normals.get(row).unwrap_or(&[]));
        }
    }

    /// A step of stochastic Heun, and its derivative.
    fn step(&self, bundle: &mut Bundle, step: f64, normals: &[Lanes]) {
        let (system, dimension, root) = (self.system, bundle.states.len(), step.sqrt());
        let slopes = self.tangent.slopes(&bundle.states);
        let mut drift = vec![[0.0; LANES]; dimension];
        system.drift(0.0, &bundle.states, &mut drift);
        let turned = slopes.of_drift(&bundle.deviations);
        let mut pushed = vec![[0.0; LANES]; dimension];
        let mut bent = vec![[0.0; LANES]; dimension];
        for (number, (noise, normal)) in system.noises().iter().zip(normals).enumerate() {
            let amplitude = noise.amplitudes(0.0, &bundle.states);
            let change = slopes.of_noise(number, &bundle.deviations);
            for lane in 0..LANES {
                pushed[noise.axis][lane] += amplitude[lane] * root * normal[lane];
                bent[noise.axis][lane] += change[lane] * root * normal[lane];
            }
        }
        let ahead = |from: &[Lanes], rate: &[Lanes], noise: &[Lanes]| -> Vec<Lanes> {
            let of_axis = |axis: usize| {
                std::array::from_fn(|lane| {
                    from[axis][lane] + step * rate[axis][lane] + noise[axis][lane]
                })
            };
            (0..dimension).map(of_axis).collect()
        };
        let there = ahead(&bundle.states, &drift, &pushed);
        let deviations = ahead(&bundle.deviations, &turned, &bent);
        let later = self.tangent.slopes(&there);
        let turned_there = later.of_drift(&deviations);
        let mut drift_there = vec![[0.0; LANES]; dimension];
        system.drift(0.0, &there, &mut drift_there);
        for axis in 0..dimension {
            for lane in 0..LANES {
                bundle.states[axis][lane] +=
                    pushed[axis][lane] + 0.5 * step * (drift[axis][lane] + drift_there[axis][lane]);
                bundle.deviations[axis][lane] +=
                    bent[axis][lane] + 0.5 * step * (turned[axis][lane] + turned_there[axis][lane]);
            }
        }
        let [now, then] = [slopes, later].map(|slopes| slopes.divergence());
        for lane in 0..LANES {
            bundle.swollen[lane] += 0.5 * step * (now[lane] + then[lane]);
        }
    }
}

#[cfg(test)]
mod tests;
