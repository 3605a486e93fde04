//! Oscillators put together from parts: a restoring force, a damping, a friction law, and white noise on the velocity.

use std::sync::Arc;

use multiversion::multiversion;

use super::friction::{FrictionLaw, Motion};
use super::parameters::{ALPHA, KAPPA, MU, Parameter, SIGMA2, X, Y};
use super::{AxisDescription, Facts, LANES, Lanes, Noise, Symmetry, System};

/// Axis of the displacement of an oscillator.
pub const DISPLACEMENT: usize = 0;

/// Axis of the velocity of an oscillator.
pub const VELOCITY: usize = 1;

/// Axis of the first internal state of an oscillator's friction law.
pub const FIRST_INTERNAL_STATE: usize = 2;

/// A spring with restoring force αx + μx³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Duffing {
    /// Linear stiffness α, of either sign.
    pub alpha: f64,
    /// Cubic stiffness μ.
    pub mu: f64,
}

impl Duffing {
    /// αx + μx³.
    #[inline(always)]
    pub fn force(&self, displacement: f64) -> f64 {
        displacement * (self.alpha + self.mu * displacement * displacement)
    }

    /// Energy of the undamped oscillator of unit mass, H = y²/2 + αx²/2 + μx⁴/4.
    #[inline(always)]
    pub fn energy(&self, motion: Motion) -> f64 {
        let square = motion.displacement * motion.displacement;
        let kinetic = motion.velocity * motion.velocity;
        0.5 * (kinetic + square * (self.alpha + 0.5 * self.mu * square))
    }
}

/// A damping force h(H) y whose coefficient may depend on the energy H.
///
/// Without friction the steady state is then known: p ∝ exp(-(2/σ²) ∫₀ᴴ h dH) (T. K. Caughey and F. Ma, 1982).
pub trait Damping: Send + Sync {
    /// The coefficient h(H); negative where energy is fed in.
    fn coefficient(&self, energy: f64) -> f64;

    /// ∫₀ᴴ h dH.
    fn integral(&self, energy: f64) -> f64;
}

/// Viscous damping h = κ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viscous {
    /// The coefficient κ, of either sign.
    pub kappa: f64,
}

impl Damping for Viscous {
    #[inline(always)]
    fn coefficient(&self, _energy: f64) -> f64 {
        self.kappa
    }

    fn integral(&self, energy: f64) -> f64 {
        self.kappa * energy
    }
}

/// An oscillator of unit mass with a damping and a friction law of `N` internal states z:
///
/// x' = y,  y' = -h(H) y - αx - μx³ - F(x, y, z, z') + ξ,  z' = the law's rates,  E[ξ(t) ξ(t+τ)] = σ² δ(τ).
///
/// Axes are x, y and the internal states in the law's order. The drift of a batch is one loop, compiled for every
/// combination of damping and law, as if it had been written out; [`FrictionLaw`] has an example.
#[derive(Clone)]
pub struct Oscillator<D, F, const N: usize> {
    spring: Duffing,
    damping: D,
    friction: F,
    sigma2: f64,
    noise: [Noise; 1],
    facts: Facts,
}

impl<D: Damping, F: FrictionLaw<N>, const N: usize> Oscillator<D, F, N> {
    /// The oscillator with noise intensity σ² (zero or more; the amplitude of the Wiener process is its root).
    pub fn new(spring: Duffing, damping: D, friction: F, sigma2: f64) -> Self {
        let bounds = (0..N).filter_map(|state| {
            let bounds = friction.bounds(state)?;
            Some((FIRST_INTERNAL_STATE + state, bounds))
        });
        let facts = Facts {
            bounds: bounds.collect(),
            switching_surfaces: friction.switching_surfaces(),
            // Everything is reflected about the origin, if the friction law is odd: spring and damping are.
            symmetry: (friction.is_odd()).then(|| Symmetry::about_origin(FIRST_INTERNAL_STATE + N)),
            ..Facts::default()
        };
        Self {
            spring,
            damping,
            friction,
            sigma2,
            noise: [Noise::constant(VELOCITY, sigma2.sqrt())],
            facts,
        }
    }
}

