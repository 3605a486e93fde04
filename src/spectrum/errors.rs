//! Errors of numbers that were worked out with all and with half of the dissipation, on the cells of a sweep and on
//! fewer.

use std::sync::Arc;

use super::grid::Grid;
use super::motion::Motion;
use super::{SpectrumError, Steady};
use crate::generator::GeneratorOptions;
use crate::space::CellSpace;
use crate::stationary::generator::AbsorbingWork;
use crate::system::System;

/// Grids by which errors are made: cells an axis over those of the sweep, and how often what they differ by is taken,
/// as for first passages.
pub(super) const FEWER: [(f64, f64); 2] = [(0.75, 1.4), (0.6, 0.6)];

/// Share of the change by dissipation that stays as an error once it is extrapolated away.
pub(super) const DAMPED: f64 = 0.5;

/// Differences between grids are taken so many times: at a kink of the drift they shrink more slowly than elsewhere.
const MARGIN: f64 = 1.5;

/// Neighbours on either side whose errors an error along a curve is no smaller than, relative to the values: where a
/// difference changes its sign it says nothing.
const BESIDE: usize = 4;

/// What a grid gives, and what it took.
pub(super) type Worked<T> = Result<(T, AbsorbingWork), SpectrumError>;

/// Solves on each of the [`FEWER`] cells, the fewest first, and on those of a sweep, each time with the grid before and
/// what it gave, which finer cells begin with; fewer cells that told nothing begin with what the finest gave. What all
/// of them took besides.
pub(super) fn on_grids<T>(
    system: &Arc<dyn System>,
    space: &CellSpace,
    steady: Steady<'_>,
    options: &GeneratorOptions,
    mut solve: impl FnMut(&Grid, &Motion, Option<(&CellSpace, &T)>) -> Worked<T>,
    tells: impl Fn(&T) -> bool,
) -> Worked<(T, Vec<T>)> {
    let grid = |factor| Grid::new(system, space, factor, options);
    let finest = grid(1.0)?;
    let motion = Motion::new(&finest, system.as_ref(), steady).ok_or(SpectrumError::Still)?;
    let mut work = AbsorbingWork::default();
    let mut before: Option<(CellSpace, T)> = None;
    let mut others = Vec::new();
    for (factor, _) in FEWER.into_iter().rev() {
        let coarse = grid(factor)?;
        let known = before.as_ref().map(|(space, found)| (space, found));
        let (found, more) = solve(&coarse, &motion, known)?;
        work.add(more);
        others.extend(before.replace((coarse.space, found)).map(|one| one.1));
    }
    let known = before.as_ref().map(|(space, found)| (space, found));
    let (found, more) = solve(&finest, &motion, known)?;
    work.add(more);
    others.extend(before.map(|one| one.1));
    others.reverse();
    for (other, (factor, _)) in others.iter_mut().zip(FEWER) {
        if tells(&found) && !tells(other) {
            let known = Some((&finest.space, &found));
            let (again, more) = solve(&grid(factor)?, &motion, known)?;
            work.add(more);
            *other = again;
        }
    }
    Ok(((found, others), work))
}

/// A number on one grid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimate {
    /// By the scheme.
    pub(super) value: f64,
    /// What half of the dissipation changes.
    pub(super) change: f64,
    /// What else is known of its error.
    pub(super) error: f64,
}

impl Estimate {
    /// Extrapolated to no dissipation.
    pub(super) fn extrapolation(&self) -> f64 {
        self.value + 2.0 * self.change
    }
}

/// Numbers with their errors, from those on the cells of a sweep and those on fewer.
pub(super) fn combined(finest: &[Estimate], fewer: &[Vec<Estimate>]) -> Vec<(f64, f64)> {
    let known = finest.iter().enumerate().map(|(number, one)| {
        let value = one.extrapolation();
        let mut error = DAMPED * one.change.abs() + one.error;
        for (others, (_, times)) in fewer.iter().zip(FEWER) {
            let other = others.get(number).map_or(f64::NAN, Estimate::extrapolation);
            let off = MARGIN * times * (value - other).abs();
            error = if off.is_nan() {
                f64::INFINITY
            } else {
                error.max(off)
            };
        }
        (value, if error.is_nan() { f64::INFINITY } else { error })
    });
    known.collect()
}

/// The same along a curve, no error smaller than its neighbours' are, relative to the larger of both values.
pub(super) fn smoothed(known: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let one = |(place, &(value, error)): (usize, &(f64, f64))| {
        let first = place.saturating_sub(BESIDE);
        let last = (place + BESIDE).min(known.len() - 1);
        let near = known[first..=last].iter().map(|&(other, error)| {
            let share = value.abs() / other.abs();
            error * if share < 1.0 { share } else { 1.0 }
        });
        (value, near.fold(error, f64::max))
    };
    known.iter().enumerate().map(one).collect()
}
