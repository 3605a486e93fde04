//! How a steady state answers to a change of its balance: p' (Σ = 0) from Q p' = -change, by itself or along with the
//! solve.

use sprs::CsMat;

use super::RateError;
use super::balance::{Balance, add_product};
use super::newton::linear;
use super::passes::{Seat, alone};
use super::solver::{DirectSolver, shape};
use crate::cancellation::{Cancellation, Cancelled};

/// Iterations of a [`DirectSolver::response`] to two digits with the factors of its own matrix.
const FRESH_RESPONSE: usize = 2;

/// A change of the balance, and how well the answer to it is wanted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Question<'a> {
    /// By how much more mass enters each cell than before, per unit time; what its sum lacks escapes.
    pub(super) change: &'a [f64],
    /// What is expected.
    pub(super) guess: Option<&'a [f64]>,
    /// Relative error in L1.
    pub(super) tolerance: f64,
}

impl DirectSolver {
    /// By how much more mass enters each cell when Q changes by `derivative` (CSC).
    ///
    /// # Errors
    /// [`RateError::Shape`] for wrong sizes, [`RateError::Storage`].
    pub(super) fn change(
        &self,
        derivative: &CsMat<f64>,
        mass: &[f64],
    ) -> Result<Vec<f64>, RateError> {
        let cells = self.space.n_cells();
        shape(cells, "derivative's rows", derivative.rows())?;
        shape(cells, "derivative's columns", derivative.cols())?;
        shape(cells, "mass", mass.len())?;
        if !derivative.is_csc() {
            return Err(RateError::Storage);
        }
        let mut change = vec![0.0; cells];
        add_product(derivative, mass, &mut change);
        Ok(change)
    }

    /// Nothing, if the vectors of a question have one entry a cell.
    ///
    /// # Errors
    /// [`RateError::Shape`].
    pub(super) fn shapes(&self, question: &Question<'_>, mass: &[f64]) -> Result<(), RateError> {
        let cells = self.space.n_cells();
        shape(cells, "change", question.change.len())?;
        shape(cells, "mass", mass.len())?;
        shape(cells, "guess", question.guess.map_or(cells, <[f64]>::len))
    }

    /// Whether the last matrix that was solved is this one.
    pub(super) fn has_solved(&self, matrix: &CsMat<f64>) -> bool {
        self.last.as_ref().is_some_and(|(last, _)| last == matrix)
    }

    /// The answer of the last steady state `mass`.
    ///
    /// # Errors
    /// As [`super::RateSolver::sensitivity`].
    pub(super) fn response(
        &mut self,
        question: &Question<'_>,
        mass: &[f64],
    ) -> Result<Vec<f64>, RateError> {
        let (Some((matrix, escape)), Some(kept)) = (&self.last, &self.preconditioner) else {
            return Err(RateError::NoSteadyState);
        };
        self.shapes(question, mass)?;
        let balance = Balance {
            matrix,
            escape,
            held: kept.held,
        };
        let (seat, limit) = (Seat::default(), self.options.max_iterations);
        let asked = answer(&seat, &balance, mass, question, limit, &self.cancellation);
        let found = alone(|rest| kept.apply_one(rest), &seat, asked)?;
        let (response, used) = found.ok_or(RateError::Sensitivity)?;
        self.count_response(used);
        Ok(response)
    }

    /// Counts the iterations of an answer beyond those that new factors would take.
    pub(super) fn count_response(&mut self, used: usize) {
        // With a stand-in new factors would save no more than they do in a solve.
        let fresh = match &self.plan {
            Some((_, plan)) if !plan.method.is_exact() => self.baseline.max(FRESH_RESPONSE),
            _ => FRESH_RESPONSE,
        };
        self.excess += used.saturating_sub(fresh);
    }
}

/// The answer of the masses `mass` to a question and the iterations used, `None` when it takes more than `limit`.
///
/// # Errors
/// [`Cancelled`].
pub(super) async fn answer(
    seat: &Seat,
    balance: &Balance<'_>,
    mass: &[f64],
    question: &Question<'_>,
    limit: usize,
    cancellation: &Cancellation,
) -> Result<Option<(Vec<f64>, usize)>, Cancelled> {
    let total: f64 = mass.iter().sum();
    let held = balance.held;
    // dF/dθ: rates change, and with them the escape, by minus the column sums.
    let lost: f64 = -question.change.iter().sum::<f64>() / total;
    let pairs = question.change.iter().zip(mass);
    let mut source: Vec<f64> = pairs.map(|(c, p)| -(c + lost * p)).collect();
    source[held] = 0.0;
    // The cell that is held does not answer; p may be added freely.
    let start = question.guess.map(|guess| {
        let share = guess[held] / mass[held];
        let pairs = guess.iter().zip(mass);
        pairs.map(|(x, p)| x - share * p).collect::<Vec<f64>>()
    });
    let start = start.filter(|start| start.iter().all(|value| value.is_finite()));
    let effort = (question.tolerance, limit);
    let jacobian = balance.jacobian(mass);
    let derivative = |vector: &[f64]| jacobian.apply(vector);
    let found = linear(seat, &derivative, (&source, start), effort, cancellation).await?;
    Ok(found.map(|(mut response, used)| {
        let excess: f64 = response.iter().sum::<f64>() / total;
        for (slot, value) in response.iter_mut().zip(mass) {
            *slot -= excess * value;
        }
        (response, used)
    }))
}
