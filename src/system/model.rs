//! What is known of a model before its parameters are bound: names, equations, parameters, source.

use std::sync::Arc;

use super::coloured::{ColouredNoiseError, coloured};
use super::{NoiseKind, System, TypedEquations};

/// One axis of a model's state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AxisDescription {
    /// Name used in files and on the command line, for example `y`.
    pub name: String,
    /// Symbol for figures; `_{}` and `^{}` set subscripts and superscripts, for example `ẋ`.
    pub symbol: String,
    /// Meaning in words.
    pub meaning: String,
    /// Whether modes carry it unless a file says otherwise: the density along it is smooth inside its bounds and no
    /// noise drives it, or it is white noise behind a filter.
    pub by_modes: bool,
}

impl AxisDescription {
    /// An axis with its name, symbol and meaning.
    pub fn new(
        name: impl Into<String>,
        symbol: impl Into<String>,
        meaning: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            symbol: symbol.into(),
            meaning: meaning.into(),
            by_modes: false,
        }
    }

    /// The axis of an internal state that modes carry; a series in place of cells. The state has bounds, no noise,
    /// and a smooth density between its bounds.
    #[must_use]
    pub fn carried_by_modes(self) -> Self {
        Self {
            by_modes: true,
            ..self
        }
    }
}

/// Values a parameter may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterRange {
    /// Any finite number.
    Any,
    /// Zero or more.
    NonNegative,
    /// More than zero.
    Positive,
}

impl ParameterRange {
    /// Whether `value` is finite and in the range.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::NonNegative => value >= 0.0,
                Self::Positive => value > 0.0,
            }
    }

    /// The range in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Any => "a finite number",
            Self::NonNegative => "a finite number, zero or more",
            Self::Positive => "a finite number greater than zero",
        }
    }
}

/// One parameter of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterDescription {
    /// Name used in files, for example `f_c`.
    pub name: String,
    /// Symbol for figures, with `_{}` and `^{}`, for example `f_{c}`.
    pub symbol: String,
    /// Meaning in words.
    pub meaning: String,
    /// Value used when a file leaves the parameter out; `None` if it must be given.
    pub default: Option<f64>,
    /// Values it may take.
    pub range: ParameterRange,
}

impl ParameterDescription {
    /// A parameter with its name, symbol and meaning; it must be given and may be any number.
    pub fn new(
        name: impl Into<String>,
        symbol: impl Into<String>,
        meaning: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            symbol: symbol.into(),
            meaning: meaning.into(),
            default: None,
            range: ParameterRange::Any,
        }
    }

    /// The parameter with a value that is used where none is given.
    #[must_use]
    pub fn with_default(self, value: f64) -> Self {
        Self {
            default: Some(value),
            ..self
        }
    }

    /// The parameter with the values it may take.
    #[must_use]
    pub fn within(self, range: ParameterRange) -> Self {
        Self { range, ..self }
    }
}

/// Binds checked values, given in the order of a model's parameters.
type Binding = dyn Fn(&[f64]) -> Arc<dyn System> + Send + Sync;

/// Everything about a set of systems but the values of their parameters. It owns all it says, so that it may be
/// compiled in or come from a file.
///
/// ```
/// use std::sync::Arc;
/// use pbif::system::{AxisDescription, Lanes, Model, ParameterDescription, ParameterRange, System};
///
/// struct OrnsteinUhlenbeck { rate: f64, sigma: f64 }
///
/// impl System for OrnsteinUhlenbeck {
///     fn dimension(&self) -> usize {
///         1
///     }
///     fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
///         for (slope, x) in drift[0].iter_mut().zip(&states[0]) {
///             *slope = -self.rate * x;
///         }
///     }
///     fn noise_axes(&self) -> &[usize] {
///         &[0]
///     }
///     fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
///         Some(self.sigma)
///     }
/// }
///
/// let model = Model::new("linear", "Linear restoring force", |values| {
///     Arc::new(OrnsteinUhlenbeck { rate: values[0], sigma: values[1].sqrt() })
/// })
/// .with_equations(["dx = -k x dt + σ dW"])
/// .with_axes([AxisDescription::new("x", "x", "position")])
/// .with_parameters([
///     ParameterDescription::new("k", "k", "rate").with_default(1.0),
///     ParameterDescription::new("sigma2", "σ^{2}", "noise intensity").within(ParameterRange::Positive),
/// ]);
/// let system = model.system_with(&[("sigma2", 0.25)]).unwrap();
/// assert_eq!(system.drift_at(0.0, &[2.0]), vec![-2.0]);
/// ```
pub struct Model {
    /// Name used in files, for example `coulomb`.
    pub name: String,
    /// One line for lists.
    pub title: String,
    /// The equations, one a line, as a person writes them.
    pub equations: Vec<String>,
    /// The axes of the state, in order.
    pub axes: Vec<AxisDescription>,
    /// The parameters, in order.
    pub parameters: Vec<ParameterDescription>,
    /// Where the model comes from.
    pub source: String,
    /// Anything a user should know, one paragraph a string.
    pub notes: Vec<String>,
    definitions: Vec<(String, String)>,
    noise_kind: NoiseKind,
    bind: Box<Binding>,
    typed: Option<Box<TypedEquations>>,
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Model")
            .field("name", &self.name)
            .field("axes", &self.axes)
            .field("parameters", &self.parameters)
            .finish_non_exhaustive()
    }
}

