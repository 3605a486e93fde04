//! A source by any method, chosen at run time.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::{
    GeneratorSource, MethodError, MethodOptions, MonteCarloSource, Problem, SgcmSource, State,
};
use crate::continuation::{DensitySource, Solution, SourceError, Subject};

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
        cancelled: Arc<AtomicBool>,
    ) -> Result<Self, MethodError> {
        Ok(match options {
            MethodOptions::Generator(options) => {
                Self::Generator(Box::new(GeneratorSource::new(problem, options, cancelled)?))
            }
            MethodOptions::Sgcm(options) => {
                Self::Sgcm(Box::new(SgcmSource::new(problem, options, cancelled)?))
            }
            MethodOptions::MonteCarlo(options) => Self::MonteCarlo(Box::new(
                MonteCarloSource::new(problem, options, cancelled)?,
            )),
        })
    }

    /// What a user may want to know before the first point: the steps that were chosen.
    pub fn describe(&self) -> String {
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
}

impl DensitySource for MethodSource {
    type State = State;

    fn subject(&self) -> &Subject {
        match self {
            Self::Generator(source) => source.subject(),
            Self::Sgcm(source) => source.subject(),
            Self::MonteCarlo(source) => source.subject(),
        }
    }

    fn solve(&self, value: f64, start: Option<&State>) -> Result<Solution<State>, SourceError> {
        match self {
            Self::Generator(source) => source.solve(value, start),
            Self::Sgcm(source) => source.solve(value, start),
            Self::MonteCarlo(source) => source.solve(value, start),
        }
    }

    fn finer(&self) -> Option<Self> {
        match self {
            Self::Generator(source) => source.finer().map(Box::new).map(Self::Generator),
            // The noise of another grid is another one: it would say nothing of the cells.
            Self::Sgcm(_) | Self::MonteCarlo(_) => None,
        }
    }

    fn state_bytes(&self, state: &State) -> usize {
        match self {
            Self::Generator(source) => source.state_bytes(state),
            Self::Sgcm(source) => source.state_bytes(state),
            Self::MonteCarlo(source) => source.state_bytes(state),
        }
    }
}
