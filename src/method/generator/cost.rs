//! What a point costs by the generator: the matrices, and factors that the elimination order predicts.
//!
//! A stencil holds 2 reach + 1 rates along each axis, 16 bytes each, in up to four matrices: Q, dQ/dθ, that of the
//! second scheme, and the one kept for sensitivities.

use super::GeneratorMethodOptions;
use super::options::finer_axes;
use crate::space::CellSpace;
use crate::stationary::generator::{Estimate, RateError, estimate};

/// Bytes of a rate in a sparse matrix, and matrices that are held.
const RATE_BYTES: f64 = 16.0;
const MATRICES: f64 = 4.0;

/// Speed of factorisations on two ordinary cores: operations a second of large fronts, and bytes of factors a second of
/// small ones, which are bound by memory. Measured (`docs/accuracy.md`), good to a factor of two.
const OPERATIONS_A_SECOND: f64 = 5e10;
const BYTES_A_SECOND: f64 = 4e8;

/// Values that a segment of a sweep has at least, and segments at most.
const LEAST_VALUES: usize = 6;
const MOST_SEGMENTS: usize = 16;

/// What a point costs by the generator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GeneratorCost {
    /// Bytes at work: the matrices, and factors and fronts at their peak.
    pub(crate) bytes: f64,
    /// The factorisation that will be used, its memory and work. Most points of a sweep reuse a neighbour's.
    pub(crate) factors: Estimate,
}

impl GeneratorCost {
    /// Seconds of a factorisation on two ordinary cores, good to a factor of two.
    pub(crate) fn factorisation_seconds(&self) -> f64 {
        self.factors.operations / OPERATIONS_A_SECOND
            + self.factors.factor_bytes as f64 / BYTES_A_SECOND
    }
}

impl GeneratorMethodOptions {
    /// Bytes of the sparse matrices on so many cells.
    pub(in crate::method) fn matrix_bytes(&self, n_cells: f64, dimension: usize) -> f64 {
        let rates = dimension * 2 * self.scheme.reach() + 1;
        MATRICES * RATE_BYTES * n_cells * rates as f64
    }

    /// Cells that the stencil reaches along each axis; modes are all coupled.
    fn reach(&self, space: &CellSpace) -> Vec<usize> {
        let axes = space.axes().iter();
        axes.map(|axis| match axis.is_modes() {
            true => axis.count() - 1,
            false => self.scheme.reach(),
        })
        .collect()
    }

    /// Into how many segments, each with a session of its own, so many values of a sweep are cut: no more than fit the
    /// memory limit together.
    ///
    /// A first solve without a neighbour takes the time of up to eight others. A fine sweep gains most from neighbours,
    /// in a coarse one every few values have factors of their own anyway: half the root of the number of values made
    /// sweeps of 13 to 301 values at most 8 % more expensive. It is a power of two, for the cores there are.
    pub(in crate::method) fn segments(&self, space: &CellSpace, values: usize) -> usize {
        let half_root = 0.5 * (values as f64).sqrt();
        let wanted = half_root.log2().round().exp2() as usize;
        let wanted = wanted.min(values / LEAST_VALUES).min(MOST_SEGMENTS);
        if wanted < 2 {
            return 1;
        }
        let limit = self.memory_limit * 1e9;
        let fit = self.cost(space).map_or(1.0, |cost| limit / cost.bytes);
        wanted.min(fit as usize).max(1)
    }

    /// Bytes at work while rows are checked beside sessions on these cells: on them between closed ends, and on finer
    /// cells where that is asked for. Where finer cells do not fit the limit they are not solved.
    pub(crate) fn bytes_of_checks(&self, space: &CellSpace, on_finer_cells: bool) -> f64 {
        let bytes = |space: &CellSpace| self.cost(space).map_or(0.0, |cost| cost.bytes);
        let finer = CellSpace::new(finer_axes(space)).ok();
        let finer = finer.filter(|_| on_finer_cells);
        bytes(space) + finer.map_or(0.0, |finer| bytes(&finer))
    }

    /// What a point costs on these cells.
    ///
    /// # Errors
    /// [`RateError::Memory`] when not even the smallest factorisation fits the limit.
    pub(crate) fn cost(&self, space: &CellSpace) -> Result<GeneratorCost, RateError> {
        let reach = self.reach(space);
        let factors = estimate(space, &reach, (self.memory_limit * 1e9) as u64, None)?;
        // A node of a series sends to the others of its place, which are as many as its reach.
        let sent = space.axes().iter().zip(&reach);
        let rates = 1 + sent
            .map(|(axis, reach)| if axis.is_modes() { *reach } else { 2 * reach })
            .sum::<usize>();
        let matrices = MATRICES * RATE_BYTES * space.n_cells() as f64 * rates as f64;
        Ok(GeneratorCost {
            bytes: matrices + factors.peak_bytes as f64,
            factors,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;

    #[test]
    fn a_sweep_is_cut_by_its_values_and_into_no_more_sessions_than_fit() {
        let axis = || Axis::uniform(-1.0, 1.0, 100).unwrap();
        let space = CellSpace::new(vec![axis(), axis()]).unwrap();
        let options = GeneratorMethodOptions::default();
        let counts = [2, 11, 13, 31, 61, 101, 301, 1001, 100_000];
        let segments = counts.map(|values| options.segments(&space, values));
        assert_eq!(segments, [1, 1, 2, 2, 4, 4, 8, 16, 16]);
        let bytes = options.cost(&space).unwrap().bytes;
        let few = GeneratorMethodOptions {
            memory_limit: 3.5e-9 * bytes,
            ..options
        };
        assert_eq!(few.segments(&space, 301), 3);
    }
}
