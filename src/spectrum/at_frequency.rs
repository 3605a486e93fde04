//! Vectors of a resolvent at a shift on the imaginary axis: what observables do at one frequency.

use nalgebra::Complex;

use super::grid::Grid;
use super::model::balanced;
use crate::cancellation::Cancellation;
use crate::stationary::generator::{RateError, Shifted, ShiftedPattern};

/// A shift at a frequency, and the last vectors of Krylov's spaces of both sides there, one an observable.
pub(super) struct AtFrequency<'a> {
    pub(super) frequency: f64,
    grid: &'a Grid,
    solver: Shifted<'a>,
    columns: Vec<Vec<Complex<f64>>>,
    rows: Vec<Vec<Complex<f64>>>,
    /// Solves from either side.
    pub(super) solves: usize,
}

impl<'a> AtFrequency<'a> {
    /// Factorises; the spaces begin with these vectors.
    ///
    /// # Errors
    /// [`RateError::Cancelled`].
    pub(super) fn new(
        (pattern, grid): (&'a ShiftedPattern, &'a Grid),
        frequency: f64,
        (columns, rows): (&[Vec<f64>], &[Vec<f64>]),
        cancellation: &Cancellation,
    ) -> Result<Self, RateError> {
        let complex = |vectors: &[Vec<f64>]| -> Vec<Vec<Complex<f64>>> {
            let of = |one: &Vec<f64>| balanced(one.clone()).into_iter().map(Complex::from);
            vectors.iter().map(|one| of(one).collect()).collect()
        };
        let shift = Complex::new(0.0, frequency);
        Ok(Self {
            frequency,
            grid,
            solver: Shifted::new(pattern, &grid.full, shift, cancellation)?,
            columns: complex(columns),
            rows: complex(rows),
            solves: 0,
        })
    }

    /// Passes through the factors.
    pub(super) fn passes(&self) -> usize {
        self.solver.passes
    }

    /// One more solve from either side; the real and the imaginary parts of what it gives, columns and rows.
    pub(super) fn solve(&mut self) -> Vec<[Vec<f64>; 2]> {
        self.solves += 1;
        self.columns = unit(self.solver.solve(&self.columns, false));
        self.rows = unit(self.solver.solve(&self.rows, true));
        let pairs = self.columns.iter().zip(&self.rows);
        let parts = pairs.flat_map(|pair| {
            [|one: &Complex<f64>| one.re, |one: &Complex<f64>| one.im].map(|part| {
                let of =
                    |vector: &[Complex<f64>]| self.grid.balanced(vector.iter().map(part).collect());
                [of(pair.0), of(pair.1)]
            })
        });
        parts.collect()
    }
}

/// Each of length one.
fn unit(mut vectors: Vec<Vec<Complex<f64>>>) -> Vec<Vec<Complex<f64>>> {
    for vector in &mut vectors {
        let length = vector.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
        vector.iter_mut().for_each(|value| *value /= length);
    }
    vectors
}
