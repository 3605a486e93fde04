//! The Bouc-Wen law: hysteresis of many shapes from one smooth internal state.

use super::{FrictionLaw, Motion};
use crate::formula::arithmetic::power;
use crate::system::oscillator::{compiled, with_friction};
use crate::system::parameters::{
    HYSTERESIS_FORCE, HYSTERESIS_GROWTH, HYSTERESIS_LOSS, HYSTERESIS_SHAPE, SHARPNESS, Z,
};
use crate::system::{AxisDescription, Facts, TypedModel, VELOCITY};

/// x' = y, y' = -κy - αx - μx³ - λz + ξ, z' = A y - β|y||z|ⁿ sgn z - γy|z|ⁿ.
pub(in crate::system) fn model() -> TypedModel {
    let named = ("bouc_wen", "Duffing oscillator with Bouc-Wen hysteresis");
    let z = AxisDescription::from(Z).carried_by_modes();
    let own = [
        HYSTERESIS_FORCE,
        HYSTERESIS_GROWTH,
        HYSTERESIS_LOSS,
        HYSTERESIS_SHAPE,
        SHARPNESS,
    ];
    with_friction(named, "λ z", [z], own)
        .with_equation("z", "A y - (β abs(y) sgn(z) + γ y) abs(z)^n")
        .with_bounds("z", "-(A/(β + γ))^(1/n)", "(A/(β + γ))^(1/n)")
        .with_mended_facts(mend)
        .with_compiled_oscillator(|values| match values[EXPONENT] {
            // Exponents of one and two have loops of their own, compiled without a power.
            1.0 => compiled(values, |own| BoucWen::new(own, One)),
            2.0 => compiled(values, |own| BoucWen::new(own, Two)),
            _ => compiled(values, |own| BoucWen::new(own, Any(own[4]))),
        })
        .with_source(
            "Y.-K. Wen, Method for random vibration of hysteretic systems, Journal of the Engineering Mechanics Division (ASCE) 102 (1976); \
             bounds: F. Ikhouane and J. Rodellar, Systems with Hysteresis (2007)",
        )
        .with_notes([
            "The literature writes the restoring force as a k x + (1 - a) k z: α = a k is the stiffness after yielding, λ = (1 - a) k.",
            "With A = 1, n = 1, γ = 0 and β = λ/f_c it is `dahl`. γ > 0 softens, γ < 0 hardens the loop; n large yields abruptly.",
            "z stays within its bounds where β + γ > 0. Where β + γ ≤ 0 it has none, and modes cannot carry it: give it cells.",
            "Noise and hysteresis balance exactly: κ E[y²] + λ E[y z] = σ²/2, and A E[y z] = E[|z|ⁿ⁺¹ (β |y| + γ y sgn(z))].",
            "With n = 1 and γ ≠ 0 the rate of z has a kink at z = 0, and with n = 2 its curvature jumps there: modes converge as a power \
             of their number, not exponentially. `modes = \"auto\"` takes as many as no longer matter to what is watched.",
        ])
}

/// There are no bounds without a positive β + γ, nor where the power overflows; and across z = 0 the rate bends only
/// with |z| itself.
fn mend(values: &[f64], facts: &mut Facts) {
    let (loss, shape) = (values[EXPONENT - 2], values[EXPONENT - 1]);
    facts
        .bounds
        .retain(|_, (_, limit)| loss + shape > 0.0 && limit.is_finite());
    let bends = values[EXPONENT] <= 1.0 && shape != 0.0;
    facts
        .switching_surfaces
        .retain(|surface| surface.axis == VELOCITY || bends);
    facts.switching_surfaces.sort_by_key(|surface| surface.axis);
}

/// Place of n among the parameters of the oscillator.
const EXPONENT: usize = 7;

