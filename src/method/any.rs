//! A source by any method, chosen at run time.

use super::exponents::WithExponents;
use super::{GeneratorSource, MethodError, MethodOptions, MonteCarloSource, Problem, SgcmSource};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource, Session, SourceError, Subject, Want};
use crate::system::ExponentMethod;

/// A source of densities by one of the methods.
pub enum MethodSource {
    /// The generator.
    Generator(Box<GeneratorSource>),
    /// Stochastic generalized cell mapping.
    Sgcm(Box<SgcmSource>),
    /// Free trajectories.
    MonteCarlo(Box<MonteCarloSource>),
}

impl MethodSource {
    /// Prepares a source by the method that the options name; see the sources.
    ///
    /// # Errors
    /// [`MethodError`].
    pub fn new(
        problem: &Problem,
        options: &MethodOptions,
        cancellation: &Cancellation,
    ) -> Result<Self, MethodError> {
        Ok(match options {
            MethodOptions::Generator(options) => {
                Self::Generator(Box::new(GeneratorSource::new(problem, options)?))
            }
            MethodOptions::Sgcm(options) => {
                Self::Sgcm(Box::new(SgcmSource::new(problem, options, cancellation)?))
            }
            MethodOptions::MonteCarlo(options) => Self::MonteCarlo(Box::new(
                MonteCarloSource::new(problem, options, cancellation)?,
            )),
        })
    }

    /// What a user may want to know before the first point: the steps that were chosen.
    pub(crate) fn describe(&self) -> String {
        match self {
            Self::Generator(_) => "generator".to_owned(),
            Self::Sgcm(source) => format!(
                "sgcm, map step {:.4}, time step {:.4}",
                source.map_step(),
                source.time_step()
            ),
            Self::MonteCarlo(source) => source.describe(),
        }
    }

    fn problem(&self) -> &Problem {
        match self {
            Self::Generator(source) => source.problem(),
            Self::Sgcm(source) => source.problem(),
            Self::MonteCarlo(source) => source.problem(),
        }
    }

    fn source(&self) -> &dyn DensitySource {
        match self {
            Self::Generator(source) => source.as_ref(),
            Self::Sgcm(source) => source.as_ref(),
            Self::MonteCarlo(source) => source.as_ref(),
        }
    }
}

impl DensitySource for MethodSource {
    fn method(&self) -> &'static str {
        self.source().method()
    }

    fn subject(&self) -> &Subject {
        self.source().subject()
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        let session = self.source().open(cancellation);
        let questions = &self.subject().family.questions;
        let by_paths = questions.largest_exponent == Some(ExponentMethod::Trajectories);
        if questions.fixed_point.is_none() && !by_paths {
            return session;
        }
        Box::new(WithExponents {
            session,
            problem: self.problem().clone(),
            cancellation: cancellation.clone(),
            method: self.method(),
            was_solved: false,
        })
    }

    fn segments(&self, values: usize) -> usize {
        self.source().segments(values)
    }

    fn cells(&self) -> Option<usize> {
        self.source().cells()
    }

    fn finer(&self, want: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        self.source().finer(want)
    }

    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        self.source().enclosed(want)
    }
}
