//! What modes that are not there may change of densities.
//!
//! Along an axis of modes the answer converges as a power of their number: modes that are left out change about as much
//! as the last ones did, a fifth of them. With u = v + w, w what the last modes carry, the steady state of fewer modes
//! is v + δ, where δ answers to what w no longer feeds into the modes before it: Q δ = P Q w, P the projection on
//! these. The factors of the steady state that is there serve for it.
//!
//! Only axes of Hermite modes, of coloured noise, are asked: along friction states and phases the answer takes a fifth
//! of a sweep's time, and the modes of friction states are judged by what the last of them carry.

use super::session::{GeneratorSession, PointSolve};
use super::truncation::OF_AN_ANSWER;
use crate::density::EstimatedDensity;
use crate::generator::cell_masses;
use crate::method::MethodError;
use crate::method::watched::differences;
use crate::space::{Axis, CellSpace, Series};

/// One mode of so many is left out, and at least one of each parity. What a last one alone carries passes through zero.
const MODES_A_MODE_LEFT_OUT: usize = 5;

impl GeneratorSession {
    /// Adds to densities of solved masses what the last modes of all axes of coloured noise change in them.
    pub(super) fn add_last_modes(
        &mut self,
        solved: &PointSolve,
        masses: &[f64],
        densities: &mut [EstimatedDensity],
    ) -> Result<(), MethodError> {
        let space = self.source.problem.space().clone();
        let Some(second) = &solved.second else {
            return Ok(());
        };
        if !space.axes().iter().any(is_coloured_noise) {
            return Ok(());
        }
        let unknowns = &solved.steady.mass;
        let last = differences(&of_first_modes(&space, unknowns), unknowns);
        // The schemes differ along the cells alone, in what is small against the masses as the last modes are.
        let fed = of_first_modes(&space, &second.product(&last));
        let fed: Vec<f64> = fed.iter().map(|rate| -rate).collect();
        let answer = self.solver.response(&fed, unknowns, None, OF_AN_ANSWER)?;
        let fewer = of_first_modes(&space, &differences(&last, &answer));
        let fewer = differences(&last, &fewer);
        let there: Vec<f64> = unknowns.iter().zip(&fewer).map(|(u, du)| u + du).collect();
        let there = cell_masses(solved.system.as_ref(), &space, &there);
        let maps = self.source.maps(solved.value)?;
        let changes = maps.changes(&self.source.problem, &differences(masses, &there))?;
        for (one, change) in densities.iter_mut().zip(changes) {
            one.truncation.add(&change);
        }
        Ok(())
    }
}

/// What all modes but the last ones of each axis of coloured noise carry of masses at the nodes.
fn of_first_modes(space: &CellSpace, masses: &[f64]) -> Vec<f64> {
    let mut first = masses.to_vec();
    let mut stride = 1;
    for axis in space.axes().iter().rev() {
        let count = axis.count();
        if is_coloured_noise(axis) {
            let owed = axis.beyond_hermite_modes(kept(axis));
            for block in first.chunks_exact_mut(stride * count) {
                for inner in 0..stride {
                    let line: Vec<f64> =
                        block.iter().skip(inner).step_by(stride).copied().collect();
                    for (node, owed) in owed.chunks_exact(count).enumerate() {
                        let part: f64 = owed.iter().zip(&line).map(|(o, m)| o * m).sum();
                        block[node * stride + inner] -= part;
                    }
                }
            }
        }
        stride *= count;
    }
    first
}

fn is_coloured_noise(axis: &Axis) -> bool {
    matches!(axis.series(), Some(Series::Hermite { .. }))
}

/// Modes that are kept of an axis of modes.
fn kept(axis: &Axis) -> usize {
    let left_out = axis.mode_number() / MODES_A_MODE_LEFT_OUT;
    axis.count().saturating_sub(left_out.max(2)).max(1)
}
