//! The solver: iterates with the factorisation it has, factorises when iterating would cost more.

mod factors;
mod held;
mod restore;

use sprs::CsMat;

use super::balance::Balance;
use super::newton::{Newton, SolveWork};
use super::passes::{Seat, run_alone, together};
use super::preconditioner::{Estimate, Preconditioner, Structure};
use super::question::{Question, answer};
use super::{RateError, RateInfo, RateMethod, RateOptions, RateSteadyState};
use crate::cancellation::{Cancellation, Cancelled};
use crate::space::CellSpace;
use factors::renewal;
use held::WEAK_HELD_SHARE;
pub(super) use held::largest;

/// Solves generators on one cell space, keeping the factorisation from one to the next.
pub(super) struct DirectSolver {
    pub(super) space: CellSpace,
    pub(super) options: RateOptions,
    /// Of a folded matrix, whose entries do not show it.
    given: Option<Structure>,
    pub(super) plan: Option<(Structure, Estimate)>,
    pub(super) preconditioner: Option<Preconditioner>,
    /// Iterations that a new factorisation would have saved since this one was made.
    pub(super) excess: usize,
    /// Least iterations that a solve has taken since the last one for which a factorisation was made.
    pub(super) baseline: usize,
    pub(super) last: Option<(CsMat<f64>, Vec<f64>)>,
    /// Factorisations that were made, and the reach and method of the last.
    factorisations: usize,
    factorised: Option<(Vec<usize>, RateMethod)>,
    pub(super) cancellation: Cancellation,
}

impl DirectSolver {
    /// A solver without a factorisation yet.
    pub(super) fn new(space: CellSpace, options: RateOptions, given: Option<Structure>) -> Self {
        Self {
            space,
            given,
            options,
            plan: None,
            preconditioner: None,
            excess: 0,
            baseline: 0,
            last: None,
            factorisations: 0,
            factorised: None,
            cancellation: Cancellation::new(),
        }
    }

    /// The solver with a token that is looked at in every front of a factorisation and in every iteration.
    #[must_use]
    pub(super) fn cancelled_by(self, cancellation: &Cancellation) -> Self {
        let cancellation = cancellation.clone();
        Self {
            cancellation,
            ..self
        }
    }

    /// Factorisations that were made since the solver was.
    pub(super) fn factorisations(&self) -> usize {
        self.factorisations
    }

    /// The (quasi-)steady state of a generator: `matrix` is n × n by columns (CSC), column j the rates out of
    /// cell j, summing to -`escape[j]`. `guess` is a neighbour's mass vector, or one predicted from it.
    ///
    /// # Errors
    /// [`RateError`] when the input is no generator, the memory does not suffice, or the solve is cancelled.
    pub(super) fn solve(
        &mut self,
        matrix: &CsMat<f64>,
        escape: &[f64],
        guess: Option<&[f64]>,
    ) -> Result<RateSteadyState, RateError> {
        Ok(self.solve_along(matrix, escape, guess, None)?.0)
    }

    /// [`DirectSolver::solve`] with a question that is answered by the same passes for the masses of the guess; there
    /// is no answer without a guess, or when it took too long.
    ///
    /// # Errors
    /// As [`DirectSolver::solve`].
    pub(super) fn solve_along(
        &mut self,
        matrix: &CsMat<f64>,
        escape: &[f64],
        guess: Option<&[f64]>,
        question: Option<Question<'_>>,
    ) -> Result<(RateSteadyState, Option<Vec<f64>>), RateError> {
        self.check(matrix, escape)?;
        let mut question = question.filter(|_| guess.is_some());
        let mut answer = None;
        let mut mass = match guess {
            Some(guess) => self.normalised(guess)?,
            None => Vec::new(),
        };
        let mut plan = self.plan(matrix)?;
        let mut progress = SolveWork::default();
        let mut held = self.choose_held(matrix, &mass);
        let mut fresh = self.is_worn()
            || self
                .preconditioner
                .as_ref()
                .is_none_or(|kept| kept.held != held);
        // At most: the old factorisation, a new one, one with a better cell held, a more demanding one.
        for _ in 0..4 {
            if fresh {
                held = self.cell_to_hold(held, &mass);
                held = self.factorise(matrix, held, &plan)?;
                progress.factorisations += 1;
            }
            if mass.is_empty() || !mass.iter().sum::<f64>().is_finite() {
                mass = vec![0.0; matrix.cols()];
                mass[held] = 1.0;
            }
            let balance = Balance {
                matrix,
                escape,
                held,
            };
            let given = self.iterate(
                &balance,
                &mut mass,
                &mut progress,
                (fresh, &plan),
                question.take(),
            )?;
            answer = answer.or(given);
            // The sign is arbitrary: on a grid too coarse, wiggles may make the held cell's mass negative.
            if mass.iter().sum::<f64>() < 0.0 {
                mass.iter_mut().for_each(|value| *value = -*value);
            }
            if progress.converged {
                break;
            }
            let (best, largest) = largest(&mass);
            if best != held && mass[held].abs() < WEAK_HELD_SHARE * largest {
                held = best;
            } else if fresh {
                let Some(demanding) = self.fall_back(&plan) else {
                    break;
                };
                plan = demanding;
            }
            fresh = true;
        }
        let steady = self.finish(matrix, escape, mass, &progress, plan.method);
        Ok((steady, answer))
    }

