//! Settings of stochastic generalized cell mapping and their defaults.

use crate::continuation::CellCheck;
use crate::method::StepChoice;
use crate::method::report::ESCAPE_LIMIT;
use crate::sampling::Integrator;
use crate::stationary::Solver;

/// What SGCM takes the density inside a cell for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Correction {
    /// Linear, with the slope that the neighbouring cells show.
    Slope,
    /// Flat: the paper's method.
    None,
}

words! { Correction, pub name: Slope: "slope", None: "none" }

/// Settings of stochastic generalized cell mapping.
#[derive(Debug, Clone, PartialEq)]
pub struct SgcmOptions {
    /// Time one transition spans.
    pub map_step: StepChoice,
    /// Step of the trajectory integrator.
    pub time_step: StepChoice,
    /// Trajectories started in each cell.
    pub samples: usize,
    /// Seed of the random streams.
    pub seed: u64,
    /// Integrator of the trajectories.
    pub integrator: Integrator,
    /// Groups the samples are split into to estimate the sampling error of the density (delete-a-group jackknife).
    pub replicates: usize,
    /// What the density inside a cell is taken for.
    pub correction: Correction,
    /// Solver of the steady state.
    pub solver: Solver,
    /// L1 error at which the solver stops.
    pub solver_tolerance: f64,
    /// Largest share of the mass that may leave Ω within one relaxation time before there is said to be no
    /// steady state.
    pub escape_limit: f64,
}

impl SgcmOptions {
    /// Not at all: cells add diffusion of their own, which moves what is found, and the noise of other cells is
    /// another.
    pub(crate) const CELL_CHECK: CellCheck = CellCheck::Impossible;
}

impl Default for SgcmOptions {
    fn default() -> Self {
        Self {
            map_step: StepChoice::Auto,
            time_step: StepChoice::Auto,
            samples: 2000,
            seed: 1,
            integrator: Integrator::WeakSplitting,
            replicates: 8,
            correction: Correction::Slope,
            solver: Solver::MultilevelAggregation,
            solver_tolerance: 1e-10,
            escape_limit: ESCAPE_LIMIT,
        }
    }
}
