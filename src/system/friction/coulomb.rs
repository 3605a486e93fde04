//! Coulomb's dry friction: a force of constant size against the velocity (the paper's first example).
//!
//! Convention of the paper's Eq. (7): κ is the viscous damping, α the linear stiffness.

use super::{FrictionLaw, Motion};
use crate::system::oscillator::{axes, parameters, with_friction};
use crate::system::parameters::COULOMB_LEVEL;
use crate::system::{AxisDescription, Model};

/// x' = y, y' = -κy - αx - μx³ - f_c sgn(y) + ξ.
pub(in crate::system) fn model() -> Model {
    let bind = |values: &[f64]| with_friction(values, |own| Coulomb { level: own[0] });
    Model::new("coulomb", "Duffing oscillator with Coulomb friction", bind)
        .with_equations([
            "x' = y",
            "y' = -κ y - α x - μ x³ - f_c sgn(y) + ξ(t),   sgn(0) = 0",
            "E[ξ(t) ξ(t+τ)] = σ² δ(τ)",
        ])
        .with_axes(axes::<AxisDescription>([]))
        .with_parameters(parameters([COULOMB_LEVEL]))
        .with_source("the paper, Eqs. (5)-(6), with the letters of Eq. (7)")
        .with_notes([
            "The paper's Eq. (5) prints α = 1 as damping and κ = 0.01 as stiffness. With that reading the marginal of x has one peak at every f_c, against the paper's Fig. 2(a); with the letters of its Eq. (7), used here, its figures come out.",
            "The marginal of y has a kink at 0, p'(0+)/p(0) = -2 f_c/σ², so it changes from two peaks to one exactly at f_c = 0.",
        ])
}

/// F = f_c sgn(y).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Coulomb {
    level: f64,
}

/// Sign with sgn(0) = 0, written so that it compiles to selects on vector registers.
#[inline(always)]
fn sign(value: f64) -> f64 {
    let positive = if value > 0.0 { 1.0 } else { 0.0 };
    let negative = if value < 0.0 { 1.0 } else { 0.0 };
    positive - negative
}

impl FrictionLaw<0> for Coulomb {
    #[inline(always)]
    fn rates(&self, _motion: Motion, _state: &[f64; 0]) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn force(&self, motion: Motion, _state: &[f64; 0], _rates: &[f64; 0]) -> f64 {
        self.level * sign(motion.velocity)
    }

    fn base_velocity(&self) -> Option<f64> {
        Some(0.0)
    }

    fn is_absent(&self) -> bool {
        self.level == 0.0
    }
}

#[cfg(test)]
mod tests {
    use crate::system::contract::tests::{assert_stationary, bound};

    #[test]
    fn the_drift_is_the_equation() {
        let values = [
            ("alpha", 1.5),
            ("kappa", 0.2),
            ("mu", 0.25),
            ("f_c", 0.5),
            ("sigma2", 0.04),
        ];
        let system = bound("coulomb", &values);
        // -0.2·3 - 1.5·2 - 0.25·8 - 0.5 = -6.1, and +0.6 - 3 - 2 + 0.5 = -3.9.
        for (state, expected) in [
            ([2.0, 3.0], -6.1),
            ([2.0, -3.0], -3.9),
            // sgn(0) = 0, also for the negative zero.
            ([2.0, 0.0], -5.0),
            ([2.0, -0.0], -5.0),
        ] {
            let drift = system.drift_at(0.0, &state);
            assert_eq!(drift[0], state[1]);
            assert!((drift[1] - expected).abs() < 1e-14, "{drift:?}");
        }
        assert_eq!(system.noises()[0].additive(), Some(0.2));
    }

    #[test]
    fn the_density_is_known_only_without_friction() {
        let values = |f_c| [("kappa", 0.3), ("mu", 0.2), ("f_c", f_c), ("sigma2", 0.5)];
        assert_stationary(&*bound("coulomb", &values(0.0)));
        let rubbing = bound("coulomb", &values(0.1));
        assert_eq!(rubbing.exact_log_density(&[0.5, 0.5]), None);
    }
}