/// Named values, in the order of a model's parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterValues(Vec<f64>);

impl ParameterValues {
    /// The values in the order of the model's parameters.
    pub fn as_slice(&self) -> &[f64] {
        &self.0
    }
}

/// Why a system could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SystemError {
    /// No model of that name.
    #[error("unknown model `{name}`")]
    UnknownModel {
        /// The name that was given.
        name: String,
    },
    /// The model has no parameter of that name.
    #[error("model `{model}` has no parameter `{parameter}`")]
    UnknownParameter {
        /// The model.
        model: String,
        /// The name that was given.
        parameter: String,
    },
    /// A parameter without a default was not given.
    #[error("model `{model}` needs parameter `{parameter}` ({meaning})")]
    MissingParameter {
        /// The model.
        model: String,
        /// The missing parameter.
        parameter: String,
        /// Its meaning.
        meaning: String,
    },
    /// A value that is given, and that a path gives too.
    #[error("parameter `{parameter}` moves along the path, and a fixed value is given too")]
    Moved {
        /// The parameter.
        parameter: String,
    },
    /// A value outside the parameter's range.
    #[error("parameter `{parameter}` of model `{model}` is {value}; it must be {allowed}")]
    OutOfRange {
        /// The model.
        model: String,
        /// The parameter.
        parameter: String,
        /// The value that was given.
        value: f64,
        /// The range in words.
        allowed: &'static str,
    },
    /// A quantity of another model.
    #[error("quantity `{quantity}` cannot be worked out with the parameters of this model")]
    QuantityNotBound {
        /// The quantity.
        quantity: String,
    },
}

/// How a model is stated.
impl Model {
    /// A model without axes or parameters yet. `bind` is given checked values, in the order of the parameters.
    pub fn new(
        name: impl Into<String>,
        title: impl Into<String>,
        bind: impl Fn(&[f64]) -> Arc<dyn System> + Send + Sync + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            equations: Vec::new(),
            axes: Vec::new(),
            parameters: Vec::new(),
            source: String::new(),
            notes: Vec::new(),
            definitions: Vec::new(),
            noise_kind: NoiseKind::White,
            bind: Box::new(bind),
            typed: None,
        }
    }

    /// The equations as formulas, where the model is made of them.
    pub fn typed(&self) -> Option<&TypedEquations> {
        self.typed.as_deref()
    }

    /// The model with the formulas that it is made of.
    pub(super) fn with_typed(self, typed: TypedEquations) -> Self {
        let typed = Some(Box::new(typed));
        Self { typed, ..self }
    }

    /// The model, which says of itself what its noise is.
    pub(super) fn with_noise_kind(self, noise_kind: NoiseKind) -> Self {
        Self { noise_kind, ..self }
    }

    /// The same model with coloured noise in place of white: each of its noises goes through a filter of this kind at
    /// the same intensity. The states of the filter are axes (`noise`, of unit variance), and its parameters (`tau`)
    /// those of the model. As its memory goes to 0 it becomes the white noise, in Stratonovich's reading: of a model in
    /// Rust the drift is taken to be that of this reading.
    ///
    /// ```
    /// use pbif::system::{Model, NoiseKind, registry};
    ///
    /// let white = registry::find("bistable").unwrap();
    /// let model = Model::with_coloured_noise(&white, NoiseKind::OrnsteinUhlenbeck).unwrap();
    /// let system = model.system_with(&[("a", -0.1), ("sigma2", 0.2), ("tau", 0.4)]).unwrap();
    /// // x' = a x - x³ + σ η/√(2τ), η' = -η/τ.
    /// let drift = system.drift_at(0.0, &[1.0, 2.0]);
    /// assert!((drift[0] - (-1.1 + 0.2_f64.sqrt() / 0.8_f64.sqrt() * 2.0)).abs() < 1e-14);
    /// assert!((drift[1] + 5.0).abs() < 1e-14);
    /// ```
    ///
    /// # Errors
    /// [`ColouredNoiseError`].
    pub fn with_coloured_noise(
        model: &Arc<Self>,
        kind: NoiseKind,
    ) -> Result<Arc<Self>, ColouredNoiseError> {
        if let Some(typed) = model.typed() {
            let coloured = typed.source().clone().with_coloured_noise(kind).build();
            return coloured.map_err(|error| ColouredNoiseError::Equations(error.to_string()));
        }
        // Any values will do: how many noises there are does not depend on them.
        let values = model
            .parameters
            .iter()
            .map(|one| one.default.unwrap_or(1.0));
        let noises = model.bound(&values.collect::<Vec<_>>()).noise_axes().len();
        coloured(model, kind, noises).map(Arc::new)
    }

    /// Whether both are stated by the same equations, noises and names of states.
    pub fn is_stated_like(&self, other: &Self) -> bool {
        let states = |model: &Self| {
            let axes = model.axes.iter();
            axes.map(|axis| axis.name.clone()).collect::<Vec<_>>()
        };
        // A model of typed equations is named by whoever types them.
        let same_name = self.name == other.name || (self.typed.is_some() && other.typed.is_some());
        same_name
            && self.equations == other.equations
            && self.noise_kind == other.noise_kind
            && states(self) == states(other)
    }

    /// What its noise is.
    pub fn noise_kind(&self) -> NoiseKind {
        self.noise_kind
    }

    /// The model with its equations, one a line, as a person writes them.
    #[must_use]
    pub fn with_equations<S: Into<String>>(self, lines: impl IntoIterator<Item = S>) -> Self {
        let equations = lines.into_iter().map(Into::into).collect();
        Self { equations, ..self }
    }

    /// The model with names for formulas of its coordinates and parameters, which quantities that are watched may use.
    #[must_use]
    pub fn with_definitions(self, definitions: Vec<(String, String)>) -> Self {
        Self {
            definitions,
            ..self
        }
    }

    /// The model with its axes, in the order of the state.
    #[must_use]
    pub fn with_axes<A: Into<AxisDescription>>(self, axes: impl IntoIterator<Item = A>) -> Self {
        let axes = axes.into_iter().map(Into::into).collect();
        Self { axes, ..self }
    }

    /// The model with its parameters, in the order in which the binding takes their values.
    #[must_use]
    pub fn with_parameters<P: Into<ParameterDescription>>(
        self,
        parameters: impl IntoIterator<Item = P>,
    ) -> Self {
        let parameters = parameters.into_iter().map(Into::into).collect();
        Self { parameters, ..self }
    }

    /// The model with the words that say where it comes from.
    #[must_use]
    pub fn with_source(self, source: impl Into<String>) -> Self {
        let source = source.into();
        Self { source, ..self }
    }

    /// The model with what a user should know, one paragraph a string.
    #[must_use]
    pub fn with_notes<S: Into<String>>(self, notes: impl IntoIterator<Item = S>) -> Self {
        let notes = notes.into_iter().map(Into::into).collect();
        Self { notes, ..self }
    }
}

