//! The second-order law of Bliman and Sorine: two elements that yield over different distances, one against the other,
//! so that the force peaks before it slides.

use super::{FrictionLaw, Motion};
use crate::system::oscillator::{compiled, with_friction};
use crate::system::parameters::{
    FAST_FORCE, FAST_LEVEL, SLIDING_DISTANCE, SLOW_FORCE, SLOW_LEVEL, SWIFTNESS,
};
use crate::system::{AxisDescription, TypedModel};

/// x' = y, y' = -κy - αx - μx³ - (u - v) + ξ, u' = (f₁y - |y|u)/(ρε), v' = (f₂y - |y|v)/ε.
pub(in crate::system) fn model() -> TypedModel {
    let title = "Duffing oscillator with second-order Bliman-Sorine friction";
    let states =
        [FAST_FORCE, SLOW_FORCE].map(|axis| AxisDescription::from(axis).carried_by_modes());
    let own = [FAST_LEVEL, SLOW_LEVEL, SLIDING_DISTANCE, SWIFTNESS];
    with_friction(("bliman_sorine", title), "(u - v)", states, own)
        .with_equation("u", "(f_1 y - abs(y) u)/(ρ ε)")
        .with_equation("v", "(f_2 y - abs(y) v)/ε")
        .with_bounds("u", "-f_1", "f_1")
        .with_bounds("v", "-f_2", "f_2")
        .with_compiled_oscillator(|values| {
            compiled(values, |own| BlimanSorine {
                level: [own[0], own[1]],
                per_distance: [(own[2] * own[3]).recip(), own[2].recip()],
            })
        })
        .with_source(
            "P.-A. Bliman and M. Sorine, Easy-to-use realistic dry friction models for automatic control, \
             European Control Conference (1995)",
        )
        .with_notes([
            "The literature's η is ρ here, its ε_f is ε. The kinetic level is f_1 - f_2; after rest the force peaks above it where ρ < 1, \
             as the fast element u slides before the slow one v.",
            "With f_2 → 0 it is `dahl` with f_c = f_1 and λ = f_1/(ρ ε).",
            "Noise and friction balance exactly: κ E[y²] + E[y (u - v)] = σ²/2, f_1 E[y u] = E[|y| u²], f_2 E[y v] = E[|y| v²].",
            "Four axes: modes carry u and v. A cell of x and y then holds the product of their numbers as unknowns.",
        ])
}

/// F = u - v, either element a Dahl law with its own distance.
#[derive(Debug, Clone, Copy, PartialEq)]
struct BlimanSorine {
    /// f₁ and f₂.
    level: [f64; 2],
    /// 1/(ρε) and 1/ε.
    per_distance: [f64; 2],
}

impl FrictionLaw<2> for BlimanSorine {
    #[inline(always)]
    fn rates(&self, motion: Motion, state: &[f64; 2]) -> [f64; 2] {
        let y = motion.velocity;
        let rate = |k: usize| self.per_distance[k] * (self.level[k] * y - y.abs() * state[k]);
        [rate(0), rate(1)]
    }

    #[inline(always)]
    fn force(&self, _motion: Motion, [u, v]: &[f64; 2], _rates: &[f64; 2]) -> f64 {
        u - v
    }
}

#[cfg(test)]
mod tests {
    use crate::system::contract::tests::bound;

    const VALUES: [(&str, f64); 7] = [
        ("kappa", 0.1),
        ("mu", 1.0),
        ("f_1", 0.75),
        ("f_2", 0.25),
        ("epsilon", 0.5),
        ("rho", 0.2),
        ("sigma2", 0.04),
    ];

    #[test]
    fn the_drift_is_the_equation() {
        let system = bound("bliman_sorine", &VALUES);
        // y' = 0.2 - 0 - (0.5 + 0.1); u' = (-1.5 - 1)/0.1; v' = (-0.5 + 0.2)/0.5.
        let drift = system.drift_at(0.0, &[0.0, -2.0, 0.5, -0.1]);
        let expected = [-2.0, -0.4, -25.0, -0.6];
        for (found, expected) in drift.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-13, "{drift:?}");
        }
        assert_eq!(
            (system.facts().bounds(2), system.facts().bounds(3)),
            (Some((-0.75, 0.75)), Some((-0.25, 0.25)))
        );
    }

    /// Pulled slowly out of the rest at u = v = 0, F = f_1 (1 - e^(-s/(ρε))) - f_2 (1 - e^(-s/ε)): it peaks where
    /// f_1 e^(-s/(ρε))/ρ = f_2 e^(-s/ε), above f_1 - f_2.
    #[test]
    fn the_force_peaks_before_it_slides() {
        let system = bound("bliman_sorine", &VALUES);
        let (step, mut state) = (1e-4, [0.0, 1.0, 0.0, 0.0]);
        let (mut largest, mut at, mut distance) = (0.0, 0.0, 0.0);
        while distance < 5.0 {
            let slopes = system.drift_at(0.0, &state);
            state[2] += step * slopes[2];
            state[3] += step * slopes[3];
            distance += step;
            if state[2] - state[3] > largest {
                (largest, at) = (state[2] - state[3], distance);
            }
        }
        let exact = 0.5 * (0.2 / 0.8) * (0.75_f64 / (0.25 * 0.2)).ln();
        assert!((at - exact).abs() < 1e-3, "{at} {exact}");
        assert!(largest > 0.52 && (state[2] - state[3] - 0.5).abs() < 1e-4);
    }
}
