//! Questions to a solve, and what they become on half of the cells.

use super::folding::Folding;
use crate::stationary::generator::question::Question;

/// A change of the generator whose effect on the steady state is wanted along with a solve.
#[derive(Debug, Clone, Copy)]
pub struct Along<'a> {
    /// By how much more mass enters each cell, dQ times the masses of the guess.
    pub change: &'a [f64],
    /// The answer that is expected, Σ = 0.
    pub expected: Option<&'a [f64]>,
    /// Relative error of the answer in L1.
    pub tolerance: f64,
}

impl<'a> Along<'a> {
    pub(super) fn question(&self) -> Question<'a> {
        Question {
            change: self.change,
            guess: self.expected,
            tolerance: self.tolerance,
            is_aside: false,
        }
    }
}

/// A question on half of the cells.
pub(super) struct FoldedQuestion {
    change: Vec<f64>,
    guess: Option<Vec<f64>>,
    tolerance: f64,
    is_aside: bool,
}

impl FoldedQuestion {
    /// A question on the sums of cells and their images.
    pub(super) fn new(question: &Question<'_>, folding: &Folding) -> Self {
        Self {
            change: folding.fold(question.change),
            guess: question.guess.map(|guess| folding.fold(guess)),
            tolerance: question.tolerance,
            is_aside: question.is_aside,
        }
    }

    pub(super) fn question(&self) -> Question<'_> {
        Question {
            change: &self.change,
            guess: self.guess.as_deref(),
            tolerance: self.tolerance,
            is_aside: self.is_aside,
        }
    }
}
