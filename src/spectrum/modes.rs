//! Eigenvalues on one grid: a model that grows until those that are wanted stand, at real shifts or, where so many lie
//! about them that it tells none, at the harmonics of the motion.

use nalgebra::Complex;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::carried::carried;
use super::errors::{Estimate, Worked};
use super::grid::Grid;
use super::grid_mode::GridMode;
use super::harmonic_shifts::near_harmonics;
use super::model::{GridModel, in_order};
use super::motion::{Motion, of_ends};
use super::real_shifts::at_real_shifts;
use crate::cancellation::Cancellation;
use crate::numerics::sort_ascending;
use crate::space::CellSpace;
use crate::stationary::generator::{AbsorbingWork, RateOptions};

/// Modes beyond those that are wanted, in place of some that are none of the equation.
const SPARE: usize = 1;

/// Modes that are carried to finer cells beyond those: there the order of decay rates may be another.
const BESIDE: usize = 3;

/// Relative change by half of the dissipation from which a number is none of the equation.
pub(super) const ARTEFACT: f64 = 0.3;

/// A mode that is slower than this share of the rate at which states change is no artefact.
const SLOW: f64 = 1e-3;

/// Seed of the vectors that begin.
pub(super) const SEED: u64 = 0x5eed;

/// The slowest modes of a grid.
#[derive(Default)]
pub(super) struct GridModes {
    pub(super) modes: Vec<GridMode>,
    /// The square of half of the difference of the two slowest.
    pub(super) discriminant: Option<Estimate>,
    /// Those that finer cells begin with, the ones that are none of the equation among them: where two modes are about
    /// to become a pair they look like that, and are not on other cells.
    carried: Vec<GridMode>,
    /// Decay rate up to which none is missing.
    pub(super) complete: f64,
}

impl GridModes {
    /// Of one mode alone, or none.
    pub(super) fn of(slowest: Option<GridMode>) -> Self {
        Self {
            modes: slowest.into_iter().collect(),
            complete: f64::INFINITY,
            ..Self::default()
        }
    }
}

/// The slowest modes of a grid, in the order of their decay rates, a few more than wanted where so many are known; from
/// those of a coarser one, where there is one.
pub(super) fn modes(
    grid: &Grid,
    wanted: usize,
    motion: &Motion,
    coarser: Option<(&CellSpace, &GridModes)>,
    (rates, cancellation): (&RateOptions, &Cancellation),
) -> Worked<GridModes> {
    let mut work = AbsorbingWork::default();
    if let Some((coarse, known)) = coarser {
        let options = (rates, cancellation);
        let begin = (coarse, known.carried.as_slice());
        let found = carried(grid, begin, wanted + SPARE, options, &mut work)?;
        if let Some(found) = found {
            let found = of_model(grid, found, wanted + SPARE + BESIDE, motion);
            let complete = known.complete;
            return Ok((GridModes { complete, ..found }, work));
        }
    }
    let mut numbers = Xoshiro256PlusPlus::seed_from_u64(SEED);
    let enough = (wanted + SPARE, motion.rate);
    let options = (rates, cancellation);
    let mut found = at_real_shifts(grid, enough, &mut numbers, options, &mut work)?;
    if found.hides {
        // The slowest mode is not known, and no other is the first.
        return Ok((GridModes::default(), work));
    }
    if found.modes.is_empty() {
        found = near_harmonics(grid, enough, &mut numbers, options, &mut work)?;
    }
    found.standing = found.modes.len();
    let most = wanted + SPARE + BESIDE;
    Ok((of_model(grid, found, most, motion), work))
}

/// What a model tells, so many modes at most to be carried on.
fn of_model(grid: &Grid, mut found: GridModel, most: usize, motion: &Motion) -> GridModes {
    let GridModel {
        columns,
        rows,
        products,
        modes,
        standing,
        ..
    } = &mut found;
    products.grow(rows, columns, [&grid.full, &grid.half]);
    let size = columns.vectors.len().min(rows.vectors.len());
    let Some(model) = products.model(size) else {
        return GridModes::default();
    };
    let all = modes
        .iter()
        .enumerate()
        .filter_map(|(index, &(value, change))| {
            let eigen = model.eigen(value)?;
            let left = motion.centred(rows.combined(&eigen.rows));
            let right = columns.combined(&eigen.columns);
            let product = |cell: usize| (left[cell] * right[cell]).norm();
            Some(GridMode {
                stands: index < *standing,
                error: change + of_ends(grid, value.norm(), product, motion),
                value,
                // A real eigenvalue stays one.
                change: match value.im {
                    0.0 => Complex::new(eigen.change.re, 0.0),
                    _ => eigen.change,
                },
                columns: right,
                rows: left,
            })
        });
    let mut carried: Vec<GridMode> = all.collect();
    sort_ascending(&mut carried, |one| one.likely_decay());
    let first_left = carried.get(most).or(carried.last());
    let complete = first_left.map_or(0.0, GridMode::likely_decay);
    carried.truncate(most);
    in_order(&mut carried, |one| one.value);
    let mut modes: Vec<GridMode> = carried.iter().filter(|one| one.stands).cloned().collect();
    let discriminant = discriminant(&modes);
    // What is that slow is an exchange between states: where dissipation or rounding hides its rate it stays a mode, of
    // which nothing is known, and no faster one takes its number.
    let hidden = SLOW * motion.rate;
    modes.retain_mut(|one| {
        let is_sound = (one.change / one.value).norm() <= ARTEFACT;
        if !is_sound {
            one.error = f64::INFINITY;
        }
        is_sound || one.value.norm() <= hidden
    });
    GridModes {
        modes,
        discriminant,
        carried,
        complete,
    }
}

/// The square of half of the difference of the two slowest modes, and what half of the dissipation changes of it, which
/// is finite where both are the same and each of them changes infinitely.
fn discriminant(slowest: &[GridMode]) -> Option<Estimate> {
    let first = slowest.first()?;
    let frequency = first.value.im;
    if frequency != 0.0 {
        return Some(Estimate {
            value: -frequency * frequency,
            change: -2.0 * frequency * first.change.im,
            error: 2.0 * frequency.abs() * first.error,
            is_of_first_order: false,
        });
    }
    let second = slowest.get(1).filter(|one| one.value.im == 0.0)?;
    let half = 0.5 * (first.value.re - second.value.re);
    Some(Estimate {
        value: half * half,
        change: half * (first.change.re - second.change.re),
        error: half.abs() * (first.error + second.error),
        is_of_first_order: false,
    })
}
