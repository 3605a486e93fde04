//! States of equations of one's own that are noise with a memory, which modes carry at far less cost than cells.

use crate::system::System;

/// States at which an equation is looked at; coordinates take them in turn.
const LOOKS: [f64; 5] = [0.31, -0.83, 1.27, 0.58, -1.61];

/// What two readings of one number may differ by, as a share of it.
const ROUNDING: f64 = 1e-9;

/// Whether a state is an Ornstein-Uhlenbeck process that no other state acts on, z' = -c z + noise of one amplitude,
/// and acts as a force does: linearly, on one other state, beside no white noise.
pub(super) fn is_noise_with_memory(system: &dyn System, axis: usize) -> bool {
    let is_alone = system.noises().iter().all(|noise| noise.axis == axis);
    let readings: Vec<[f64; 2]> = (0..LOOKS.len())
        .map(|look| {
            let state = state_at(system, look);
            let rate = -system.drift_at(0.0, &state)[axis] / state[axis];
            [rate, system.intensity_at(axis, 0.0, &state)]
        })
        .collect();
    let first = readings[0];
    let is_same = |reading: &[f64; 2]| {
        let mut pairs = reading.iter().zip(first);
        pairs.all(|(a, b)| (a - b).abs() <= ROUNDING * b)
    };
    is_alone
        && first.iter().all(|value| *value > 0.0)
        && readings.iter().all(is_same)
        && is_force(system, axis)
}

/// A state of which no coordinate is zero.
fn state_at(system: &dyn System, look: usize) -> Vec<f64> {
    let place = |coordinate: usize| LOOKS[(look + coordinate * look + coordinate) % LOOKS.len()];
    (0..system.dimension()).map(place).collect()
}

/// Whether the drift of one other axis alone has the state in it, times a number.
fn is_force(system: &dyn System, axis: usize) -> bool {
    let factors_at = |look: usize| -> Vec<f64> {
        let state = state_at(system, look);
        let mut without = state.clone();
        without[axis] = 0.0;
        let pairs = system
            .drift_at(0.0, &state)
            .into_iter()
            .zip(system.drift_at(0.0, &without));
        let factors = pairs.map(|(with, without)| (with - without) / state[axis]);
        let others = factors.enumerate().filter(|(other, _)| *other != axis);
        others.map(|(_, factor)| factor).collect()
    };
    let first = factors_at(0);
    let is_same = |look: usize| {
        let pairs = factors_at(look);
        pairs
            .iter()
            .zip(&first)
            .all(|(a, b)| (a - b).abs() <= ROUNDING.sqrt() * b.abs().max(ROUNDING))
    };
    let acted_on = first
        .iter()
        .filter(|factor| factor.abs() > ROUNDING)
        .count();
    acted_on == 1 && (1..LOOKS.len()).all(is_same)
}

/// What such a state is better written as.
pub(super) fn better_written(name: &str) -> String {
    format!(
        "`{name}` is noise with a memory: of {name}' = -{name}/tau + s ξ leave the equation out, give the equation that it \
         acts in the noise \"s tau\" times its factor there, and `system.noise.kind = \"ornstein-uhlenbeck\"`, with the \
         parameter `tau`; modes then carry it, at far less cost (docs/coloured-noise.md)"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Interpretation, TypedModel};

    fn is(force: &str, z: &str, noise: &str, other: Option<&str>) -> bool {
        let typed = TypedModel::new("typed", "A typed system", ["x", "y", "z"])
            .with_equation("x", "y")
            .with_equation("y", format!("x - x^3 - 0.3 y + {force}"))
            .with_equation("z", z)
            .with_noise("z", [noise])
            .with_noise("y", other)
            .with_interpretation(Interpretation::Ito);
        let system = typed.build().unwrap().system_with(&[]).unwrap();
        assert!(!is_noise_with_memory(&*system, 0) && !is_noise_with_memory(&*system, 1));
        is_noise_with_memory(&*system, 2)
    }

    #[test]
    fn a_force_that_is_a_filter_of_first_order_is_known_and_no_other_state() {
        assert!(is("0.7 z", "-z/0.4", "0.3", None));
        for (force, z, noise, other) in [
            ("z", "-z/0.4 + 0.1 x", "0.3", None),
            ("z", "-z^3", "0.3", None),
            ("z", "-2 z", "0.3 + 0.1 z^2", None),
            ("z", "z", "0.3", None),
            ("z^2", "-2 z", "0.3", None),
            ("x z", "-2 z", "0.3", None),
            ("z", "-2 z", "0.3", Some("0.2")),
        ] {
            assert!(!is(force, z, noise, other), "{force}, {z}");
        }
    }
}
