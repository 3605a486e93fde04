//! Oscillator whose damping depends on its energy: its steady state is known exactly (Caughey and Ma).

use std::sync::Arc;

use super::friction::Frictionless;
use super::parameters::{ALPHA, GROWTH, MU, SATURATION, SIGMA2, X, Y};
use super::{Damping, Duffing, Model, Oscillator, System};

/// x' = y, y' = -(-a + bH)y - αx - μx³ + ξ, H the energy.
pub(super) fn model() -> Model {
    Model::new("rayleigh", "Oscillator with energy-dependent damping, exactly solvable", bind)
        .with_equations([
            "x' = y",
            "y' = -(-a + b H) y - α x - μ x³ + ξ(t)",
            "H = y²/2 + α x²/2 + μ x⁴/4",
            "E[ξ(t) ξ(t+τ)] = σ² δ(τ)",
        ])
        .with_axes([X, Y])
        .with_parameters([GROWTH, SATURATION, ALPHA, MU, SIGMA2])
        .with_source("T. K. Caughey and F. Ma, The exact steady-state solution of a class of non-linear stochastic systems (1982)")
        .with_notes([
            "The steady state is p ∝ exp(-(2/σ²)(-a H + b H²/2)): with α > 0 and μ ≥ 0 the joint density has one peak for a ≤ 0 and a crater for a > 0.",
        ])
}

fn bind(values: &[f64]) -> Arc<dyn System> {
    let (alpha, mu) = (values[2], values[3]);
    let damping = EnergyDamping {
        growth: values[0],
        saturation: values[1],
    };
    let spring = Duffing { alpha, mu };
    Arc::new(Oscillator::new(spring, damping, Frictionless, values[4]))
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

    fn integral(&self, energy: f64) -> f64 {
        energy * (0.5 * self.saturation * energy - self.growth)
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
