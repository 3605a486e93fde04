//! Settings of the generator method and their defaults.

use crate::continuation::CellCheck;
use crate::generator::AdvectiveScheme;
use crate::method::options::ESCAPE_LIMIT;

/// Settings of the generator method.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneratorMethodOptions {
    /// How advective fluxes are reconstructed.
    pub scheme: AdvectiveScheme,
    /// Gigabytes that factors may take; beyond, a smaller factorisation preconditions.
    pub memory_limit: f64,
    /// L1 error at which the solver stops.
    pub solver_tolerance: f64,
    /// Largest share of the mass that may leave Ω within one relaxation time before there is said to be no
    /// steady state.
    pub escape_limit: f64,
}

impl GeneratorMethodOptions {
    /// On finer cells: a scheme of high order shows there what the cells do.
    pub const CELL_CHECK: CellCheck = CellCheck::OnFinerCells;
}

impl Default for GeneratorMethodOptions {
    fn default() -> Self {
        Self {
            scheme: AdvectiveScheme::default(),
            memory_limit: 8.0,
            // Far below the error of any grid; every digit costs iterations.
            solver_tolerance: 1e-8,
            escape_limit: ESCAPE_LIMIT,
        }
    }
}
