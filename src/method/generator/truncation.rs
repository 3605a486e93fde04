//! What open ends of Ω may have changed of densities, and of what is asked of a steady state besides.
//!
//! What lies beyond them is missing: inside, all values are too large by as much. What leaves through them comes back
//! in truth, while here all of the mass comes back in its place. In first order that is what the steady state would
//! answer if what leaves stayed in the cells that it leaves from: where a well leaks it says by how much that well
//! holds too little, and the others too much.

use super::session::{GeneratorSession, PointSolve};
use crate::density::{EstimatedDensity, LEAK_ALLOWANCE};
use crate::generator::cell_masses;
use crate::method::MethodError;
use crate::method::measures::ask_for_ends;
use crate::method::report::Missing;

/// Relative error of an answer, to what ends do or to what modes do that are not there.
pub(super) const OF_AN_ANSWER: f64 = 0.1;

/// What leaves and comes back leaves most likely at once: so many times, at most, it does within a relaxation time.
const AGAIN: f64 = 10.0;

/// Mass that what leaves may move and densities have it as a share alone, which is stated of all values then.
const LITTLE: f64 = 5e-4;

/// Share of what comes back that leaves again, at most.
const MOST_AGAIN: f64 = 0.95;

/// Relative error of what returns, over all cells: what lives beside the ends is a small part of them. With 1e-2 and
/// factors of a neighbouring value what returns was ten times too small.
const OF_RETURNS: f64 = 1e-3;

/// Share of the mass that leaves within a relaxation time below which it changes no number that is asked for.
const NO_LEAK: f64 = 1e-12;

/// What the ends of the ranges cut off a steady state.
#[derive(Debug, Clone, Default)]
pub(super) struct CutOff {
    /// By how much the unknowns would differ if what leaves stayed in the cells that it leaves from; `None` where that
    /// is next to nothing.
    pub(super) returning: Option<Vec<f64>>,
    /// Share of the mass that lies beyond the ends.
    pub(super) beyond: f64,
}

impl GeneratorSession {
    /// What the ends cut off a steady state, and adds to densities of its masses what they may have changed.
    pub(super) fn truncate(
        &mut self,
        solved: &PointSolve,
        missing: Missing,
        densities: &mut [EstimatedDensity],
    ) -> Result<CutOff, MethodError> {
        let stated = densities.iter().map(|one| {
            let errors = one.standard_error.iter().zip(one.density.volumes());
            errors.map(|(error, volume)| error * volume).sum::<f64>()
        });
        let least = stated.fold(f64::INFINITY, f64::min);
        // Where less leaves than schemes differ by, or little, its share will do.
        let is_little = AGAIN * missing.leak <= least.max(LITTLE);
        let is_asked = ask_for_ends(self.source.problem.subject());
        let returning = if missing.leak > NO_LEAK && (is_asked || !is_little) {
            Some(self.returning(solved)?)
        } else {
            None
        };
        let changes = match &returning {
            Some(returning) => self.changes(solved, returning)?,
            None => Vec::new(),
        };
        let moved: f64 = match &returning {
            Some(returning) => returning.iter().map(|change| change.abs()).sum(),
            None => AGAIN * missing.leak,
        };
        for one in densities.iter_mut() {
            one.truncation.share = missing.beyond + LEAK_ALLOWANCE * moved;
            if missing.leak > NO_LEAK && missing.level > one.negligible {
                one.truncation.level = missing.level * one.density.maximum();
            }
        }
        for (one, change) in densities.iter_mut().zip(changes) {
            let change = change.iter().map(|change| LEAK_ALLOWANCE * change);
            one.truncation.change = change.collect();
        }
        Ok(CutOff {
            returning,
            beyond: missing.beyond,
        })
    }

    /// Changes of the watched densities by a change of the unknowns.
    fn changes(&self, solved: &PointSolve, change: &[f64]) -> Result<Vec<Vec<f64>>, MethodError> {
        let problem = &self.source.problem;
        let masses =
            |unknowns: &[f64]| cell_masses(solved.system.as_ref(), problem.space(), unknowns);
        let unknowns = &solved.steady.mass;
        let pairs = unknowns.iter().zip(change);
        let other: Vec<f64> = pairs.map(|(own, change)| own + change).collect();
        let pairs = masses(&other).into_iter().zip(masses(unknowns));
        let masses: Vec<f64> = pairs.map(|(other, own)| other - own).collect();
        let maps = self.source.maps(solved.value)?;
        maps.changes(problem, &masses)
    }

    /// By how much the unknowns would differ if what leaves stayed where it leaves from. What stays there leaves again,
    /// and is taken to return as the first of it does.
    fn returning(&mut self, solved: &PointSolve) -> Result<Vec<f64>, MethodError> {
        let unknowns = &solved.steady.mass;
        let leaving = |masses: &[f64]| {
            let pairs = solved.escape.iter().zip(masses);
            pairs.map(|(rate, mass)| rate * mass).collect::<Vec<f64>>()
        };
        let back = leaving(unknowns);
        let mut change = self.solver.response_at_ends(&back, unknowns, OF_RETURNS)?;
        let [first, again] = [back, leaving(&change)].map(|all| all.iter().sum::<f64>());
        // Where nothing leaves in the sum, nothing of it leaves again.
        let again = if first > 0.0 { again / first } else { 0.0 };
        let again = again.clamp(0.0, MOST_AGAIN);
        change.iter_mut().for_each(|change| *change /= 1.0 - again);
        Ok(change)
    }
}
