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

/// Most terms of the series.
const TERMS: usize = 4;

/// Share of the mass below which a term is the last.
const LAST_TERM: f64 = 0.001;

/// Largest ratio of terms that is believed.
const LARGEST_RATIO: f64 = 0.8;

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
        let difference = self.by_closed_ends(solved, masses)?;
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

    /// What the masses would change by if what leaves stayed where it leaves from: a series, of which each term is what
    /// the one before lets out.
    fn by_closed_ends(
        &mut self,
        solved: &PointSolve,
        masses: &[f64],
    ) -> Result<Vec<f64>, MethodError> {
        let unknowns = &solved.steady.mass;
        let mut closed = unknowns.clone();
        let mut term = unknowns.clone();
        let mut size: f64 = unknowns.iter().map(|mass| mass.abs()).sum();
        let enough = LAST_TERM * size;
        for number in 1..=TERMS {
            let back = solved.escape.iter().zip(&term);
            let back: Vec<f64> = back.map(|(rate, mass)| rate * mass).collect();
            term = self.solver.response(&back, unknowns, None, OF_AN_ANSWER)?;
            let before = std::mem::replace(&mut size, term.iter().map(|one| one.abs()).sum());
            // The last term stands for those after it.
            let ratio = (size / before).min(LARGEST_RATIO);
            let is_last = number == TERMS || size < enough;
            let rest = if is_last { 1.0 / (1.0 - ratio) } else { 1.0 };
            let pairs = closed.iter_mut().zip(&term);
            pairs.for_each(|(sum, term)| *sum += rest * term);
            if is_last {
                break;
            }
        }
        let space = self.source.problem.space();
        let closed = cell_masses(solved.system.as_ref(), space, &closed);
        Ok(closed.iter().zip(masses).map(|(a, b)| a - b).collect())
    }
}
