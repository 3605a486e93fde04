//! Steps of a sweep by SGCM: given, or chosen from a pilot at both ends and in the middle of the sweep. One choice
//! serves the whole sweep, so that the transition matrix varies smoothly with the parameter.

use std::sync::Arc;

use super::SgcmOptions;
use crate::method::structure::{closed_ends, kinked_surfaces};
use crate::method::{MethodError, Problem, StepChoice, autonomous};
use crate::monte_carlo::{StepBias, TOLERATED_BIAS, automatic_step, relaxation, step_bias};
use crate::sampling::{Pilot, pilot};
use crate::space::CellSpace;
use crate::system::{SwitchingSurface, System};

/// Steps, and what else the pilots showed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Steps {
    /// Time one transition spans.
    pub(super) map_step: f64,
    /// Step of the integrator.
    pub(super) time_step: f64,
    /// Its bias, the most certain at both ends and in the middle of the sweep.
    pub(super) bias: Option<StepBias>,
    /// Cells to grow from: visited by a pilot somewhere along the sweep.
    pub(super) cells: Vec<usize>,
    /// Largest mean noise intensity b²/2 along the sweep, one value an axis.
    pub(super) noise: Vec<f64>,
    /// Whether the lower and upper end of each axis is a wall that the system cannot pass.
    pub(super) closed_ends: Vec<[bool; 2]>,
    /// Switching surfaces on which the density has a kink.
    pub(super) kinked: Vec<SwitchingSurface>,
}

pub(super) fn choose_steps(problem: &Problem, options: &SgcmOptions) -> Result<Steps, MethodError> {
    let (systems, space) = (problem.family().along()?, problem.space());
    autonomous(&systems)?;
    let pilots: Vec<Pilot> = systems
        .iter()
        .map(|system| pilot(system.as_ref(), space, options.seed))
        .collect();
    let (time_step, bias) = time_step(space, options, &systems);
    let map_step = match options.map_step {
        StepChoice::Fixed(step) => step,
        StepChoice::Auto => -smallest(&pilots, |pilot| -pilot.automatic_map_step(time_step)),
    };
    let mut cells: Vec<usize> = pilots
        .iter()
        .flat_map(|pilot| pilot.cells.clone())
        .collect();
    cells.sort_unstable();
    cells.dedup();
    let noise = (0..space.dimension())
        .map(|axis| -smallest(&pilots, |pilot| -pilot.noise_intensity[axis]))
        .collect();
    Ok(Steps {
        map_step,
        time_step,
        bias,
        cells,
        noise,
        closed_ends: closed_ends(&systems, space),
        kinked: kinked_surfaces(&systems, space),
    })
}

/// The time step, given or chosen, and its bias, by halving it on a sample of settled trajectories.
fn time_step(
    space: &CellSpace,
    options: &SgcmOptions,
    systems: &[Arc<dyn System>],
) -> (f64, Option<StepBias>) {
    let (seed, integrator) = (options.seed, options.integrator);
    let relaxed: Vec<_> = systems
        .iter()
        .map(|system| relaxation(system.as_ref(), space, seed))
        .collect();
    let ends = || systems.iter().zip(&relaxed);
    let step = options.time_step.or(|| {
        let steps = ends().map(|(system, relaxed)| {
            automatic_step(
                system.as_ref(),
                space,
                relaxed,
                integrator,
                TOLERATED_BIAS,
                seed,
            )
            .0
        });
        steps.fold(f64::INFINITY, f64::min)
    });
    let biases = ends().filter_map(|(system, relaxed)| {
        step_bias(system.as_ref(), space, relaxed, (integrator, step), seed)
    });
    let bias = biases.reduce(StepBias::worse);
    (step, bias)
}

fn smallest(pilots: &[Pilot], value: impl Fn(&Pilot) -> f64) -> f64 {
    pilots.iter().map(value).fold(f64::INFINITY, f64::min)
}
