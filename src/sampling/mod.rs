//! Stochastic generalized cell mapping (SGCM): transition probabilities between cells, estimated by
//! sampled trajectories.
//!
//! [`pilot`] looks at a system with a few free trajectories: where its mass is, and which steps suit it.
//! [`sample_transitions`] then samples every reachable cell.
//!
//! # Decisions
//!
//! **Streams are keyed by (seed, cell, sample), never by the parameter.** The transition matrix then varies smoothly
//! with the parameter, warm starts save work, and results depend neither on the number of threads nor on which cells
//! happen to be sampled first.
//!
//! **Only reachable cells are sampled.** Sampling grows from where a pilot's trajectories settle (and from the
//! neighbour's mass) until no new cell appears. A chain without the sink is split into strongly connected components;
//! the steady state lives on the closed one, or, with escape, on the one that keeps its mass longest. Several are
//! reported, not averaged.
//!
//! **A phase passes whole cells.** Trajectories of a forced system start at the very phase for which a cell stands, and
//! end at another such phase: nothing spreads along it (`phase.rs`). The chain goes round for ever; its solvers know.
//!
//! **Laws, not paths.** A map needs where trajectories end, as a law. Increments with the first five moments of normal
//! ones give it to the same weak order, from four random bits a step. Whatever compares paths (halving a step,
//! passages) has normal increments.

#[cfg(test)]
mod accuracy_tests;
mod column;
mod end_moments;
mod four_point;
mod growth;
mod integrator;
mod jacobian;
mod left_out;
mod lookup;
mod normal;
mod options;
mod order;
mod phase;
mod pilot;
mod random;
mod settling;
mod slopes;
mod starts;
mod transition;

pub use growth::sample_transitions;
pub use integrator::Integrator;
pub(crate) use integrator::{Stepper, WholeTurn};
pub(crate) use left_out::{GROUPS_AT_ONCE, Linearised, OfGroups};
pub(crate) use lookup::CellLookup;
pub use options::SamplingOptions;
pub(crate) use phase::{frequency_of_forcing, part_of_period};
pub(crate) use pilot::stand_still;
pub use pilot::{Pilot, pilot};
pub(crate) use random::{NormalStream, StreamKey, mix, unit};
pub(crate) use settling::{hull, settled};
pub(crate) use starts::{StartLattice, shift};
pub use transition::{SampledTransitions, TransitionMatrix};

/// Why transitions could not be sampled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SamplingError {
    /// A step that is not a positive number.
    #[error("the {name} is {value}; it must be a finite number greater than zero")]
    Step {
        /// Which step.
        name: &'static str,
        /// The value that was given.
        value: f64,
    },
    /// Numbers of samples and groups that do not go together.
    #[error(
        "{samples} samples cannot be split into {groups} groups: there must be 1 to 256 groups, and a sample in each"
    )]
    Groups {
        /// Samples a cell.
        samples: usize,
        /// Number of groups.
        groups: usize,
    },
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
    Periodic(#[from] crate::system::PeriodicDrift),
    /// A map step of a forced system that is no whole number of the parts into which cells divide the period.
    #[error(
        "the map step {map_step} is no whole number of the parts of the period, {part} each, for which the cells along the phase stand"
    )]
    Phase {
        /// The map step.
        map_step: f64,
        /// Time in which the phase passes one cell.
        part: f64,
    },
    /// A cell to start from that does not exist.
    #[error("there is no cell {cell} to start from; the cell space has {n_cells}")]
    Seed {
        /// The number that was given.
        cell: usize,
        /// Number of cells.
        n_cells: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] crate::cancellation::Cancelled),
}
