//! Stochastic generalized cell mapping (SGCM): transition probabilities between cells, estimated by
//! sampled trajectories.

mod transition;

pub use transition::TransitionMatrix;