    pub(super) fn check(&self, matrix: &CsMat<f64>, escape: &[f64]) -> Result<(), RateError> {
        let cells = self.space.n_cells();
        shape(cells, "rows", matrix.rows())?;
        shape(cells, "columns", matrix.cols())?;
        shape(cells, "escape", escape.len())?;
        if !matrix.is_csc() {
            return Err(RateError::Storage);
        }
        for (cell, (column, &escape)) in matrix.outer_iterator().zip(escape).enumerate() {
            let sum: f64 = column.data().iter().sum();
            let size: f64 = column.data().iter().map(|rate| rate.abs()).sum();
            let gap = (sum + escape).abs();
            if !gap.is_finite() || gap > 1e-10 * (size + escape.abs()) {
                return Err(RateError::Column { cell, sum, escape });
            }
        }
        Ok(())
    }

    fn normalised(&self, guess: &[f64]) -> Result<Vec<f64>, RateError> {
        shape(self.space.n_cells(), "guess", guess.len())?;
        let sum: f64 = guess.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(RateError::Guess);
        }
        Ok(guess.iter().map(|value| value / sum).collect())
    }

    /// Improves `mass` with the factorisation at hand; gives the answer to the question, if there is one.
    fn iterate(
        &mut self,
        balance: &Balance<'_>,
        mass: &mut [f64],
        progress: &mut SolveWork,
        (fresh, plan): (bool, &Estimate),
        question: Option<Question<'_>>,
    ) -> Result<Option<Vec<f64>>, Cancelled> {
        let Some(kept) = &self.preconditioner else {
            return Ok(None);
        };
        let worth = if fresh {
            usize::MAX
        } else {
            self.baseline + renewal(plan)
        };
        let (seat, other) = (Seat::default(), Seat::default());
        let limit = worth.min(self.options.max_iterations);
        let limit = limit.min(self.patience(plan));
        let newton = Newton {
            balance,
            seat: &seat,
            tolerance: self.options.tolerance,
            limit,
            fresh,
            exact: plan.method.is_exact(),
            cancellation: &self.cancellation,
        };
        let (used, passes, given) = match question {
            None => {
                let run = newton.run(mass, progress);
                let used = run_alone(|rest| kept.apply_one(rest), &seat, run)?;
                (used, used, None)
            }
            Some(question) => {
                let guess = mass.to_vec();
                let asked = answer(
                    &other,
                    balance,
                    &guess,
                    &question,
                    limit,
                    &self.cancellation,
                );
                let run = newton.run(mass, progress);
                let (used, given, passes) = together(kept, [&seat, &other], run, asked);
                (used?, passes, given?.map(|(given, _)| given))
            }
        };
        // A cold solve takes more than a warm one would have, and factors made ahead are not tried on their own matrix.
        self.baseline = if fresh { used } else { self.baseline.min(used) };
        self.excess += passes.saturating_sub(self.baseline);
        Ok(given)
    }

    fn finish(
        &mut self,
        matrix: &CsMat<f64>,
        escape: &[f64],
        mut mass: Vec<f64>,
        progress: &SolveWork,
        method: RateMethod,
    ) -> RateSteadyState {
        let sum: f64 = mass.iter().sum();
        mass.iter_mut().for_each(|value| *value /= sum);
        let balance = Balance {
            matrix,
            escape,
            held: 0,
        };
        let info = RateInfo {
            method,
            factorisations: progress.factorisations,
            iterations: progress.iterations,
            residual: balance.relative_residual(&mass),
            error_estimate: progress.error,
            escape_rate: balance.escape_rate(&mass),
            negative_mass: mass.iter().map(|value| (-value).max(0.0)).sum(),
            unknowns: mass.len(),
            factor_bytes: self
                .preconditioner
                .as_ref()
                .map_or(0, Preconditioner::factor_bytes),
            converged: progress.converged && sum > 0.0,
        };
        self.last = Some((matrix.clone(), escape.to_vec()));
        RateSteadyState { mass, info }
    }
}

pub(super) fn shape(cells: usize, part: &'static str, found: usize) -> Result<(), RateError> {
    if found == cells {
        Ok(())
    } else {
        Err(RateError::Shape { cells, part, found })
    }
}
