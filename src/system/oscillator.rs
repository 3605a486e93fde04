//! Oscillators put together from parts: a restoring force, a damping, a friction law, and white noise on the velocity.

use std::sync::Arc;

use multiversion::multiversion;

use super::friction::{FrictionLaw, Motion};
use super::parameters::{ALPHA, Axis, KAPPA, MU, Parameter, SIGMA2, X, Y};
use super::{LANES, Lanes, SwitchingSurface, Symmetry, System};

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
#[derive(Debug, Clone)]
pub struct Oscillator<D, F, const N: usize> {
    spring: Duffing,
    damping: D,
    friction: F,
    sigma: f64,
    sigma2: f64,
}

impl<D: Damping, F: FrictionLaw<N>, const N: usize> Oscillator<D, F, N> {
    /// The oscillator with noise intensity σ² (zero or more; the amplitude of the Wiener process is its root).
    pub fn new(spring: Duffing, damping: D, friction: F, sigma2: f64) -> Self {
        Self {
            spring,
            damping,
            friction,
            sigma: sigma2.sqrt(),
            sigma2,
        }
    }
}

/// Axes of a built-in oscillator with friction: x, y, and the internal states of its law.
pub(super) fn axes(internal: impl IntoIterator<Item = Axis>) -> Vec<Axis> {
    [X, Y].into_iter().chain(internal).collect()
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

    fn noise_axes(&self) -> &[usize] {
        &[VELOCITY]
    }

    fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
        Some(self.sigma)
    }

    fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        let state = axis.checked_sub(FIRST_INTERNAL_STATE)?;
        (state < N).then(|| self.friction.bounds(state)).flatten()
    }

    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        self.friction.switching_surfaces()
    }

    /// Everything is reflected about the origin, if the friction law is odd: spring and damping are.
    fn symmetry(&self) -> Option<Symmetry> {
        let dimension = self.dimension();
        self.friction.is_odd().then(|| Symmetry {
            centre: vec![0.0; dimension],
            reflected: vec![true; dimension],
        })
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
