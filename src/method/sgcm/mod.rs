//! Stochastic generalized cell mapping: its settings, what a point costs, the choice of its steps, the slope
//! correction, the source, its solutions, its session.

#[cfg(test)]
mod angles_tests;
mod cost;
mod options;
mod passages;
mod phases;
#[cfg(test)]
mod phases_tests;
mod replicates;
#[cfg(test)]
mod replicates_tests;
mod session;
mod slope_correction;
mod solved;
mod source;
mod steps;
mod velocities;
mod visits;
mod widening;

pub(crate) use cost::SgcmCost;
pub use options::{Correction, SgcmOptions};
#[cfg(feature = "store")]
pub(crate) use phases::FEWEST_PHASES;
pub use slope_correction::{Corrected, solve_corrected};
pub use source::SgcmSource;