/// |z|ⁿ.
trait Exponent: Send + Sync {
    fn of(&self, size: f64) -> f64;
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct One;

impl Exponent for One {
    #[inline(always)]
    fn of(&self, size: f64) -> f64 {
        size
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Two;

impl Exponent for Two {
    #[inline(always)]
    fn of(&self, size: f64) -> f64 {
        size * size
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Any(f64);

impl Exponent for Any {
    #[inline(always)]
    fn of(&self, size: f64) -> f64 {
        power(size, self.0)
    }
}

/// F = λz, z' = A y - β|y||z|ⁿ⁻¹z - γy|z|ⁿ.
#[derive(Debug, Clone, Copy, PartialEq)]
struct BoucWen<E> {
    stiffness: f64,
    growth: f64,
    loss: f64,
    shape: f64,
    exponent: E,
}

impl<E> BoucWen<E> {
    /// From λ, A, β and γ.
    fn new(values: &[f64], exponent: E) -> Self {
        Self {
            stiffness: values[0],
            growth: values[1],
            loss: values[2],
            shape: values[3],
            exponent,
        }
    }
}

impl<E: Exponent> FrictionLaw<1> for BoucWen<E> {
    #[inline(always)]
    fn rates(&self, motion: Motion, [z]: &[f64; 1]) -> [f64; 1] {
        let (y, size) = (motion.velocity, self.exponent.of(z.abs()));
        let lost = self.loss * y.abs() * size.copysign(*z);
        [self.growth * y - lost - self.shape * y * size]
    }

    #[inline(always)]
    fn force(&self, _motion: Motion, [z]: &[f64; 1], _rates: &[f64; 1]) -> f64 {
        self.stiffness * z
    }
}

#[cfg(test)]
mod tests {
    use crate::system::contract;
    use crate::system::contract::tests::bound;

    const COMMON: [(&str, f64); 4] = [
        ("kappa", 0.1),
        ("mu", 1.0),
        ("lambda", 0.5),
        ("sigma2", 0.04),
    ];

    fn with(own: &[(&str, f64)]) -> std::sync::Arc<dyn crate::system::System> {
        bound("bouc_wen", &[&COMMON[..], own].concat())
    }

    #[test]
    fn the_drift_is_the_equation() {
        // |z| = 0.4, y = -2: z' = -2 A - 2 β (-|z|ⁿ) + 2 γ |z|ⁿ = -3 + 2·0.75 |z|ⁿ + 2·0.25 |z|ⁿ.
        for n in [1.0, 2.0, 1.5] {
            let system = with(&[("A", 1.5), ("beta", 0.75), ("gamma", 0.25), ("n", n)]);
            let drift = system.drift_at(0.0, &[0.0, -2.0, -0.4]);
            assert_eq!(drift[0], -2.0);
            assert!((drift[1] - 0.4).abs() < 1e-15, "{drift:?}");
            let expected = -3.0 + 2.0 * 0.4_f64.powf(n);
            assert!((drift[2] - expected).abs() < 1e-15, "{n} {drift:?}");
            let (low, high) = system.facts().bounds(2).unwrap();
            assert!((high - 1.5_f64.powf(1.0 / n)).abs() < 1e-15 && low == -high);
        }
    }

    #[test]
    fn the_contract_holds_for_every_shape_of_the_loop() {
        for n in [0.5, 1.0, 1.5, 2.0, 3.0] {
            for gamma in [-1.0, -0.4, 0.0, 0.7] {
                let system = with(&[("beta", 0.5), ("gamma", gamma), ("n", n)]);
                assert_eq!(system.facts().bounds(2).is_some(), gamma > -0.5);
                let held = contract::verify(&*system, &[(-2.0, 2.0); 3]);
                assert_eq!(held, Ok(()), "n = {n}, gamma = {gamma}");
            }
        }
    }

    #[test]
    fn without_its_shape_it_is_dahls_law_to_the_last_bit() {
        let f_c = 0.25;
        let bouc_wen = with(&[("beta", 0.5 / f_c), ("n", 1.0)]);
        let dahl = bound("dahl", &[&COMMON[..], &[("f_c", f_c)]].concat());
        for k in 0..200 {
            let share = |step: f64| (f64::from(k) * step).fract() - 0.5;
            let state = [4.0 * share(0.618), 4.0 * share(0.755), share(0.57)];
            assert_eq!(bouc_wen.drift_at(0.0, &state), dahl.drift_at(0.0, &state));
        }
        assert_eq!(bouc_wen.facts().bounds(2), dahl.facts().bounds(2));
    }
}
