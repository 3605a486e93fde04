//! What Monte Carlo does at every parameter value of a sweep, chosen once from trajectories at both ends and in the
//! middle.

use std::sync::Arc;

use super::{Estimator, MonteCarloOptions};
use crate::cancellation::{Cancellation, Cancelled};
use crate::method::time_step::time_step;
use crate::monte_carlo::{ErgodicRun, Relaxation, StepBias};
use crate::sampling::part_of_period;
use crate::space::CellSpace;
use crate::system::{LANES, System};

/// Trajectories of a time average: every core has several batches, and burn-in stays a small part.
const TRAJECTORIES: f64 = 2048.0;

/// Autocorrelation times of burn-in: e⁻¹² = 6e-6 of the start is left.
const BURN_IN: f64 = 12.0;

/// The same under a forcing: there means oscillate, which forget at half of the rate at which variances do.
const BURN_IN_OF_MEANS: f64 = 24.0;

/// Shortest time, in burn-ins, over which it is watched how angles turn: eight windows.
const TURNING: f64 = 4.0;

/// Share of the wanted error that an automatic time step may add as bias.
const BIAS_SHARE: f64 = 0.5;

/// What is done at every parameter value: one plan serves a sweep, so that densities vary smoothly along it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MonteCarloPlan {
    /// Step of the integrator.
    pub time_step: f64,
    /// Its bias, the largest at both ends and in the middle of the sweep; `None` where nothing settles there.
    pub bias: Option<StepBias>,
    /// Longest autocorrelation time found there.
    pub relaxation_time: f64,
    /// Whether these times could be measured.
    pub relaxation_resolved: bool,
    /// Number of trajectories.
    pub trajectories: usize,
    /// Time before states are counted.
    pub burn_in: f64,
    /// Time during which the states of a trajectory are counted; zero for an ensemble.
    pub length: f64,
    /// Steps between two looks at a trajectory.
    pub stride: usize,
    /// Relative standard error of the variances to be expected.
    pub error: f64,
}

impl MonteCarloPlan {
    /// Step of the integrator for a system: of a forced one the stride lasts one part of its period.
    pub(super) fn step_of(&self, system: &dyn System, space: &CellSpace) -> f64 {
        part_of_period(system, space).map_or(self.time_step, |part| part / self.stride as f64)
    }

    /// Integrator steps of all trajectories at one parameter value.
    pub(crate) fn steps(&self) -> f64 {
        self.trajectories as f64 * (self.burn_in + self.length) / self.time_step
    }

    /// Chooses what is left to the program, for some systems along a sweep and how they relax.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub(super) fn choose(
        systems: &[Arc<dyn System>],
        space: &CellSpace,
        relaxed: &[Relaxation],
        options: &MonteCarloOptions,
        cancellation: &Cancellation,
    ) -> Result<Self, Cancelled> {
        let (time_step, bias) = time_step(
            (systems, relaxed),
            space,
            options.time_step,
            BIAS_SHARE * options.error,
            (options.integrator, options.seed),
            cancellation,
        )?;
        let relaxation_time = relaxed.iter().map(|one| one.time).fold(0.0, f64::max);
        let strides = relaxed.iter().map(|one| ErgodicRun::stride(one, time_step));
        let mut stride = strides.min().unwrap_or(2);
        let mut spacing = stride as f64 * time_step;
        let longest = longest_part(systems, space);
        let is_forced = longest.is_some();
        if let Some(longest) = longest {
            stride = 2 * (0.5 * longest / time_step).ceil() as usize;
            spacing = longest;
        }
        let relaxations = if is_forced { BURN_IN_OF_MEANS } else { BURN_IN };
        let burn_in = options.burn_in.or(|| relaxations * relaxation_time);
        let mut amount = match options.estimator {
            Estimator::Ergodic => ergodic(options, relaxed, (spacing, is_forced)),
            Estimator::Ensemble => ensemble(options, relaxed),
        };
        let angles = |system: &Arc<dyn System>| {
            let facts = system.facts();
            facts.turns.keys().any(|axis| facts.phase != Some(*axis))
        };
        if options.estimator == Estimator::Ergodic && systems.iter().any(angles) {
            let longest = amount.length.max(TURNING * burn_in);
            amount.length = options.length.or(|| longest);
        }
        Ok(Self {
            time_step,
            bias,
            relaxation_time,
            relaxation_resolved: relaxed.iter().all(|one| one.resolved),
            trajectories: amount.trajectories as usize,
            burn_in,
            length: amount.length,
            stride,
            error: amount.error,
        })
    }

    /// The plan in words.
    pub(super) fn describe(&self, estimator: Estimator) -> String {
        format!(
            "monte-carlo ({}), {} trajectories of {:.0} after {:.0}, time step {:.4}, a look every {} steps: {:.1e} steps a point",
            estimator.name(),
            self.trajectories,
            self.length,
            self.burn_in,
            self.time_step,
            self.stride,
            self.steps()
        )
    }
}

/// The longest time between looks at a forced system along a sweep; and no shorter than some steps that follow the
/// forcing.
fn longest_part(systems: &[Arc<dyn System>], space: &CellSpace) -> Option<f64> {
    let parts = systems.iter();
    let parts = parts.filter_map(|system| part_of_period(system.as_ref(), space));
    parts.reduce(f64::max)
}

/// How much is run, and the relative standard error of the variances that it gives.
struct Amount {
    trajectories: f64,
    length: f64,
    error: f64,
}

/// Long trajectories: the wanted error needs a total time. Each is looked at once at least.
fn ergodic(
    options: &MonteCarloOptions,
    relaxed: &[Relaxation],
    (shortest, is_sparse): (f64, bool),
) -> Amount {
    // Total time that makes the relative error of every variance one.
    let times = relaxed.iter().map(|one| one.time);
    let averaging = relaxed.iter().flat_map(|one| &one.averaging_time).copied();
    // Looks that are far apart know no more than independent states do.
    let independent = relaxed.iter().map(|one| one.relative_square() * shortest);
    let averaging = times.chain(averaging).fold(0.0, f64::max);
    let averaging = match is_sparse {
        true => independent.fold(averaging, f64::max),
        false => averaging,
    };
    let trajectories = whole_batches(options.trajectories.or(|| TRAJECTORIES));
    let wanted = averaging / (options.error * options.error);
    let length = options.length.or(|| (wanted / trajectories).max(shortest));
    Amount {
        trajectories,
        length,
        error: (averaging / (trajectories * length)).sqrt(),
    }
}

/// Many trajectories looked at once: the wanted error needs a number of them.
fn ensemble(options: &MonteCarloOptions, relaxed: &[Relaxation]) -> Amount {
    let kurtosis = relaxed.iter().map(Relaxation::relative_square);
    let kurtosis = kurtosis.fold(1.0, f64::max);
    let wanted = || kurtosis / (options.error * options.error);
    let trajectories = whole_batches(options.trajectories.or(wanted));
    Amount {
        trajectories,
        length: 0.0,
        error: (kurtosis / trajectories).sqrt(),
    }
}

fn whole_batches(trajectories: f64) -> f64 {
    let lanes = LANES as f64;
    (trajectories / lanes).ceil().clamp(1.0, 1e9) * lanes
}
