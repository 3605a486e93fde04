//! States of equations of one's own that are noise with a memory, which modes carry at far less cost than cells.

use crate::system::System;

/// States at which an equation is looked at; coordinates take them in turn.
const LOOKS: [f64; 5] = [0.31, -0.83, 1.27, 0.58, -1.61];

/// What two readings of one number may differ by, as a share of it.
const ROUNDING: f64 = 1e-9;

/// Whether a state is an Ornstein-Uhlenbeck process that no other state acts on: z' = -c z + noise of one amplitude.
pub(super) fn is_noise_with_memory(system: &dyn System, axis: usize) -> bool {
    let state = |look: usize| -> Vec<f64> {
        let place =
            |coordinate: usize| LOOKS[(look + coordinate * look + coordinate) % LOOKS.len()];
        (0..system.dimension()).map(place).collect()
    };
    let noises: Vec<_> = system
        .noises()
        .iter()
        .filter(|noise| noise.axis == axis)
        .collect();
    let readings = (0..LOOKS.len()).map(|look| {
        let state = state(look);
        let rate = -system.drift_at(0.0, &state)[axis] / state[axis];
        let amplitude: f64 = noises
            .iter()
            .map(|noise| noise.at(0.0, &state).powi(2))
            .sum();
        [rate, amplitude]
    });
    let readings: Vec<[f64; 2]> = readings.collect();
    let first = readings[0];
    let is_same = |reading: &[f64; 2]| {
        let mut pairs = reading.iter().zip(first);
        pairs.all(|(a, b)| (a - b).abs() <= ROUNDING * b)
    };
    !noises.is_empty() && first.iter().all(|value| *value > 0.0) && readings.iter().all(is_same)
}

/// What such a state is better written as.
pub(super) fn better_written(name: &str) -> String {
    format!(
        "`{name}` is noise with a memory: leave its equation out, let its force be the noise of the equation that it \
         acts in, and give `system.noise.kind = \"ornstein-uhlenbeck\"` with the parameter `tau`; modes then carry it, \
         at far less cost (docs/coloured-noise.md)"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::TypedModel;

    #[test]
    fn a_filter_of_first_order_is_known_and_no_other_state() {
        let is = |z: &str, noise: &str| {
            let typed = TypedModel::new("typed", "A typed system", ["x", "y", "z"])
                .with_equation("x", "y")
                .with_equation("y", "x - x^3 - 0.3 y + z")
                .with_equation("z", z)
                .with_noise("z", [noise])
                .with_interpretation(crate::system::Interpretation::Ito);
            let system = typed.build().unwrap().system_with(&[]).unwrap();
            assert!(!is_noise_with_memory(&*system, 0) && !is_noise_with_memory(&*system, 1));
            is_noise_with_memory(&*system, 2)
        };
        assert!(is("-z/0.4", "0.3"));
        for (z, noise) in [
            ("-z/0.4 + 0.1 x", "0.3"),
            ("-z^3", "0.3"),
            ("-2 z", "0.3 + 0.1 z^2"),
            ("z", "0.3"),
        ] {
            assert!(!is(z, noise), "{z}");
        }
    }
}
