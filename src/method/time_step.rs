//! The integrator's step of a sweep by trajectories, given or chosen, and its bias.

use std::sync::Arc;

use super::StepChoice;
use crate::monte_carlo::{Relaxation, StepBias, automatic_step, step_bias};
use crate::sampling::Integrator;
use crate::space::CellSpace;
use crate::system::System;

/// The longest step whose bias stays below `wanted` for all of some systems along a sweep, unless one is given; and its
/// bias, the most certain of theirs, by halving it on a sample of settled trajectories. `None` where nothing settles.
pub(super) fn time_step(
    (systems, relaxed): (&[Arc<dyn System>], &[Relaxation]),
    space: &CellSpace,
    choice: StepChoice,
    wanted: f64,
    (integrator, seed): (Integrator, u64),
) -> (f64, Option<StepBias>) {
    let all = || systems.iter().zip(relaxed);
    let step = choice.or(|| {
        let steps = all().map(|(system, relaxed)| {
            automatic_step(system.as_ref(), space, relaxed, integrator, wanted, seed).0
        });
        steps.fold(f64::INFINITY, f64::min)
    });
    let biases = all().filter_map(|(system, relaxed)| {
        step_bias(system.as_ref(), space, relaxed, (integrator, step), seed)
    });
    (step, biases.reduce(StepBias::worse))
}
