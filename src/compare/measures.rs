//! Numbers of a value beside its densities, by generator and Monte Carlo: moments, rates, times of first passage.

use super::{ComparedValue, Method};
use crate::continuation::Measure;

/// A number of the steady state by the generator and by Monte Carlo, each with its error.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeasurePair {
    /// Its name, as in the tables of a sweep.
    pub(crate) name: String,
    /// By the generator.
    pub(crate) generator: (f64, f64),
    /// By Monte Carlo.
    pub(crate) monte_carlo: (f64, f64),
}

impl MeasurePair {
    /// The difference in units of both errors.
    pub(crate) fn apart(&self) -> f64 {
        let difference = self.monte_carlo.0 - self.generator.0;
        difference / self.monte_carlo.1.hypot(self.generator.1)
    }
}

impl ComparedValue {
    /// The numbers that both the generator and Monte Carlo give with an error.
    pub(crate) fn measures(&self) -> Vec<MeasurePair> {
        let of = |method| {
            let mut all = self.solved.iter();
            let solved = all.find(|solved| solved.method == method);
            solved.map_or(&[][..], |solved| &solved.report.measures)
        };
        let pair = |one: &Measure| {
            let mut others = of(Method::MonteCarlo).iter();
            let other = others.find(|other| other.name == one.name)?;
            Some(MeasurePair {
                name: one.name.clone(),
                generator: (one.value, one.error?),
                monte_carlo: (other.value, other.error?),
            })
        };
        of(Method::Generator).iter().filter_map(pair).collect()
    }
}
