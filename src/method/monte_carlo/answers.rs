//! What trajectories tell of phases and angles: moments at phases, amplitudes, mean velocities and effective
//! diffusions.

use crate::continuation::Measure;
use crate::continuation::measure::{TURN_DIFFUSION, VELOCITY};
use crate::density::{EstimatedMoments, Moments};
use crate::method::Problem;
use crate::method::forcing::Forced;
use crate::monte_carlo::{Estimate, StepBias};
use crate::system::System;

/// Mean and standard deviation of each axis at a phase, in the order of the phases that are watched.
pub(super) fn at_phases(problem: &Problem, found: &Estimate) -> Vec<EstimatedMoments> {
    let Some(periodic) = &found.periodic else {
        return Vec::new();
    };
    let moments = problem.family().at_phases().map(|(at, _)| {
        let part = (at.phase * periodic.parts() as f64).round() as usize;
        let [mean, deviation] = periodic.moments(at.axis, part % periodic.parts());
        let of = |mean: f64, standard_deviation: f64| Moments {
            mean,
            standard_deviation,
        };
        EstimatedMoments {
            moments: of(mean.0, deviation.0),
            errors: Some(of(mean.1, deviation.1)),
        }
    });
    moments.collect()
}

/// Velocities and diffusions of angles, amplitudes and amplifications of states. The relative bias of the time step is
/// a part of their errors.
pub(super) fn rotations_and_answers(
    problem: &Problem,
    system: &dyn System,
    found: &Estimate,
    bias: Option<StepBias>,
) -> Vec<Measure> {
    let family = problem.family();
    let bias = bias.map_or(0.0, |bias| bias.certain());
    let mut measures = Vec::new();
    for (axis, name) in family.angles() {
        let rotation = found.rotations.iter().find(|one| one.axis == axis);
        measures.extend(rotation.into_iter().flat_map(|rotation| {
            let both = [
                (VELOCITY, rotation.velocity),
                (TURN_DIFFUSION, rotation.diffusion),
            ];
            both.map(|(kind, (value, error))| Measure {
                error: Some(error + bias * value.abs()),
                ..kind.measure(name, value)
            })
        }));
    }
    if let (Some(periodic), Some(phase)) = (&found.periodic, family.model().phase_axis()) {
        let space = problem.space();
        let forced = Forced {
            system,
            space,
            phase,
        };
        measures.extend(forced.measures(family, |axis| {
            let (amplitude, error) = periodic.amplitude(axis);
            (amplitude, error + bias * amplitude)
        }));
    }
    measures
}
