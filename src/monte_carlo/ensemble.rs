//! The density at one time, by many trajectories from a start region: what the paper calls Monte Carlo.

use super::batch::{Limits, Purpose};
use super::ergodic::{ErgodicRun, Starts, Worker, whole};
use super::{Estimate, MonteCarloError};
use crate::cancellation::Cancellation;
use crate::sampling::{CellLookup, Integrator, Stepper, WholeTurn};
use crate::space::CellSpace;
use crate::system::System;

/// A run of many trajectories to one time.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsembleRun {
    /// Step of the integrator.
    pub time_step: f64,
    /// The integrator.
    pub integrator: Integrator,
    /// Seed of the random streams.
    pub seed: u64,
    /// Trajectories, rounded up to a multiple of [`crate::system::LANES`].
    pub trajectories: usize,
    /// Time at which the trajectories are counted, to within two steps.
    pub time: f64,
    /// Where they start, uniformly: one range an axis (a point where both ends agree); empty for all of Ω.
    pub start: Vec<(f64, f64)>,
}

/// Estimates the density at one time on the cells of a space, conditioned on Ω: a histogram of independent states,
/// whose errors are multinomial. Trajectories that leave Ω keep running, and those that run away are counted; see
/// [`ergodic`](super::ergodic()). Blocks for the errors are batches of trajectories: give at least some hundred.
///
/// # Errors
/// [`MonteCarloError`].
pub fn ensemble(
    system: &dyn System,
    space: &CellSpace,
    run: &EnsembleRun,
    cancellation: &Cancellation,
) -> Result<Estimate, MonteCarloError> {
    // One look, a pair of steps after the rest.
    let stride = 2;
    let last = stride as f64 * run.time_step;
    let as_ergodic = ErgodicRun {
        time_step: run.time_step,
        integrator: run.integrator,
        seed: run.seed,
        trajectories: run.trajectories,
        burn_in: if run.time > last {
            run.time - last
        } else {
            run.time
        },
        // Less than a stride, so that it is rounded up to one look.
        length: 0.5 * last,
        stride,
    };
    if system.facts().phase.is_some() {
        return Err(MonteCarloError::Ensemble);
    }
    as_ergodic.check(system, space)?;
    if !run.start.is_empty() && run.start.len() != space.dimension() {
        return Err(MonteCarloError::Start);
    }
    let worker = Worker {
        stepper: Stepper::new(system, run.integrator, run.time_step, cancellation),
        lookup: &CellLookup::new(space),
        limits: Limits::new(space),
        starts: Starts::Box(if run.start.is_empty() {
            whole(space)
        } else {
            run.start.clone()
        }),
        purpose: Purpose::Ensemble,
        turns: WholeTurn::of(system),
        phases: None,
        run: &as_ergodic,
    };
    worker.all(space)
}
