//! Stochastic differential equations: the trait every model implements, and the built-in models.
//!
//! A [`System`] is an Itô equation dX = a(X, t; θ) dt + B(X, t; θ) dW in d = 1…4 dimensions with its
//! parameters θ already bound. A [`Model`] is what it comes from: names, equations, parameters
//! with their meaning, and a function that binds values. A [`Family`] is a model with fixed values and a [`Path`]
//! through its parameters: what is swept. [`registry`] lists the built-in models; a [`TypedModel`] makes one of
//! equations as text.
//!
//! # Decisions
//!
//! **Batches of 64 states.** `System::drift` takes 64 states at a time in structure-of-arrays form. One virtual call is
//! shared by 64 states, the arithmetic fills vector registers, and a model that is not compiled in (an expression from
//! a file) can be evaluated the same way. Models are compiled for several instruction sets and picked at run time;
//! fused multiply-add is not used, so that results are the same bits on every machine.
//!
//! **A built-in model is formulas with a compiled drift.** Equations, noise, bounds, surfaces, symmetry and typesetting
//! follow from formulas as a user types them (`system/typed`), and the contract holds the compiled drift to them. Of an
//! oscillator the loop over a batch is generic over damping and friction law (`system/oscillator.rs`,
//! `system/friction/`), and compiled for each pair, so that the parts cost what a loop written out costs.
//!
//! **Steps of built-in oscillators are compiled too.** A step that is a pass over arrays for every stage, with a call
//! of the drift between passes, serves every system, but most of its time goes into loads, stores and what both
//! stages work out alike. An oscillator therefore also has its steps as one loop with the drift inside
//! (`CompiledSteps`, `system/oscillator/steps.rs`): 1.3 to 1.7 times as many steps a second of sampled trajectories,
//! with the same bits.
//!
//! **Where an end is a wall, a face lies or the drift jumps has one definition each**: `Facts::walls`, `Axis::face_at`
//! (a millionth of a cell) and `SwitchingSurface::drift_jump`. A system that declares a period is refused by every
//! method (`Facts::autonomous`) until densities that follow it exist.

mod binding;
mod bistable;
mod bound_quantity;
mod coloured;
mod compiled_steps;
pub mod contract;
mod description;
mod displaced;
mod enclosed;
mod ends;
mod facts;
mod family;
pub mod friction;
mod linear;
mod model;
mod noise;
mod oscillator;
mod parameters;
mod passage;
mod path;
mod quantity;
mod questions;
mod rayleigh;
mod region;
pub mod registry;
mod spectrum;
mod symmetry;
mod tangent;
#[cfg(test)]
pub(crate) mod test_families;
mod typed;

pub use crate::formula::{LANES, Lanes};
pub use binding::{ParameterValues, SystemError};
pub use bound_quantity::BoundQuantity;
pub use coloured::{ColouredNoiseError, NoiseKind};
pub use compiled_steps::{CompiledSteps, StepScheme};
pub use description::{AxisDescription, ParameterDescription, ParameterRange};
pub(crate) use description::{PHASE_AXIS, in_letters};
pub(crate) use enclosed::Enclosed;
pub(crate) use ends::{absorbs, closed_ends, largest_power, may_stay, natural_ends};
pub use facts::{Facts, PeriodicDrift, SwitchingSurface, Symmetry};
pub use family::Family;
pub use linear::{FixedPointFault, Linearised};
pub use model::Model;
pub use noise::{Amplitude, Noise};
pub use oscillator::VELOCITY;
pub(crate) use oscillator::{DISPLACEMENT, FIRST_INTERNAL_STATE};
pub use passage::{
    FieldKind, FieldQuestion, MeasureLevel, PassageQuestion, PassageStart, VisitsQuestion,
};
pub use path::Path;
pub(crate) use quantity::AtPhase;
pub use quantity::{Quantity, QuantityError, QuantityFault, quantities};
pub use questions::{ExponentMethod, Questions};
pub(crate) use region::{Basin, BasinOf, joined_names};
pub use region::{Region, RegionError, RegionFault, regions};
pub use spectrum::{Band, Fluctuating, Sides, SpectrumQuestion};
pub(crate) use symmetry::{proved_symmetry, symmetry_over_a_period};
pub(crate) use tangent::TangentFault;
pub(crate) use tangent::{HALF_TURN, Tangent};
use typed::Compiled;
pub use typed::DampedParticle;
pub(crate) use typed::FormulaHazard;
pub use typed::{
    CompiledDrift, FormulaPlace, Interpretation, PeriodFault, TypedEquations, TypedModel,
    TypedModelError,
};

