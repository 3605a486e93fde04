//! Stochastic generalized cell mapping (SGCM): transition probabilities between cells, estimated by
//! sampled trajectories.

mod integrator;
mod transition;

pub use integrator::Integrator;
pub use transition::TransitionMatrix;
