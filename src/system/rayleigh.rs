//! Oscillator whose damping depends on its energy: its steady state is known exactly (Caughey and Ma).

use super::TypedModel;
use super::friction::{Frictionless, Motion};
use super::oscillator::{Damping, Duffing, Oscillator, oscillator};
use super::parameters::{ALPHA, GROWTH, MU, NO_STATES, SATURATION, SIGMA2};

/// x' = y, y' = -(-a + bH)y - αx - μx³ + ξ, H the energy.
pub(super) fn model() -> TypedModel {
    let title = "Oscillator with energy-dependent damping, exactly solvable";
    let parameters = [GROWTH, SATURATION, ALPHA, MU, SIGMA2];
    oscillator(("rayleigh", title), "-(-a + b H) y - α x - μ x³", NO_STATES, parameters)
        .with_definition("H", "y²/2 + α x²/2 + μ x⁴/4")
        .with_compiled_oscillator(|values| {
            let (damping, spring) = parts(values);
            let friction = Frictionless;
            Oscillator { spring, damping, friction }.compiled()
        })
        .with_exact_log_density(exact_log_density)
        .with_source("T. K. Caughey and F. Ma, The exact steady-state solution of a class of non-linear stochastic systems (1982)")
        .with_notes([
            "The steady state is p ∝ exp(-(2/σ²)(-a H + b H²/2)): with α > 0 and μ ≥ 0 the joint density has one peak for a ≤ 0 and a crater for a > 0.",
        ])
}

fn parts(values: &[f64]) -> (EnergyDamping, Duffing) {
    let damping = EnergyDamping {
        growth: values[0],
        saturation: values[1],
    };
    let spring = Duffing {
        alpha: values[2],
        mu: values[3],
    };
    (damping, spring)
}

/// p ∝ exp(-(2/σ²) ∫₀ᴴ h dH).
fn exact_log_density(values: &[f64], state: &[f64]) -> Option<f64> {
    let &[displacement, velocity] = state else {
        return None;
    };
    let (damping, spring) = parts(values);
    let energy = spring.energy(Motion {
        displacement,
        velocity,
    });
    let integral = energy * (0.5 * damping.saturation * energy - damping.growth);
    Some(-2.0 / values[4] * integral)
}

/// h = -a + bH.
#[derive(Debug, Clone, Copy, PartialEq)]
struct EnergyDamping {
    growth: f64,
    saturation: f64,
}

impl Damping for EnergyDamping {
    #[inline(always)]
    fn coefficient(&self, energy: f64) -> f64 {
        self.saturation * energy - self.growth
    }
}

#[cfg(test)]
mod tests {
    use super::super::contract::tests::{assert_stationary, bound};

    #[test]
    fn the_drift_is_the_equation() {
        let values = [("a", 0.5), ("b", 0.25), ("mu", 2.0), ("sigma2", 0.09)];
        let system = bound("rayleigh", &values);
        // H = 9/2 + 4/2 + 2·16/4 = 14.5; y' = -(-0.5 + 3.625)·3 - 2 - 16 = -27.375.
        let drift = system.drift_at(0.0, &[2.0, 3.0]);
        assert_eq!(drift, vec![3.0, -27.375]);
    }

    #[test]
    fn the_density_solves_fokker_planck_on_both_sides_of_the_bifurcation() {
        for a in [-0.4, 0.6] {
            let values = [("a", a), ("b", 0.3), ("mu", 0.2), ("sigma2", 0.5)];
            assert_stationary(&*bound("rayleigh", &values));
        }
    }
}
