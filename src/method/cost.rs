//! What a point of a sweep costs, whatever the method. Each method predicts its own.

use super::{GeneratorCost, MethodOptions, MonteCarloCost, SgcmCost};
use crate::monte_carlo::BLOCKS;
use crate::space::CellSpace;
use crate::stationary::generator::RateError;

/// What a point costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cost {
    /// By the generator.
    Generator(GeneratorCost),
    /// By SGCM.
    Sgcm(SgcmCost),
    /// By Monte Carlo.
    MonteCarlo(MonteCarloCost),
}

impl Cost {
    /// Bytes at work, where it is uncertain the upper bound.
    pub(crate) fn most_bytes(&self) -> f64 {
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

    /// Into how many segments so many values of a sweep are cut, each with a session of its own.
    pub(crate) fn segments(&self, space: &CellSpace, values: usize) -> usize {
        match self {
            Self::Generator(options) => options.segments(space, values),
            Self::Sgcm(_) | Self::MonteCarlo(_) => 1,
        }
    }

    /// Bytes of the densities of a point on so many bins, as they are kept until a sweep ends: values, their errors,
    /// and the other estimates of each.
    pub(crate) fn kept_bytes(&self, bins: f64) -> f64 {
        let others = match self {
            Self::Generator(_) => 1,
            Self::Sgcm(options) => options.replicates,
            Self::MonteCarlo(_) => BLOCKS,
        };
        bins * 8.0 * (2 + others) as f64
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
