//! Solves with a generator less a complex number on its diagonal, for eigenvalues near that number.
//!
//! Factors are in single precision, at a fourth of the memory of complex ones in double, and refined in double.

use faer::c32;
use nalgebra::Complex;
use sprs::CsMat;

use super::RateError;
use super::dissection::Dissection;
use super::narrowing;
use super::preconditioner::{Structure, whole_grid};
use super::scaled::{Scaled, factors};
use super::symbolic::Symbolic;
use crate::cancellation::Cancellation;
use crate::space::CellSpace;

/// Residual, relative to the right side, at which a solve is good enough: what is solved spans spaces, between which
/// models hold the generator itself, so that their numbers have the square of this error.
const TOLERANCE: f64 = 1e-5;

/// Passes of refinement at most.
const PASSES: usize = 8;

/// Structure of the factors of a generator, for any number of shifts.
pub(crate) struct ShiftedPattern(Symbolic);

impl ShiftedPattern {
    /// Of a matrix `n × n` by columns on the cells of a space.
    pub(crate) fn new(space: &CellSpace, matrix: &CsMat<f64>) -> Self {
        let structure = Structure {
            reach: narrowing::reach(space, matrix),
            folded: None,
        };
        let grid = whole_grid(space, &structure);
        Self(Symbolic::new(matrix, Dissection::new(&grid)))
    }

    /// Memory that the factors at one shift take.
    pub(crate) fn bytes(&self) -> u64 {
        (self.0.factor_entries() * size_of::<c32>()) as u64
    }
}

/// Factors of Q - σ.
pub(crate) struct Shifted<'a> {
    matrix: &'a CsMat<f64>,
    shift: Complex<f64>,
    pattern: &'a ShiftedPattern,
    factors: Scaled<c32>,
    /// Passes through the factors.
    pub(crate) passes: usize,
}

impl<'a> Shifted<'a> {
    /// Factorises.
    ///
    /// # Errors
    /// [`RateError::Cancelled`].
    pub(crate) fn new(
        pattern: &'a ShiftedPattern,
        matrix: &'a CsMat<f64>,
        shift: Complex<f64>,
        cancellation: &Cancellation,
    ) -> Result<Self, RateError> {
        let starts = matrix.indptr();
        let starts = starts.raw_storage();
        let mut rates: Vec<Complex<f64>> = matrix.data().iter().map(|&one| one.into()).collect();
        for column in 0..matrix.cols() {
            let entries = starts[column]..starts[column + 1];
            let own = matrix.indices()[entries.clone()]
                .iter()
                .position(|&row| row == column);
            if let Some(own) = own {
                rates[entries.start + own] -= shift;
            }
        }
        Ok(Self {
            matrix,
            shift,
            pattern,
            factors: factors(&pattern.0, rates, None, cancellation)?,
            passes: 0,
        })
    }

    /// Cells of the matrix.
    pub(crate) fn cells(&self) -> usize {
        self.matrix.cols()
    }

    /// About (Q - σ)⁻¹ of each of many vectors, of lengths about one, or of the transposed matrix: one pass in single
    /// precision.
    pub(crate) fn pass(&mut self, vectors: &mut [Vec<Complex<f64>>], is_transposed: bool) {
        self.passes += vectors.len();
        let pattern = &self.pattern.0;
        self.factors.solve_block(pattern, vectors, is_transposed);
    }

    /// (Q - σ)⁻¹ of each of several vectors, or of the transposed matrix; as good as refinement makes it.
    pub(crate) fn solve(
        &mut self,
        right: &[Vec<Complex<f64>>],
        is_transposed: bool,
    ) -> Vec<Vec<Complex<f64>>> {
        let sizes: Vec<f64> = right.iter().map(|one| length(one)).collect();
        let mut solved = vec![vec![Complex::default(); self.cells()]; right.len()];
        let mut residuals = right.to_vec();
        for _ in 0..PASSES {
            let scales: Vec<f64> = residuals.iter().map(|one| length(one)).collect();
            for (residual, scale) in residuals.iter_mut().zip(&scales) {
                // Nothing is left of nothing.
                let scale = scale.max(f64::MIN_POSITIVE);
                residual.iter_mut().for_each(|one| *one /= scale);
            }
            self.pass(&mut residuals, is_transposed);
            for ((solved, change), scale) in solved.iter_mut().zip(&residuals).zip(&scales) {
                let pairs = solved.iter_mut().zip(change);
                pairs.for_each(|(x, change)| *x += change * scale);
            }
            for ((residual, right), solved) in residuals.iter_mut().zip(right).zip(&solved) {
                *residual = self.residual(right, solved, is_transposed);
            }
            // Also where it is no number.
            let mut sizes = residuals.iter().zip(&sizes);
            if !sizes.any(|(left, size)| length(left) > TOLERANCE * size) {
                break;
            }
        }
        solved
    }

    /// The right side less what a vector makes.
    fn residual(
        &self,
        right: &[Complex<f64>],
        solved: &[Complex<f64>],
        is_transposed: bool,
    ) -> Vec<Complex<f64>> {
        let mut residual: Vec<Complex<f64>> = right
            .iter()
            .zip(solved)
            .map(|(right, x)| right + self.shift * x)
            .collect();
        for (column, rates) in self.matrix.outer_iterator().enumerate() {
            for (row, &rate) in rates.iter() {
                if is_transposed {
                    residual[column] -= solved[row] * rate;
                } else {
                    residual[row] -= solved[column] * rate;
                }
            }
        }
        residual
    }
}

fn length(vector: &[Complex<f64>]) -> f64 {
    vector.iter().map(Complex::norm_sqr).sum::<f64>().sqrt()
}
