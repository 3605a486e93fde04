//! Friction laws, one file each: formulas that say all of a law, and its force and rates to be compiled.

pub(super) mod bliman_sorine;
pub(super) mod bouc_wen;
pub(super) mod coulomb;
pub(super) mod dahl;
pub(super) mod elasto_plastic;
pub(super) mod lugre;
pub(crate) mod pulled;
mod sliding;
pub(super) mod stribeck;

/// Motion of the body that rubs, as its friction contact sees it.
#[derive(Clone, Copy)]
pub(super) struct Motion {
    /// Displacement x.
    pub(super) displacement: f64,
    /// Velocity y = x'.
    pub(super) velocity: f64,
}

/// A friction law with `N` internal states z: the force F(x, y, z, z') that it takes from y', and the rates z'. What
/// the law's formulas say, to be compiled.
///
/// The law is written for one state, as on paper; an [`Oscillator`](super::oscillator::Oscillator) runs it over whole
/// batches. Mark `rates` and `force` with `#[inline(always)]` and keep them free of branches on the state (a select
/// such as `if y > 0.0 { 1.0 } else { 0.0 }` is none), so that the loop over a batch fills vector registers.
pub(super) trait FrictionLaw<const N: usize>: Send + Sync {
    /// Rates z' of the internal states.
    fn rates(&self, motion: Motion, state: &[f64; N]) -> [f64; N];

    /// Force per unit mass that the law takes from y'; `rates` are those of [`FrictionLaw::rates`].
    fn force(&self, motion: Motion, state: &[f64; N], rates: &[f64; N]) -> f64;
}

/// No friction.
pub(super) struct Frictionless;

impl FrictionLaw<0> for Frictionless {
    #[inline(always)]
    fn rates(&self, _motion: Motion, _state: &[f64; 0]) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn force(&self, _motion: Motion, _state: &[f64; 0], _rates: &[f64; 0]) -> f64 {
        0.0
    }
}
