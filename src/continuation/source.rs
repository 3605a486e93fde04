//! The seam of a sweep: whatever can give densities at a parameter value, starting from a neighbour's.

use super::SolveReport;
use crate::density::{EstimatedDensity, Moments, Observable};
use crate::system::Family;

/// A solve's result: densities, report, and what warm-starts the neighbour.
#[derive(Debug, Clone)]
pub struct Solution<State> {
    /// How it went.
    pub report: SolveReport,
    /// Mean and standard deviation of every axis; empty without a density.
    pub moments: Vec<Moments>,
    /// The observed densities in the order the source was asked for; empty without a density.
    pub densities: Vec<EstimatedDensity>,
    /// Start for a neighbour; `None` without a density.
    pub state: Option<State>,
}

impl<State> Solution<State> {
    /// A solution without densities, for the reason that the report gives.
    pub fn without_density(report: SolveReport) -> Self {
        Self {
            report,
            moments: Vec::new(),
            densities: Vec::new(),
            state: None,
        }
    }
}

/// Why a source cannot give a solution at all. A failed solve is data, not an error: see
/// [`PointStatus`](super::PointStatus).
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The source was asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// The method refuses, for example because the parameter value is not allowed.
    #[error(transparent)]
    Method(#[from] Box<dyn std::error::Error + Send + Sync>),
}

/// What a source gives densities of.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Systems along a path; the ends of the path are those of a sweep.
    pub family: Family,
    /// The densities that are watched, in the order in which a source gives them.
    pub observables: Vec<Observable>,
}

/// A source of densities along a path through the parameters of a model.
pub trait DensitySource {
    /// What a solution leaves for its neighbour (a mass vector, a factorisation).
    type State;

    /// What it gives densities of.
    fn subject(&self) -> &Subject;

    /// Densities at a parameter value, warm-started from a neighbour's state where one is given.
    ///
    /// # Errors
    /// [`SourceError`] when the value is not allowed. Failed solves are reported in the solution.
    fn solve(
        &self,
        value: f64,
        start: Option<&Self::State>,
    ) -> Result<Solution<Self::State>, SourceError>;

    /// The same source on finer cells, to check what was found; `None` where there is none, or it would say
    /// nothing (sampling errors differ from grid to grid).
    fn finer(&self) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// Bytes that a state takes, for the sweep to decide how many to keep.
    fn state_bytes(&self, state: &Self::State) -> usize {
        size_of_val(state)
    }
}
