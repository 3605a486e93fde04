//! What a third scheme says of a point.

use super::second::third;
use super::session::{GeneratorSession, PointSolve, ROUGH};
use crate::generator::LineRates;
use crate::method::MethodError;
use crate::stationary::generator::{RateError, RateSolver};

impl GeneratorSession {
    /// What a third scheme changes of the unknowns, where means of formulas are wanted: of what weighs the tails two
    /// schemes may err alike. `None` where nothing wants it, and where nothing answers.
    pub(super) fn by_third_scheme(
        &mut self,
        solved: &PointSolve,
    ) -> Result<Option<Vec<f64>>, MethodError> {
        let questions = &self.source.problem.family().questions;
        let is_wanted = !questions.averaged.is_empty() || questions.largest_exponent.is_some();
        let unknowns = &solved.steady.mass;
        let is_solved =
            solved.steady.info.converged && unknowns.iter().all(|value| value.is_finite());
        if solved.second.is_none() || !is_wanted || !is_solved {
            return Ok(None);
        }
        let scheme = third(self.source.options.scheme);
        let [lines] = (self.source).assemble_lines(solved.system.as_ref(), [scheme])?;
        let change = lines.product(unknowns);
        let answer = self.solver.response(&change, unknowns, None, ROUGH);
        let answer = match answer {
            Err(RateError::Sensitivity) => return Ok(None),
            answer => answer?,
        };
        Ok(Some(if lines.has_breaks() {
            again(&mut self.solver, &lines, unknowns, answer)?
        } else {
            answer
        }))
    }
}

/// What another scheme changes, with the next term of the series by the factors of the first one. At planes at which a
/// force bends or jumps the schemes are so far apart that the first term alone is half of it.
pub(super) fn again(
    solver: &mut RateSolver,
    other: &LineRates,
    unknowns: &[f64],
    change: Vec<f64>,
) -> Result<Vec<f64>, MethodError> {
    let changed: Vec<f64> = unknowns.iter().zip(&change).map(|(u, du)| u + du).collect();
    let more = solver.response(&other.product(&changed), unknowns, None, ROUGH)?;
    let both = change.iter().zip(more);
    Ok(both.map(|(a, b)| a + b).collect())
}
