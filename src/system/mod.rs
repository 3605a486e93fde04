//! Stochastic differential equations: the trait every model implements, and the built-in models.
//!
//! A [`System`] is an Itô equation dX = a(X, t; θ) dt + B(X, t; θ) dW in d = 1…4 dimensions with its
//! parameters θ already bound. A [`Model`] is what it comes from: names, equations, parameters
//! with their meaning, and a function that binds values. A [`Family`] is a model with fixed values and a [`Path`]
//! through its parameters: what is swept. [`registry`] lists the built-in models; a [`TypedModel`] makes one of
//! equations as text.

mod binding;
mod bistable;
mod coloured;
pub mod contract;
mod description;
mod enclosed;
#[cfg(test)]
pub(crate) mod examples;
mod facts;
mod family;
pub mod friction;
mod model;
mod oscillator;
mod parameters;
mod path;
mod quantity;
mod rayleigh;
pub mod registry;
mod symmetry;
mod typed;
mod typeset;

pub use crate::formula::{LANES, Lanes};
pub use binding::{ParameterValues, SystemError};
pub use coloured::{
    CORRELATION_TIME, ColouredNoiseError, NOISE_AXIS, NOISE_DAMPING, NOISE_FREQUENCY,
    NOISE_RATE_AXIS, NoiseKind,
};
pub use description::{AxisDescription, ParameterDescription, ParameterRange};
pub(crate) use enclosed::Enclosed;
pub use facts::{PeriodicDrift, SwitchingSurface, Symmetry};
pub use family::Family;
pub use model::Model;
pub use oscillator::{
    DISPLACEMENT, Damping, Duffing, FIRST_INTERNAL_STATE, Oscillator, VELOCITY, Viscous,
};
pub use path::Path;
pub use quantity::{BoundQuantity, Quantity, QuantityError, QuantityFault, quantities};
pub use symmetry::proved_symmetry;
pub use typed::{
    FormulaHazard, FormulaPlace, Interpretation, TypedEquations, TypedModel, TypedModelError,
};

/// An Itô equation dX = a(X, t) dt + Σ_k b_k(X, t) e_{axis(k)} dW_k with bound parameters.
///
/// Each Wiener process `k` drives exactly one axis, [`System::noise_axes`]`[k]`; an axis may have none.
/// Stratonovich equations are given with their Itô drift.
///
/// # A minimal implementation
///
/// ```
/// use pbif::system::{Lanes, System, contract};
///
/// /// dx = -x dt + 0.5 dW.
/// struct OrnsteinUhlenbeck;
///
/// impl System for OrnsteinUhlenbeck {
///     fn dimension(&self) -> usize {
///         1
///     }
///     fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
///         for (slope, x) in drift[0].iter_mut().zip(&states[0]) {
///             *slope = -x;
///         }
///     }
///     fn noise_axes(&self) -> &[usize] {
///         &[0]
///     }
///     fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
///         Some(0.5)
///     }
///     /// Normal with variance 0.5²/2.
///     fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
///         Some(-state[0] * state[0] / (0.5 * 0.5))
///     }
/// }
///
/// assert_eq!(OrnsteinUhlenbeck.drift_at(0.0, &[2.0]), vec![-2.0]);
/// // What is declared is tried at random states of Ω, the density against the Fokker-Planck equation.
/// contract::verify(&OrnsteinUhlenbeck, &[(-2.0, 2.0)])?;
/// # Ok::<(), contract::ContractViolation>(())
/// ```
pub trait System: Send + Sync {
    /// Number of axes d, 1 to [`crate::MAX_DIMENSION`].
    fn dimension(&self) -> usize;

    /// Drift a(X, t) of a batch: `states[axis][lane]` in, `drift[axis][lane]` out. Both slices have
    /// length d. Must write every entry; non-finite values are allowed and mean overflow.
    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]);

    /// Axis that each Wiener process drives; its length is the number of processes.
    fn noise_axes(&self) -> &[usize];

    /// Amplitude b_k when it depends on neither state nor time, else `None`.
    fn additive_amplitude(&self, channel: usize) -> Option<f64>;

    /// Amplitude b_k(X, t) of a batch. Models with state-dependent noise override it; the default
    /// copies [`System::additive_amplitude`], or zero where that is `None`.
    fn amplitude(&self, channel: usize, time: f64, states: &[Lanes], amplitude: &mut Lanes) {
        let _ = (time, states);
        amplitude.fill(self.additive_amplitude(channel).unwrap_or(0.0));
    }

    /// Period of the drift in time; `None` for an autonomous system.
    fn period(&self) -> Option<f64> {
        None
    }

    /// Values that a coordinate can never leave (for Dahl's law |z| ≤ f_c/λ), where the model knows them.
    fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        let _ = axis;
        None
    }

    /// Mean and standard deviation of a coordinate that is a state of a linear filter of white noise, such as η in
    /// η' = -(η - mean)/τ + b ξ with constant b and τ, upon which nothing else acts. Such coordinates are independent
    /// of one another and normal; those of one filter may turn into one another, as η' = ω ν, ν' = -ω η - γ ν + b ξ do.
    fn filtered_noise(&self, axis: usize) -> Option<(f64, f64)> {
        let _ = axis;
        None
    }

    /// Rate λ > 0, per unit of time, at which a coordinate without noise and without bounds relaxes: its drift is
    /// g - λ x, where g depends on the other coordinates only and λ on none. The voltage of a circuit that an
    /// oscillator drives is one, and the force of a Maxwell element. Hermite modes can carry it
    /// ([`crate::space::Axis::hermite`]).
    fn relaxation_rate(&self, axis: usize) -> Option<f64> {
        let _ = axis;
        None
    }

    /// Planes where the drift is not smooth.
    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        Vec::new()
    }

    /// A reflection under which the steady state is invariant.
    fn symmetry(&self) -> Option<Symmetry> {
        None
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

    /// Amplitude of one Wiener process at a single state.
    fn amplitude_at(&self, channel: usize, time: f64, state: &[f64]) -> f64 {
        let states: Vec<Lanes> = state.iter().map(|&value| [value; LANES]).collect();
        let mut amplitude = [0.0; LANES];
        self.amplitude(channel, time, &states, &mut amplitude);
        amplitude[0]
    }
}
