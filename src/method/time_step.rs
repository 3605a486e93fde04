//! The integrator's step of a sweep by trajectories, given or chosen, and its bias.

use std::sync::Arc;

use crate::cancellation::{Cancellation, Cancelled};
use crate::monte_carlo::{Relaxation, StepBias, automatic_step, step_bias};
use crate::sampling::Integrator;
use crate::space::CellSpace;
use crate::system::System;

/// The longest step whose bias stays below `wanted` for all of some systems along a sweep, unless one is given; and its
/// bias, the most certain of theirs, by halving it on a sample of settled trajectories. `None` where nothing settles.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn time_step(
    (systems, relaxed): (&[Arc<dyn System>], &[Relaxation]),
    space: &CellSpace,
    choice: StepChoice,
    wanted: f64,
    (integrator, seed): (Integrator, u64),
    cancellation: &Cancellation,
) -> Result<(f64, Option<StepBias>), Cancelled> {
    let all = || systems.iter().zip(relaxed);
    let step = match choice {
        StepChoice::Fixed(step) => step,
        StepChoice::Auto => {
            let mut shortest = f64::INFINITY;
            for (system, relaxed) in all() {
                let wanted = (integrator, wanted);
                let found =
                    automatic_step(system.as_ref(), space, relaxed, wanted, seed, cancellation)?;
                shortest = shortest.min(found.0);
            }
            shortest
        }
    };
    let mut worst: Option<StepBias> = None;
    for (system, relaxed) in all() {
        let step = (integrator, step);
        let bias = step_bias(system.as_ref(), space, relaxed, step, seed, cancellation)?;
        worst = worst.into_iter().chain(bias).reduce(StepBias::worse);
    }
    Ok((step, worst))
}

/// A step (a time, a number of trajectories) that is given, or left to the program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepChoice {
    /// Chosen from the system, the cells and the noise.
    Auto,
    /// Given; times in the system's unit of time.
    Fixed(f64),
}

impl StepChoice {
    /// What is given, or else what is chosen.
    pub(super) fn or(self, chosen: impl FnOnce() -> f64) -> f64 {
        match self {
            Self::Auto => chosen(),
            Self::Fixed(value) => value,
        }
    }
}
