//! Symmetric generators on half of the cells.
//!
//! Where the matrix does not change when all cells are counted from the other end (a system that is odd about the
//! middle of its cells), the steady state is symmetric too, being the only one, and so is its answer to symmetric
//! changes. Cells and their mirror images are then summed: half the unknowns, half the memory, less than half the work.
//! Symmetry is seen in the matrix itself, to rounding; a change that is not symmetric is answered on all cells.

mod along;
mod folding;
#[cfg(test)]
mod tests;

use sprs::CsMat;

use super::memory::SolverMemory;
use super::narrowing;
use super::preconditioner::{Estimate, Structure, estimate_of};
use super::question::Question;
use super::solver::DirectSolver;
use super::{RateError, RateOptions, RateSteadyState};
use crate::cancellation::Cancellation;
use crate::space::{Axis, CellSpace};
pub use along::Along;
use along::FoldedQuestion;
use folding::{Folding, is_centrosymmetric, is_symmetric};

/// Unknowns below which halving them is not worth the while, and the same where modes make dense blocks of them.
const WORTH_FOLDING: usize = 12_000;
const WORTH_FOLDING_WITH_MODES: usize = 7000;

/// Solves generators on one cell space, keeping the factorisation from one to the next.
pub struct RateSolver {
    space: CellSpace,
    options: RateOptions,
    cancellation: Cancellation,
    plain: DirectSolver,
    half: Option<Half>,
    /// The last matrix, with its escape, that was solved on half of the cells; `None` after one that was not.
    folded: Option<(CsMat<f64>, Vec<f64>)>,
}

/// Unknowns from which on half of them are worth having.
fn worth_folding(space: &CellSpace) -> usize {
    if space.axes().iter().any(Axis::is_modes) {
        WORTH_FOLDING_WITH_MODES
    } else {
        WORTH_FOLDING
    }
}

/// The solver on half of the cells.
struct Half {
    folding: Folding,
    solver: DirectSolver,
}

impl RateSolver {
    /// A solver without a factorisation yet.
    pub fn new(space: CellSpace, options: RateOptions) -> Self {
        Self {
            plain: DirectSolver::new(space.clone(), options, None),
            space,
            options,
            cancellation: Cancellation::new(),
            half: None,
            folded: None,
        }
    }

    /// The solver with a token that is looked at in every front of a factorisation and in every iteration.
    #[must_use]
    pub(crate) fn cancelled_by(self, cancellation: &Cancellation) -> Self {
        Self {
            plain: self.plain.cancelled_by(cancellation),
            half: None,
            folded: None,
            cancellation: cancellation.clone(),
            ..self
        }
    }

    /// The (quasi-)steady state of a generator: `matrix` is n × n by columns (CSC), column j the rates out of
    /// cell j, summing to -`escape[j]`. `guess` is a neighbour's mass vector, or one predicted from it.
    ///
    /// # Errors
    /// [`RateError`] when the input is no generator, the memory does not suffice, or the solve is cancelled.
    pub fn solve(
        &mut self,
        matrix: &CsMat<f64>,
        escape: &[f64],
        guess: Option<&[f64]>,
    ) -> Result<RateSteadyState, RateError> {
        Ok(self.solve_along(matrix, escape, guess, None)?.0)
    }

