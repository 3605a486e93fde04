//! What a model may have beside its formulas: a compiled drift that says the same faster, and what no formula says.

use std::sync::Arc;

use super::TypedModel;
use crate::system::{CompiledSteps, Facts, Lanes};

/// Drift of a batch: time and states in, slopes out.
pub type CompiledDrift = Box<dyn Fn(f64, &[Lanes], &mut [Lanes]) + Send + Sync>;

/// What of a model with its values is compiled.
pub(in crate::system) struct Compiled {
    pub(in crate::system) drift: CompiledDrift,
    /// Steps in one loop with the drift, of an oscillator.
    pub(in crate::system) steps: Option<Arc<dyn CompiledSteps>>,
}

/// Makes what is compiled from values of the parameters.
type BindCompiled = dyn Fn(&[f64]) -> Compiled + Send + Sync;

/// Logarithm of a density at values of the parameters and a state.
type LogDensity = fn(&[f64], &[f64]) -> Option<f64>;

/// What a model may have beside its formulas.
#[derive(Clone, Default)]
pub(super) struct Extras {
    pub(super) compiled: Option<Arc<BindCompiled>>,
    pub(super) log_density: Option<LogDensity>,
    /// Mends what the formulas tell, given values of the parameters.
    pub(super) facts: Option<fn(&[f64], &mut Facts)>,
    /// Formula of a friction force.
    pub(super) friction: Option<String>,
}

impl std::fmt::Debug for Extras {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = f.debug_struct("Extras");
        shown.field("compiled", &self.compiled.is_some());
        shown.field("friction", &self.friction);
        shown.finish_non_exhaustive()
    }
}

impl TypedModel {
    /// The model with a drift that is compiled: what its formulas say, but faster. Everything else still follows from
    /// the formulas, and [`contract::verify_model`](crate::system::contract::verify_model) tries whether both agree.
    /// Such a model counts as compiled in, not as one of a sweep file: its formulas are no part of what a file says.
    ///
    /// ```
    /// use pbif::system::{TypedModel, contract};
    ///
    /// let model = TypedModel::new("cubic", "Cubic damping", ["x"])
    ///     .with_equation("x", "-a x^3")
    ///     .with_noise("x", ["0.5"])
    ///     .with_parameters(["a"])
    ///     .with_compiled_drift(|values| {
    ///         let a = values[0];
    ///         Box::new(move |_, states, drift| drift[0] = states[0].map(|x| -a * x * x * x))
    ///     })
    ///     .build()?;
    /// contract::verify_model(&model, &model.values(&[("a", 2.0)])?, &[(-2.0, 2.0)])?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_compiled_drift(
        mut self,
        bind: impl Fn(&[f64]) -> CompiledDrift + Send + Sync + 'static,
    ) -> Self {
        self.extras.compiled = Some(Arc::new(move |values: &[f64]| Compiled {
            drift: bind(values),
            steps: None,
        }));
        self
    }

    /// The same of an oscillator, whose steps are compiled too.
    #[must_use]
    pub(in crate::system) fn with_compiled_oscillator(
        mut self,
        bind: impl Fn(&[f64]) -> Compiled + Send + Sync + 'static,
    ) -> Self {
        self.extras.compiled = Some(Arc::new(bind));
        self
    }

    /// The model with the logarithm of its steady-state density at values of the parameters and a state, up to a
    /// constant, where it is known exactly.
    #[must_use]
    pub fn with_exact_log_density(mut self, density: fn(&[f64], &[f64]) -> Option<f64>) -> Self {
        self.extras.log_density = Some(density);
        self
    }

    /// The model with what its formulas tell mended by values of the parameters, before a symmetry is looked for.
    #[must_use]
    pub(in crate::system) fn with_mended_facts(mut self, mend: fn(&[f64], &mut Facts)) -> Self {
        self.extras.facts = Some(mend);
        self
    }

    /// The model with a formula of its friction force, the viscous part left out.
    #[must_use]
    pub(in crate::system) fn with_friction(mut self, force: impl Into<String>) -> Self {
        self.extras.friction = Some(force.into());
        self
    }

    pub(super) fn is_compiled(&self) -> bool {
        self.extras.compiled.is_some()
    }
}
