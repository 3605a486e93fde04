//! Steady states of transition matrices: the class of cells that holds one, and the solvers.
//!
//! A steady state solves P p = p, Σ p = 1. When mass leaks to the sink it is quasi-stationary: P p = λ p on
//! the cells that keep their mass longest, with λ = 1 - (escape per step); conditioned on staying inside,
//! nothing changes. See [`solve`].

mod absorption;
mod acceleration;
mod chain;
mod classes;
mod components;
mod convergence;
mod elimination;
mod first_order;
mod hierarchy;
mod multilevel;
mod power;
#[cfg(test)]
mod sampled_chain;
mod second_eigenvalue;
mod solve;
#[cfg(test)]
mod tests;

use crate::cancellation::Cancellation;

pub use classes::ClassShare;
pub(crate) use first_order::{MOST_APPLICATIONS, without_groups};
pub use second_eigenvalue::{SecondEigenvalue, second_eigenvalue};
pub use solve::solve;

/// Solvers by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// Multilevel aggregation on the cell grid.
    MultilevelAggregation,
    /// Power iteration p ← P p.
    PowerIteration,
}

words! { Solver, pub name: MultilevelAggregation: "multilevel", PowerIteration: "power" }

/// Settings of [`solve`].
#[derive(Debug, Clone)]
pub struct Options {
    /// The solver.
    pub solver: Solver,
    /// Estimated L1 error of the masses at which the solver stops, above 0 and below 1. Rounding allows
    /// about 1e-14, for power iteration 1e-16 / (1 - |λ₂|/λ₁).
    pub tolerance: f64,
    /// Largest number of cycles (multilevel) or steps (power iteration).
    pub max_iterations: usize,
    /// Is looked at in every cycle or step.
    pub cancellation: Cancellation,
}

impl Options {
    /// Settings with an iteration limit that suits the solver: 100 cycles, or 100 000 steps.
    pub fn new(solver: Solver, tolerance: f64) -> Self {
        let max_iterations = match solver {
            Solver::MultilevelAggregation => 100,
            Solver::PowerIteration => 100_000,
        };
        Self {
            solver,
            tolerance,
            max_iterations,
            cancellation: Cancellation::new(),
        }
    }

    /// The settings with a token that ends the solve.
    #[must_use]
    pub(crate) fn cancelled_by(self, cancellation: &Cancellation) -> Self {
        let cancellation = cancellation.clone();
        Self {
            cancellation,
            ..self
        }
    }
}

/// What a solve found.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// One steady state.
    Steady(SteadyState),
    /// Several classes of cells hold mass for good, or leak about equally slowly: which steady state is
    /// reached depends on the start.
    SeveralClasses {
        /// The classes, longest-lived first.
        classes: Vec<ClassShare>,
        /// Share of the initial mass that goes to the sink before it reaches any of them.
        escaped: f64,
    },
    /// Every class of cells loses more than `LARGEST_ESCAPE` of its mass in one map step.
    NoneInside {
        /// Mass that the longest-lived class loses in one map step.
        escape_per_step: f64,
    },
}

/// Largest share of its mass that a class may lose in one map step and still be said to hold a
/// (quasi-)steady state. Callers that know a time scale should ask for much less.
pub(crate) const LARGEST_ESCAPE: f64 = 0.5;

/// A (quasi-)steady state.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyState {
    /// Mass of every cell of the cell space, Σ = 1; zero outside the class, positive inside.
    pub mass: Vec<f64>,
    /// How the solve went.
    pub info: Info,
}

/// How a solve went.
#[derive(Debug, Clone, PartialEq)]
pub struct Info {
    /// The solver.
    pub solver: Solver,
    /// Cycles or steps.
    pub iterations: usize,
    /// Work: passes over all transition probabilities of the class (products, sweeps, projections).
    pub matrix_passes: usize,
    /// L1 norm of P p - λ p.
    pub residual: f64,
    /// Estimated L1 distance of `mass` to the exact solution, from the observed contraction; at most 2.
    pub error_estimate: f64,
    /// Whether the estimate reached the tolerance; if not, `mass` is the last iterate.
    pub converged: bool,
    /// 1 - λ: share of the mass that goes to the sink in one map step.
    pub escape_per_step: f64,
    /// Number of cells that carry the steady state.
    pub class_cells: usize,
    /// Number of other cells of the transition matrix.
    pub transient_cells: usize,
}

/// Why an input cannot be solved at all. Non-convergence is data, see [`Info::converged`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StationaryError {
    /// A part of the transition matrix has the wrong size or order.
    #[error("transition matrix of {cells} cells: {part} has size {found}")]
    Shape {
        /// Number of cells it is over.
        cells: usize,
        /// The part.
        part: &'static str,
        /// Its size.
        found: usize,
    },
    /// A matrix compressed by columns.
    #[error("the transition matrix must be compressed by rows (CSR)")]
    Storage,
    /// Cell numbers that do not ascend or lie outside the cell space.
    #[error("cell {cell} of the transition matrix is out of order or outside the cell space")]
    Cell {
        /// The number.
        cell: usize,
    },
    /// A column that does not sum to one with the sink, or holds a negative or non-finite entry.
    #[error("transition probabilities from cell {cell} sum to {sum} with the sink, not to one")]
    Column {
        /// Number of the cell in the cell space.
        cell: usize,
        /// The sum (NaN when an entry is negative or not finite).
        sum: f64,
    },
    /// A guess of the wrong length, or with entries that are negative or not finite.
    #[error("the initial guess needs {cells} finite masses ≥ 0, one a cell of the space")]
    Guess {
        /// Number of cells of the space.
        cells: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] crate::cancellation::Cancelled),
    /// A tolerance outside (0, 1).
    #[error("solver tolerance {tolerance} is not between 0 and 1")]
    Tolerance {
        /// The value that was given.
        tolerance: f64,
    },
}
