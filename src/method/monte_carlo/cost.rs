//! What a point costs by Monte Carlo: a count and a replicate's mass for each cell and block, and integrator steps.

use super::{Estimator, MonteCarloOptions};
use crate::method::StepChoice;
use crate::monte_carlo::BLOCKS;

/// Steps a second by Heun's integrator with looks, on two ordinary cores. Measured (`docs/monte-carlo.md`), good to a
/// factor of two.
const STEPS_A_SECOND: f64 = 3e8;

/// The same of paths that look at the border of a region after each step (0.5e8 to 1e8 measured).
const PASSAGE_STEPS_A_SECOND: f64 = 7e7;

/// What a point costs by Monte Carlo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MonteCarloCost {
    /// Bytes at work.
    pub(crate) bytes: f64,
    /// Integrator steps of all trajectories; `None` where they depend on what is chosen when the sweep runs.
    pub(crate) steps: Option<f64>,
}

impl MonteCarloCost {
    /// Seconds of one passage at most, where its longest time is left to the program; good to a factor of two.
    pub(crate) const PASSAGE_SECONDS: f64 =
        MonteCarloOptions::PASSAGE_STEPS / PASSAGE_STEPS_A_SECOND;

    /// Seconds on two ordinary cores, good to a factor of two, where the steps are known.
    pub(crate) fn seconds(&self) -> Option<f64> {
        self.steps.map(|steps| steps / STEPS_A_SECOND)
    }
}

impl MonteCarloOptions {
    /// What a point costs on so many cells.
    pub(crate) fn cost(&self, n_cells: f64) -> MonteCarloCost {
        MonteCarloCost {
            bytes: n_cells * 16.0 * BLOCKS as f64,
            steps: self.steps(),
        }
    }

    fn steps(&self) -> Option<f64> {
        let given = |choice: StepChoice| match choice {
            StepChoice::Fixed(value) => Some(value),
            StepChoice::Auto => None,
        };
        let length = match self.estimator {
            Estimator::Ergodic => given(self.length)?,
            Estimator::Ensemble => 0.0,
        };
        let time = given(self.burn_in)? + length;
        Some(given(self.trajectories)? * time / given(self.time_step)?)
    }
}
