//! What a sweep sees of the generator: a source that opens sessions, and sessions that solve and remember.

#[cfg(feature = "serde")]
use super::memory;
use super::session::GeneratorSession;
use super::source::{GeneratorSource, METHOD};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource, Session, Solution, SourceError, Subject, Want};
use crate::method::MethodError;

impl DensitySource for GeneratorSource {
    fn method(&self) -> &'static str {
        METHOD
    }

    fn subject(&self) -> &Subject {
        self.problem.subject()
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        Box::new(GeneratorSession::new(self, cancellation))
    }

    fn segments(&self, values: usize) -> usize {
        self.options.segments(self.problem.space(), values)
    }

    fn cells(&self) -> Option<usize> {
        Some(self.problem.space().n_cells())
    }

    fn finer(&self, want: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        Ok(Some(Box::new(self.refined(want)?)))
    }

    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        let closed_ends = vec![[true; 2]; self.closed_ends.len()];
        Some(Box::new(Self {
            enclosed: true,
            checks: !want.errors,
            closed_ends,
            problem: self.problem.wanting(want),
            ..self.clone()
        }))
    }
}

impl Session for GeneratorSession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        let origin = self.source.problem.family().origin_at(value);
        let origin = origin.map_err(MethodError::from)?;
        let mut solution = self.solve_from_nearest(value)?;
        if let Some((axis, at)) = origin {
            // It is one at a fixed distance from the origin.
            solution.sensitivity = None;
            for density in &mut solution.densities {
                density.displace(axis, at);
            }
            for finding in &mut solution.report.findings {
                finding.displace(axis, at);
            }
        }
        Ok(solution)
    }

    #[cfg(feature = "serde")]
    fn memory(&self) -> Vec<u8> {
        memory::write(self)
    }

    #[cfg(feature = "serde")]
    fn recall(&mut self, left: &[(f64, &[u8])]) -> Result<(), SourceError> {
        memory::recall(self, left)
    }
}
