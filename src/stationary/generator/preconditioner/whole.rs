//! Factors of all cells together.

use sprs::CsMat;

use super::{NO_CELL, RateMethod};
use crate::cancellation::{Cancellation, Cancelled};
use crate::stationary::generator::dissection::{Dissection, Grid};
use crate::stationary::generator::fronts::{Factors, allocate, factorise};
use crate::stationary::generator::symbolic::Symbolic;
use crate::stationary::generator::triangular::{self, transposed::solve_transposed};

enum Numbers {
    Double(Factors<f64>),
    Single(Factors<f32>),
}

/// Factors of all cells together.
pub(super) struct WholeFactors {
    method: RateMethod,
    symbolic: Symbolic,
    numbers: Numbers,
    /// Column starts and rows of the matrix that `symbolic` was made for.
    pattern: (Vec<usize>, Vec<usize>),
    /// Power of two near the largest rate; the factors are those of the matrix over this.
    scale: f64,
}

impl WholeFactors {
    /// Bytes of the factors.
    pub(super) fn bytes(&self) -> u64 {
        (self.symbolic.factor_entries() * self.method.bytes_per_number()) as u64
    }

    pub(super) fn new(
        grid: impl FnOnce() -> Grid,
        method: RateMethod,
        (matrix, held): (&CsMat<f64>, usize),
        old: Option<Self>,
        cancellation: &Cancellation,
    ) -> Result<Self, Cancelled> {
        let starts = matrix.indptr();
        let starts = starts.raw_storage();
        let reusable = old.filter(|old| {
            old.method == method && old.pattern.0 == starts && old.pattern.1 == matrix.indices()
        });
        let mut this = reusable.unwrap_or_else(|| {
            let symbolic = Symbolic::new(matrix, Dissection::new(&grid()));
            let numbers = match method {
                RateMethod::Lu | RateMethod::NarrowLu => Numbers::Double(allocate(&symbolic)),
                _ => Numbers::Single(allocate(&symbolic)),
            };
            Self {
                method,
                symbolic,
                numbers,
                pattern: (starts.to_vec(), matrix.indices().to_vec()),
                scale: 1.0,
            }
        });
        this.factorise(matrix, held, cancellation)?;
        Ok(this)
    }

    fn factorise(
        &mut self,
        matrix: &CsMat<f64>,
        held: usize,
        cancellation: &Cancellation,
    ) -> Result<(), Cancelled> {
        let starts = matrix.indptr();
        let starts = starts.raw_storage();
        let largest = matrix
            .data()
            .iter()
            .fold(0.0f64, |max, rate| max.max(rate.abs()));
        self.scale = if largest > 0.0 && largest.is_finite() {
            largest.log2().round().exp2()
        } else {
            1.0
        };
        let mut values: Vec<f64> = matrix.data().iter().map(|rate| rate / self.scale).collect();
        let mut place = NO_CELL;
        if held != NO_CELL {
            values[starts[held]..starts[held + 1]].fill(0.0);
            for (value, &row) in values.iter_mut().zip(matrix.indices()) {
                if row == held {
                    *value = 0.0;
                }
            }
            let held = held as u32;
            let found = self.symbolic.order.iter().position(|&cell| cell == held);
            place = found.unwrap_or(0);
        }
        let symbolic = &self.symbolic;
        match &mut self.numbers {
            Numbers::Double(factors) => factorise(symbolic, &values, place, factors, cancellation),
            Numbers::Single(factors) => factorise(symbolic, &values, place, factors, cancellation),
        }
    }

    pub(super) fn apply<const R: usize>(
        &self,
        residuals: [&[f64]; R],
        held: usize,
    ) -> [Vec<f64>; R] {
        let order = &self.symbolic.order;
        let ordered =
            |residual: &[f64]| order.iter().map(|&cell| residual[cell as usize]).collect();
        let mut x: [Vec<f64>; R] = residuals.map(ordered);
        let vectors = x.each_mut().map(Vec::as_mut_slice);
        match &self.numbers {
            Numbers::Double(factors) => triangular::solve(&self.symbolic, &factors.fronts, vectors),
            Numbers::Single(factors) => triangular::solve(&self.symbolic, &factors.fronts, vectors),
        }
        x.map(|x| self.in_place(&x, held))
    }

    pub(super) fn apply_transposed(&self, residual: &[f64], held: usize) -> Vec<f64> {
        let order = self.symbolic.order.iter();
        let mut x: Vec<f64> = order.map(|&cell| residual[cell as usize]).collect();
        match &self.numbers {
            Numbers::Double(factors) => {
                solve_transposed(&self.symbolic, &factors.fronts, &mut x);
            }
            Numbers::Single(factors) => {
                solve_transposed(&self.symbolic, &factors.fronts, &mut x);
            }
        }
        self.in_place(&x, held)
    }

    /// What stands in the elimination order, cell by cell.
    fn in_place(&self, x: &[f64], held: usize) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        for (&cell, value) in self.symbolic.order.iter().zip(x) {
            out[cell as usize] = value / self.scale;
        }
        if let Some(value) = out.get_mut(held) {
            *value = 0.0;
        }
        out
    }
}
