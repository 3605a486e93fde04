//! Free trajectories: their settings, the plan of a sweep, the source.

mod options;
mod plan;
mod source;

pub use options::{Estimator, MonteCarloOptions};
pub use plan::MonteCarloPlan;
pub use source::MonteCarloSource;
