//! Models made of typed equations: text in, a [`Model`] out.
//!
//! ```text
//! TypedModel ── read: names, formulas, drift correction ──► Reading ── bind values ──► a System of tapes
//! ```
//!
//! `read` turns texts into expressions and refuses what does not fit together, `bound` is the system with its values,
//! `error` says what can be wrong. The language is described in [`crate::formula`].

mod bound;
mod compiled;
mod equations;
mod error;
mod hysteresis;
mod linear;
mod particle;
mod read;
mod relaxation;
pub(super) mod statement;
mod tangent;

use std::sync::Arc;

use super::coloured::coloured;
use super::{AxisDescription, Model, NoiseKind, ParameterDescription};
use crate::formula::language::typeset_name;
use compiled::Extras;

pub(super) use compiled::Compiled;
pub use compiled::CompiledDrift;
pub(crate) use equations::FormulaHazard;
pub use equations::TypedEquations;
pub use error::{FormulaPlace, PeriodFault, TypedModelError};
pub use particle::DampedParticle;

/// How a stochastic integral is read where the amplitude of a noise depends on the state that it drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpretation {
    /// The equation is an Itô equation: the amplitude is taken before each increment.
    Ito,
    /// The equation is a Stratonovich equation, the limit of noise with a short memory. Its Itô drift, which is what
    /// every method uses, has ½ Σ_k b_k ∂b_k/∂x_i more on axis i.
    Stratonovich,
}

words! { Interpretation, pub name: Ito: "ito", Stratonovich: "stratonovich" }

/// A stochastic differential equation as text, from which [`TypedModel::build`] makes a [`Model`].
///
/// An axis x has the equation x' = f(x, …) + Σ_k b_k ξ_k(t) with independent white noises E\[ξ(t) ξ(t+τ)\] = δ(τ). What
/// a model declares beside its drift is read off the formulas: constant amplitudes, switching surfaces, and the
/// reflection symmetry, which is verified at every value of the parameters.
///
/// ```
/// use pbif::system::{Interpretation, ParameterDescription, ParameterRange, TypedModel, contract};
///
/// let model = TypedModel::new("duffing", "Duffing oscillator with dry friction", ["x", "y"])
///     .with_equation("x", "y")
///     .with_equation("y", "-kappa y - x (1 + mu x^2) - f_c sign(y)")
///     .with_noise("y", ["sqrt(sigma2)", "0.1 x"])
///     .with_interpretation(Interpretation::Stratonovich)
///     .with_parameters([
///         ParameterDescription::from("kappa"),
///         ParameterDescription::from("mu").with_default(0.0),
///         ParameterDescription::from("f_c"),
///         ParameterDescription::from("sigma2").within(ParameterRange::Positive),
///     ])
///     .build()?;
/// let values = model.values(&[("kappa", 0.1), ("f_c", 0.2), ("sigma2", 0.04)])?;
/// let system = model.system(&values);
/// assert_eq!(system.drift_at(0.0, &[1.0, -2.0]), vec![-2.0, 0.2 - 1.0 + 0.2]);
/// assert_eq!(system.noises()[0].additive(), Some(0.2));
/// assert_eq!(system.facts().switching_surfaces[0].axis, 1);
/// contract::verify_model(&model, &values, &[(-2.0, 2.0); 2])?;
///
/// // What is wrong is shown in the formula.
/// let refused = TypedModel::new("decay", "Linear decay", ["x"])
///     .with_equation("x", "-rat x")
///     .with_parameters([ParameterDescription::from("rate")])
///     .build();
/// assert!(refused.unwrap_err().to_string().contains("did you mean `rate`?"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct TypedModel {
    name: String,
    title: String,
    axes: Vec<AxisDescription>,
    parameters: Vec<ParameterDescription>,
    /// Axis and drift.
    equations: Vec<(String, String)>,
    /// Name and formula.
    definitions: Vec<(String, String)>,
    /// Wiener processes, each with the axes that it drives and its amplitudes there.
    processes: Vec<Vec<(String, String)>>,
    interpretation: Option<Interpretation>,
    noise_kind: NoiseKind,
    /// Axis, lower and upper bound.
    bounds: Vec<(String, String, String)>,
    period: Option<String>,
    /// Axis and period of angles.
    turns: Vec<(String, f64)>,
    source: String,
    notes: Vec<String>,
    extras: Extras,
}

