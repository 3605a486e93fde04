//! Tests of the solver against exact null vectors and dense algebra.

mod along;
mod cancelled;
mod exact;
mod generators;
mod transposed;
mod warm;

use sprs::CsMat;

use crate::space::{Axis, CellSpace};

/// A space with the given numbers of cells; ranges do not matter to the solver.
fn space(shape: &[usize]) -> CellSpace {
    let axes = shape
        .iter()
        .map(|&count| Axis::uniform(-1.0, 1.0, count).unwrap());
    CellSpace::new(axes.collect()).unwrap()
}

/// Largest difference of two mass vectors in L1.
pub(super) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum()
}

/// Dense copy.
fn dense(matrix: &CsMat<f64>) -> nalgebra::DMatrix<f64> {
    let mut copy = nalgebra::DMatrix::zeros(matrix.rows(), matrix.cols());
    for (&rate, (row, column)) in matrix {
        copy[(row, column)] += rate;
    }
    copy
}
