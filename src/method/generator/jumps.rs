//! How the jumps at the kinks of densities change with a parameter.
//!
//! They follow from the equations at once. Where the drift does not jump by as much all over the plane, they depend on
//! how the mass is spread over it as well, and only then is the change of the masses asked for, which takes a
//! triangular solve.

use std::sync::Arc;

use super::GeneratorSource;
use crate::method::MethodError;
use crate::system::{System, SystemError};

/// Step of differences, relative to the number that is varied (to `LEAST` where that is smaller). Their error is step⁴
/// times the fifth derivative over 30, and rounding over the step.
const STEP: f64 = 2e-3;
const LEAST: f64 = 1e-2;
/// A share of the largest jump by which jumps differ that do not depend on the masses.
const ROUNDING: f64 = 1e-9;

/// A solved point, as far as its kinks depend on it.
pub(super) struct Kinked<'a> {
    pub(super) source: &'a GeneratorSource,
    /// The path's coordinate.
    pub(super) coordinate: f64,
    pub(super) masses: &'a [f64],
}

impl Kinked<'_> {
    /// Changes of the jumps of every watched density, for systems that depend on one number, at its value; `change`
    /// gives those of the masses. Nothing where the number of jumps is not the same beside.
    pub(super) fn changes(
        &self,
        system_at: impl Fn(f64) -> Result<Arc<dyn System>, SystemError>,
        value: f64,
        change: impl FnOnce() -> Result<Vec<f64>, MethodError>,
    ) -> Result<Vec<Vec<f64>>, MethodError> {
        let here = system_at(value)?;
        let jumps = self.jumps(here.as_ref(), self.masses)?;
        let spread = self.jumps(here.as_ref(), &vec![1.0; self.masses.len()])?;
        let sizes = jumps.iter().chain(&spread).flatten();
        let largest = sizes.fold(0.0_f64, |most, jump| most.max(jump.abs()));
        let pairs = jumps.iter().flatten().zip(spread.iter().flatten());
        let depends = pairs
            .into_iter()
            .any(|(one, other)| (one - other).abs() > ROUNDING * largest);
        let change = if depends { change()? } else { Vec::new() };
        let step = STEP * value.abs().max(LEAST);
        let mut sums: Vec<Vec<f64>> = jumps.iter().map(|one| vec![0.0; one.len()]).collect();
        for (steps, weight) in [(2.0, -1.0), (1.0, 8.0), (-1.0, -8.0), (-2.0, 1.0)] {
            let offset = steps * step;
            let system = system_at(value + offset)?;
            let mut masses = self.masses.to_vec();
            let pairs = masses.iter_mut().zip(&change);
            pairs.for_each(|(mass, rate)| *mass += offset * rate);
            let beside = self.jumps(system.as_ref(), &masses)?;
            for (sums, jumps) in sums.iter_mut().zip(&beside) {
                if sums.len() != jumps.len() {
                    return Ok(Vec::new());
                }
                let pairs = sums.iter_mut().zip(jumps);
                pairs.for_each(|(sum, jump)| *sum += weight / (12.0 * step) * jump);
            }
        }
        Ok(sums)
    }

    /// The jumps of every watched density, one after the other.
    fn jumps(&self, system: &dyn System, masses: &[f64]) -> Result<Vec<Vec<f64>>, MethodError> {
        let (problem, kinked) = (&self.source.problem, &self.source.kinked);
        let maps = self.source.maps(self.coordinate)?;
        let of = |&observable| {
            let structure = maps.structure(system, problem, masses, observable, kinked);
            let jumps = structure.kinks.into_iter().flat_map(|kink| kink.jump);
            jumps.collect()
        };
        Ok(problem.observables().iter().map(of).collect())
    }
}