/// Axes of a built-in oscillator with friction: x, y, and the internal states of its law.
pub(super) fn axes<A: Into<AxisDescription>>(
    internal: impl IntoIterator<Item = A>,
) -> Vec<AxisDescription> {
    let internal = internal.into_iter().map(Into::into);
    [X, Y]
        .map(AxisDescription::from)
        .into_iter()
        .chain(internal)
        .collect()
}

/// Parameters of a built-in oscillator with friction: α, κ, μ, those of its law, σ².
pub(super) fn parameters(law: impl IntoIterator<Item = Parameter>) -> Vec<Parameter> {
    let oscillator = [ALPHA, KAPPA, MU].into_iter();
    oscillator.chain(law).chain([SIGMA2]).collect()
}

/// Binds the values of [`parameters`]; `law` is given those of the law.
pub(super) fn with_friction<F: FrictionLaw<N> + 'static, const N: usize>(
    values: &[f64],
    law: impl FnOnce(&[f64]) -> F,
) -> Arc<dyn System> {
    let last = values.len() - 1;
    let spring = Duffing {
        alpha: values[0],
        mu: values[2],
    };
    let damping = Viscous { kappa: values[1] };
    let law = law(&values[3..last]);
    Arc::new(Oscillator::new(spring, damping, law, values[last]))
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
    let Oscillator {
        spring,
        damping,
        friction,
        ..
    } = oscillator;
    for lane in 0..LANES {
        let motion = Motion {
            displacement: x[lane],
            velocity: y[lane],
        };
        let mut state = [0.0; N];
        for index in 0..N {
            state[index] = z[index][lane];
        }
        let rates = friction.rates(motion, &state);
        let damping = damping.coefficient(spring.energy(motion));
        x_slope[lane] = motion.velocity;
        y_slope[lane] = -damping * motion.velocity
            - spring.force(motion.displacement)
            - friction.force(motion, &state, &rates);
        for index in 0..N {
            z_slopes[index][lane] = rates[index];
        }
    }
}

impl<D: Damping, F: FrictionLaw<N>, const N: usize> System for Oscillator<D, F, N> {
    fn dimension(&self) -> usize {
        FIRST_INTERNAL_STATE + N
    }

    fn drift(&self, _time: f64, states: &[Lanes], slopes: &mut [Lanes]) {
        drift(self, states, slopes);
    }

    fn noises(&self) -> &[Noise] {
        &self.noise
    }

    fn facts(&self) -> &Facts {
        &self.facts
    }

    fn friction_force(&self, state: &[f64]) -> Option<f64> {
        let (&[displacement, velocity], internal) = state.split_first_chunk()?;
        let internal: &[f64; N] = internal.try_into().ok()?;
        let motion = Motion {
            displacement,
            velocity,
        };
        let rates = self.friction.rates(motion, internal);
        (!self.friction.is_absent()).then(|| self.friction.force(motion, internal, &rates))
    }

    /// Known without friction and with noise: p ∝ exp(-(2/σ²) ∫₀ᴴ h dH).
    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        let &[displacement, velocity] = state else {
            return None;
        };
        let motion = Motion {
            displacement,
            velocity,
        };
        let dissipated = self.damping.integral(self.spring.energy(motion));
        (self.friction.is_absent() && self.sigma2 > 0.0).then(|| -2.0 / self.sigma2 * dissipated)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::contract;
    use crate::system::friction::Frictionless;

    /// Two bristles of different stiffness that slip at their own levels, each damped: F = Σ (k z + c z').
    struct TwoBristles {
        stiffness: [f64; 2],
        level: [f64; 2],
        damping: f64,
    }

