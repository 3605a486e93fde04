//! Free trajectories as a reference: densities by counting visits, without a cell map and without a generator.
//!
//! [`relaxation()`] measures how long a system remembers; [`ergodic()`] averages a fixed number of long trajectories
//! over time, [`ensemble()`] counts many at one time; [`first_passages`] follows paths until they enter a region;
//! [`transitions()`] counts how often long ones go from one region to another;
//! [`sample_path`] follows a single one, to be looked at; `exponent_along_trajectories` finds
//! how fast neighbouring ones run apart; `step_bias` finds what a time step does to the density.
//!
//! # Decisions
//!
//! **A time step is honest or told.** Every method with trajectories compares its step with half of it on coupled
//! paths, once a sweep; the bias is a column.

mod advances;
mod autocorrelation;
mod batch;
mod cell_paths;
mod crossings;
mod ensemble;
mod ergodic;
mod estimate;
mod exit_times;
mod halving;
mod passage;
mod passing;
mod path;
mod phases;
mod relaxation;
mod tangent;
#[cfg(test)]
mod tests;
mod transitions;
mod turning;
mod walk;
mod watched;

pub use advances::Rotation;
pub(crate) use cell_paths::{CellPath, CellPaths, CellRun, PathEnd, PathsFrom};
pub use ensemble::{EnsembleRun, ensemble};
pub use ergodic::{ErgodicRun, ergodic};
pub(crate) use estimate::BLOCKS;
pub use estimate::Estimate;
pub use exit_times::{ExitNumber, ExitTimes};
pub(crate) use halving::{BiasedQuantity, StepBias, TOLERATED_BIAS, automatic_step, step_bias};
pub use passage::{PassageRun, PassageStart, SteadyStart, first_passages};
pub use path::{PathRun, SamplePath, sample_path};
pub use phases::Periodic;
pub use relaxation::{Relaxation, relaxation};
pub(crate) use tangent::{TangentRun, exponent_along_trajectories};
pub use transitions::{TransitionRun, Transitions, transitions};
pub use walk::PassageTarget;

use crate::space::CellSpace;
use crate::system::{PeriodicDrift, System};

/// Why a run of trajectories could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MonteCarloError {
    /// A time that is not a positive number.
    #[error("the {name} is {value}; it must be a finite number greater than zero")]
    Time {
        /// Which time.
        name: &'static str,
        /// The value that was given.
        value: f64,
    },
    /// No step between looks.
    #[error("looks at a trajectory must be at least one step apart")]
    Stride,
    /// Looks at a forced system that are not even parts of a period apart.
    #[error(
        "looks are {spacing} apart, and of a forced system they must be {wanted} apart: a period in {parts} parts"
    )]
    Phases {
        /// Time between looks.
        spacing: f64,
        /// What it must be.
        wanted: f64,
        /// Cells along the phase, each of which stands for the phase at its beginning.
        parts: usize,
    },
    /// Many trajectories at one time, of a forced system.
    #[error("an ensemble at one time shows a forced system at one phase: use time averages")]
    Ensemble,
    /// A start that does not have a finite value for each axis.
    #[error("a state to start from does not have one finite value an axis")]
    Start,
    /// No path can start: the state is inside the region that ends it, or the region to start from is hardly visited.
    #[error("no path starts outside of the region that ends it")]
    NoStart,
    /// The system and the cell space differ in dimension.
    #[error("the system has {system} axes, the cell space {space}")]
    Dimension {
        /// Axes of the system.
        system: usize,
        /// Axes of the cell space.
        space: usize,
    },
    /// The drift depends on time.
    #[error(transparent)]
    Periodic(#[from] PeriodicDrift),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] crate::cancellation::Cancelled),
}

impl MonteCarloError {
    /// Times must be finite and greater than zero; each with its name.
    fn check_times<const N: usize>(times: [(&'static str, f64); N]) -> Result<(), Self> {
        let is_wrong = |(_, value): &(&str, f64)| !(value.is_finite() && *value > 0.0);
        match times.into_iter().find(is_wrong) {
            Some((name, value)) => Err(Self::Time { name, value }),
            None => Ok(()),
        }
    }

    /// Whether the long-run density of the system can be counted on the cells of the space.
    fn check(system: &dyn System, space: &CellSpace) -> Result<(), Self> {
        system.facts().autonomous()?;
        let (system, space) = (system.dimension(), space.dimension());
        if system == space {
            Ok(())
        } else {
            Err(Self::Dimension { system, space })
        }
    }
}
