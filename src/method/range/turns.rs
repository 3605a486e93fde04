//! Systems that are the same a turn of 2π further along an axis, as a pendulum's equations are. Along such an axis
//! there is no stationary density: moved by a turn it would be another one. It is one of an angle.

use std::f64::consts::TAU;

use crate::system::System;

/// States at which the system is looked at.
const STATES: usize = 8;
/// The relative difference that is rounding.
const ROUNDING: f64 = 1e-9;

/// Whether drift and noise depend on the coordinate of an axis and are the same a turn of 2π further, at states of
/// which none is special.
pub(crate) fn repeats_along(system: &dyn System, axis: usize) -> bool {
    let rates = |state: &[f64]| {
        let noises = (0..state.len()).map(|axis| system.intensity_at(axis, 0.0, state));
        let mut rates = system.drift_at(0.0, state);
        rates.extend(noises);
        rates
    };
    let changes_after = |turn: f64| {
        let states = (0..STATES).map(|state| -> Vec<f64> {
            let coordinates = (0..system.dimension()).map(|axis| axis as f64);
            coordinates
                .map(|axis| 0.3 + 0.45 * state as f64 - 0.2 * axis)
                .collect()
        });
        states.into_iter().any(|mut state| {
            let before = rates(&state);
            state[axis] += turn;
            let pairs = before.into_iter().zip(rates(&state));
            let mut differences =
                pairs.map(|(before, after)| (after - before) / (1.0 + before.abs()));
            !differences.all(|difference| difference.abs() < ROUNDING)
        })
    };
    changes_after(1.0) && !changes_after(TAU)
}
