//! What is known of a model before its parameters are bound: names, equations, parameters, source.

use std::sync::Arc;

use super::System;

/// One axis of a model's state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxisDescription {
    /// Name used in files and on the command line, for example `y`.
    pub name: &'static str,
    /// Symbol for figures; `_{}` and `^{}` set subscripts and superscripts, for example `ẋ`.
    pub symbol: &'static str,
    /// Meaning in words.
    pub meaning: &'static str,
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterDescription {
    /// Name used in files, for example `f_c`.
    pub name: &'static str,
    /// Symbol for figures, with `_{}` and `^{}`, for example `f_{c}`.
    pub symbol: &'static str,
    /// Meaning in words.
    pub meaning: &'static str,
    /// Value used when a file leaves the parameter out; `None` if it must be given.
    pub default: Option<f64>,
    /// Values it may take.
    pub range: ParameterRange,
}

/// A family of systems: everything about a model but the values of its parameters.
#[derive(Debug)]
pub struct Model {
    /// Name used in files, for example `coulomb`.
    pub name: &'static str,
    /// One line for lists.
    pub title: &'static str,
    /// The equations, one a line, as a person writes them.
    pub equations: &'static [&'static str],
    /// The axes of the state, in order.
    pub axes: &'static [AxisDescription],
    /// The parameters, in order.
    pub parameters: &'static [ParameterDescription],
    /// Where the model comes from.
    pub source: &'static str,
    /// Anything a user should know, one paragraph a string.
    pub notes: &'static [&'static str],
    /// Binds checked values, given in the order of `parameters`.
    pub bind: fn(&[f64]) -> Arc<dyn System>,
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
        model: &'static str,
        /// The name that was given.
        parameter: String,
    },
    /// A parameter without a default was not given.
    #[error("model `{model}` needs parameter `{parameter}` ({meaning})")]
    MissingParameter {
        /// The model.
        model: &'static str,
        /// The missing parameter.
        parameter: &'static str,
        /// Its meaning.
        meaning: &'static str,
    },
    /// A value outside the parameter's range.
    #[error("parameter `{parameter}` of model `{model}` is {value}; it must be {allowed}")]
    OutOfRange {
        /// The model.
        model: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The value that was given.
        value: f64,
        /// The range in words.
        allowed: &'static str,
    },
}

impl Model {
    /// Position of a parameter in [`Model::parameters`].
    ///
    /// # Errors
    /// [`SystemError::UnknownParameter`].
    pub fn parameter_index(&self, name: &str) -> Result<usize, SystemError> {
        self.parameters
            .iter()
            .position(|parameter| parameter.name == name)
            .ok_or_else(|| SystemError::UnknownParameter {
                model: self.name,
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
            let value = value.ok_or(SystemError::MissingParameter {
                model: self.name,
                parameter: parameter.name,
                meaning: parameter.meaning,
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
        (self.bind)(values.as_slice())
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
            model: self.name,
            parameter: parameter.name,
            value,
            allowed: parameter.range.words(),
        })
    }
}
