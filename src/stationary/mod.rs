//! Steady states of transition matrices.

pub mod rates;

/// Solvers by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// Multilevel aggregation on the cell grid.
    MultilevelAggregation,
    /// Power iteration p ← P p.
    PowerIteration,
}

impl Solver {
    /// All solvers.
    pub const ALL: [Self; 2] = [Self::MultilevelAggregation, Self::PowerIteration];

    /// Name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::MultilevelAggregation => "multilevel",
            Self::PowerIteration => "power",
        }
    }
}
