//! What a source of densities is made for, and what it leaves for a neighbour.

use std::sync::Arc;

use super::MethodError;
use super::generator::Trail;
use crate::density::Observable;
use crate::space::CellSpace;
use crate::system::{Model, ParameterValues, System};

/// What is swept, on which cells, and what is watched.
#[derive(Debug, Clone)]
pub struct Setting<'a> {
    /// The model.
    pub model: &'a Arc<Model>,
    /// Its parameters; the swept one is replaced by every value in turn.
    pub values: &'a ParameterValues,
    /// Name of the swept parameter.
    pub parameter: &'a str,
    /// First and last value of the sweep.
    pub range: (f64, f64),
    /// The cells.
    pub space: &'a CellSpace,
    /// What is watched, in this order.
    pub observables: &'a [Observable],
}

impl Setting<'_> {
    /// The system at both ends and in the middle of the sweep.
    pub(super) fn systems_along(&self) -> Result<Vec<Arc<dyn System>>, MethodError> {
        let (from, to) = self.range;
        [from, 0.5 * (from + to), to]
            .into_iter()
            .map(|value| {
                let values = self.model.with(self.values, self.parameter, value)?;
                Ok(self.model.system(&values))
            })
            .collect()
    }
}

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
