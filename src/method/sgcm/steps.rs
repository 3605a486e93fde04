//! Steps of a sweep by SGCM: given, or chosen from a pilot at both ends and in the middle of the sweep. One choice
//! serves the whole sweep, so that the transition matrix varies smoothly with the parameter.

use super::SgcmOptions;
use super::phases::PhaseMap;
use crate::cancellation::Cancellation;
use crate::method::structure::{closed_ends, kinked_surfaces};
use crate::method::time_step::time_step;
use crate::method::{MethodError, Problem, StepChoice, has_densities};
use crate::monte_carlo::{Relaxation, StepBias, TOLERATED_BIAS, relaxation};
use crate::sampling::{Pilot, pilot};
use crate::system::SwitchingSurface;

/// Steps, and what else the pilots showed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Steps {
    /// Time one transition spans; of a forced system where it is shortest.
    pub(super) map_step: f64,
    /// How the phase of a forcing is mapped.
    pub(super) phase: Option<PhaseMap>,
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

pub(super) fn choose_steps(
    problem: &Problem,
    options: &SgcmOptions,
    cancellation: &Cancellation,
) -> Result<Steps, MethodError> {
    let (systems, space) = (problem.family().along()?, problem.space());
    has_densities(problem)?;
    let (mut pilots, mut relaxed) = (Vec::<Pilot>::new(), Vec::<Relaxation>::new());
    for system in &systems {
        let (system, seed) = (system.as_ref(), options.seed);
        pilots.push(pilot(system, space, seed, cancellation)?);
        relaxed.push(relaxation(system, space, seed, cancellation)?);
    }
    let (mut time_step, bias) = time_step(
        (&systems, &relaxed),
        space,
        options.time_step,
        TOLERATED_BIAS,
        (options.integrator, options.seed),
        cancellation,
    )?;
    let longest = || {
        largest(&pilots, |pilot| {
            pilot.automatic_map_step(time_step, options.samples)
        })
    };
    let map_step = options.map_step.or(longest);
    let all = systems.iter().map(AsRef::as_ref);
    let phase = PhaseMap::choose(all, space, (options.map_step, map_step));
    if let (Some(phase), StepChoice::Auto) = (&phase, options.time_step) {
        time_step = time_step.min(phase.longest_step());
    }
    let mut cells: Vec<usize> = pilots
        .iter()
        .flat_map(|pilot| pilot.cells.clone())
        .collect();
    cells.sort_unstable();
    cells.dedup();
    let noise = (0..space.dimension())
        .map(|axis| largest(&pilots, |pilot| pilot.noise_intensity[axis]))
        .collect();
    Ok(Steps {
        map_step: phase.map_or(map_step, |phase| phase.map_step()),
        phase,
        time_step,
        bias,
        cells,
        noise,
        closed_ends: closed_ends(&systems, space),
        kinked: kinked_surfaces(&systems, space),
    })
}

fn largest(pilots: &[Pilot], value: impl Fn(&Pilot) -> f64) -> f64 {
    pilots.iter().map(value).fold(f64::NEG_INFINITY, f64::max)
}
