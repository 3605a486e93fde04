//! Settings of the methods and their defaults, the only place where these defaults stand.

use crate::sampling::Integrator;
use crate::stationary::Solver;

/// A step that is given, or left to the program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepChoice {
    /// Chosen from the system, the cells and the noise.
    Auto,
    /// Given, in the system's unit of time.
    Fixed(f64),
}

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
    /// Solver of the steady state.
    pub solver: Solver,
    /// L1 error at which the solver stops.
    pub solver_tolerance: f64,
    /// Largest share of the mass that may leave Ω within one relaxation time before there is said to be no
    /// steady state.
    pub escape_limit: f64,
}

impl Default for SgcmOptions {
    fn default() -> Self {
        Self {
            map_step: StepChoice::Auto,
            time_step: StepChoice::Auto,
            samples: 2000,
            seed: 1,
            integrator: Integrator::StochasticHeun,
            replicates: 8,
            solver: Solver::MultilevelAggregation,
            solver_tolerance: 1e-10,
            escape_limit: 0.5,
        }
    }
}
