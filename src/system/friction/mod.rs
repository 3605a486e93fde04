//! Friction laws, one file each, and what an oscillator wants to know of a law.

pub(super) mod bliman_sorine;
pub(super) mod bouc_wen;
pub(super) mod coulomb;
pub(super) mod dahl;
pub(super) mod elasto_plastic;
pub(super) mod lugre;
pub mod pulled;
mod sliding;
pub(super) mod stribeck;

use super::{SwitchingSurface, VELOCITY};

/// Motion of the body that rubs, as its friction contact sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Displacement x.
    pub displacement: f64,
    /// Velocity y = x'.
    pub velocity: f64,
}

/// A friction law with `N` internal states z: the force F(x, y, z, z') that it takes from y', and the rates z'.
///
/// The law is written for one state, as on paper; an [`Oscillator`](super::Oscillator) runs it over whole batches. Mark
/// `rates` and `force` with `#[inline(always)]` and keep them free of branches on the state (a select such as
/// `if y > 0.0 { 1.0 } else { 0.0 }` is none), so that the loop over a batch fills vector registers.
///
/// # Example
///
/// The LuGre law without its Stribeck part: bristles of stiffness σ₀ and damping σ₁ that slip at the level f_c,
/// z' = y - (σ₀|y|/f_c) z and F = σ₀z + σ₁z'. The bristles never bend beyond f_c/σ₀.
///
/// ```
/// use pbif::system::friction::{FrictionLaw, Motion};
/// use pbif::system::{Duffing, Oscillator, System, Viscous, contract};
///
/// struct Bristles {
///     stiffness: f64,
///     damping: f64,
///     level: f64,
/// }
///
/// impl FrictionLaw<1> for Bristles {
///     #[inline(always)]
///     fn rates(&self, motion: Motion, [z]: &[f64; 1]) -> [f64; 1] {
///         let y = motion.velocity;
///         [y - self.stiffness / self.level * y.abs() * z]
///     }
///     #[inline(always)]
///     fn force(&self, _motion: Motion, [z]: &[f64; 1], [rate]: &[f64; 1]) -> f64 {
///         self.stiffness * z + self.damping * rate
///     }
///     fn bounds(&self, _state: usize) -> Option<(f64, f64)> {
///         let limit = self.level / self.stiffness;
///         Some((-limit, limit))
///     }
///     fn base_velocity(&self) -> Option<f64> {
///         Some(0.0)
///     }
/// }
///
/// let bristles = Bristles { stiffness: 2.0, damping: 0.3, level: 0.5 };
/// let spring = Duffing { alpha: 1.0, mu: 0.0 };
/// let system = Oscillator::new(spring, Viscous { kappa: 0.1 }, bristles, 0.02);
/// assert_eq!(system.dimension(), 3);
/// // At y = 1, z = 0.25 the bristles are at their limit: z' = 0, F = σ₀z = f_c.
/// assert_eq!(system.drift_at(0.0, &[0.0, 1.0, 0.25]), vec![1.0, -0.1 - 0.5, 0.0]);
/// contract::verify(&system, &[(-2.0, 2.0); 3])?;
/// # Ok::<(), contract::ContractViolation>(())
/// ```
pub trait FrictionLaw<const N: usize>: Send + Sync {
    /// Rates z' of the internal states.
    fn rates(&self, motion: Motion, state: &[f64; N]) -> [f64; N];

    /// Force per unit mass that the law takes from y'; `rates` are those of [`FrictionLaw::rates`].
    fn force(&self, motion: Motion, state: &[f64; N], rates: &[f64; N]) -> f64;

    /// Values that an internal state, counted from 0, can never leave; see `Facts::bounds`.
    fn bounds(&self, state: usize) -> Option<(f64, f64)> {
        let _ = state;
        None
    }

    /// Velocity of the base on which the body rubs, if it rubs on one: there the force jumps or a rate bends. Friction
    /// on a base at rest is taken to be odd.
    fn base_velocity(&self) -> Option<f64> {
        None
    }

    /// The plane where the body rests on its base.
    fn at_base(&self) -> Option<SwitchingSurface> {
        let at = self.base_velocity()?;
        Some(SwitchingSurface { axis: VELOCITY, at })
    }

    /// Planes where force or rates are not smooth, by the axes of the oscillator
    /// ([`VELOCITY`], [`FIRST_INTERNAL_STATE`](super::FIRST_INTERNAL_STATE) + i): [`FrictionLaw::at_base`], unless
    /// there are others.
    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        self.at_base().into_iter().collect()
    }

    /// Whether force and rates change sign with displacement, velocity and internal states: unless the law says
    /// otherwise, where it rubs on a base at rest.
    fn is_odd(&self) -> bool {
        self.base_velocity() == Some(0.0)
    }

    /// Whether the law, with the values it has, exerts no force at all.
    fn is_absent(&self) -> bool {
        false
    }
}

/// No friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frictionless;

impl FrictionLaw<0> for Frictionless {
    #[inline(always)]
    fn rates(&self, _motion: Motion, _state: &[f64; 0]) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn force(&self, _motion: Motion, _state: &[f64; 0], _rates: &[f64; 0]) -> f64 {
        0.0
    }

    fn is_odd(&self) -> bool {
        true
    }

    fn is_absent(&self) -> bool {
        true
    }
}
