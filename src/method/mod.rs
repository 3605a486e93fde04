//! Methods: sources of densities for a sweep, each made of the modules before it.

mod findings;
mod options;
mod sgcm;
mod steps;

pub use options::{SgcmOptions, StepChoice};
pub use sgcm::{Setting, SgcmSource};

/// Why a method cannot give a solution at all. Failed solves are data, see
/// [`PointStatus`](crate::continuation::PointStatus).
#[derive(Debug, thiserror::Error)]
pub enum MethodError {
    /// A parameter value is not allowed.
    #[error(transparent)]
    System(#[from] crate::system::SystemError),
    /// Transitions could not be sampled.
    #[error(transparent)]
    Sampling(#[from] crate::sampling::SamplingError),
    /// The transition matrix cannot be solved.
    #[error(transparent)]
    Stationary(#[from] crate::stationary::StationaryError),
    /// A density could not be computed.
    #[error(transparent)]
    Density(#[from] crate::density::DensityError),
}