/// How values become systems.
impl Model {
    /// Names and formulas that quantities may use.
    pub fn definitions(&self) -> &[(String, String)] {
        &self.definitions
    }

    /// Position of a parameter in [`Model::parameters`].
    ///
    /// # Errors
    /// [`SystemError::UnknownParameter`].
    pub fn parameter_index(&self, name: &str) -> Result<usize, SystemError> {
        self.parameters
            .iter()
            .position(|parameter| parameter.name == name)
            .ok_or_else(|| SystemError::UnknownParameter {
                model: self.name.clone(),
                parameter: name.to_owned(),
            })
    }

    /// Checks named values, fills in defaults, and puts them in order.
    ///
    /// # Errors
    /// [`SystemError::UnknownParameter`], [`SystemError::MissingParameter`] or [`SystemError::OutOfRange`].
    pub fn values(&self, given: &[(&str, f64)]) -> Result<ParameterValues, SystemError> {
        for (name, _) in given {
            self.parameter_index(name)?;
        }
        let value_of = |parameter: &ParameterDescription| {
            let named = given.iter().rev().find(|(name, _)| *name == parameter.name);
            let value = named.map(|(_, value)| *value).or(parameter.default);
            let value = value.ok_or_else(|| SystemError::MissingParameter {
                model: self.name.clone(),
                parameter: parameter.name.clone(),
                meaning: parameter.meaning.clone(),
            })?;
            self.check(parameter, value)?;
            Ok(value)
        };
        let values: Result<Vec<f64>, SystemError> = self.parameters.iter().map(value_of).collect();
        values.map(ParameterValues)
    }

    /// The same values with one of them replaced.
    ///
    /// # Errors
    /// [`SystemError::UnknownParameter`] or [`SystemError::OutOfRange`].
    pub fn with(
        &self,
        values: &ParameterValues,
        name: &str,
        value: f64,
    ) -> Result<ParameterValues, SystemError> {
        let index = self.parameter_index(name)?;
        self.check(&self.parameters[index], value)?;
        let mut changed = values.clone();
        changed.0[index] = value;
        Ok(changed)
    }

    /// The system with these parameters.
    pub fn system(&self, values: &ParameterValues) -> Arc<dyn System> {
        self.bound(values.as_slice())
    }

    /// The system with values in the order of the parameters.
    pub(super) fn bound(&self, values: &[f64]) -> Arc<dyn System> {
        (self.bind)(values)
    }

    /// The system with these named values; see [`Model::values`].
    ///
    /// # Errors
    /// As [`Model::values`].
    pub fn system_with(&self, given: &[(&str, f64)]) -> Result<Arc<dyn System>, SystemError> {
        Ok(self.system(&self.values(given)?))
    }

    fn check(&self, parameter: &ParameterDescription, value: f64) -> Result<(), SystemError> {
        if parameter.range.contains(value) {
            return Ok(());
        }
        Err(SystemError::OutOfRange {
            model: self.name.clone(),
            parameter: parameter.name.clone(),
            value,
            allowed: parameter.range.words(),
        })
    }
}
