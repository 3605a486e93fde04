//! Cell space: a rectilinear grid of boxes over the domain Ω. Everything outside is the sink. An axis may carry a
//! series of modes in place of cells.
//!
//! # Decisions
//!
//! **Modes are nodes.** A density along an axis of modes is a polynomial, held as its values times weights at the nodes
//! of Gauss's rule. In that basis whatever runs along the other axes needs no change (each node is a place like a
//! cell), the mass is the plain sum, and the rates along the axis are a dense block; it is the same Galerkin method as
//! with Legendre coefficients, to the last digit where the drift is a polynomial of degree two. `Axis::modes` therefore
//! is an axis whose cells are as wide as the weights, and no other module asks, but those that reconstruct along an
//! axis. The dissection never cuts across modes.
//!
//! The same holds of an axis that closes on itself (`fourier.rs`): 2K + 1 even nodes carry K harmonics. What other axes
//! do at a node may depend on the phase in any smooth way, by however many harmonics: nothing is projected by hand. Of
//! the products that Galerkin's method has, the highest harmonic of the density with the highest of the drift alone is
//! taken for another, an error of the size of what is left out anyway.

mod axis;
mod cells;
mod fourier;
mod grading;
mod hermite;
pub(crate) mod nodes;
mod series;

pub use axis::Axis;
pub use cells::CellSpace;
pub use grading::Grading;
pub(crate) use hermite::NORMAL_RANGE;
pub(crate) use series::MOST_MODES;
pub(crate) use series::Series;

/// Why an axis or a cell space could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpaceError {
    /// The range is empty, reversed or not finite.
    #[error("range from {from} to {to} is not a range of finite numbers with from < to")]
    Range {
        /// Lower end that was given.
        from: f64,
        /// Upper end that was given.
        to: f64,
    },
    /// Fewer than two cells.
    #[error("{count} cells on an axis; at least 2 are needed")]
    Count {
        /// Number of cells that was given.
        count: usize,
    },
    /// Too few or too many modes.
    #[error("{count} modes on an axis; 2 to {most} are possible")]
    Modes {
        /// Number of modes that was given.
        count: usize,
        /// The largest number.
        most: usize,
    },
    /// Too few or too many harmonics.
    #[error("{count} harmonics along an axis that closes on itself; 1 to {most} are possible")]
    Harmonics {
        /// Number of harmonics that was given.
        count: usize,
        /// The largest number.
        most: usize,
    },
    /// A point of grading outside the range, or repeated.
    #[error("cells cannot be graded toward {at}: it must lie in [{from}, {to}], each point once")]
    GradingPoint {
        /// The point that was given.
        at: f64,
        /// Lower end of the axis.
        from: f64,
        /// Upper end of the axis.
        to: f64,
    },
    /// A smallest width that the number of cells cannot give.
    #[error("smallest cell {smallest} must be positive and below the uniform width {uniform}")]
    GradingWidth {
        /// The width that was asked for.
        smallest: f64,
        /// Width of the cells without grading.
        uniform: f64,
    },
    /// Too few cells to give every piece between graded points at least one.
    #[error("{count} cells are too few for {points} graded points")]
    GradingCount {
        /// Number of cells that was given.
        count: usize,
        /// Number of points.
        points: usize,
    },
    /// No axis, or more than four.
    #[error("{axes} axes; a cell space has 1 to 4")]
    Dimension {
        /// Number of axes that was given.
        axes: usize,
    },
    /// More cells than can be numbered.
    #[error("the cell space has more than {limit} cells")]
    TooManyCells {
        /// The largest number of cells.
        limit: usize,
    },
}
