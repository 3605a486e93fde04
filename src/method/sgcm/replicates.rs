//! Steady states without one group of samples each, by whose scatter the sampling error is estimated.
//!
//! A group less changes a steady state little: to first order its change is that of a linear equation, which is
//! solved for several groups at once without a matrix of their own (`stationary`, `first_order.rs`). Where the
//! change is not small, or is not found so, the cell map of the samples that are left is solved like that of all
//! samples.

use super::Correction;
use super::slope_correction::solve_by;
use super::source::{SampledPoint, SgcmSource};
use crate::MAX_DIMENSION;
use crate::cancellation::{Cancellation, Cancelled};
use crate::method::MethodError;
use crate::numerics::in_parallel;
use crate::sampling::{GROUPS_AT_ONCE, SampledTransitions};
use crate::stationary::{Options, Outcome, SteadyState, without_groups};

/// Mass that a group may move and its change still be taken to first order. What is of second order grows like its
/// square: of changes that move 0.01 it is 3 %, cell by cell, and less of moments.
const LARGEST_CHANGE: f64 = 0.05;

/// L1 error to which a cell map without a group is solved: far below any sampling error, which is all it is for.
const TOLERANCE: f64 = 1e-7;

/// L1 change by a turn of the slope correction at which it ends.
const CHANGE: f64 = 1e-4;

/// Steady states without one group each.
pub(super) struct Replicates {
    /// Masses of all cells, by group; none at all where there are fewer than two.
    pub(super) masses: Vec<Vec<f64>>,
    /// Applications of the linear map, each for [`GROUPS_AT_ONCE`] groups.
    pub(super) applications: usize,
    /// Cell maps that were solved.
    pub(super) solves: usize,
}

impl SgcmSource {
    /// Steady states without one group of samples each; fewer than asked for when one of them has none. `slopes` are
    /// those of the full steady state.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub(super) fn replicates(
        &self,
        point: &SampledPoint,
        correction: Correction,
        slopes: &[[f64; MAX_DIMENSION]],
        full: &SteadyState,
        cancellation: &Cancellation,
    ) -> Result<Replicates, Cancelled> {
        let transitions = &point.transitions;
        let groups = transitions.groups();
        let mut found = Replicates {
            masses: Vec::with_capacity(groups),
            applications: 0,
            solves: 0,
        };
        if groups < 2 {
            return Ok(found);
        }
        let is_corrected = correction == Correction::Slope;
        let map = transitions.linearised(self.problem.space(), &full.mass, slopes, is_corrected);
        let firsts: Vec<usize> = (0..groups).step_by(GROUPS_AT_ONCE).collect();
        let escape = full.info.escape_per_step;
        let changed = in_parallel(firsts.len(), |number| {
            without_groups(&map, firsts[number], escape, cancellation)
        })?;
        found.applications = changed.iter().map(|changed| changed.applications).sum();
        let changes: Vec<Option<Vec<f64>>> = changed
            .into_iter()
            .flat_map(|changed| changed.by_group)
            .take(groups)
            .collect();
        let is_small = |change: &Vec<f64>| moved(change) <= LARGEST_CHANGE;
        let changes: Vec<Option<Vec<f64>>> = changes
            .into_iter()
            .map(|change| change.filter(is_small))
            .collect();
        found.solves = changes.iter().filter(|change| change.is_none()).count();
        let masses = in_parallel(changes.len(), |group| match &changes[group] {
            Some(change) => Ok(Some(changed_by(transitions, full, change))),
            None => self.solve_without(transitions, correction, full, group, cancellation),
        })?;
        found.masses.extend(masses.into_iter().flatten());
        if found.masses.len() < 2 {
            found.masses.clear();
        }
        Ok(found)
    }

    /// The steady state of the samples without a group, solved for like that of all.
    fn solve_without(
        &self,
        transitions: &SampledTransitions,
        correction: Correction,
        full: &SteadyState,
        group: usize,
        cancellation: &Cancellation,
    ) -> Result<Option<Vec<f64>>, Cancelled> {
        let options = Options::new(self.options.solver, TOLERANCE).cancelled_by(cancellation);
        let solved = solve_by(
            correction,
            transitions,
            self.problem.space(),
            Some(full.mass.as_slice()),
            Some(group),
            (&options, CHANGE),
        );
        match solved.map(|solved| solved.outcome) {
            Ok(Outcome::Steady(steady)) => Ok(Some(steady.mass)),
            Err(MethodError::Cancelled(cancelled)) => Err(cancelled),
            _ => Ok(None),
        }
    }
}

/// Mass that is elsewhere after a change.
fn moved(change: &[f64]) -> f64 {
    0.5 * change.iter().map(|change| change.abs()).sum::<f64>()
}

/// Masses with a change of those of the sampled cells, none below zero, Σ = 1.
fn changed_by(transitions: &SampledTransitions, full: &SteadyState, change: &[f64]) -> Vec<f64> {
    let mut mass = full.mass.clone();
    for (&cell, change) in transitions.cells().iter().zip(change) {
        mass[cell] = (mass[cell] + change).max(0.0);
    }
    let total: f64 = mass.iter().sum();
    mass.iter_mut().for_each(|mass| *mass /= total);
    mass
}
