//! Coulomb's friction with Stribeck's part: more at rest than when sliding, on a base that stands or moves.
//!
//! A force that falls with the velocity of sliding feeds energy in where a base drags the body along: stick-slip and
//! squeal.

use super::sliding::{CubicForce, SlidingForce, StribeckLevel};
use super::{FrictionLaw, Motion};
use crate::system::TypedModel;
use crate::system::oscillator::{compiled, with_friction};
use crate::system::parameters::{
    BELT_VELOCITY, COULOMB_LEVEL, LEAST_LEVEL, LEAST_VELOCITY, NO_STATES, STATIC_LEVEL,
    STRIBECK_VELOCITY,
};

const KINK: &str = "The density has a kink where the body moves with the base: the jump of ∂p/∂y over p across y = v_b is -4 f_s/σ². \
     With v_b = 0 the marginal of y therefore changes from two peaks to one exactly at f_s = 0.";

const BASE: &str = "With v_b ≠ 0 the force in the middle, g(v_b), pulls the body aside, to about x = g(v_b)/α. A sweep of v_b moves the surface \
     on which friction switches; cells then cannot have a face on it at every value. Sweep κ, f_c or f_s on a grid with a face at v_b \
     (`grade = \"auto\"`), or v_b itself on narrow uniform cells.";

/// x' = y, y' = -κy - αx - μx³ - g sgn(u) + ξ, u = y - v_b.
pub(in crate::system) fn model() -> TypedModel {
    let title = "Duffing oscillator with Coulomb, viscous and Stribeck friction";
    let own = [
        COULOMB_LEVEL,
        STATIC_LEVEL,
        STRIBECK_VELOCITY,
        BELT_VELOCITY,
    ];
    with_friction(("stribeck", title), "g sgn(u)", NO_STATES, own)
        .with_definition("u", "y - v_b")
        .with_definition("g", "f_c + (f_s - f_c) exp(-(u/v_s)²)")
        .with_compiled_oscillator(|values| {
            compiled(values, |own| Sliding {
                force: StribeckLevel::new(own[0], own[1], own[2]),
                base: own[3],
            })
        })
        .with_source(
            "L. C. Bo and D. Pavelescu, The friction-speed relation and its influence on the critical velocity of stick-slip motion, \
             Wear 82 (1982); B. Armstrong-Hélouvry, P. Dupont and C. Canudas de Wit, Automatica 30 (1994)",
        )
        .with_notes([
            "With f_s = f_c and v_b = 0 it is `coulomb`. κ is the viscous part; `stribeck_cubic` has a polynomial in place of g.",
            KINK,
            BASE,
        ])
}

/// x' = y, y' = -κy - αx - μx³ - F + ξ, u = y - v_b, F a cubic polynomial of u and a jump.
pub(in crate::system) fn model_cubic() -> TypedModel {
    let title = "Duffing oscillator with friction that is a jump and a cubic polynomial";
    let own = [STATIC_LEVEL, LEAST_LEVEL, LEAST_VELOCITY, BELT_VELOCITY];
    with_friction(("stribeck_cubic", title), "F", NO_STATES, own)
        .with_definition("u", "y - v_b")
        .with_definition("F", "f_s sgn(u) - (3/2) (f_s - f_m) (u/v_m - (u/v_m)³/3)")
        .with_compiled_oscillator(|values| {
            compiled(values, |own| Sliding {
                force: CubicForce::new(own[0], own[1], own[2]),
                base: own[3],
            })
        })
        .with_source(
            "J. J. Thomsen and A. Fidlin, Analytical approximations for stick-slip vibration amplitudes, \
             International Journal of Non-Linear Mechanics 38 (2003)",
        )
        .with_notes([
            "F falls from f_s at rest to f_m at the velocity v_m and rises beyond it with the cube of the velocity.",
            KINK,
            BASE,
        ])
}

/// Friction against a base that moves with a velocity of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sliding<G> {
    force: G,
    /// v_b.
    base: f64,
}

impl<G: SlidingForce> FrictionLaw<0> for Sliding<G> {
    #[inline(always)]
    fn rates(&self, _motion: Motion, _state: &[f64; 0]) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn force(&self, motion: Motion, _state: &[f64; 0], _rates: &[f64; 0]) -> f64 {
        self.force.at(motion.velocity - self.base)
    }
}

#[cfg(test)]
mod tests {
    use crate::system::contract::tests::bound;

    const VALUES: [(&str, f64); 7] = [
        ("alpha", 1.5),
        ("kappa", 0.2),
        ("mu", 0.25),
        ("f_s", 0.5),
        ("v_s", 0.5),
        ("v_b", 2.0),
        ("sigma2", 0.04),
    ];

    #[test]
    fn the_drift_is_the_equation() {
        let system = bound("stribeck", &[&VALUES[..], &[("f_c", 0.2)]].concat());
        // -0.2·1 - 1.5·2 - 0.25·8 = -5.2; u = -1, u/v_s = -2, g = 0.2 + 0.3 e⁻⁴ against the motion of the base.
        let drift = system.drift_at(0.0, &[2.0, 1.0]);
        let expected = -5.2 + 0.2 + 0.3 * (-4.0_f64).exp();
        assert_eq!(drift[0], 1.0);
        assert!((drift[1] - expected).abs() < 1e-14, "{drift:?}");
        // Moving with the base: no friction. -0.4 - 3 - 2.
        assert!((system.drift_at(0.0, &[2.0, 2.0])[1] + 5.4).abs() < 1e-14);
        assert_eq!(system.facts().switching_surfaces[0].at, 2.0);
        assert_eq!(system.facts().symmetry, None);
    }

    #[test]
    fn the_drift_of_the_cubic_law_is_the_equation() {
        let mut values = VALUES.to_vec();
        values[4] = ("v_m", 0.5);
        values.push(("f_m", 0.2));
        let system = bound("stribeck_cubic", &values);
        // u/v_m = -2: F = -0.5 - 0.45 (-2 + 8/3) = -0.8.
        let drift = system.drift_at(0.0, &[2.0, 1.0]);
        assert!((drift[1] - (-5.2 + 0.8)).abs() < 1e-14, "{drift:?}");
    }

    #[test]
    fn without_its_part_it_is_coulombs_law() {
        let common = [("kappa", 0.2), ("mu", 0.25), ("f_c", 0.3), ("sigma2", 0.04)];
        let coulomb = bound("coulomb", &common);
        let stribeck = [&common[..], &[("f_s", 0.3), ("v_s", 0.1)]].concat();
        let stribeck = bound("stribeck", &stribeck);
        for state in [[0.3, -1.2], [1.0, 0.0], [-0.7, 0.02]] {
            assert_eq!(
                stribeck.drift_at(0.0, &state),
                coulomb.drift_at(0.0, &state)
            );
        }
        assert_eq!(stribeck.facts().symmetry, coulomb.facts().symmetry);
    }
}