    /// [`RateSolver::solve`], and along with it how the masses of the guess answer to a change of the generator, by the
    /// same passes through the factors: nearly for nothing. There is no answer without a guess, to a change that breaks
    /// a symmetry that is made use of, or when it took too long.
    ///
    /// # Errors
    /// As [`RateSolver::solve`]; [`RateError::Shape`] for a change of the wrong size.
    pub(crate) fn solve_along(
        &mut self,
        matrix: &CsMat<f64>,
        escape: &[f64],
        guess: Option<&[f64]>,
        along: Option<&Along<'_>>,
    ) -> Result<(RateSteadyState, Option<Vec<f64>>), RateError> {
        self.folded = None;
        let question = along.filter(|_| guess.is_some()).map(Along::question);
        if let (Some(question), Some(guess)) = (&question, guess) {
            self.plain.shapes(question, guess)?;
        }
        if self.space.n_cells() < worth_folding(&self.space) || !is_centrosymmetric(matrix, escape)
        {
            return self.plain.solve_along(matrix, escape, guess, question);
        }
        self.plain.check(matrix, escape)?;
        let Some(half) = self.half(matrix)? else {
            return self.plain.solve_along(matrix, escape, guess, question);
        };
        let folding = &half.folding;
        let guess = guess.map(|guess| folding.fold(guess));
        let (folded, escaping) = folding.generator(matrix, escape);
        let question = question.filter(|question| is_symmetric(question.change));
        let question = question.map(|question| FoldedQuestion::new(&question, folding));
        let question = question.as_ref().map(FoldedQuestion::question);
        let solver = &mut half.solver;
        let (steady, answer) =
            solver.solve_along(&folded, &escaping, guess.as_deref(), question)?;
        let mass = folding.unfold(&steady.mass);
        let answer = answer.map(|answer| folding.unfold(&answer));
        let mut info = steady.info;
        info.unknowns = mass.len();
        self.folded = Some((matrix.clone(), escape.to_vec()));
        Ok((RateSteadyState { mass, info }, answer))
    }

    /// Whether iterating with the factorisation at hand has come to cost more than a new one would: the next solve
    /// factorises, unless [`RateSolver::renew`] does before.
    pub(crate) fn is_worn(&self) -> bool {
        match (&self.folded, &self.half) {
            (Some(_), Some(half)) => half.solver.is_worn(),
            _ => self.plain.is_worn(),
        }
    }

    /// Factorises a generator in the middle of those that are solved next, which reaches about twice as many of them as
    /// the factorisation of the first would. `mass` is about its steady state.
    ///
    /// # Errors
    /// As [`RateSolver::solve`].
    pub(crate) fn renew(
        &mut self,
        matrix: &CsMat<f64>,
        escape: &[f64],
        mass: &[f64],
    ) -> Result<(), RateError> {
        let half = self.half.as_mut().filter(|_| self.folded.is_some());
        let Some(half) = half.filter(|_| is_centrosymmetric(matrix, escape)) else {
            return self.plain.renew(matrix, escape, mass);
        };
        let (matrix, escape) = half.folding.generator(matrix, escape);
        let mass = half.folding.fold(mass);
        half.solver.renew(&matrix, &escape, &mass)
    }

    /// Factorisations that were made since the solver was.
    pub(crate) fn factorisations(&self) -> usize {
        let half = self.half.as_ref();
        self.plain.factorisations() + half.map_or(0, |half| half.solver.factorisations())
    }

    /// Where the solver stands, but for the matrices: on half of the cells if the last solve was, else on all of them.
    pub(crate) fn memory(&self) -> SolverMemory {
        match (&self.folded, &self.half) {
            (Some(_), Some(half)) => SolverMemory {
                folded: true,
                ..half.solver.memory()
            },
            _ => self.plain.memory(),
        }
    }

    /// Brings a fresh solver to where another one on the same cells was: `factorised` is the matrix that it had
    /// factorised, `last` that of its last solve with the escape. What is solved then is the same to the bit.
    ///
    /// # Errors
    /// As [`RateSolver::solve`].
    pub(crate) fn restore(
        &mut self,
        memory: &SolverMemory,
        factorised: Option<&CsMat<f64>>,
        last: Option<(CsMat<f64>, Vec<f64>)>,
    ) -> Result<(), RateError> {
        let Some((matrix, escape)) = last.as_ref().filter(|_| memory.folded) else {
            return self.plain.restore(memory, factorised, last);
        };
        self.plain.check(matrix, escape)?;
        if let Some(other) = factorised.filter(|other| other.cols() != matrix.cols()) {
            return Err(RateError::Shape {
                cells: matrix.cols(),
                part: "columns",
                found: other.cols(),
            });
        }
        let Some(half) = self.half(matrix)? else {
            return Ok(());
        };
        let folding = &half.folding;
        let old = factorised.map(|matrix| folding.generator(matrix, escape).0);
        let new = folding.generator(matrix, escape);
        half.solver.restore(memory, old.as_ref(), Some(new))?;
        self.folded = last;
        Ok(())
    }