    impl FrictionLaw<2> for TwoBristles {
        #[inline(always)]
        fn rates(&self, motion: Motion, state: &[f64; 2]) -> [f64; 2] {
            let mut rates = [motion.velocity; 2];
            for index in 0..2 {
                let slip = self.stiffness[index] / self.level[index] * motion.velocity.abs();
                rates[index] -= slip * state[index];
            }
            rates
        }

        #[inline(always)]
        fn force(&self, _motion: Motion, state: &[f64; 2], rates: &[f64; 2]) -> f64 {
            let mut force = 0.0;
            for index in 0..2 {
                force += self.stiffness[index] * state[index] + self.damping * rates[index];
            }
            force
        }

        fn bounds(&self, state: usize) -> Option<(f64, f64)> {
            let limit = self.level[state] / self.stiffness[state];
            Some((-limit, limit))
        }

        fn base_velocity(&self) -> Option<f64> {
            Some(0.0)
        }
    }

    #[test]
    fn a_law_may_have_several_states_and_a_force_that_depends_on_their_rates() {
        let law = TwoBristles {
            stiffness: [2.0, 1.0],
            level: [1.0, 0.25],
            damping: 0.5,
        };
        let spring = Duffing {
            alpha: 1.0,
            mu: 1.0,
        };
        let system = Oscillator::new(spring, Viscous { kappa: 0.1 }, law, 0.04);
        // z₁' = -2 - 2·2·0.25 = -3, z₂' = -2 + 4·2·0.125 = -1; F = 0.5 - 0.125 + 0.5·(-4) = -1.625;
        // y' = 0.2 - 1 - 1 + 1.625 = -0.175.
        let drift = system.drift_at(0.0, &[1.0, -2.0, 0.25, -0.125]);
        assert_eq!((drift[0], drift[2], drift[3]), (-2.0, -3.0, -1.0));
        assert!((drift[1] + 0.175).abs() < 1e-15, "{drift:?}");
        assert_eq!(system.dimension(), 4);
        assert_eq!(system.facts().bounds(3), Some((-0.25, 0.25)));
        assert_eq!(system.facts().bounds.len(), 2);
        assert_eq!(contract::verify(&system, &[(-2.0, 2.0); 4]), Ok(()));
    }

    #[test]
    fn a_law_that_is_odd_in_name_only_is_found_out() {
        struct OneSided;
        impl FrictionLaw<0> for OneSided {
            fn rates(&self, _motion: Motion, _state: &[f64; 0]) -> [f64; 0] {
                []
            }
            fn force(&self, motion: Motion, _state: &[f64; 0], _rates: &[f64; 0]) -> f64 {
                0.1 * motion.velocity.abs()
            }
            fn is_odd(&self) -> bool {
                true
            }
        }
        let spring = Duffing {
            alpha: 1.0,
            mu: 0.0,
        };
        let system = Oscillator::new(spring, Viscous { kappa: 0.1 }, OneSided, 0.04);
        let verified = contract::verify(&system, &[(-2.0, 2.0); 2]);
        let asymmetric = matches!(
            verified,
            Err(contract::ContractViolation::Asymmetric { .. })
        );
        assert!(asymmetric, "{verified:?}");
    }

    #[test]
    fn without_friction_the_density_follows_from_the_damping() {
        let spring = Duffing {
            alpha: 1.0,
            mu: 0.5,
        };
        let system = Oscillator::new(spring, Viscous { kappa: 0.2 }, Frictionless, 0.5);
        // H = 0.5·(4 + 1 + 0.25) = 2.625; -(2/σ²) κ H = -2.1.
        let found = system.exact_log_density(&[1.0, 2.0]).unwrap();
        assert!((found + 2.1).abs() < 1e-14, "{found}");
        assert_eq!(contract::verify(&system, &[(-2.0, 2.0); 2]), Ok(()));
        let still = Oscillator::new(spring, Viscous { kappa: 0.2 }, Frictionless, 0.0);
        assert_eq!(still.exact_log_density(&[1.0, 2.0]), None);
    }
}
