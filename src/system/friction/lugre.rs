//! The LuGre law: bristles that bend, are damped, and slip at a level that falls with the velocity.

use super::sliding::StribeckLevel;
use super::{FrictionLaw, Motion};
use crate::system::oscillator::{compiled, with_friction};
use crate::system::parameters::{
    CONTACT_DAMPING, DAHL_LEVEL, LAMBDA, STATIC_LEVEL_OF_BRISTLES, STRIBECK_VELOCITY, Z,
};
use crate::system::{AxisDescription, TypedModel};

/// x' = y, y' = -κy - αx - μx³ - λz - ηz' + ξ, z' = y - (λ|y|/g(y)) z.
pub(in crate::system) fn model() -> TypedModel {
    let named = ("lugre", "Duffing oscillator with LuGre friction");
    let z = AxisDescription::from(Z).carried_by_modes();
    let own = [
        LAMBDA,
        CONTACT_DAMPING,
        DAHL_LEVEL,
        STATIC_LEVEL_OF_BRISTLES,
        STRIBECK_VELOCITY,
    ];
    with_friction(named, "(λ z + η w)", [z], own)
        .with_equation("z", "w")
        .with_definition("w", "y - (λ abs(y)/g) z")
        .with_definition("g", "f_c + (f_s - f_c) exp(-(y/v_s)²)")
        // Beyond the largest level the bristles are never bent.
        .with_bounds("z", "-max(f_c, f_s)/λ", "max(f_c, f_s)/λ")
        .with_compiled_oscillator(|values| {
            compiled(values, |own| LuGre {
                stiffness: own[0],
                damping: own[1],
                level: StribeckLevel::new(own[2], own[3], own[4]),
            })
        })
        .with_source(
            "C. Canudas de Wit, H. Olsson, K. J. Åström and P. Lischinsky, A new model for control of systems with friction, \
             IEEE Transactions on Automatic Control 40 (1995)",
        )
        .with_notes([
            "The literature's letters: σ₀ = λ (stiffness of the bristles), σ₁ = η (their damping), σ₂ = κ (viscous friction). \
             Under steady sliding z = g(y) sgn(y)/λ, and the friction force is g(y) sgn(y) + κ y.",
            "With η = 0 and f_s = f_c it is `dahl`; with λ → ∞ too it is `coulomb`, or `stribeck` where f_s > f_c.",
            "Noise and friction balance exactly: E[y (λ z + η z')] + κ E[y²] = σ²/2 and E[y z] = λ E[|y| z²/g(y)].",
            "The law is passive only for κ ≥ η (f_s - f_c)/f_c (N. Barabanov and R. Ortega, IEEE Transactions on Automatic Control 45, \
             2000): beyond that a bristle may feed energy in.",
            "Modes carry z. Give it cells (`cells.z.count = 16`) for its own density and for the methods with trajectories.",
        ])
}

/// F = λz + ηz', z' = y - (λ|y|/g(y)) z.
#[derive(Debug, Clone, Copy, PartialEq)]
struct LuGre {
    stiffness: f64,
    damping: f64,
    level: StribeckLevel,
}

impl FrictionLaw<1> for LuGre {
    #[inline(always)]
    fn rates(&self, motion: Motion, [z]: &[f64; 1]) -> [f64; 1] {
        let y = motion.velocity;
        [y - self.stiffness / self.level.at(y) * y.abs() * z]
    }

    #[inline(always)]
    fn force(&self, _motion: Motion, [z]: &[f64; 1], [rate]: &[f64; 1]) -> f64 {
        self.stiffness * z + self.damping * rate
    }
}

#[cfg(test)]
mod tests {
    use crate::system::contract::tests::bound;

    const COMMON: [(&str, f64); 6] = [
        ("alpha", -1.0),
        ("kappa", 0.1),
        ("mu", 1.0),
        ("lambda", 0.5),
        ("f_c", 0.25),
        ("sigma2", 0.04),
    ];

    #[test]
    fn the_drift_is_the_equation() {
        let own = [("eta", 0.3), ("f_s", 0.5), ("v_s", 2.0)];
        let system = bound("lugre", &[&COMMON[..], &own[..]].concat());
        // g = 0.25 + 0.25/e; z' = -2 - (0.5·2/g)·0.4; y' = 0.1·2 + 3 - 27 - 0.5·0.4 - 0.3 z'.
        let level = 0.25 + 0.25 * (-1.0_f64).exp();
        let rate = -2.0 - 0.4 / level;
        let drift = system.drift_at(0.0, &[3.0, -2.0, 0.4]);
        assert_eq!(drift[0], -2.0);
        assert!((drift[2] - rate).abs() < 1e-13, "{drift:?}");
        assert!((drift[1] - (-24.0 - 0.3 * rate)).abs() < 1e-13, "{drift:?}");
        assert_eq!(system.facts().bounds(2), Some((-1.0, 1.0)));
    }

    #[test]
    fn without_damping_and_stribeck_part_it_is_dahls_law_to_the_last_bit() {
        let own = [("eta", 0.0), ("f_s", 0.25), ("v_s", 0.1)];
        let lugre = bound("lugre", &[&COMMON[..], &own[..]].concat());
        let dahl = bound("dahl", &COMMON);
        for k in 0..200 {
            let share = |step: f64| (f64::from(k) * step).fract() - 0.5;
            let state = [4.0 * share(0.618), 4.0 * share(0.755), share(0.57)];
            assert_eq!(lugre.drift_at(0.0, &state), dahl.drift_at(0.0, &state));
        }
        assert_eq!(lugre.facts().bounds(2), dahl.facts().bounds(2));
        assert_eq!(lugre.facts().symmetry, dahl.facts().symmetry);
    }
}
