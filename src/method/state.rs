//! What a solved point leaves for its neighbour.

use std::sync::Arc;

use super::generator::Trail;

/// What a solved point leaves for its neighbour.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Mass of every cell (for the generator its unknowns), Σ = 1.
    pub(super) mass: Arc<Vec<f64>>,
    /// What the generator remembers of the points before.
    pub(super) trail: Trail,
}

impl State {
    /// Memory that the state takes, what it shares with others not counted.
    pub(super) fn bytes(&self) -> usize {
        // The masses, and for the generator as many differences between schemes.
        2 * size_of_val(self.mass.as_slice())
    }
}
