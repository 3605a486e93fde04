//! Numbers of a value beside its densities, by all methods: moments, rates, times of first passage.

use super::{ComparedValue, Method};
use crate::continuation::Measure;

/// A number of the steady state by the generator, by Monte Carlo and by SGCM, each with its error.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ComparedMeasure {
    /// Its name, as in the tables of a sweep.
    pub(crate) name: String,
    /// By the generator.
    pub(crate) generator: (f64, f64),
    /// By Monte Carlo.
    pub(crate) monte_carlo: (f64, f64),
    /// By SGCM with densities linear inside the cells, where it gives this number with an error.
    pub(crate) sgcm: Option<(f64, f64)>,
}

impl ComparedMeasure {
    /// Monte Carlo less the generator, in units of both errors.
    pub(crate) fn apart(&self) -> f64 {
        apart(self.monte_carlo, self.generator)
    }

    /// SGCM less the generator, in units of both errors.
    pub(crate) fn sgcm_apart(&self) -> Option<f64> {
        self.sgcm.map(|sgcm| apart(sgcm, self.generator))
    }
}

fn apart(one: (f64, f64), other: (f64, f64)) -> f64 {
    (one.0 - other.0) / one.1.hypot(other.1)
}

impl ComparedValue {
    /// The numbers that both the generator and Monte Carlo give with an error.
    pub(crate) fn measures(&self) -> Vec<ComparedMeasure> {
        let of = |method| {
            let mut all = self.solved.iter();
            let solved = all.find(|solved| solved.method == method);
            solved.map_or(&[][..], |solved| &solved.report.measures)
        };
        let by = |method, name: &str| {
            let found = of(method).iter().find(|other| other.name == name)?;
            Some((found.value, found.error?))
        };
        let compared = |one: &Measure| {
            Some(ComparedMeasure {
                name: one.name.clone(),
                generator: (one.value, one.error?),
                monte_carlo: by(Method::MonteCarlo, &one.name)?,
                sgcm: by(Method::SgcmSlope, &one.name),
            })
        };
        of(Method::Generator).iter().filter_map(compared).collect()
    }
}
