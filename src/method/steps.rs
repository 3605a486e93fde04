//! Steps of a sweep by SGCM: given, or chosen from a pilot at both ends and in the middle of the sweep. One choice
//! serves the whole sweep, so that the transition matrix varies smoothly with the parameter.

use super::findings::closed_ends;
use super::structure::kinked_surfaces;
use super::{MethodError, Setting, SgcmOptions, StepChoice};
use crate::sampling::{Pilot, pilot};
use crate::system::SwitchingSurface;

/// Steps, and what else the pilots showed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Steps {
    /// Time one transition spans.
    pub(super) map_step: f64,
    /// Step of the integrator.
    pub(super) time_step: f64,
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
    setting: &Setting<'_>,
    options: &SgcmOptions,
) -> Result<Steps, MethodError> {
    let systems = setting.systems_along()?;
    let pilots: Vec<Pilot> = systems
        .iter()
        .map(|system| pilot(system.as_ref(), setting.space, options.seed))
        .collect();
    let time_step = match options.time_step {
        StepChoice::Fixed(step) => step,
        StepChoice::Auto => smallest(&pilots, |pilot| {
            pilot.automatic_time_step(options.integrator)
        }),
    };
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
    let noise = (0..setting.space.dimension())
        .map(|axis| -smallest(&pilots, |pilot| -pilot.noise_intensity[axis]))
        .collect();
    Ok(Steps {
        map_step,
        time_step,
        cells,
        noise,
        closed_ends: closed_ends(&systems, setting.space),
        kinked: kinked_surfaces(&systems, setting.space),
    })
}

fn smallest(pilots: &[Pilot], value: impl Fn(&Pilot) -> f64) -> f64 {
    pilots.iter().map(value).fold(f64::INFINITY, f64::min)
}
