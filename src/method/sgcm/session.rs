//! SGCM at work: samples grow from the cells that the nearest solved point used, and its masses are the guess.

use std::sync::Arc;

use super::SgcmSource;
use super::source::METHOD;
#[cfg(feature = "serde")]
use crate::bytes::{NotWhatWasWritten, from_bytes, to_bytes};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource, Session, Solution, SourceError, Subject};
use crate::method::MethodError;
use crate::method::neighbours::Neighbours;

/// Owns the masses of the solved points.
pub(super) struct SgcmSession {
    source: SgcmSource,
    masses: Neighbours<Arc<Vec<f64>>>,
    /// Whether the last solve has left some.
    has_left: bool,
    cancellation: Cancellation,
}

impl SgcmSession {
    pub(super) fn new(source: &SgcmSource, cancellation: &Cancellation) -> Self {
        Self {
            source: source.clone(),
            masses: Neighbours::default(),
            has_left: false,
            cancellation: cancellation.clone(),
        }
    }

    fn solve_from_nearest(&mut self, value: f64) -> Result<Solution<'static>, MethodError> {
        self.has_left = false;
        let (source, cancellation) = (&self.source, &self.cancellation);
        let start = self.masses.nearest(value).cloned();
        let start = start.as_ref().map(|mass| mass.as_slice());
        let point = source.sample_at(value, start, cancellation)?;
        let correction = source.correction();
        let (solution, mass) = source.solve_sampled(&point, correction, start, cancellation)?;
        if let Some(mass) = mass {
            self.keep(value, mass);
        }
        Ok(solution)
    }

    fn keep(&mut self, value: f64, mass: Vec<f64>) {
        let bytes = size_of_val(mass.as_slice());
        self.masses.keep(value, Arc::new(mass), bytes);
        self.has_left = true;
    }
}

impl Session for SgcmSession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        Ok(self.solve_from_nearest(value)?)
    }

    #[cfg(feature = "serde")]
    fn memory(&self) -> Vec<u8> {
        let left = self.masses.newest().filter(|_| self.has_left);
        left.map_or_else(Vec::new, |(_, mass)| to_bytes(mass.as_slice()))
    }

    #[cfg(feature = "serde")]
    fn recall(&mut self, left: &[(f64, &[u8])]) -> Result<(), SourceError> {
        let cells = self.source.cells();
        for (value, bytes) in left.iter().filter(|(_, bytes)| !bytes.is_empty()) {
            let mass: Vec<f64> = from_bytes(bytes)?;
            if mass.len() != cells {
                return Err(NotWhatWasWritten.into());
            }
            self.keep(*value, mass);
        }
        Ok(())
    }
}

impl DensitySource for SgcmSource {
    fn method(&self) -> &'static str {
        METHOD
    }

    fn subject(&self) -> &Subject {
        self.subject()
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        Box::new(SgcmSession::new(self, cancellation))
    }
}
