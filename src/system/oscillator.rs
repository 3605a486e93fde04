//! Oscillators put together from parts: a restoring force, a damping, a friction law, and white noise on the velocity.
//! What they are stands in formulas; the loop over a batch of states, compiled for each pair of damping and law, is
//! their drift, and loops with that drift inside are the steps of their trajectories (`oscillator/steps.rs`).

mod steps;

use std::sync::Arc;

use multiversion::multiversion;

use super::friction::{FrictionLaw, Motion};
use super::parameters::{ALPHA, KAPPA, MU, Parameter, SIGMA2, X, Y};
use super::typed::statement::AMPLITUDE;
use super::{AxisDescription, Compiled, LANES, Lanes, TypedModel};

/// Axis of the displacement of an oscillator.
pub(crate) const DISPLACEMENT: usize = 0;

/// Axis of the velocity of an oscillator.
pub const VELOCITY: usize = 1;

/// Axis of the first internal state of an oscillator's friction law.
pub(crate) const FIRST_INTERNAL_STATE: usize = 2;

/// A spring with restoring force αx + μx³.
#[derive(Clone, Copy)]
pub(super) struct Duffing {
    /// Linear stiffness α, of either sign.
    pub(super) alpha: f64,
    /// Cubic stiffness μ.
    pub(super) mu: f64,
}

impl Duffing {
    #[inline(always)]
    fn force(&self, displacement: f64) -> f64 {
        displacement * (self.alpha + self.mu * displacement * displacement)
    }

    /// Energy of the undamped oscillator of unit mass, H = y²/2 + αx²/2 + μx⁴/4.
    #[inline(always)]
    pub(super) fn energy(&self, motion: Motion) -> f64 {
        let square = motion.displacement * motion.displacement;
        let kinetic = motion.velocity * motion.velocity;
        0.5 * (kinetic + square * (self.alpha + 0.5 * self.mu * square))
    }
}

/// A damping force h(H) y whose coefficient may depend on the energy H.
pub(super) trait Damping: Send + Sync {
    /// The coefficient h(H); negative where energy is fed in.
    fn coefficient(&self, energy: f64) -> f64;
}

/// Viscous damping h = κ, of either sign.
struct Viscous(f64);

impl Damping for Viscous {
    #[inline(always)]
    fn coefficient(&self, _energy: f64) -> f64 {
        self.0
    }
}

/// An oscillator of unit mass with a damping and a friction law of `N` internal states z:
///
/// x' = y,  y' = -h(H) y - αx - μx³ - F(x, y, z, z') + σ ξ,  z' = the law's rates.
///
/// Axes are x, y and the internal states in the law's order.
pub(super) struct Oscillator<D, F, const N: usize> {
    pub(super) spring: Duffing,
    pub(super) damping: D,
    pub(super) friction: F,
}

impl<D: Damping + 'static, F: FrictionLaw<N> + 'static, const N: usize> Oscillator<D, F, N> {
    /// Its drift, and steps in one loop with it.
    pub(super) fn compiled(self) -> Compiled {
        let oscillator = Arc::new(self);
        let of_drift = Arc::clone(&oscillator);
        Compiled {
            drift: Box::new(move |_, states, slopes| drift(&of_drift, states, slopes)),
            steps: Some(oscillator),
        }
    }
}

impl<D: Damping, F: FrictionLaw<N>, const N: usize> Oscillator<D, F, N> {
    /// y' and z' at a state.
    #[inline(always)]
    fn slopes(&self, motion: Motion, state: &[f64; N]) -> (f64, [f64; N]) {
        let rates = self.friction.rates(motion, state);
        let damping = self.damping.coefficient(self.spring.energy(motion));
        let force = -damping * motion.velocity
            - self.spring.force(motion.displacement)
            - self.friction.force(motion, state, &rates);
        (force, rates)
    }
}

/// A model x' = y, y' = force + σ ξ of an oscillator; the internal states have no equations yet.
pub(super) fn oscillator<A: Into<AxisDescription>>(
    (name, title): (&str, &str),
    force: &str,
    internal: impl IntoIterator<Item = A>,
    parameters: impl IntoIterator<Item = Parameter>,
) -> TypedModel {
    let motion = [X, Y].map(AxisDescription::from).into_iter();
    let axes = motion.chain(internal.into_iter().map(Into::into));
    TypedModel::new(name, title, axes)
        .with_equation("x", "y")
        .with_equation("y", force)
        .with_noise("y", [AMPLITUDE])
        .with_definition(AMPLITUDE, "sqrt(sigma2)")
        .with_parameters(parameters)
}

/// Duffing's oscillator with viscous damping and a friction force, a product or in parentheses.
pub(super) fn with_friction<A: Into<AxisDescription>>(
    named: (&str, &str),
    friction: &str,
    internal: impl IntoIterator<Item = A>,
    law: impl IntoIterator<Item = Parameter>,
) -> TypedModel {
    let force = format!("-κ y - α x - μ x³ - {friction}");
    let parameters = [ALPHA, KAPPA, MU].into_iter().chain(law).chain([SIGMA2]);
    oscillator(named, &force, internal, parameters).with_friction(friction)
}

/// What is compiled of [`with_friction`], from values of its parameters; `law` is given those of the law.
pub(super) fn compiled<F: FrictionLaw<N> + 'static, const N: usize>(
    values: &[f64],
    law: impl FnOnce(&[f64]) -> F,
) -> Compiled {
    Oscillator {
        spring: Duffing {
            alpha: values[0],
            mu: values[2],
        },
        damping: Viscous(values[1]),
        friction: law(&values[3..]),
    }
    .compiled()
}

#[multiversion(targets = "simd")]
fn drift<D: Damping, F: FrictionLaw<N>, const N: usize>(
    oscillator: &Oscillator<D, F, N>,
    states: &[Lanes],
    slopes: &mut [Lanes],
) {
    let ([x, y, z @ ..], [x_slope, y_slope, z_slopes @ ..]) = (states, slopes) else {
        return;
    };
    let (Ok(z), Ok(z_slopes)) = (
        <&[Lanes; N]>::try_from(z),
        <&mut [Lanes; N]>::try_from(z_slopes),
    ) else {
        return;
    };
    for lane in 0..LANES {
        let motion = Motion {
            displacement: x[lane],
            velocity: y[lane],
        };
        let mut state = [0.0; N];
        for index in 0..N {
            state[index] = z[index][lane];
        }
        let (force, rates) = oscillator.slopes(motion, &state);
        x_slope[lane] = motion.velocity;
        y_slope[lane] = force;
        for index in 0..N {
            z_slopes[index][lane] = rates[index];
        }
    }
}
