//! The generator Q of a system on a cell space: du/dt = Q u, the cell map in the limit of a short step.
//!
//! The unknown u of a cell is the *point value* of the density at the cell's node times the local volume
//! Π dx/du of the cell (the node is where the cell coordinate of each axis is half-way between two edges; on
//! uniform axes the middle). Σ u is conserved but for what leaves, and u is a cell's mass to second order;
//! [`cell_masses`] turns it into the integrals over the cells to fifth order. Working with point values on a
//! grid that is uniform in the cell coordinate keeps the full order of one-dimensional fluxes in several
//! dimensions and on graded axes (Shu and Osher 1988).
//!
//! | part | file |
//! | --- | --- |
//! | schemes and stencils | `scheme.rs`, `geometry.rs` |
//! | drift and diffusion along a grid line | `sampler.rs` |
//! | fluxes along a grid line: fitted and advected drift | `line.rs`, `smooth.rs` |
//! | rates along an axis of modes | `modes.rs` |
//! | the matrix | `assemble.rs`, `columns.rs` |
//! | what fluxes through a wall, or a plane at which a force jumps, leave out | `jumps.rs` |
//! | whether drifts bend or jump at a face | `turns.rs` |
//! | a noise that moves an axis and an angle at once | `shared_noise.rs` |
//! | decay of the last harmonics of an angle without noise | `spectral_viscosity.rs` |
//! | the matrix of a process that ends in a region | `absorbing.rs` |
//! | masses of cells and moments from the unknowns | `masses.rs` |
//! | one axis: its motion as a birth-and-death chain | `chain/` |
//! | one axis: the steady state by quadrature, its extrema from the equations | `one_axis/` |
//! | dQ/dθ | `derivative.rs` |
//! | axes graded toward switching surfaces | `grading.rs` |
//! | is the grid fine enough for the noise | `resolution.rs` |

mod absorbing;
#[cfg(test)]
mod accuracy_tests;
mod assemble;
#[cfg(test)]
mod banded_tests;
mod chain;
mod columns;
mod derivative;
mod geometry;
mod grading;
mod jumps;
mod line;
mod masses;
mod modes;
mod one_axis;
mod resolution;
mod sampler;
mod scheme;
mod shared_noise;
mod smooth;
mod spectral_viscosity;
mod spurious;
mod turns;

pub(crate) use absorbing::{
    AbsorbingGenerator, Closure, Ending, RateChange, assemble_absorbing, assemble_with_changes,
    lagrange, lagrange_slopes, levels,
};
pub use assemble::assemble;
pub(crate) use assemble::{assemble_damped, assemble_lines};
pub(crate) use chain::{
    AxisEnd, Chain, Grid as ChainGrid, MESH_DEPTH, MESH_PLACES, Mesh, Reach, Reduced,
};
pub(crate) use columns::LineRates;
pub use derivative::assemble_derivative;
pub use grading::automatic_grading;
pub use masses::{cell_masses, unknown_moments};
pub(crate) use masses::{normalised_to_walls, summed_to_walls};
pub(crate) use one_axis::{End, NODES, exponent_at};
pub use one_axis::{OneAxis, one_axis, profile};
pub(crate) use resolution::{Resolution, resolution};
pub use scheme::AdvectiveScheme;
pub(crate) use scheme::Dissipation;
pub(crate) use shared_noise::{add_shared_noise, at_nodes};
pub(crate) use spectral_viscosity::add_spectral_viscosity;
pub(crate) use spurious::spurious_at_breaks;

use sprs::CsMat;

use crate::system::{PeriodicDrift, SystemError};

/// Settings of the discretisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GeneratorOptions {
    /// How advective fluxes are reconstructed.
    pub scheme: AdvectiveScheme,
}

/// The generator on the `n` cells of a cell space, du/dt = Q u.
///
/// The pattern depends on the grid, the scheme and the noisy axes only, never on a parameter: generators of
/// neighbouring parameter values have the same pattern, zeros stored where need be.
#[derive(Debug, Clone)]
pub struct Generator {
    /// Q, `n × n`, per unit time, compressed by columns (CSC): column `j` lists the cells that cell `j` feeds.
    /// Columns sum to minus the escape rate.
    pub matrix: CsMat<f64>,
    /// Rate of loss to the sink from each cell, per unit time; length `n`.
    pub escape: Vec<f64>,
}

/// Why a generator could not be assembled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GeneratorError {
    /// The cell space and the system differ in dimension.
    #[error("the cell space has {axes} axes, the system {dimension}")]
    Dimension {
        /// Axes of the cell space.
        axes: usize,
        /// Dimension of the system.
        dimension: usize,
    },
    /// The drift depends on time.
    #[error(transparent)]
    Periodic(#[from] PeriodicDrift),
    /// A Wiener process drives an axis that the system does not have.
    #[error("Wiener process {channel} drives axis {axis} of a system with {dimension} axes")]
    NoiseAxis {
        /// The process.
        channel: usize,
        /// The axis it names.
        axis: usize,
        /// Dimension of the system.
        dimension: usize,
    },
    /// A drift or noise amplitude that is not a finite number.
    #[error("drift or noise along axis {axis} is not finite on the grid line through {state:?}")]
    NotFinite {
        /// The component.
        axis: usize,
        /// A state on the grid line.
        state: Vec<f64>,
    },
    /// Rates that are beyond the range of numbers, though drift and noise are not.
    #[error(
        "the rates along axis {axis} are beyond the range of numbers: drift, noise or the ends of the axis are too large or too small; \
         use other units"
    )]
    Overflow {
        /// The axis.
        axis: usize,
    },
    /// An axis of modes that has noise, or where the state may pass an end of the range.
    #[error(
        "axis {axis} cannot have modes: they are for states without noise that stay between the ends of the range"
    )]
    Modes {
        /// The axis.
        axis: usize,
    },
    /// An axis of harmonics that is no turn of the system.
    #[error("axis {axis} cannot have harmonics: they are for angles and phases, over one turn")]
    Turn {
        /// The axis.
        axis: usize,
    },
    /// An axis of Hermite modes that is neither white noise behind a linear filter, with the mean and deviation of the
    /// axis, nor a state without noise that relaxes linearly.
    #[error(
        "axis {axis} cannot have Hermite modes: they are for white noise behind a linear filter, of the mean and the \
         standard deviation of the axis, and for states without noise that relax linearly"
    )]
    Filter {
        /// The axis.
        axis: usize,
    },
    /// The parameter of a derivative is unknown, or cannot be varied about its value.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The matrix could not be laid out.
    #[error("the matrix of {n_cells} cells could not be laid out: {reason}")]
    Structure {
        /// Number of cells.
        n_cells: usize,
        /// What the matrix library says.
        reason: String,
    },
}

impl GeneratorError {
    /// The same words with the names of the axes, in their order, in place of their numbers.
    pub(crate) fn with_names(&self, names: &[&str]) -> String {
        let words = self.to_string();
        let (Self::NoiseAxis { axis, .. }
        | Self::NotFinite { axis, .. }
        | Self::Overflow { axis }
        | Self::Modes { axis }
        | Self::Turn { axis }
        | Self::Filter { axis }) = self
        else {
            return words;
        };
        match names.get(*axis) {
            Some(name) => words.replacen(&format!("axis {axis}"), &format!("axis `{name}`"), 1),
            None => words,
        }
    }
}
