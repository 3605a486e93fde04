//! Settings of Monte Carlo and their defaults.

use crate::continuation::CellCheck;
use crate::method::StepChoice;
use crate::method::report::ESCAPE_LIMIT;
use crate::sampling::Integrator;

/// How free trajectories make a density.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// A fixed number of long trajectories, averaged over time.
    Ergodic,
    /// Many trajectories, counted at one time.
    Ensemble,
}

words! { Estimator, pub name: Ergodic: "ergodic", Ensemble: "ensemble" }

/// Settings of Monte Carlo.
#[derive(Debug, Clone, PartialEq)]
pub struct MonteCarloOptions {
    /// How the density is made.
    pub estimator: Estimator,
    /// Step of the trajectory integrator.
    pub time_step: StepChoice,
    /// Time before states are counted.
    pub burn_in: StepChoice,
    /// Time during which the states of one trajectory are counted (ergodic).
    pub length: StepChoice,
    /// Wanted relative standard error of the variance of every axis; what is left to the program is chosen for it.
    pub error: f64,
    /// Number of trajectories.
    pub trajectories: StepChoice,
    /// Paths that are followed for each passage that is asked for.
    pub passages: usize,
    /// Time at which a path of a passage that still goes on is given up.
    pub longest_passage: StepChoice,
    /// Seed of the random streams.
    pub seed: u64,
    /// Integrator of the trajectories.
    pub integrator: Integrator,
    /// Largest share of the time outside Ω, or of the trajectories that run away within one autocorrelation time,
    /// before there is said to be no steady state.
    pub escape_limit: f64,
}

impl MonteCarloOptions {
    /// It need not be checked: cells only count.
    pub(crate) const CELL_CHECK: CellCheck = CellCheck::Needless;

    /// Integrator steps of the paths of a passage, at most, where nothing else is said.
    pub(super) const PASSAGE_STEPS: f64 = 1e9;
}

impl Default for MonteCarloOptions {
    fn default() -> Self {
        Self {
            estimator: Estimator::Ergodic,
            time_step: StepChoice::Auto,
            burn_in: StepChoice::Auto,
            length: StepChoice::Auto,
            // About ten seconds for the paper's first example on two cores.
            error: 0.002,
            trajectories: StepChoice::Auto,
            // A mean time of an exponential distribution to 0.8 %.
            passages: 16_384,
            longest_passage: StepChoice::Auto,
            seed: 1,
            integrator: Integrator::StochasticHeun,
            escape_limit: ESCAPE_LIMIT,
        }
    }
}