/// How a model is typed.
impl TypedModel {
    /// A model with its axes, in the order of the state; a name will do for an axis.
    pub fn new<A: Into<AxisDescription>>(
        name: impl Into<String>,
        title: impl Into<String>,
        axes: impl IntoIterator<Item = A>,
    ) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            axes: axes.into_iter().map(Into::into).collect(),
            parameters: Vec::new(),
            equations: Vec::new(),
            definitions: Vec::new(),
            processes: Vec::new(),
            interpretation: None,
            noise_kind: NoiseKind::White,
            bounds: Vec::new(),
            period: None,
            turns: Vec::new(),
            source: String::new(),
            notes: Vec::new(),
            extras: Extras::default(),
        }
    }

    /// The right side of the equation of an axis, without its noise. Every axis needs one.
    #[must_use]
    pub fn with_equation(mut self, axis: impl Into<String>, drift: impl Into<String>) -> Self {
        self.equations.push((axis.into(), drift.into()));
        self
    }

    /// Independent white noises on the equation of an axis, by their amplitudes (the root of the noise intensity).
    #[must_use]
    pub fn with_noise<S: Into<String>>(
        mut self,
        axis: impl Into<String>,
        amplitudes: impl IntoIterator<Item = S>,
    ) -> Self {
        let axis = axis.into();
        for amplitude in amplitudes {
            self.processes.push(vec![(axis.clone(), amplitude.into())]);
        }
        self
    }

    /// One white noise that stands in the equations of several axes, with its amplitude in each. The methods need
    /// noises that are independent between axes, so that [`TypedModel::build`] refuses all but one amplitude that is
    /// not zero.
    #[must_use]
    pub fn with_shared_noise<A: Into<String>, S: Into<String>>(
        mut self,
        amplitudes: impl IntoIterator<Item = (A, S)>,
    ) -> Self {
        let amplitudes = amplitudes.into_iter();
        let process = amplitudes.map(|(axis, amplitude)| (axis.into(), amplitude.into()));
        self.processes.push(process.collect());
        self
    }

    /// How the noise is read. It must be said where it makes a difference: where an amplitude on an axis depends on
    /// that same axis.
    #[must_use]
    pub fn with_interpretation(mut self, interpretation: Interpretation) -> Self {
        self.interpretation = Some(interpretation);
        self
    }

    /// The noises coloured, as [`Model::with_coloured_noise`] has it: each gets axes of its own, and the model the
    /// filter's parameters. Where an amplitude depends on the axis that it drives there is but one reading,
    /// Stratonovich's, which need not be said.
    #[must_use]
    pub fn with_coloured_noise(mut self, kind: NoiseKind) -> Self {
        self.noise_kind = kind;
        self
    }

    /// A name for a formula of states, parameters, time and other definitions, in whatever order.
    #[must_use]
    pub fn with_definition(mut self, name: impl Into<String>, formula: impl Into<String>) -> Self {
        self.definitions.push((name.into(), formula.into()));
        self
    }

    /// Values that an axis never leaves, as formulas of the parameters; see `Facts::bounds`.
    #[must_use]
    pub fn with_bounds(
        mut self,
        axis: impl Into<String>,
        lower: impl Into<String>,
        upper: impl Into<String>,
    ) -> Self {
        self.bounds.push((axis.into(), lower.into(), upper.into()));
        self
    }

    /// An axis that is an angle: it closes on itself after a period, and drift and noise are periodic in it. It runs
    /// from minus half of the period to half of it.
    #[must_use]
    pub fn with_angle(mut self, axis: impl Into<String>, period: f64) -> Self {
        self.turns.push((axis.into(), period));
        self
    }

    /// The period in time of formulas that contain `t`, as a formula of the parameters, of a system that is not to be
    /// solved. Without it `t` may stand in sines and cosines of multiples of one frequency, whose phase is an axis of
    /// the model, `t`, in periods.
    #[must_use]
    pub fn with_period(mut self, period: impl Into<String>) -> Self {
        self.period = Some(period.into());
        self
    }

    /// The parameters, in order; a name will do for one that must be given and may be any number.
    #[must_use]
    pub fn with_parameters<P: Into<ParameterDescription>>(
        mut self,
        parameters: impl IntoIterator<Item = P>,
    ) -> Self {
        self.parameters
            .extend(parameters.into_iter().map(Into::into));
        // Beside a first one it is the second of several.
        if self.parameters.iter().any(|one| one.symbol == "σ₁") {
            let intensity = |one: &&mut ParameterDescription| one.symbol == INTENSITY;
            let renamed = self.parameters.iter_mut().filter(intensity);
            renamed.for_each(|one| one.symbol = "σ₂".to_owned());
        }
        self
    }

    /// The words that say where the model comes from.
    #[must_use]
    pub fn with_source(mut self, source: impl Into<String>) -> Self {
        self.source = source.into();
        self
    }

    /// What a user should know, one paragraph a string.
    #[must_use]
    pub fn with_notes<S: Into<String>>(mut self, notes: impl IntoIterator<Item = S>) -> Self {
        self.notes.extend(notes.into_iter().map(Into::into));
        self
    }

    /// Reads all formulas. Places where the drift is not smooth and that are no plane of one coordinate are named in
    /// the model's notes.
    ///
    /// # Errors
    /// The first [`TypedModelError`] that is found.
    pub fn build(self) -> Result<Arc<Model>, TypedModelError> {
        let all = self.build_or_all_errors();
        all.map_err(|errors| {
            errors
                .into_iter()
                .next()
                .unwrap_or(TypedModelError::TooLarge)
        })
    }

    /// As [`TypedModel::build`], with everything that is wrong.
    ///
    /// # Errors
    /// Every name, equation, noise, definition and bound that is wrong; never empty.
    pub fn build_or_all_errors(self) -> Result<Arc<Model>, Vec<TypedModelError>> {
        let (reading, found) = read::read(&self)?;
        let reading = Arc::new(reading);
        let statements = self.statements();
        let is_compiled = self.is_compiled();
        let bound = Arc::clone(&reading);
        let bind = move |values: &[f64]| bound::bind(&bound, values);
        // Built-in models say themselves what a user should know of them, and quantities keep the names of their parts.
        let found = found.into_iter().filter(|_| !is_compiled);
        let definitions = self.definitions.iter().filter(|_| !is_compiled);
        let notes = self.notes.iter().cloned().chain(found);
        let axes = self.axes.iter().enumerate();
        let axes = axes.map(|(index, axis)| {
            let axis = axis.clone();
            if reading.turns.of_axes.contains_key(&index) {
                axis.closing()
            } else if is_internal(&reading, index) {
                axis.carried_by_modes()
            } else {
                axis
            }
        });
        let phase = reading.turns.phase.map(|_| AxisDescription::phase());
        let axes = axes.chain(phase);
        let model = Model::new(self.name.as_str(), self.title.as_str(), bind)
            .with_statements(statements)
            .with_axes(axes.collect::<Vec<_>>())
            .with_parameters(self.parameters.clone())
            .with_source(self.source.as_str())
            .with_notes(notes)
            .with_definitions(definitions.cloned().collect());
        let (kind, noises) = (self.noise_kind, reading.noise_axes.len());
        let model = Arc::new(model.with_typed(TypedEquations::new(self, reading)));
        if !kind.is_coloured() {
            return Ok(model);
        }
        let coloured = coloured(&model, kind, noises);
        coloured.map(Arc::new).map_err(|error| vec![error.into()])
    }
}

