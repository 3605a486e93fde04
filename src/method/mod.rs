//! Methods: sources of densities for a sweep, each made of the modules before it and each in a wing of its own.

mod any;
mod cost;
mod generator;
mod monte_carlo;
mod options;
mod problem;
mod range;
mod report;
mod sgcm;
mod state;
mod structure;
mod time_step;

pub use any::MethodSource;
pub use cost::Cost;
pub use generator::{GeneratorCost, GeneratorMethodOptions, GeneratorSource};
pub use monte_carlo::{
    Estimator, MonteCarloCost, MonteCarloOptions, MonteCarloPlan, MonteCarloSource,
};
pub use options::{MethodOptions, StepChoice};
pub use problem::Problem;
pub use range::automatic_ranges;
pub use sgcm::{
    Corrected, Correction, SampledPoint, SgcmCost, SgcmOptions, SgcmSource, solve_corrected,
};
pub use state::State;

use crate::system::System;

/// Why a method cannot give a solution at all. Failed solves are data, see
/// [`PointStatus`](crate::continuation::PointStatus).
#[derive(Debug, thiserror::Error)]
pub enum MethodError {
    /// The cells have another number of axes than the model.
    #[error("the model has {axes} axes, the cells have {cells}")]
    Dimension {
        /// Axes of the model.
        axes: usize,
        /// Axes of the cells.
        cells: usize,
    },
    /// A parameter value is not allowed.
    #[error(transparent)]
    System(#[from] crate::system::SystemError),
    /// The drift depends on time.
    #[error(transparent)]
    Periodic(#[from] crate::system::PeriodicDrift),
    /// Transitions could not be sampled.
    #[error(transparent)]
    Sampling(#[from] crate::sampling::SamplingError),
    /// Free trajectories could not be run.
    #[error(transparent)]
    MonteCarlo(#[from] crate::monte_carlo::MonteCarloError),
    /// The generator could not be assembled.
    #[error(transparent)]
    Generator(#[from] crate::generator::GeneratorError),
    /// The generator cannot be solved.
    #[error(transparent)]
    Rates(#[from] crate::stationary::generator::RateError),
    /// The transition matrix cannot be solved.
    #[error(transparent)]
    Stationary(#[from] crate::stationary::StationaryError),
    /// A density could not be computed.
    #[error(transparent)]
    Density(#[from] crate::density::DensityError),
}

/// Nothing, if no system depends on time: densities that follow a period are not computed yet.
fn autonomous(systems: &[std::sync::Arc<dyn System>]) -> Result<(), MethodError> {
    for system in systems {
        system.autonomous()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
