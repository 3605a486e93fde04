//! The contract of a [`System`]: whether what it declares holds for its drift and its noise.
//!
//! Methods trust declarations: walls carry no flux, a centre of symmetry decides signatures, grids have faces on
//! switching surfaces. A declaration that does not hold gives a wrong density without a word. [`verify`] tries all of
//! them at random states:
//!
//! | declared | tried |
//! | --- | --- |
//! | dimension, noises, bounds, surfaces, symmetry, period | they fit each other |
//! | drift and noise | finite; a batch gives each lane what the state gives alone |
//! | formulas of a model whose drift is compiled | the drift is what they say |
//! | [`Facts::period`] | drift and noise repeat after it; without one they do not change with time |
//! | [`Facts::symmetry`] | the image of a state has the image of its drift, its noise and its exact density |
//! | `Facts::bounds` | at a bound the drift points inward or along, and noise does not act across |
//! | [`Facts::filtered_noise`] | its drift and noise are those of a linear filter with this mean and deviation |
//! | [`Facts::relaxation_rates`] | no noise acts on the axis, and its drift falls with the coordinate at this rate everywhere |
//! | [`System::exact_log_density`] | solves the stationary Fokker-Planck equation (central differences) |
//! | [`Facts::switching_surfaces`] | drift or its slope jumps there |
//!
//! States are the same at every call; two calls give the same answer.

mod declarations;
mod density;
mod relaxing;
mod surfaces;
#[cfg(test)]
pub(super) mod tests;
mod trial;
mod violation;

pub use violation::{ContractViolation, Quantity};

use std::collections::HashSet;

#[cfg(doc)]
use super::Facts;
use super::{Model, ParameterValues, System};
use crate::formula::tape::Tape;
use trial::Trial;

/// Whether what a system declares holds at random states of the box `ranges` (one range an axis, those of the domain Ω
/// for example; within the system's own bounds).
///
/// A surface across which the drift is smooth is found last, and does no harm: a friction law declares its surface at a
/// friction level of zero too. Who allows that passes over [`ContractViolation::SmoothSurface`].
///
/// ```
/// use pbif::system::{Facts, Lanes, Noise, Symmetry, System, contract};
///
/// /// dx = (0.1 + x - x³) dt + 0.5 dW, with a symmetry that it does not have.
/// struct Tilted { noise: [Noise; 1], facts: Facts }
///
/// impl System for Tilted {
///     fn dimension(&self) -> usize {
///         1
///     }
///     fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
///         drift[0] = states[0].map(|x| 0.1 + x * (1.0 - x * x));
///     }
///     fn noises(&self) -> &[Noise] {
///         &self.noise
///     }
///     fn facts(&self) -> &Facts {
///         &self.facts
///     }
/// }
///
/// let symmetry = Some(Symmetry::about_origin(1));
/// let facts = Facts { symmetry, ..Facts::default() };
/// let refused = contract::verify(&Tilted { noise: [Noise::constant(0, 0.5)], facts }, &[(-2.0, 2.0)]);
/// assert!(matches!(refused, Err(contract::ContractViolation::Asymmetric { .. })));
/// ```
///
/// # Errors
/// The first [`ContractViolation`] that is found, with a state at which it shows.
pub fn verify(system: &dyn System, ranges: &[(f64, f64)]) -> Result<(), ContractViolation> {
    verify_with(system, ranges, None)
}

/// As [`verify`]; with formulas that say the same as the drift.
fn verify_with(
    system: &dyn System,
    ranges: &[(f64, f64)],
    formulas: Option<&Tape>,
) -> Result<(), ContractViolation> {
    let ranges = declarations::check(system, ranges)?;
    let trial = Trial::new(system, ranges)?;
    if let Some(formulas) = formulas {
        trial.check_formulas(formulas)?;
    }
    trial.check_time()?;
    trial.check_symmetry()?;
    trial.check_bounds()?;
    trial.check_filters()?;
    trial.check_relaxations()?;
    density::check(&trial)?;
    surfaces::check(&trial)
}

/// As [`verify`] for a model with these parameter values; also that a compiled drift is what the model's formulas say,
/// that the model describes every axis, names nothing twice, and allows its own defaults.
///
/// # Errors
/// The first [`ContractViolation`] that is found.
pub fn verify_model(
    model: &Model,
    values: &ParameterValues,
    ranges: &[(f64, f64)],
) -> Result<(), ContractViolation> {
    let axes = model.axes.iter().map(|axis| &axis.name);
    let parameters = model.parameters.iter().map(|one| &one.name);
    let mut names = HashSet::new();
    for name in axes.chain(parameters) {
        if !names.insert(name) {
            let name = name.clone();
            return Err(ContractViolation::NameTwice { name });
        }
    }
    for parameter in &model.parameters {
        if let Some(value) = parameter.default.filter(|&v| !parameter.range.contains(v)) {
            let parameter = parameter.name.clone();
            return Err(ContractViolation::Default { parameter, value });
        }
    }
    let system = model.system(values);
    let (described, dimension) = (model.axes.len(), system.dimension());
    if described != dimension {
        return Err(ContractViolation::AxesDescribed {
            described,
            dimension,
        });
    }
    // Filters of coloured noise have no formulas.
    let typed = model
        .formulas()
        .filter(|_| !model.noise_kind().is_coloured());
    let formulas = typed.and_then(|typed| typed.drift(values.as_slice()));
    verify_with(system.as_ref(), ranges, formulas.as_ref())
}
