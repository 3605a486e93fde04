//! Where a solver stands, as numbers: with the matrices that it holds on to, another one can be brought there.

use super::RateMethod;

/// Where a [`RateSolver`](super::RateSolver) stands.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SolverMemory {
    /// Reach of the stencil and method of later factorisations.
    pub(super) plan: Option<(Vec<usize>, RateMethod)>,
    /// The same of the last factorisation.
    pub(super) factorised: Option<(Vec<usize>, RateMethod)>,
    /// Whether all of it is of the solver on half of the cells.
    pub(super) folded: bool,
    /// The cell that it holds.
    pub(super) held: usize,
    pub(super) excess: usize,
    pub(super) baseline: usize,
}
