//! What open ends of Ω may have changed of densities.
//!
//! What lies beyond them is missing: inside, all values are too large by as much. What leaves through them comes back
//! in truth, while here all of the mass comes back in its place. In first order that is what the steady state would
//! answer if what leaves stayed in the cells that it leaves from: where a well leaks it says by how much that well
//! holds too little, and the others too much.

use super::session::{GeneratorSession, PointSolve};
use crate::density::{EstimatedDensity, LEAK_ALLOWANCE, Truncation};
use crate::generator::cell_masses;
use crate::method::MethodError;
use crate::method::report::Missing;

/// Relative error of an answer, to what ends do or to what modes do that are not there.
pub(super) const OF_AN_ANSWER: f64 = 0.1;

/// Share of the mass that leaves within a relaxation time below which it changes no number that is asked for.
const NO_LEAK: f64 = 1e-12;

/// Relative error of a term of the series: with a rough one the next, which lives beside the ends, is too small by half.
const OF_A_TERM: f64 = 1e-3;

/// Most terms of the series.
const TERMS: usize = 6;

/// Share of the first term below which a term is the last.
const LAST_TERM: f64 = 0.03;

/// Largest ratio of terms that is believed.
const LARGEST_RATIO: f64 = 0.95;

impl GeneratorSession {
    /// Adds to densities of solved masses what the ends may have changed.
    pub(super) fn truncate(
        &mut self,
        solved: &PointSolve,
        masses: &[f64],
        missing: Missing,
        densities: &mut [EstimatedDensity],
    ) -> Result<(), MethodError> {
        let stated = densities.iter().map(|one| {
            let errors = one.standard_error.iter().zip(one.density.volumes());
            errors.map(|(error, volume)| error * volume).sum::<f64>()
        });
        let least = stated.fold(f64::INFINITY, f64::min);
        // Where less leaves than schemes differ by, its share will do.
        if missing.leak <= least {
            let share = missing.beyond + LEAK_ALLOWANCE * missing.leak;
            densities
                .iter_mut()
                .for_each(|one| one.truncation.share = share);
            return Ok(());
        }
        let closed = self.by_closed_ends(solved)?;
        let closed = cell_masses(solved.system.as_ref(), self.source.problem.space(), &closed);
        let difference: Vec<f64> = closed.iter().zip(masses).map(|(a, b)| a - b).collect();
        let moved: f64 = difference.iter().map(|change| change.abs()).sum();
        let maps = self.source.maps(solved.value)?;
        let changes = maps.changes(&self.source.problem, &difference)?;
        for (one, change) in densities.iter_mut().zip(changes) {
            one.truncation = Truncation {
                share: missing.beyond + LEAK_ALLOWANCE * moved,
                change: change
                    .iter()
                    .map(|change| LEAK_ALLOWANCE * change)
                    .collect(),
            };
        }
        Ok(())
    }

    /// By how much the unknowns would differ if what leaves stayed where it leaves from, where visits or passages are
    /// asked for.
    pub(super) fn returning(
        &mut self,
        solved: &PointSolve,
        missing: Option<Missing>,
    ) -> Result<Option<Vec<f64>>, MethodError> {
        let questions = &self.source.problem.family().questions;
        let is_asked = !(questions.visits.is_empty() && questions.passages.is_empty());
        let leaks = missing.is_some_and(|missing| missing.leak > NO_LEAK);
        if !is_asked || !leaks || self.source.checks {
            return Ok(None);
        }
        let closed = self.by_closed_ends(solved)?;
        let pairs = closed.iter().zip(&solved.steady.mass);
        Ok(Some(pairs.map(|(closed, own)| closed - own).collect()))
    }

    /// What the unknowns would be if what leaves stayed where it leaves from: a series, of which each term is what the
    /// one before lets out.
    pub(super) fn by_closed_ends(&mut self, solved: &PointSolve) -> Result<Vec<f64>, MethodError> {
        let unknowns = &solved.steady.mass;
        let mut closed = unknowns.clone();
        let mut term = unknowns.clone();
        let mut sizes: Vec<f64> = Vec::new();
        for number in 1..=TERMS {
            let back = solved.escape.iter().zip(&term);
            let back: Vec<f64> = back.map(|(rate, mass)| rate * mass).collect();
            term = self.solver.response(&back, unknowns, None, OF_A_TERM)?;
            sizes.push(term.iter().map(|one| one.abs()).sum());
            // What is let out again leaves most likely at once: the second term may be as large as the first, which says
            // nothing of those after it.
            let (size, before) = match sizes.as_slice() {
                [.., before, size] => (*size, *before),
                _ => (f64::INFINITY, f64::INFINITY),
            };
            // The last term stands for those after it.
            let is_last = number == TERMS || size < LAST_TERM * sizes[0];
            let rest = if is_last {
                1.0 / (1.0 - (size / before).min(LARGEST_RATIO))
            } else {
                1.0
            };
            let pairs = closed.iter_mut().zip(&term);
            pairs.for_each(|(sum, term)| *sum += rest * term);
            if is_last {
                break;
            }
        }
        Ok(closed)
    }
}
