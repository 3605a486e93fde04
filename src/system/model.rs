//! What is known of a model before its parameters are bound: names, equations, parameters, source.

use std::sync::Arc;

use super::typed::statement::Statement;
use super::{AxisDescription, NoiseKind, PHASE_AXIS, ParameterDescription, System, TypedEquations};
use crate::formula::mathml::{Element, words};

/// Binds checked values, given in the order of a model's parameters.
type Binding = dyn Fn(&[f64]) -> Arc<dyn System> + Send + Sync;

/// Everything about a set of systems but the values of their parameters. It owns all it says, so that it may be
/// compiled in or come from a file.
///
/// ```
/// use std::sync::Arc;
/// use pbif::system::{AxisDescription, Lanes, Model, Noise, ParameterDescription, ParameterRange, System};
///
/// struct OrnsteinUhlenbeck { rate: f64, noise: [Noise; 1] }
///
/// impl System for OrnsteinUhlenbeck {
///     fn dimension(&self) -> usize {
///         1
///     }
///     fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
///         drift[0] = states[0].map(|x| -self.rate * x);
///     }
///     fn noises(&self) -> &[Noise] {
///         &self.noise
///     }
/// }
///
/// let model = Model::new("linear", "Linear restoring force", |values| {
///     let noise = [Noise::constant(0, values[1].sqrt())];
///     Arc::new(OrnsteinUhlenbeck { rate: values[0], noise })
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
    layouts: Vec<Element>,
    pub(super) definitions: Vec<(String, String)>,
    noise_kind: NoiseKind,
    pub(super) bind: Box<Binding>,
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
            layouts: Vec::new(),
            definitions: Vec::new(),
            noise_kind: NoiseKind::White,
            bind: Box::new(bind),
            typed: None,
        }
    }

    /// The axis of the phase of a periodic forcing, where there is one.
    pub(crate) fn phase_axis(&self) -> Option<usize> {
        self.axes.iter().position(|axis| axis.name == PHASE_AXIS)
    }

    /// The equations as formulas, where the model is made of nothing else: not those of one whose drift is compiled.
    pub fn typed(&self) -> Option<&TypedEquations> {
        self.formulas().filter(|typed| !typed.is_compiled())
    }

    /// The equations as formulas, where they are known.
    pub(super) fn formulas(&self) -> Option<&TypedEquations> {
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

    /// Whether both are stated by the same equations, noises and names of states.
    pub(crate) fn is_stated_like(&self, other: &Self) -> bool {
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
    pub(crate) fn noise_kind(&self) -> NoiseKind {
        self.noise_kind
    }

    /// The model with its equations, one a line, as a person writes them.
    #[must_use]
    pub fn with_equations<S: Into<String>>(self, lines: impl IntoIterator<Item = S>) -> Self {
        let lines = lines.into_iter().map(Into::into);
        self.with_statements(lines.map(|line| (line.clone(), words(&line))).collect())
    }

    /// The model with its equations as lines and typeset.
    pub(super) fn with_statements(self, statements: Vec<Statement>) -> Self {
        let (equations, layouts) = statements.into_iter().unzip();
        Self {
            equations,
            layouts,
            ..self
        }
    }

    /// The lines of [`Model::equations`] as MathML: laid out where they come from formulas, else the text.
    ///
    /// ```
    /// let model = pbif::system::registry::find("coulomb")?;
    /// let first = model.typeset()[0].to_string();
    /// assert!(first.starts_with("<mrow><mover") && first.ends_with("<mo>=</mo><mi>y</mi></mrow>"), "{first}");
    /// # Ok::<(), pbif::system::SystemError>(())
    /// ```
    pub fn typeset(&self) -> &[Element] {
        &self.layouts
    }

    /// The model with names for formulas of its coordinates and parameters, which quantities that are watched may use.
    #[must_use]
    pub(crate) fn with_definitions(self, definitions: Vec<(String, String)>) -> Self {
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
    pub(crate) fn with_source(self, source: impl Into<String>) -> Self {
        let source = source.into();
        Self { source, ..self }
    }

    /// The model with what a user should know, one paragraph a string.
    #[must_use]
    pub(crate) fn with_notes<S: Into<String>>(self, notes: impl IntoIterator<Item = S>) -> Self {
        let notes = notes.into_iter().map(Into::into).collect();
        Self { notes, ..self }
    }
}
