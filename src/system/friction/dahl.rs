//! Dahl's friction (the paper's second example), as the law is and as the paper prints it.
//!
//! The friction force λz comes from an internal displacement z that follows y elastically at first and
//! saturates at ±f_c/λ under steady sliding. The print has x where the law has z, and then nothing saturates.

use super::{FrictionLaw, Motion};
use crate::system::oscillator::{compiled, with_friction};
use crate::system::parameters::{DAHL_LEVEL, LAMBDA, Z};
use crate::system::{AxisDescription, TypedModel};

/// x' = y, y' = -κy - αx - μx³ - λz + ξ, z' = y - (λ|y|/f_c) z.
pub(in crate::system) fn model() -> TypedModel {
    let named = ("dahl", "Duffing oscillator with Dahl friction");
    let z = AxisDescription::from(Z).carried_by_modes();
    with_friction(named, "λ z", [z], [LAMBDA, DAHL_LEVEL])
        .with_equation("z", "y - (λ abs(y)/f_c) z")
        .with_bounds("z", "-f_c/λ", "f_c/λ")
        .with_compiled_oscillator(|values| compiled(values, |own| Dahl(Contact::new(own))))
        .with_source("the paper, Eqs. (7)-(9), with z as last factor of z'; P. R. Dahl, A solid friction model (1968)")
        .with_notes([
            "The paper's Eqs. (8) and (9) print x as the last factor of z'. Dahl's law has z, and with it the paper's claims hold; the printed equations are the model `dahl_eq8`, which has no steady state.",
            "The friction force λ z stays within ±f_c. The internal displacement z is an axis of the cell space like x and y.",
        ])
}

/// x' = y, y' = -κy - αx - μx³ - λz + ξ, z' = y - (λ|y|/f_c) x.
pub(in crate::system) fn model_eq8() -> TypedModel {
    let title = "Duffing oscillator with Dahl friction as printed (no steady state)";
    with_friction(("dahl_eq8", title), "λ z", [Z], [LAMBDA, DAHL_LEVEL])
        .with_equation("z", "y - (λ abs(y)/f_c) x")
        .with_compiled_oscillator(|values| compiled(values, |own| DahlAsPrinted(Contact::new(own))))
        .with_source("the paper, Eqs. (8)-(9), as printed")
        .with_notes([
            "The print has x as the last factor of z', where Dahl's law has z (model `dahl`). Nothing then holds z back: it is not bounded, it runs away, and the system has no steady state.",
        ])
}

/// What both readings share: F = λz, z' = y - (λ|y|/f_c) times the factor in which they differ.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Contact {
    /// λ.
    stiffness: f64,
    /// λ/f_c.
    saturation: f64,
}

impl Contact {
    /// From λ and f_c.
    fn new(values: &[f64]) -> Self {
        let (lambda, f_c) = (values[0], values[1]);
        Self {
            stiffness: lambda,
            saturation: lambda / f_c,
        }
    }

    #[inline(always)]
    fn rate(&self, velocity: f64, held_by: f64) -> f64 {
        velocity - self.saturation * velocity.abs() * held_by
    }
}

/// Dahl's law.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Dahl(Contact);

impl FrictionLaw<1> for Dahl {
    #[inline(always)]
    fn rates(&self, motion: Motion, [z]: &[f64; 1]) -> [f64; 1] {
        [self.0.rate(motion.velocity, *z)]
    }

    #[inline(always)]
    fn force(&self, _motion: Motion, [z]: &[f64; 1], _rates: &[f64; 1]) -> f64 {
        self.0.stiffness * z
    }
}

/// The law as printed: the displacement stands where z should, and z knows no bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
struct DahlAsPrinted(Contact);

impl FrictionLaw<1> for DahlAsPrinted {
    #[inline(always)]
    fn rates(&self, motion: Motion, _state: &[f64; 1]) -> [f64; 1] {
        [self.0.rate(motion.velocity, motion.displacement)]
    }

    #[inline(always)]
    fn force(&self, _motion: Motion, [z]: &[f64; 1], _rates: &[f64; 1]) -> f64 {
        self.0.stiffness * z
    }
}

#[cfg(test)]
mod tests {
    use crate::system::contract::tests::bound;

    const VALUES: [(&str, f64); 6] = [
        ("alpha", -1.0),
        ("kappa", 0.1),
        ("mu", 1.0),
        ("lambda", 0.5),
        ("f_c", 0.25),
        ("sigma2", 0.04),
    ];

    #[test]
    fn the_drift_is_the_equation() {
        let system = bound("dahl", &VALUES);
        // y' = 0.1·2 + 3 - 27 - 0.5·0.4 = -24; z' = -2 - (0.5·2/0.25)·0.4 = -3.6.
        let drift = system.drift_at(0.0, &[3.0, -2.0, 0.4]);
        assert_eq!(drift[0], -2.0);
        assert!((drift[1] + 24.0).abs() < 1e-13, "{drift:?}");
        assert!((drift[2] + 3.6).abs() < 1e-14, "{drift:?}");
        assert_eq!(system.facts().bounds(2), Some((-0.5, 0.5)));
        assert_eq!(
            (system.facts().bounds(1), system.facts().bounds(3)),
            (None, None)
        );
        // Sliding at the limit leaves z where it is.
        assert_eq!(system.drift_at(0.0, &[0.0, 2.0, 0.5])[2], 0.0);
    }

    #[test]
    fn the_drift_of_the_print_is_the_printed_equation() {
        let system = bound("dahl_eq8", &VALUES);
        // y' = 0.1·2 + 3 - 27 - 0.5·0.4 = -24; z' = -2 - (0.5·2/0.25)·3 = -14.
        let drift = system.drift_at(0.0, &[3.0, -2.0, 0.4]);
        assert_eq!(drift[0], -2.0);
        assert!((drift[1] + 24.0).abs() < 1e-13, "{drift:?}");
        assert!((drift[2] + 14.0).abs() < 1e-14, "{drift:?}");
        assert_eq!(system.facts().bounds(2), None);
    }
}
