//! How the densities of a solved point answer to parameters: Q du = -(dQ/dθ) u with the factorisation that solved it.

use std::sync::Arc;

use super::GeneratorSource;
use super::jumps::Kinked;
use crate::continuation::{Sensitivity, SourceError};
use crate::generator::{GeneratorOptions, assemble_derivative, cell_masses};
use crate::method::MethodError;
use crate::stationary::generator::RateSolver;
use crate::system::{System, SystemError};

/// Relative error of derivatives, in L1: a slope of an indicator to about as many digits as the indicator itself has.
const ACCURACY: f64 = 1e-6;

/// Size of the change of the unknowns, relative in L1, by which their map to masses is differentiated. It is linear but
/// for its norm, so that the error is this squared times the small change of the norm.
const SHARE: f64 = 1e-3;

/// The answer of one solved point.
pub(super) struct GeneratorSensitivity<'session> {
    pub(super) source: &'session GeneratorSource,
    pub(super) solver: &'session mut RateSolver,
    pub(super) value: f64,
    pub(super) system: Arc<dyn System>,
    /// The generator's unknowns, Σ = 1.
    pub(super) unknowns: Arc<Vec<f64>>,
}

impl Sensitivity for GeneratorSensitivity<'_> {
    fn to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        let varied = self.source.varied(self.value, name)?;
        Ok(self.of(|value| varied.at(value), varied.value)?)
    }

    fn jumps_to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        let varied = self.source.varied(self.value, name)?;
        let (source, space) = (self.source, self.source.problem.space());
        let masses = cell_masses(self.system.as_ref(), space, &self.unknowns);
        let kinked = Kinked {
            source,
            coordinate: self.value,
            masses: &masses,
        };
        let at = |value| varied.at(value);
        Ok(kinked.changes(at, varied.value, || self.rates(at, varied.value))?)
    }

    fn along_path(&mut self) -> Result<Vec<Vec<f64>>, SourceError> {
        let family = self.source.problem.family().clone();
        Ok(self.of(|value| family.at(value), self.value)?)
    }
}

impl GeneratorSensitivity<'_> {
    /// Of systems that depend on one number, at its value. The formulas of quantities are held.
    fn of(
        &mut self,
        system_at: impl Fn(f64) -> Result<Arc<dyn System>, SystemError>,
        value: f64,
    ) -> Result<Vec<Vec<f64>>, MethodError> {
        let masses = self.rates(system_at, value)?;
        let problem = &self.source.problem;
        self.source.maps(self.value)?.changes(problem, &masses)
    }

    /// The same of the masses of the cells.
    fn rates(
        &mut self,
        system_at: impl Fn(f64) -> Result<Arc<dyn System>, SystemError>,
        value: f64,
    ) -> Result<Vec<f64>, MethodError> {
        let problem = &self.source.problem;
        let options = GeneratorOptions {
            scheme: self.source.options.scheme,
        };
        let derivative = assemble_derivative(system_at, value, problem.space(), &options)
            .map_err(|error| self.source.refused(error))?;
        let (matrix, unknowns) = (&derivative.matrix, self.unknowns.as_slice());
        let change = self
            .solver
            .sensitivity_within(matrix, unknowns, None, ACCURACY)?;
        Ok(self.change_of_masses(&change))
    }

    /// By how much the masses of the cells change with the unknowns, to first order.
    fn change_of_masses(&self, change: &[f64]) -> Vec<f64> {
        let size: f64 = change.iter().map(|value| value.abs()).sum();
        let step = SHARE / size.max(f64::MIN_POSITIVE);
        let masses = |step: f64| {
            let pairs = self.unknowns.iter().zip(change);
            let moved: Vec<f64> = pairs.map(|(u, du)| u + step * du).collect();
            cell_masses(self.system.as_ref(), self.source.problem.space(), &moved)
        };
        let pairs = masses(step).into_iter().zip(masses(-step));
        pairs.map(|(up, down)| (up - down) / (2.0 * step)).collect()
    }
}
