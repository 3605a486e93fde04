//! Overdamped motion in a quartic potential: the smallest model with a P-bifurcation, exactly solvable.

use std::sync::Arc;

use multiversion::multiversion;

use super::parameters::{GROWTH, SIGMA2, X};
use super::{Facts, Lanes, Model, Noise, Symmetry, System};

/// dx = (ax - x³) dt + σ dW.
pub(super) fn model() -> Model {
    Model::new(
        "bistable",
        "Overdamped particle in a quartic potential, exactly solvable",
        bind,
    )
    .with_equations(["dx = (a x - x³) dt + σ dW"])
    .with_axes([X])
    .with_parameters([GROWTH, SIGMA2])
    .with_source("textbook pitchfork normal form with additive noise")
    .with_notes([
        "The steady state is p ∝ exp((2/σ²)(a x²/2 - x⁴/4)): one peak for a ≤ 0, two for a > 0.",
    ])
}

fn bind(values: &[f64]) -> Arc<dyn System> {
    Arc::new(Bistable {
        a: values[0],
        sigma2: values[1],
        noise: [Noise::constant(0, values[1].sqrt())],
        facts: Facts {
            symmetry: Some(Symmetry::about_origin(1)),
            ..Facts::default()
        },
    })
}

struct Bistable {
    a: f64,
    sigma2: f64,
    noise: [Noise; 1],
    facts: Facts,
}

#[multiversion(targets = "simd")]
fn drift(a: f64, states: &[Lanes], drift: &mut [Lanes]) {
    let ([x], [x_slope]) = (states, drift) else {
        return;
    };
    for lane in 0..x.len() {
        let x = x[lane];
        x_slope[lane] = x * (a - x * x);
    }
}

impl System for Bistable {
    fn dimension(&self) -> usize {
        1
    }

    fn drift(&self, _time: f64, states: &[Lanes], slopes: &mut [Lanes]) {
        drift(self.a, states, slopes);
    }

    fn noises(&self) -> &[Noise] {
        &self.noise
    }

    fn facts(&self) -> &Facts {
        &self.facts
    }

    /// p ∝ exp((2/σ²)(ax²/2 - x⁴/4)).
    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        let &[x] = state else { return None };
        let square = x * x;
        Some(2.0 / self.sigma2 * square * (0.5 * self.a - 0.25 * square))
    }
}

#[cfg(test)]
mod tests {
    use super::super::contract::tests::{assert_stationary, bound};

    #[test]
    fn the_drift_is_the_equation() {
        let system = bound("bistable", &[("a", 0.5), ("sigma2", 0.25)]);
        assert_eq!(system.drift_at(0.0, &[2.0]), vec![-7.0]);
        assert_eq!(system.noises()[0].additive(), Some(0.5));
    }

    #[test]
    fn the_density_solves_fokker_planck_on_both_sides_of_the_bifurcation() {
        for a in [-0.7, 0.9] {
            let system = bound("bistable", &[("a", a), ("sigma2", 0.5)]);
            assert_stationary(&*system);
        }
    }
}
