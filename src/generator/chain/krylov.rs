//! Eigenvalues and eigenfunctions of a chain from the vectors f, L⁻¹f, L⁻²f and so on: the slowest ones soon have all
//! their digits.

use nalgebra::{DMatrix, SymmetricEigen};

use super::{Chain, solve::AbsorbingChain};
use crate::numerics::sort_descending;

/// A vector that is shorter than this beside the others, relative to its length before, adds nothing.
const NOTHING: f64 = 1e-10;

/// What the slow part of a chain does: its eigenvalues, and functions that are one in the mean square each.
pub(crate) struct Reduced {
    /// Decay rates in ascending order.
    pub(crate) rates: Vec<f64>,
    /// Eigenfunctions at the places.
    pub(crate) functions: Vec<Vec<f64>>,
}

/// An orthonormal basis, and L⁻¹ in it.
pub(crate) struct Krylov {
    basis: Vec<Vec<f64>>,
    inverse: DMatrix<f64>,
}

impl Chain {
    /// From functions without a mean, of a process that never ends, by so many vectors each.
    pub(crate) fn krylov(&self, starts: &[Vec<f64>], vectors: usize) -> Krylov {
        // Where half of the mass is on either side nothing is the difference of large numbers.
        let middle = self.middle();
        let ends: Vec<bool> = (0..self.masses.len())
            .map(|place| place == middle)
            .collect();
        let ending = self.until(&ends);
        let whole: f64 = self.masses.iter().sum();
        let answer = |function: &[f64]| {
            let mut found = ending.solve(&self.weighted(function), |_| 0.0);
            let mean = Self::over(&self.masses, &found) / whole;
            found.iter_mut().for_each(|value| *value -= mean);
            found
        };
        Krylov::new(self, answer, [starts, &[], &[]], vectors)
    }
}

impl AbsorbingChain<'_> {
    /// From functions that are zero where the process ends, by so many vectors each.
    pub(crate) fn krylov(&self, starts: &[Vec<f64>], vectors: usize) -> Krylov {
        let answer = |function: &[f64]| self.solve(&self.chain.weighted(function), |_| 0.0);
        Krylov::new(self.chain, answer, [starts, &[], &[]], vectors)
    }

    /// From a function that is zero where the process ends, by so many vectors, and by (s - L)⁻¹ of it and (s - L)⁻² of
    /// it at some rates s: what changes as fast as that is in them. The latter are the last.
    pub(crate) fn krylov_with(&self, start: &[f64], vectors: usize, rates: &[f64]) -> Krylov {
        let at = |rate: f64, function: &[f64]| {
            self.solve_at(rate, &self.chain.weighted(function), |_| 0.0)
        };
        let once: Vec<Vec<f64>> = rates.iter().map(|&rate| at(rate, start)).collect();
        let pairs = rates.iter().zip(&once);
        let twice: Vec<Vec<f64>> = pairs.map(|(&rate, once)| at(rate, once)).collect();
        let starts = [&[start.to_vec()], once.as_slice(), twice.as_slice()];
        Krylov::new(self.chain, |function| at(0.0, function), starts, vectors)
    }
}

impl Krylov {
    fn new(
        chain: &Chain,
        answer: impl Fn(&[f64]) -> Vec<f64>,
        [starts, between, last]: [&[Vec<f64>]; 3],
        vectors: usize,
    ) -> Self {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut images: Vec<Vec<f64>> = Vec::new();
        let mut take = |all: &[Vec<f64>]| {
            let mut more = Vec::new();
            for vector in all {
                if let Some(vector) = beside(chain, &basis, vector.clone()) {
                    let image = answer(&vector);
                    more.push(image.clone());
                    images.push(image);
                    basis.push(vector);
                }
            }
            more
        };
        // What is made of a start may hold it but for rounding, and its own powers are to go on from it.
        let mut next = take(starts);
        take(between);
        for _ in 1..vectors {
            next = take(&next);
        }
        take(last);
        let weighted: Vec<Vec<f64>> = basis.iter().map(|vector| chain.weighted(vector)).collect();
        let overlap = |row: usize, column: usize| Chain::over(&weighted[row], &images[column]);
        let size = basis.len();
        let inverse = DMatrix::from_fn(size, size, |row, column| {
            0.5 * (overlap(row, column) + overlap(column, row))
        });
        Self { basis, inverse }
    }

    /// What the first `share` of the vectors say, with functions or without.
    pub(crate) fn reduced(&self, share: f64, with_functions: bool) -> Reduced {
        let size = (share * self.basis.len() as f64).ceil() as usize;
        let part = self.inverse.view((0, 0), (size, size)).into_owned();
        if !part.iter().all(|value| value.is_finite()) {
            return Reduced {
                rates: Vec::new(),
                functions: Vec::new(),
            };
        }
        let eigen = SymmetricEigen::new(part);
        let mut order: Vec<usize> = (0..size)
            .filter(|&one| eigen.eigenvalues[one] > 0.0)
            .collect();
        sort_descending(&mut order, |&place| eigen.eigenvalues[place]);
        let function = |&one: &usize| {
            let mut sum = vec![0.0; self.basis[0].len()];
            for (vector, weight) in self.basis.iter().zip(eigen.eigenvectors.column(one).iter()) {
                sum.iter_mut()
                    .zip(vector)
                    .for_each(|(sum, value)| *sum += weight * value);
            }
            sum
        };
        Reduced {
            rates: order
                .iter()
                .map(|&one| eigen.eigenvalues[one].recip())
                .collect(),
            functions: match with_functions {
                true => order.iter().map(function).collect(),
                false => Vec::new(),
            },
        }
    }
}

/// What of a vector is beside others, of length one; `None` where that is nothing.
fn beside(chain: &Chain, basis: &[Vec<f64>], mut vector: Vec<f64>) -> Option<Vec<f64>> {
    let length = |vector: &[f64]| Chain::over(&chain.weighted(vector), vector).sqrt();
    let before = length(&vector);
    for _ in 0..2 {
        let weighted = chain.weighted(&vector);
        let overlaps: Vec<f64> = basis
            .iter()
            .map(|known| Chain::over(&weighted, known))
            .collect();
        for (known, overlap) in basis.iter().zip(overlaps) {
            vector
                .iter_mut()
                .zip(known)
                .for_each(|(own, known)| *own -= overlap * known);
        }
    }
    let after = length(&vector);
    if !(after.is_finite() && after > NOTHING * before) {
        return None;
    }
    vector.iter_mut().for_each(|value| *value /= after);
    Some(vector)
}
