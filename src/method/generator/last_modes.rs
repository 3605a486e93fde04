//! What modes that are not there may change of densities.
//!
//! Along an axis of modes the answer converges as a power of their number: modes that are left out change about as much
//! as the last ones did, a fifth of them. With u = v + w, w what the last modes carry, the steady state of fewer modes
//! is v + δ, where δ answers to what w no longer feeds into the modes before it: Q δ = P Q w, P the projection on
//! these. The factors of the steady state that is there serve for it.
//!
//! Axes of Hermite modes, of coloured noise, are asked for what is watched, and these and harmonics of angles for means
//! and deviations. Along friction states and phases the answer takes a fifth of a sweep's time, and the modes of
//! friction states are judged by what the last of them carry.

use super::session::{GeneratorSession, PointSolve};
use super::truncation::OF_AN_ANSWER;
use super::unknowns::moments_of;
use crate::density::{EstimatedDensity, EstimatedMoments, Moments};
use crate::generator::{LineRates, cell_masses, summed_to_walls};
use crate::method::watched::differences;
use crate::method::{MethodError, Problem};
use crate::space::{Axis, CellSpace, Series};
use crate::stationary::generator::RateSolver;

/// Times what the last modes change of a number: those that are not there may do as much.
const SAFETY: f64 = 2.0;

impl GeneratorSession {
    /// Adds to densities of solved masses what the last modes of all axes of coloured noise change in them. Gives the
    /// unknowns without these modes, where there are any.
    pub(super) fn add_last_modes(
        &mut self,
        solved: &PointSolve,
        masses: &[f64],
        densities: &mut [EstimatedDensity],
    ) -> Result<Option<Vec<f64>>, MethodError> {
        let space = self.source.problem.space().clone();
        let asked: Vec<bool> = space.axes().iter().map(is_coloured_noise).collect();
        let Some(fewer) = self.by_fewer_modes(solved, &asked)? else {
            return Ok(None);
        };
        let there = cell_masses(solved.system.as_ref(), &space, &fewer);
        let maps = self.source.maps(solved.value)?;
        let changes = maps.changes(&self.source.problem, &differences(masses, &there))?;
        for (one, change) in densities.iter_mut().zip(changes) {
            one.truncation.add(&change);
        }
        Ok(Some(fewer))
    }

    /// Adds to moments of axes and, behind them, of the quantities that are averaged what the last modes of coloured
    /// noise change in them (`without` are the unknowns without these), and the last harmonics of angles; in a check
    /// nothing. With the moments goes by how much the unknowns may be off for that, where it is known.
    pub(super) fn with_last_modes(
        &mut self,
        solved: &PointSolve,
        moments: Vec<EstimatedMoments>,
        without: Option<Vec<f64>>,
    ) -> Result<(Vec<EstimatedMoments>, Option<Vec<f64>>), MethodError> {
        let problem = self.source.problem.clone();
        let space = problem.space();
        let asked = angles(&problem);
        let harmonics = self.by_fewer_modes(solved, &asked)?;
        let system = solved.system.as_ref();
        let mut moments = moments;
        let mut by_modes: Option<Vec<f64>> = None;
        for there in without.into_iter().chain(harmonics) {
            let masses = cell_masses(system, space, &there);
            let of_quantities = self.source.maps(solved.value)?.plain_moments(&masses)?;
            let of_axes = moments_of(space, &summed_to_walls(system, space, &there));
            let others = of_axes.into_iter().chain(of_quantities);
            for (own, other) in moments.iter_mut().zip(others) {
                *own = with_change(*own, other);
            }
            let unknowns = &solved.steady.mass;
            let changes = by_modes.get_or_insert_with(|| vec![0.0; unknowns.len()]);
            for (change, (there, own)) in changes.iter_mut().zip(there.iter().zip(unknowns)) {
                *change += SAFETY * (there - own);
            }
        }
        Ok((moments, by_modes))
    }

    /// The unknowns as they would be without the last modes of the axes that are asked, by a flag an axis; `None` where
    /// there are none such, or nothing is to be judged.
    fn by_fewer_modes(
        &mut self,
        solved: &PointSolve,
        asked: &[bool],
    ) -> Result<Option<Vec<f64>>, MethodError> {
        let space = self.source.problem.space().clone();
        let Some(second) = solved.second.as_ref().filter(|_| asked.contains(&true)) else {
            return Ok(None);
        };
        let unknowns = &solved.steady.mass;
        let modes = LastModes {
            space: &space,
            asked,
            scheme: second,
        };
        let change = modes.change(&mut self.solver, unknowns, unknowns)?;
        Ok(Some(
            unknowns.iter().zip(change).map(|(u, du)| u + du).collect(),
        ))
    }
}

/// Which axes are angles, a flag an axis.
pub(super) fn angles(problem: &Problem) -> Vec<bool> {
    let mut flags = vec![false; problem.space().dimension()];
    for (axis, _) in problem.family().angles() {
        flags[axis] = true;
    }
    flags
}

/// The last modes of some axes.
pub(super) struct LastModes<'a> {
    pub(super) space: &'a CellSpace,
    /// A flag an axis.
    pub(super) asked: &'a [bool],
    /// The rates. Schemes differ along the cells alone, in what is small against the masses as the last modes are.
    pub(super) scheme: &'a LineRates,
}

impl LastModes<'_> {
    /// By how much `answering`, which answers to a source as the steady state `unknowns` does to none, would differ
    /// without these modes.
    pub(super) fn change(
        &self,
        solver: &mut RateSolver,
        unknowns: &[f64],
        answering: &[f64],
    ) -> Result<Vec<f64>, MethodError> {
        let of_first = |masses: &[f64]| of_first_modes(self.space, self.asked, masses);
        let last = differences(&of_first(answering), answering);
        let fed = of_first(&self.scheme.product(&last));
        let fed: Vec<f64> = fed.iter().map(|rate| -rate).collect();
        let answer = solver.response(&fed, unknowns, None, OF_AN_ANSWER)?;
        let fewer = of_first(&differences(&last, &answer));
        Ok(differences(&last, &fewer))
    }
}

/// Moments with errors that hold what others differ by.
fn with_change(own: EstimatedMoments, other: Moments) -> EstimatedMoments {
    let change = |other: f64, own: f64| SAFETY * (other - own).abs();
    let (mean, deviation) = (own.moments.mean, own.moments.standard_deviation);
    own.with(Moments {
        mean: change(other.mean, mean),
        standard_deviation: change(other.standard_deviation, deviation),
    })
}

/// What all modes but the last ones of each of these axes carry of masses at the nodes.
fn of_first_modes(space: &CellSpace, asked: &[bool], masses: &[f64]) -> Vec<f64> {
    let mut first = masses.to_vec();
    let mut stride = 1;
    for (axis, asked) in space.axes().iter().zip(asked).rev() {
        let count = axis.count();
        if *asked {
            let owed = axis.beyond_modes(axis.fewer_modes());
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
