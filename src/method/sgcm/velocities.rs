//! Mean velocities of angles by SGCM: the average of the drift over the cells.
//!
//! Effective diffusions are not worked out: the cells forget how often a trajectory went round.

use crate::continuation::Measure;
use crate::continuation::measure::VELOCITY;
use crate::density::{EstimatedMoments, Moments};
use crate::method::Problem;
use crate::method::report::Missing;
use crate::space::CellSpace;
use crate::system::{LANES, System};

/// Places across a cell, from its middle in widths, over which a mean is exact for cubics (Gauss).
const GAUSS: f64 = 0.288_675_134_594_812_9;

/// The mean velocity of each angle. Errors are those of sampling, twice what the drift's curvature inside the cells
/// counts, a share of the fastest turning that the time step and the cells add, and what the mass that is missing in
/// the ranges of other axes would do, moving as fast as any.
pub(super) fn velocities(
    problem: &Problem,
    system: &dyn System,
    (masses, replicates): (&[f64], &[Vec<f64>]),
    (share, missing): (f64, Missing),
) -> Vec<Measure> {
    let (family, space) = (problem.family(), problem.space());
    let angles = family.angles().map(|(axis, name)| {
        let [middle, mean] = drifts(system, space, axis);
        let sum = |masses: &[f64], of: &[f64]| -> f64 {
            masses
                .iter()
                .zip(of)
                .map(|(mass, drift)| mass * drift)
                .sum()
        };
        // Masses are of densities that are linear in the cells: of the curvature a cell's mean knows a twenty-fourth of
        // the square of its width, and the slopes take away twice that.
        let of = |masses: &[f64]| Moments {
            mean: 2.0 * sum(masses, &middle) - sum(masses, &mean),
            standard_deviation: 0.0,
        };
        let others: Vec<Moments> = replicates.iter().map(|one| of(one)).collect();
        let found = EstimatedMoments::by_replicates(of(masses), &others);
        let velocity = found.moments.mean;
        let curved = (velocity - sum(masses, &middle)).abs();
        let square: f64 = masses
            .iter()
            .zip(&middle)
            .map(|(mass, one)| mass * one * one)
            .sum();
        let spread = (square - velocity * velocity).max(0.0).sqrt();
        let fastest = middle
            .iter()
            .fold(0.0, |most: f64, one| most.max(one.abs()));
        let sampling = found.errors.map_or(f64::INFINITY, |errors| errors.mean);
        let missing = fastest * (missing.beyond + missing.leak);
        Measure {
            error: Some(sampling + 2.0 * curved + share.abs() * spread + missing),
            ..VELOCITY.measure(name, velocity)
        }
    });
    angles.collect()
}

/// The drift along an axis in the middle of every cell, and its mean over the cell.
fn drifts(system: &dyn System, space: &CellSpace, axis: usize) -> [Vec<f64>; 2] {
    let dimension = space.dimension();
    let phase = system.facts().phase;
    let spread: Vec<usize> = (0..dimension).filter(|axis| phase != Some(*axis)).collect();
    let cells = space.n_cells();
    let (mut middle, mut mean) = (vec![0.0; cells], vec![0.0; cells]);
    let mut all = vec![[0.0; LANES]; dimension];
    let corners = 1_usize << spread.len();
    for first in (0..cells).step_by(LANES) {
        let here = first..cells.min(first + LANES);
        // The middle comes last.
        for corner in 0..=corners {
            let mut states = vec![[0.0; LANES]; dimension];
            for (axis, lanes) in states.iter_mut().enumerate() {
                let cut = &space.axes()[axis];
                let aside = match spread.iter().position(|one| *one == axis) {
                    Some(_) if corner == corners => 0.0,
                    Some(bit) if corner >> bit & 1 == 0 => -GAUSS,
                    Some(_) => GAUSS,
                    // A cell along the phase stands for its beginning.
                    None => -0.5,
                };
                for (lane, slot) in lanes.iter_mut().enumerate() {
                    let position = space.position((first + lane).min(cells - 1), axis);
                    *slot = cut.centre(position) + aside * cut.width(position);
                }
            }
            system.drift(0.0, &states, &mut all);
            for (lane, cell) in here.clone().enumerate() {
                match corner == corners {
                    true => middle[cell] = all[axis][lane],
                    false => mean[cell] += all[axis][lane] / corners as f64,
                }
            }
        }
    }
    [middle, mean]
}
