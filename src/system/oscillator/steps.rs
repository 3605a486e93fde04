//! Steps of an oscillator's trajectories in one loop with its drift, compiled for each pair of damping and law: a state
//! is loaded and stored once a step, and what both stages of a step share is worked out once.

use multiversion::multiversion;

use super::{Damping, Oscillator};
use crate::system::compiled_steps::{CompiledSteps, StepScheme};
use crate::system::friction::{FrictionLaw, Motion};
use crate::system::{LANES, Lanes};

impl<D: Damping, F: FrictionLaw<N>, const N: usize> CompiledSteps for Oscillator<D, F, N> {
    fn advance(
        &self,
        scheme: StepScheme,
        time_step: f64,
        increment: f64,
        states: &mut [Lanes],
        normals: &[Lanes],
    ) {
        match scheme {
            StepScheme::Heun => heun(self, time_step, increment, states, normals),
            StepScheme::Splitting => splitting(self, time_step, increment, states, normals),
        }
    }

    fn shift(&self, time_step: f64, sign: f64, states: &[Lanes], shifted: &mut [Lanes]) {
        shift(self, time_step, sign, states, shifted);
    }
}

/// One state of a batch: its motion and its internal states.
type State<const N: usize> = (Motion, [f64; N]);

#[inline(always)]
fn state_of<const N: usize>(x: &Lanes, y: &Lanes, z: &[Lanes; N], lane: usize) -> State<N> {
    let motion = Motion {
        displacement: x[lane],
        velocity: y[lane],
    };
    let mut internal = [0.0; N];
    for index in 0..N {
        internal[index] = z[index][lane];
    }
    (motion, internal)
}

#[multiversion(targets = "simd")]
fn splitting<D: Damping, F: FrictionLaw<N>, const N: usize>(
    oscillator: &Oscillator<D, F, N>,
    step: f64,
    increment: f64,
    states: &mut [Lanes],
    normals: &[Lanes],
) {
    let [x, y, z @ ..] = states else {
        return;
    };
    let Ok(z) = <&mut [Lanes; N]>::try_from(z) else {
        return;
    };
    let half = 0.5 * step;
    for lane in 0..LANES {
        x[lane] += half * y[lane];
    }
    let steps = normals.len();
    for (number, normals) in normals.iter().enumerate() {
        let time = if number + 1 < steps { step } else { half };
        for lane in 0..LANES {
            let (motion, internal) = state_of(x, y, z, lane);
            let (force, rates) = oscillator.slopes(motion, &internal);
            let mut predicted = internal;
            for index in 0..N {
                predicted[index] += step * rates[index];
            }
            let predictor = Motion {
                velocity: motion.velocity + (step * force + increment * normals[lane]),
                ..motion
            };
            let (end_force, end_rates) = oscillator.slopes(predictor, &predicted);
            let velocity = predictor.velocity + half * (end_force - force);
            for index in 0..N {
                z[index][lane] = predicted[index] + half * (end_rates[index] - rates[index]);
            }
            y[lane] = velocity;
            x[lane] = motion.displacement + time * velocity;
        }
    }
}

#[multiversion(targets = "simd")]
fn heun<D: Damping, F: FrictionLaw<N>, const N: usize>(
    oscillator: &Oscillator<D, F, N>,
    step: f64,
    increment: f64,
    states: &mut [Lanes],
    normals: &[Lanes],
) {
    let [x, y, z @ ..] = states else {
        return;
    };
    let Ok(z) = <&mut [Lanes; N]>::try_from(z) else {
        return;
    };
    let half = 0.5 * step;
    for normals in normals {
        for lane in 0..LANES {
            let (motion, internal) = state_of(x, y, z, lane);
            let (force, rates) = oscillator.slopes(motion, &internal);
            let mut predicted = internal;
            for index in 0..N {
                predicted[index] += step * rates[index];
            }
            let predictor = Motion {
                displacement: motion.displacement + step * motion.velocity,
                velocity: motion.velocity + (step * force + increment * normals[lane]),
            };
            let (end_force, end_rates) = oscillator.slopes(predictor, &predicted);
            for index in 0..N {
                z[index][lane] = predicted[index] + half * (end_rates[index] - rates[index]);
            }
            x[lane] = predictor.displacement + half * (predictor.velocity - motion.velocity);
            y[lane] = predictor.velocity + half * (end_force - force);
        }
    }
}

#[multiversion(targets = "simd")]
fn shift<D: Damping, F: FrictionLaw<N>, const N: usize>(
    oscillator: &Oscillator<D, F, N>,
    step: f64,
    sign: f64,
    states: &[Lanes],
    shifted: &mut [Lanes],
) {
    let ([x, y, z @ ..], [_, velocity, internal @ ..]) = (states, shifted) else {
        return;
    };
    let (Ok(z), Ok(internal)) = (
        <&[Lanes; N]>::try_from(z),
        <&mut [Lanes; N]>::try_from(internal),
    ) else {
        return;
    };
    let (half, eighth) = (0.5 * step, 0.125 * step);
    // A drift that is not finite shifts nothing.
    let shift_of = |up: f64, down: f64| {
        let shift = eighth * (up - down);
        if shift.is_finite() { sign * shift } else { 0.0 }
    };
    for lane in 0..LANES {
        let (motion, state) = state_of(x, y, z, lane);
        let moved = |time: f64| Motion {
            displacement: motion.displacement + time * motion.velocity,
            ..motion
        };
        let (force_up, rates_up) = oscillator.slopes(moved(half), &state);
        let (force_down, rates_down) = oscillator.slopes(moved(-half), &state);
        velocity[lane] += shift_of(force_up, force_down);
        for index in 0..N {
            internal[index][lane] += shift_of(rates_up[index], rates_down[index]);
        }
    }
}
