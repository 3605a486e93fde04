//! Slow modes with the errors of the cells.

use std::sync::Arc;

use nalgebra::Complex;

use super::errors::{DAMPED, Estimate, FEWER, combined, on_grids};
use super::grid::Grid;
use super::grid_mode::GridMode;
use super::model::in_order;
use super::modes::{GridModes, modes};
use super::motion::Motion;
use super::slowest::slowest;
use super::{SpectrumError, Steady};
use crate::cancellation::Cancellation;
use crate::generator::GeneratorOptions;
use crate::numerics::sort_ascending;
use crate::space::CellSpace;
use crate::stationary::generator::{AbsorbingWork, RateOptions};
use crate::system::System;

/// Relative error from which a mode is not told.
pub(super) const UNKNOWN: f64 = 0.1;

/// A mode with which deviations from the steady state die out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlowMode {
    /// Decay rate -Re λ, per unit time, with its error.
    pub decay: (f64, f64),
    /// Angular frequency |Im λ|, per unit time, with its error; zero where it does not oscillate.
    pub frequency: (f64, f64),
}

/// Slow modes, and what they took.
#[derive(Debug, Clone, PartialEq)]
pub struct SlowModes {
    /// In the order of their decay rates, a pair of conjugates once, of those that oscillate no faster than about three
    /// times as fast as states change; fewer than wanted where no more are known.
    pub modes: Vec<SlowMode>,
    /// The square of half of the difference of the two slowest modes, per unit time squared, with its error: below zero
    /// where they are a pair that oscillates. It passes zero smoothly where two real modes become a pair, at which
    /// neither is known well. Not known where the second one oscillates and the first does not.
    pub discriminant: Option<(f64, f64)>,
    /// The left vector of the first mode on the cells, but for a constant and a factor; empty where it oscillates, or
    /// is not known.
    pub left: Vec<f64>,
    /// Factorisations and passes.
    pub work: AbsorbingWork,
}

/// The slowest modes of a system on the cells of a sweep. They do not depend on what was solved before. With none
/// wanted, that with the eigenvalue nearest to zero alone, which takes a few solves where it is an exchange between
/// states that happens rarely.
///
/// # Errors
/// [`SpectrumError`].
pub fn slow_modes(
    system: &Arc<dyn System>,
    space: &CellSpace,
    wanted: usize,
    steady: Steady<'_>,
    settings: (&GeneratorOptions, &RateOptions),
    cancellation: &Cancellation,
) -> Result<SlowModes, SpectrumError> {
    let solve = |grid: &Grid, motion: &Motion, coarser: Option<(&CellSpace, &GridModes)>| {
        let options = (settings.1, cancellation);
        match wanted {
            0 => slowest(grid, motion, options),
            _ => modes(grid, wanted, motion, coarser, options),
        }
    };
    let tells = |grid: &GridModes| wanted == 0 || !grid.modes.is_empty();
    let ((found, fewer), work) = on_grids(system, space, steady, settings.0, solve, tells)?;
    let of_grid = |grid: &GridModes| grid.discriminant.into_iter().collect::<Vec<_>>();
    let of_fewer: Vec<Vec<Estimate>> = fewer.iter().map(of_grid).collect();
    let discriminant = combined(&of_grid(&found), &of_fewer);
    let complete = found.complete;
    let (found, fewer) = (found.modes, fewer.into_iter().map(|grid| grid.modes));
    let fewer: Vec<Vec<GridMode>> = fewer.collect();
    let mut errors: Vec<Complex<f64>> = found
        .iter()
        .map(|one| sizes(one.change) * DAMPED + both(one.error))
        .collect();
    for (others, (_, times)) in fewer.iter().zip(FEWER) {
        for (error, other) in errors.iter_mut().zip(matched(&found, others)) {
            *error = Complex::new(
                error.re.max(times * other.re),
                error.im.max(times * other.im),
            );
        }
    }
    let mut known: Vec<(Complex<f64>, Complex<f64>)> = found
        .iter()
        .map(GridMode::extrapolation)
        .zip(errors)
        .collect();
    in_order(&mut known, |(value, _)| *value);
    // The number of a mode says how many are slower: beyond one that is not known there is none.
    let is_known = |(value, error): &(Complex<f64>, Complex<f64>)| {
        let is_next = -value.re <= complete * (1.0 + UNKNOWN);
        value.re < 0.0 && is_next && error.re <= UNKNOWN * value.norm()
    };
    let first_unknown = known.iter().position(|one| !is_known(one));
    known.truncate(first_unknown.unwrap_or(usize::MAX));
    known.truncate(wanted.max(1));
    let first = found.iter().find(|one| {
        let slowest = known.first();
        slowest.is_some_and(|(value, _)| one.extrapolation() == *value)
    });
    let left = first.map(GridMode::left).unwrap_or_default();
    let modes = known.into_iter().map(|(value, error)| SlowMode {
        decay: (-value.re, error.re),
        frequency: (value.im.abs(), if value.im == 0.0 { 0.0 } else { error.im }),
    });
    Ok(SlowModes {
        modes: modes.collect(),
        discriminant: discriminant
            .first()
            .copied()
            .filter(|known| known.1.is_finite()),
        left,
        work,
    })
}

fn sizes(value: Complex<f64>) -> Complex<f64> {
    Complex::new(value.re.abs(), value.im.abs())
}

fn both(error: f64) -> Complex<f64> {
    Complex::new(error, error)
}

/// By how much each mode differs from its own on another grid, infinite where it has none there. Pairs are made from
/// the nearest on.
fn matched(modes: &[GridMode], others: &[GridMode]) -> Vec<Complex<f64>> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (index, one) in modes.iter().enumerate() {
        for (other, two) in others.iter().enumerate() {
            pairs.push((
                (one.extrapolation() - two.extrapolation()).norm(),
                index,
                other,
            ));
        }
    }
    sort_ascending(&mut pairs, |one| one.0);
    let mut differences = vec![both(f64::INFINITY); modes.len()];
    let mut taken = vec![false; others.len()];
    for (_, index, other) in pairs {
        if differences[index].re.is_infinite() && !taken[other] {
            taken[other] = true;
            differences[index] =
                sizes(modes[index].extrapolation() - others[other].extrapolation());
        }
    }
    differences
}
