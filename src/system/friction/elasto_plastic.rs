//! The elasto-plastic law: a contact that bends like a spring up to a level, then yields more and more until it slides.

use std::f64::consts::PI;

use super::{FrictionLaw, Motion};
use crate::formula::arithmetic::{reduced_cosine, sign};
use crate::system::oscillator::{compiled, with_friction};
use crate::system::parameters::{CONTACT_DAMPING, ELASTIC_LEVEL, LAMBDA, YIELDING_LEVEL, Z};
use crate::system::{AxisDescription, TypedModel};

/// x' = y, y' = -κy - αx - μx³ - λz - ηz' + ξ, z' = y (1 - a(w) w/(f_b + f_t)), w = λ z sgn y.
pub(in crate::system) fn model() -> TypedModel {
    let title = "Duffing oscillator with elasto-plastic friction";
    let z = AxisDescription::from(Z).carried_by_modes();
    let own = [LAMBDA, CONTACT_DAMPING, ELASTIC_LEVEL, YIELDING_LEVEL];
    with_friction(
        ("elasto_plastic", title),
        "(λ z + η r)",
        [z],
        own,
    )
    .with_equation("z", "r")
    .with_definition("r", "y (1 - a w/(f_b + f_t))")
    .with_definition("w", "λ z sgn(y)")
    .with_definition("a", "(1 - cos(π s))/2")
    .with_definition("s", "min(max((w - f_b)/f_t, 0), 1)")
    .with_bounds("z", "-(f_b + f_t)/λ", "(f_b + f_t)/λ")
    .with_compiled_oscillator(|values| {
        compiled(values, |own| ElastoPlastic {
            stiffness: own[0],
            damping: own[1],
            elastic: own[2],
            yielding: own[3],
        })
    })
    .with_source(
        "P. Dupont, V. Hayward, B. Armstrong and F. Altpeter, Single state elastoplastic friction models, \
         IEEE Transactions on Automatic Control 47 (2002)",
    )
    .with_notes([
        "The literature's letters: σ₀ = λ, σ₁ = η, σ₂ = κ, break-away at z_ba = f_b/λ, steady sliding at z_ss = z_max = (f_b + f_t)/λ. \
         Under steady sliding the friction force is (f_b + f_t) sgn(y) + κ y.",
        "Below f_b the contact is a spring: unlike `dahl` and `lugre` it does not creep under a small force that goes to and fro.",
        "Noise and friction balance exactly: E[y (λ z + η z')] + κ E[y²] = σ²/2.",
        "a has a jump of its second derivative at both ends of the yielding, so that modes converge as a power of their number; cells \
         (`cells.z.count = 16`) are for the density of z itself and for the methods with trajectories.",
    ])
}

/// F = λz + ηz', z' = y (1 - a(w) w/(f_b + f_t)).
#[derive(Debug, Clone, Copy, PartialEq)]
struct ElastoPlastic {
    stiffness: f64,
    damping: f64,
    elastic: f64,
    yielding: f64,
}

impl FrictionLaw<1> for ElastoPlastic {
    #[inline(always)]
    fn rates(&self, motion: Motion, [z]: &[f64; 1]) -> [f64; 1] {
        let y = motion.velocity;
        let force = self.stiffness * z * sign(y);
        let way = ((force - self.elastic) / self.yielding).clamp(0.0, 1.0);
        let share = 0.5 * (1.0 - reduced_cosine(PI * way));
        [y * (1.0 - share * force / (self.elastic + self.yielding))]
    }

    #[inline(always)]
    fn force(&self, _motion: Motion, [z]: &[f64; 1], [rate]: &[f64; 1]) -> f64 {
        self.stiffness * z + self.damping * rate
    }
}

#[cfg(test)]
mod tests {
    use crate::system::contract::tests::bound;

    fn rate_of_z(y: f64, z: f64) -> f64 {
        let values = [
            ("alpha", 1.0),
            ("kappa", 0.1),
            ("sigma2", 0.04),
            ("lambda", 0.5),
            ("eta", 0.3),
            ("f_b", 0.1),
            ("f_t", 0.2),
        ];
        let system = bound("elasto_plastic", &values);
        let (low, high) = system.facts().bounds(2).unwrap();
        assert!((low + 0.6).abs() < 1e-15 && (high - 0.6).abs() < 1e-15);
        let drift = system.drift_at(0.0, &[0.7, y, z]);
        let force = 0.1 * y + 0.7 + 0.5 * z + 0.3 * drift[2];
        assert!((drift[1] + force).abs() < 1e-14, "{drift:?}");
        drift[2]
    }

    #[test]
    fn the_contact_is_a_spring_then_yields_then_slides() {
        // Elastic: below f_b, and where it is unloaded.
        assert_eq!(rate_of_z(2.0, 0.2), 2.0);
        assert_eq!(rate_of_z(-2.0, 0.5), -2.0);
        assert_eq!(rate_of_z(2.0, -0.5), 2.0);
        // Half way: w = 0.2, a = 1/2.
        assert!((rate_of_z(2.0, 0.4) - 2.0 * (1.0 - 0.5 * 0.2 / 0.3)).abs() < 1e-14);
        // Sliding, whichever way.
        assert!(rate_of_z(2.0, 0.6).abs() < 1e-15 && rate_of_z(-2.0, -0.6).abs() < 1e-15);
        assert_eq!(rate_of_z(0.0, 0.6), 0.0);
    }
}
