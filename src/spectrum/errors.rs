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

/// Solves on the fewest cells first, and then on others and on those of a sweep side by side, which begin with what the
/// fewest gave; fewer cells that told nothing begin with what the finest gave. What all of them took besides.
pub(super) fn on_grids<T: Send + Sync>(
    system: &Arc<dyn System>,
    space: &CellSpace,
    steady: Steady<'_>,
    options: &GeneratorOptions,
    solve: impl Fn(&Grid, &Motion, Option<(&CellSpace, &T)>) -> Worked<T> + Sync,
    tells: impl Fn(&T) -> bool,
) -> Worked<(T, Vec<T>)> {
    let grid = |factor| Grid::new(system, space, (factor, steady.phase), options);
    let finest = grid(1.0)?;
    let motion = Motion::new(&finest, system.as_ref(), steady).ok_or(SpectrumError::Still)?;
    let [more, fewest] = FEWER.map(|(factor, _)| factor);
    let (fewest, more) = (grid(fewest)?, grid(more)?);
    let (of_fewest, mut work) = solve(&fewest, &motion, None)?;
    let known = Some((&fewest.space, &of_fewest));
    let (on_finest, on_more) = rayon::join(
        || solve(&finest, &motion, known),
        || solve(&more, &motion, known),
    );
    let ((found, of_finest), (of_more, of_others)) = (on_finest?, on_more?);
    work.add(of_finest);
    work.add(of_others);
    let mut others = vec![of_more, of_fewest];
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
    /// Whether it falls with the width of cells itself, and not with its square.
    pub(super) is_of_first_order: bool,
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
        for (others, (factor, times)) in fewer.iter().zip(FEWER) {
            let times = match one.is_of_first_order {
                true => factor / (1.0 - factor),
                false => times,
            };
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
