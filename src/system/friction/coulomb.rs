//! Coulomb's dry friction: a force of constant size against the velocity (the paper's first example).
//!
//! Convention of the paper's Eq. (7): κ is the viscous damping, α the linear stiffness.

use super::{FrictionLaw, Motion};
use crate::system::TypedModel;
use crate::system::oscillator::{Duffing, compiled, with_friction};
use crate::system::parameters::{COULOMB_LEVEL, NO_STATES};

/// x' = y, y' = -κy - αx - μx³ - f_c sgn(y) + ξ.
pub(in crate::system) fn model() -> TypedModel {
    let named = ("coulomb", "Duffing oscillator with Coulomb friction");
    with_friction(named, "f_c sgn(y)", NO_STATES, [COULOMB_LEVEL])
        .with_compiled_oscillator(|values| compiled(values, |own| Coulomb { level: own[0] }))
        .with_exact_log_density(exact_log_density)
        .with_source("the paper, Eqs. (5)-(6), with the letters of Eq. (7)")
        .with_notes([
            "The paper's Eq. (5) prints α = 1 as damping and κ = 0.01 as stiffness. With that reading the marginal of x has one peak at every f_c, against the paper's Fig. 2(a); with the letters of its Eq. (7), used here, its figures come out.",
            "The marginal of y has a kink at 0, p'(0+)/p(0) = -2 f_c/σ², so it changes from two peaks to one exactly at f_c = 0.",
        ])
}

/// Without friction p ∝ exp(-(2/σ²) κ H).
fn exact_log_density(values: &[f64], state: &[f64]) -> Option<f64> {
    let (&[alpha, kappa, mu, level, sigma2], &[displacement, velocity]) = (values, state) else {
        return None;
    };
    let motion = Motion {
        displacement,
        velocity,
    };
    let energy = Duffing { alpha, mu }.energy(motion);
    (level == 0.0).then(|| -2.0 / sigma2 * (kappa * energy))
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
