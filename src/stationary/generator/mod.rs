//! Steady states of generators: Q p = 0, or the quasi-stationary Q p = -r p when mass escapes at rate r.
//!
//! One probable cell is held at a fixed mass and its balance dropped (the columns of Q sum to zero with the
//! escape, so it follows from the others); the rest is a regular sparse system. It is factorised in an order
//! made for box grids ([`RateSolver`] keeps the factorisation), and the factorisation of one parameter value
//! preconditions the solves of its neighbours. Never a row of ones: it would fill the factors.
//!
//! | file | what it does |
//! | --- | --- |
//! | `dissection` | elimination order from the geometry of the grid |
//! | `prediction` | memory and work before any matrix is there |
//! | `symbolic`, `fronts`, `triangular` | multifrontal LU: structure, numbers, substitution |
//! | `updates` | where fronts leave what they add to their parents' |
//! | `narrowing` | a matrix of reach one that stands in where the factors would not fit |
//! | `modewise` | factors of every mode by itself, lower ones first, where there are many |
//! | `harmonics` | factors of every harmonic of a phase by itself |
//! | `preconditioner` | one of these factorisations, with one cell held |
//! | `balance` | residual and Jacobian of the (quasi-)steady state |
//! | `passes` | passes through the factors, which two iterations may share |
//! | `krylov`, `newton` | GMRES, and Newton's method by it |
//! | `question` | a change of the balance, and its answer |
//! | `response` | how a steady state answers to a change |
//! | `absorbing` | processes that end: occupied times, and what is expected from each cell |
//! | `shifted` | solves beside a complex number, for eigenvalues near it |
//! | `solver` | when to iterate, when to factorise |
//! | `memory` | where the solver stands, to go on from there later |
//! | `symmetric` | symmetric generators on half of the cells |

mod absorbing;
mod balance;
mod dissection;
mod fronts;
mod harmonics;
mod krylov;
mod memory;
mod modewise;
mod narrowing;
mod newton;
mod number;
mod passes;
mod preconditioner;
mod prediction;
mod question;
mod response;
mod scaled;
mod shifted;
mod solver;
mod symbolic;
mod symmetric;
#[cfg(test)]
mod tests;
mod triangular;
mod updates;

pub use absorbing::AbsorbingWork;
pub(crate) use absorbing::{Absorbing, AbsorbingSolver, Expected, FactorMemory};
pub(crate) use balance::{dot, product, transposed_product};
pub(crate) use memory::SolverMemory;
pub use preconditioner::{Estimate, RateMethod, estimate};
pub(crate) use shifted::{Shifted, ShiftedPattern};
pub use symmetric::{Along, RateSolver};

/// Settings of [`RateSolver`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateOptions {
    /// Estimated L1 error of the masses (Σ = 1) at which a solve stops.
    pub tolerance: f64,
    /// Largest number of iterations (applications of the factorisation) per factorisation.
    pub max_iterations: usize,
    /// Bytes that factors and fronts may take; beyond, a smaller factorisation preconditions.
    pub memory_limit_bytes: u64,
    /// Factorisation to use; `None` chooses by memory.
    pub method: Option<RateMethod>,
}

impl Default for RateOptions {
    fn default() -> Self {
        Self {
            tolerance: 1e-10,
            max_iterations: 300,
            memory_limit_bytes: 8 << 30,
            method: None,
        }
    }
}

/// A (quasi-)steady state of a generator.
#[derive(Debug, Clone, PartialEq)]
pub struct RateSteadyState {
    /// Mass of every cell, Σ = 1. High-order fluxes may leave small negative masses.
    pub mass: Vec<f64>,
    /// How the solve went.
    pub info: RateInfo,
}

/// How a solve went.
#[derive(Debug, Clone, PartialEq)]
pub struct RateInfo {
    /// The factorisation that was used.
    pub method: RateMethod,
    /// Factorisations done in this solve.
    pub factorisations: usize,
    /// Applications of a factorisation (a forward and a backward substitution each).
    pub iterations: usize,
    /// ‖Q p + r p‖₁ / ‖|Q| |p|‖₁, all cells counted.
    pub residual: f64,
    /// Estimated L1 distance of `mass` to the exact solution.
    pub error_estimate: f64,
    /// r: mass that leaves per unit time while the rest keeps its shape.
    pub escape_rate: f64,
    /// Σ |min(mass, 0)|.
    pub negative_mass: f64,
    /// Number of cells.
    pub unknowns: usize,
    /// Bytes of the factors.
    pub factor_bytes: u64,
    /// Whether the estimate reached the tolerance; if not, `mass` is the last iterate.
    pub converged: bool,
}

/// Why a generator cannot be solved at all. Non-convergence is data, see [`RateInfo::converged`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RateError {
    /// A part of the input has the wrong size.
    #[error("generator of {cells} cells: {part} has size {found}")]
    Shape {
        /// Number of cells of the space.
        cells: usize,
        /// The part.
        part: &'static str,
        /// Its size.
        found: usize,
    },
    /// A matrix compressed by rows.
    #[error("the generator must be compressed by columns (CSC)")]
    Storage,
    /// A rate that is not finite, or a column that does not sum to minus the escape from its cell.
    #[error("rates out of cell {cell} sum to {sum} instead of minus the escape {escape}")]
    Column {
        /// Number of the cell.
        cell: usize,
        /// The sum.
        sum: f64,
        /// Escape rate from the cell.
        escape: f64,
    },
    /// An initial guess without a positive finite sum.
    #[error("the initial guess has no positive finite sum")]
    Guess,
    /// Not even the smallest factorisation fits.
    #[error(
        "factors need {:.1} GB, more than the {:.1} GB that are allowed",
        *.needed as f64 / 1e9, *.limit as f64 / 1e9
    )]
    Memory {
        /// Bytes of the smallest factorisation.
        needed: u64,
        /// The limit in the options.
        limit: u64,
    },
    /// The system gives less memory than a factorisation needs.
    #[error(
        "factors need {:.2} GB of memory, and the system gives this process less (`ulimit -v`, or the limit of a batch job)",
        *.needed as f64 / 1e9
    )]
    NoRoom {
        /// Bytes of the factorisation at its peak.
        needed: u64,
    },
    /// The factorisation at hand did not solve for the sensitivity within the iterations allowed.
    #[error("the sensitivity did not converge")]
    Sensitivity,
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] crate::cancellation::Cancelled),
    /// A sensitivity was asked for before any steady state was found.
    #[error("no steady state has been solved yet")]
    NoSteadyState,
}
