//! The transposed solve Qᵀ x = b with the factors of the last steady state: what functions of the state need (mean
//! times, adjoints), as the steady state needs Q.
//!
//! One cell is held, as for the steady state: x is y + c with y zero there. Weighted by the steady state p the
//! equations of all cells sum to c r Σp = -(b·p + r y·p), r the rate at which mass escapes, so that the equation of
//! the held cell gives c and the rest is Q'ᵀ y + e (p·y) / Σp = b - e (b·p) / (r Σp) with the escape e: regular
//! however slowly mass escapes. Where none does, c is free, and b must have no mean under p.

use sprs::CsMat;

use super::RateError;
use super::balance::{Balance, dot};
use super::newton::{linear, norm};
use super::passes::{Seat, run_alone};
use super::question::Question;
use super::solver::DirectSolver;

/// A solution of Qᵀ x = b.
#[derive(Debug, Clone, PartialEq)]
pub struct TransposedSolution {
    /// x: one value a cell.
    pub values: Vec<f64>,
    /// Applications of the factorisation.
    pub iterations: usize,
    /// ‖Qᵀ x - b‖₁ / (‖|Qᵀ| |x|‖₁ + ‖b‖₁), all cells counted.
    pub residual: f64,
}

impl DirectSolver {
    /// The solution for a right side, which stands in the question as the change; `mass` is the last steady state.
    ///
    /// # Errors
    /// As [`super::RateSolver::transposed`].
    pub(super) fn transposed(
        &mut self,
        question: &Question<'_>,
        mass: &[f64],
    ) -> Result<TransposedSolution, RateError> {
        let (Some((matrix, escape)), Some(kept)) = (&self.last, &self.preconditioner) else {
            return Err(RateError::NoSteadyState);
        };
        self.shapes(question, mass)?;
        let held = kept.held;
        let balance = Balance {
            matrix,
            escape,
            held,
        };
        let (total, rate) = (mass.iter().sum::<f64>(), balance.escape_rate(mass));
        let mean = dot(question.change, mass) / total;
        let mut right = question.change.to_vec();
        let leaks = rate != 0.0;
        if !leaks {
            right.iter_mut().for_each(|value| *value -= mean);
        }
        let mut source = right.clone();
        if leaks {
            let pairs = source.iter_mut().zip(escape);
            pairs.for_each(|(value, escape)| *value -= escape * (mean / rate));
        }
        source[held] = 0.0;
        let operator = |y: &[f64]| {
            let mut out = product(matrix, y);
            let share = dot(mass, y) / total;
            let pairs = out.iter_mut().zip(escape);
            pairs.for_each(|(value, escape)| *value += escape * share);
            out[held] = 0.0;
            out
        };
        let shifted =
            |guess: &[f64]| -> Vec<f64> { guess.iter().map(|x| x - guess[held]).collect() };
        let start = question.guess.map(shifted);
        let effort = (question.tolerance, self.options.max_iterations);
        let seat = Seat::default();
        let work = linear(
            &seat,
            &operator,
            (&source, start),
            effort,
            &self.cancellation,
        );
        let found = run_alone(|rest| kept.apply_transposed(rest), &seat, work)?;
        let (mut values, iterations) = found.ok_or(RateError::Sensitivity)?;
        let lift = if leaks { -mean / rate } else { 0.0 };
        let shift = lift - dot(&values, mass) / total;
        values.iter_mut().for_each(|value| *value += shift);
        let left = product(matrix, &values);
        let left: Vec<f64> = left.iter().zip(&right).map(|(a, b)| a - b).collect();
        let columns = matrix.outer_iterator();
        let sizes = columns.flat_map(|column| {
            let pairs = column.indices().iter().zip(column.data());
            let sizes = pairs.map(|(&row, rate)| (rate * values[row]).abs());
            sizes.collect::<Vec<f64>>()
        });
        let scale = sizes.sum::<f64>() + norm(&right);
        let residual = norm(&left) / scale.max(f64::MIN_POSITIVE);
        // As of a response: new factors of a stand-in would save no more.
        self.count_response(iterations);
        Ok(TransposedSolution {
            values,
            iterations,
            residual,
        })
    }
}

/// Qᵀ x.
pub(super) fn product(matrix: &CsMat<f64>, x: &[f64]) -> Vec<f64> {
    let columns = matrix.outer_iterator();
    let sum = |indices: &[usize], rates: &[f64]| {
        let pairs = indices.iter().zip(rates);
        pairs.map(|(&row, rate)| rate * x[row]).sum::<f64>()
    };
    columns
        .map(|column| sum(column.indices(), column.data()))
        .collect()
}
