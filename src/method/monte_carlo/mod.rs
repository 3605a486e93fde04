//! Free trajectories: their settings, the plan of a sweep, the source.

mod options;
mod source;

pub use options::{Estimator, MonteCarloOptions};
pub use source::{MonteCarloPlan, MonteCarloSource};