    /// The solver on half of the cells; `None` where there is no half, or it would not fit the memory in full.
    fn half(&mut self, matrix: &CsMat<f64>) -> Result<Option<&mut Half>, RateError> {
        if self.half.is_none() {
            let Some(folding) = Folding::new(&self.space) else {
                return Ok(None);
            };
            let reach = narrowing::reach(&self.space, matrix);
            let structure = Structure {
                reach: reach.clone(),
                folded: Some(folding.axis),
            };
            let limit = self.options.memory_limit_bytes;
            let fits = |plan: Estimate| !plan.method.is_narrow();
            let plan = estimate_of(&folding.half, &structure, limit, self.options.method);
            if !plan.is_ok_and(fits) {
                return Ok(None);
            }
            let solver = DirectSolver::new(folding.half.clone(), self.options, Some(structure));
            self.half = Some(Half {
                folding,
                solver: solver.cancelled_by(&self.cancellation),
            });
        }
        Ok(self.half.as_mut())
    }

    /// dp/dθ (Σ = 0) from Q dp = -(dQ/dθ) p at the last steady state, with its factorisation; `derivative` is
    /// dQ/dθ (CSC, any pattern), `mass` the steady state. Escape is taken into account.
    ///
    /// # Errors
    /// [`RateError::NoSteadyState`] before the first solve, [`RateError::Shape`] for wrong sizes,
    /// [`RateError::Sensitivity`] when the iterations do not suffice, [`RateError::Cancelled`].
    pub fn sensitivity(
        &mut self,
        derivative: &CsMat<f64>,
        mass: &[f64],
    ) -> Result<Vec<f64>, RateError> {
        self.sensitivity_within(derivative, mass, None, self.options.tolerance)
    }

    /// [`RateSolver::sensitivity`] to a relative error of `tolerance` in L1: predictions and estimates of errors need
    /// two digits, and with a neighbour's factorisation every digit costs iterations. `guess` is what is expected.
    ///
    /// # Errors
    /// As [`RateSolver::sensitivity`].
    pub(crate) fn sensitivity_within(
        &mut self,
        derivative: &CsMat<f64>,
        mass: &[f64],
        guess: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<Vec<f64>, RateError> {
        let change = self.plain.change(derivative, mass)?;
        self.response(&change, mass, guess, tolerance)
    }

    /// How the last steady state `mass` answers to a change of its balance: p' (Σ = 0) from Q p' = -`change`, where
    /// `change` is by how much more mass enters each cell than before, per unit time; what its sum lacks escapes.
    ///
    /// # Errors
    /// As [`RateSolver::sensitivity`].
    pub(crate) fn response(
        &mut self,
        change: &[f64],
        mass: &[f64],
        guess: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<Vec<f64>, RateError> {
        self.answer(
            &Question {
                change,
                guess,
                tolerance,
                is_aside: false,
            },
            mass,
        )
    }

    /// The same of what enters beside the ends of the ranges: the work says nothing of how worn the factors are.
    ///
    /// # Errors
    /// As [`RateSolver::sensitivity`].
    pub(crate) fn response_at_ends(
        &mut self,
        change: &[f64],
        mass: &[f64],
        tolerance: f64,
    ) -> Result<Vec<f64>, RateError> {
        self.answer(
            &Question {
                change,
                guess: None,
                tolerance,
                is_aside: true,
            },
            mass,
        )
    }

    fn answer(&mut self, question: &Question<'_>, mass: &[f64]) -> Result<Vec<f64>, RateError> {
        let Some((matrix, escape)) = &self.folded else {
            return self.plain.response(question, mass);
        };
        self.plain.shapes(question, mass)?;
        let is_even = is_symmetric(question.change);
        if let Some(half) = self.half.as_mut().filter(|_| is_even) {
            let folded = FoldedQuestion::new(question, &half.folding);
            let mass = half.folding.fold(mass);
            let response = half.solver.response(&folded.question(), &mass)?;
            return Ok(half.folding.unfold(&response));
        }
        // Only now are factors of the whole matrix needed. It stays solved on half of the cells.
        if !self.plain.has_solved(matrix) {
            self.plain.solve(matrix, escape, Some(mass))?;
        }
        self.plain.response(question, mass)
    }
}
