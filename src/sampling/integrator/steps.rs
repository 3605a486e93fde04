//! The loops over steps, compiled for each set of instructions.

use multiversion::multiversion;

use super::Stepper;
use crate::MAX_DIMENSION;
use crate::system::{LANES, Lanes};

/// Room for what a step works out, a row an axis.
#[repr(align(64))]
pub(super) struct Scratch {
    /// Zero on axes without noise.
    increments: [Lanes; MAX_DIMENSION],
    start: [Lanes; MAX_DIMENSION],
    end: [Lanes; MAX_DIMENSION],
}

impl Scratch {
    pub(super) fn new() -> Self {
        let rows = [[0.0; LANES]; MAX_DIMENSION];
        Self {
            increments: rows,
            start: rows,
            end: rows,
        }
    }
}

/// Steps of Heun's of all axes, or of those that are no positions between half steps of these.
#[multiversion(targets = "simd")]
pub(super) fn heun(
    stepper: &Stepper<'_>,
    states: &mut [Lanes],
    first: usize,
    steps: usize,
    normals: &[Lanes],
    scratch: &mut Scratch,
) {
    let (dimension, channels) = (states.len(), stepper.noise.len());
    let (step, half) = (stepper.time_step, 0.5 * stepper.time_step);
    let Scratch {
        increments,
        start,
        end,
    } = scratch;
    let (start, end) = (&mut start[..dimension], &mut end[..dimension]);
    stepper.move_positions(states, half);
    for number in 0..steps {
        let time = (first + number) as f64 * step;
        // Time is a position too.
        let times = match stepper.positions.is_empty() {
            true => [time, time + step],
            false => [time + half; 2],
        };
        let normals = &normals[number * channels..(number + 1) * channels];
        stepper.system.drift(times[0], states, start);
        stepper.increments(times[0], states, normals, increments);
        // States become those of the predictor x + dt F(x) + b ΔW, and then go on by dt/2 (F(predictor) - F(x)).
        stepper.predict(states, start, normals, increments);
        stepper.drift_beyond(times[1], states, end);
        for &axis in &stepper.rest {
            for lane in 0..LANES {
                states[axis][lane] += half * (end[axis][lane] - start[axis][lane]);
            }
        }
        // A velocity at a wall is turned round before it moves anything.
        stepper.reflect(states);
        stepper.move_positions(states, if number + 1 < steps { step } else { half });
        stepper.turn_back(states);
    }
}

#[multiversion(targets = "simd")]
pub(super) fn euler_maruyama(
    stepper: &Stepper<'_>,
    states: &mut [Lanes],
    first: usize,
    steps: usize,
    normals: &[Lanes],
    scratch: &mut Scratch,
) {
    let (dimension, channels) = (states.len(), stepper.noise.len());
    let step = stepper.time_step;
    let Scratch {
        increments, start, ..
    } = scratch;
    let start = &mut start[..dimension];
    for number in 0..steps {
        let time = (first + number) as f64 * step;
        let normals = &normals[number * channels..(number + 1) * channels];
        stepper.increments(time, states, normals, increments);
        stepper.system.drift(time, states, start);
        stepper.predict(states, start, normals, increments);
        stepper.reflect(states);
        stepper.turn_back(states);
    }
}
