//! What a point of a sweep costs, whatever the method. Each method predicts its own.

use super::{GeneratorCost, MethodOptions, MonteCarloCost, SgcmCost};
use crate::space::CellSpace;
use crate::stationary::generator::RateError;

/// What a point costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cost {
    /// By the generator.
    Generator(GeneratorCost),
    /// By SGCM.
    Sgcm(SgcmCost),
    /// By Monte Carlo.
    MonteCarlo(MonteCarloCost),
}

impl Cost {
    /// Bytes at work, where it is uncertain the upper bound.
    pub fn most_bytes(&self) -> f64 {
        match self {
            Self::Generator(cost) => cost.bytes,
            Self::Sgcm(cost) => cost.most_bytes,
            Self::MonteCarlo(cost) => cost.bytes,
        }
    }
}

impl MethodOptions {
    /// What a point costs on these cells.
    ///
    /// # Errors
    /// [`RateError::Memory`] when the generator's factors exceed their limit.
    pub(crate) fn cost(&self, space: &CellSpace) -> Result<Cost, RateError> {
        let n_cells = space.n_cells() as f64;
        Ok(match self {
            Self::Generator(options) => Cost::Generator(options.cost(space)?),
            Self::Sgcm(options) => Cost::Sgcm(options.cost(n_cells, space.dimension())),
            Self::MonteCarlo(options) => Cost::MonteCarlo(options.cost(n_cells)),
        })
    }

    /// Lower bound of the bytes at work on so many cells, which need not be laid out for it.
    pub(crate) fn least_bytes(&self, n_cells: f64, dimension: usize) -> f64 {
        match self {
            Self::Generator(options) => options.matrix_bytes(n_cells, dimension),
            Self::Sgcm(options) => options.cost(n_cells, dimension).least_bytes,
            Self::MonteCarlo(options) => options.cost(n_cells).bytes,
        }
    }
}