/// Axes from this one on are internal states; those before it are the oscillator's, which are looked at.
const FIRST_INTERNAL_AXIS: usize = 2;

/// Whether an axis is that of an internal state that relaxes linearly, or may have hysteresis: modes serve better than
/// cells for it.
fn is_internal(reading: &read::Reading, axis: usize) -> bool {
    let is_form = reading.relaxation[axis].is_some() || reading.paths[axis].is_some();
    axis >= FIRST_INTERNAL_AXIS && is_form
}

/// What was typed, to write it down again.
impl TypedModel {
    /// Axes and the right sides of their equations, in the order typed.
    pub(crate) fn equations(&self) -> &[(String, String)] {
        &self.equations
    }

    /// Wiener processes in the order typed, each with the axes that it drives and its amplitudes there.
    pub(crate) fn processes(&self) -> &[Vec<(String, String)>] {
        &self.processes
    }

    /// How the noise is read, where it was said.
    pub(crate) fn interpretation(&self) -> Option<Interpretation> {
        self.interpretation
    }

    /// Names and formulas of the definitions.
    pub(crate) fn definitions(&self) -> &[(String, String)] {
        &self.definitions
    }

    /// Axes with their lower and upper bounds.
    pub fn bounds(&self) -> &[(String, String, String)] {
        &self.bounds
    }

    /// Axes that are angles, with their periods.
    pub(crate) fn angles(&self) -> &[(String, f64)] {
        &self.turns
    }
}

/// The symbol of `sigma2`: an intensity of noise, as in the built-in models.
const INTENSITY: &str = "σ^{2}";

/// The symbol of a name in figures: Greek letters, and what follows `_` as a subscript.
fn symbol(name: &str) -> String {
    if typeset_name(name) == "σ₂" {
        return INTENSITY.to_owned();
    }
    match typeset_name(name).split_once('_') {
        Some((letter, subscript)) => format!("{letter}_{{{subscript}}}"),
        None => typeset_name(name),
    }
}

/// An axis by its name, with the symbol that follows from it (`alpha_0`: α₀).
impl From<&str> for AxisDescription {
    fn from(name: &str) -> Self {
        Self::new(name, symbol(name), "")
    }
}

/// A parameter by its name, with the symbol that follows from it; it must be given and may be any number.
impl From<&str> for ParameterDescription {
    fn from(name: &str) -> Self {
        Self::new(name, symbol(name), "")
    }
}
