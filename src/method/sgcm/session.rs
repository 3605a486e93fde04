//! SGCM at work: samples grow from the cells that the nearest solved point used, and its masses are the guess.

use std::sync::Arc;

use super::SgcmSource;
use crate::cancellation::Cancellation;
use crate::continuation::{Session, Solution, SourceError};
use crate::method::MethodError;
use crate::method::neighbours::Neighbours;

/// Owns the masses of the solved points.
pub(super) struct SgcmSession {
    source: SgcmSource,
    masses: Neighbours<Arc<Vec<f64>>>,
    cancellation: Cancellation,
}

impl SgcmSession {
    pub(super) fn new(source: &SgcmSource, cancellation: &Cancellation) -> Self {
        Self {
            source: source.clone(),
            masses: Neighbours::default(),
            cancellation: cancellation.clone(),
        }
    }

    fn solve_from_nearest(&mut self, value: f64) -> Result<Solution<'static>, MethodError> {
        let (source, cancellation) = (&self.source, &self.cancellation);
        let start = self.masses.nearest(value).cloned();
        let start = start.as_ref().map(|mass| mass.as_slice());
        let point = source.sample_at(value, start, cancellation)?;
        let correction = source.correction();
        let (solution, mass) = source.solve_sampled(&point, correction, start, cancellation)?;
        if let Some(mass) = mass {
            let bytes = size_of_val(mass.as_slice());
            self.masses.keep(value, Arc::new(mass), bytes);
        }
        Ok(solution)
    }
}

impl Session for SgcmSession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        Ok(self.solve_from_nearest(value)?)
    }
}
