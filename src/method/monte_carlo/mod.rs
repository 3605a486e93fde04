//! Free trajectories: their settings, what a point costs, the plan of a sweep, the source.

mod answers;
mod cost;
mod options;
mod passages;
mod plan;
mod source;
mod transitions;
#[cfg(test)]
pub(in crate::method) mod turns_tests;
mod visits;

pub(crate) use cost::MonteCarloCost;
pub use options::{Estimator, MonteCarloOptions};
pub(crate) use plan::MonteCarloPlan;
pub use source::MonteCarloSource;