/// An Itô equation dX = a(X, t) dt + Σ_k b_k(X, t) e_{axis(k)} dW_k with bound parameters.
///
/// Stratonovich equations are given with their Itô drift.
///
/// # A minimal implementation
///
/// ```
/// use pbif::system::{Lanes, Noise, System, contract};
///
/// /// dx = -x dt + 0.5 dW.
/// struct OrnsteinUhlenbeck([Noise; 1]);
///
/// impl System for OrnsteinUhlenbeck {
///     fn dimension(&self) -> usize {
///         1
///     }
///     fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
///         drift[0] = states[0].map(|x| -x);
///     }
///     fn noises(&self) -> &[Noise] {
///         &self.0
///     }
///     /// Normal with variance 0.5²/2.
///     fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
///         Some(-state[0] * state[0] / (0.5 * 0.5))
///     }
/// }
///
/// let system = OrnsteinUhlenbeck([Noise::constant(0, 0.5)]);
/// assert_eq!(system.drift_at(0.0, &[2.0]), vec![-2.0]);
/// // What is declared is tried at random states of Ω, the density against the Fokker-Planck equation.
/// contract::verify(&system, &[(-2.0, 2.0)])?;
/// # Ok::<(), contract::ContractViolation>(())
/// ```
pub trait System: Send + Sync {
    /// Number of axes d, 1 to [`crate::MAX_DIMENSION`].
    fn dimension(&self) -> usize;

    /// Drift a(X, t) of a batch: `states[axis][lane]` in, `drift[axis][lane]` out. Both slices have
    /// length d. Must write every entry; non-finite values are allowed and mean overflow.
    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]);

    /// The noises, independent of each other; an axis may have none or several.
    fn noises(&self) -> &[Noise];

    /// Steps in one loop with the drift, where they are compiled: those of an autonomous oscillator whose axes are
    /// displacement, velocity and internal states, with one noise of constant amplitude, on the velocity.
    fn compiled_steps(&self) -> Option<&dyn CompiledSteps> {
        None
    }

    /// What is known of the system beside its equations.
    fn facts(&self) -> &Facts {
        &facts::NOTHING
    }

    /// Friction force per unit mass at a state, its viscous part left out, of an oscillator with a friction law (axes:
    /// displacement, velocity, internal states of the law); `None` without one.
    fn friction_force(&self, state: &[f64]) -> Option<f64> {
        let _ = state;
        None
    }

    /// Logarithm of the steady-state density at a state, up to a constant, where it is known exactly.
    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        let _ = state;
        None
    }

    /// Drift at a single state: d values.
    fn drift_at(&self, time: f64, state: &[f64]) -> Vec<f64> {
        let states: Vec<Lanes> = state.iter().map(|&value| [value; LANES]).collect();
        let mut drift = vec![[0.0; LANES]; state.len()];
        self.drift(time, &states, &mut drift);
        drift.iter().map(|lanes| lanes[0]).collect()
    }
}

impl dyn System + '_ {
    /// The noises on an axis.
    pub(crate) fn noises_on(&self, axis: usize) -> impl Iterator<Item = &Noise> {
        self.noises().iter().filter(move |noise| noise.axis == axis)
    }

    /// Whether noise drives an axis.
    pub(crate) fn is_noisy(&self, axis: usize) -> bool {
        self.noises_on(axis).next().is_some()
    }

    /// Noise intensity Σ b² on an axis at a state.
    pub(crate) fn intensity_at(&self, axis: usize, time: f64, state: &[f64]) -> f64 {
        let squares = self
            .noises_on(axis)
            .map(|noise| noise.at(time, state).powi(2));
        squares.sum()
    }
}
