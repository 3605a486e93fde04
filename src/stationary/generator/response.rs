//! How a steady state answers to a change of its balance: p' (Σ = 0) from Q p' = -change, by itself or along with the
//! solve.

use sprs::CsMat;

use super::RateError;
use super::balance::{Balance, add_product};
use super::passes::{Seat, run_alone};
use super::question::{Question, answer};
use super::solver::{DirectSolver, shape};

/// Iterations of a [`DirectSolver::response`] to two digits with the factors of its own matrix.
const FRESH_RESPONSE: usize = 2;

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

    /// The answer of the last steady state `mass`. Factors that served it may not serve the answer: where they do not,
    /// more demanding ones are made.
    ///
    /// # Errors
    /// As [`super::RateSolver::sensitivity`].
    pub(super) fn response(
        &mut self,
        question: &Question<'_>,
        mass: &[f64],
    ) -> Result<Vec<f64>, RateError> {
        loop {
            if let Some((response, used)) = self.try_to_answer(question, mass)? {
                if !question.is_aside {
                    self.count_response(used);
                }
                return Ok(response);
            }
            let plan = self.plan.as_ref().map(|(_, plan)| *plan);
            let demanding = plan.and_then(|plan| self.fall_back(&plan));
            demanding.ok_or(RateError::Sensitivity)?;
            let (matrix, escape) = self.last.take().ok_or(RateError::NoSteadyState)?;
            let renewed = self.renew(&matrix, &escape, mass);
            self.last = Some((matrix, escape));
            renewed?;
        }
    }

    /// The answer by the factors at hand, and the iterations that it took; `None` where they do not serve.
    fn try_to_answer(
        &self,
        question: &Question<'_>,
        mass: &[f64],
    ) -> Result<Option<(Vec<f64>, usize)>, RateError> {
        let (Some((matrix, escape)), Some(kept)) = (&self.last, &self.preconditioner) else {
            return Err(RateError::NoSteadyState);
        };
        self.shapes(question, mass)?;
        let balance = Balance {
            matrix,
            escape,
            held: kept.held,
        };
        let plan = self.plan.as_ref().map(|(_, plan)| plan);
        let patience = plan.map_or(usize::MAX, |plan| self.patience(plan));
        let (seat, limit) = (Seat::default(), self.options.max_iterations.min(patience));
        let asked = answer(&seat, &balance, mass, question, limit, &self.cancellation);
        Ok(run_alone(|rest| kept.apply_one(rest), &seat, asked)?)
    }

    /// Counts the iterations of an answer beyond those that new factors would take.
    fn count_response(&mut self, used: usize) {
        // With a stand-in new factors would save no more than they do in a solve.
        let fresh = match &self.plan {
            Some((_, plan)) if !plan.method.is_exact() => self.baseline.max(FRESH_RESPONSE),
            _ => FRESH_RESPONSE,
        };
        self.excess += used.saturating_sub(fresh);
    }
}
