//! Overdamped motion in a quartic potential: the smallest model with a P-bifurcation, exactly solvable.

use multiversion::multiversion;

use super::parameters::{GROWTH, SIGMA2, X};
use super::typed::statement::AMPLITUDE;
use super::{Lanes, TypedModel};

/// x' = ax - x³ + σ ξ.
pub(super) fn model() -> TypedModel {
    let title = "Overdamped particle in a quartic potential, exactly solvable";
    TypedModel::new("bistable", title, [X])
        .with_equation("x", "a x - x³")
        .with_noise("x", [AMPLITUDE])
        .with_definition(AMPLITUDE, "sqrt(sigma2)")
        .with_parameters([GROWTH, SIGMA2])
        .with_compiled_drift(|values| {
            let a = values[0];
            Box::new(move |_, states, slopes| drift(a, states, slopes))
        })
        .with_exact_log_density(exact_log_density)
        .with_source("textbook pitchfork normal form with additive noise")
        .with_notes([
            "The steady state is p ∝ exp((2/σ²)(a x²/2 - x⁴/4)): one peak for a ≤ 0, two for a > 0.",
        ])
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

/// p ∝ exp((2/σ²)(ax²/2 - x⁴/4)).
fn exact_log_density(values: &[f64], state: &[f64]) -> Option<f64> {
    let (&[a, sigma2], &[x]) = (values, state) else {
        return None;
    };
    let square = x * x;
    Some(2.0 / sigma2 * square * (0.5 * a - 0.25 * square))
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
