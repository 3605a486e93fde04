//! From named values to a system: values are checked against a model's parameters and bound.

use std::sync::Arc;

use super::{Model, ParameterDescription, System};

/// Named values, in the order of a model's parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterValues(Vec<f64>);

impl ParameterValues {
    /// The values in the order of the model's parameters.
    pub fn as_slice(&self) -> &[f64] {
        &self.0
    }
}

/// Why a system could not be made. [`Debug`](std::fmt::Debug) shows it in words too, for a `main` that returns it.
#[derive(Clone, PartialEq, thiserror::Error)]
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

impl std::fmt::Debug for SystemError {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{self}")
    }
}

/// How values become systems.
impl Model {
    /// Names and formulas that quantities may use.
    pub(crate) fn definitions(&self) -> &[(String, String)] {
        &self.definitions
    }

    /// Position of a parameter in [`Model::parameters`].
    ///
    /// # Errors
    /// [`SystemError::UnknownParameter`].
    pub(crate) fn parameter_index(&self, name: &str) -> Result<usize, SystemError> {
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
    pub(crate) fn with(
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
