//! Eigenvalues on one grid: a model that grows until those that are wanted stand, at real shifts or, where so many lie
//! about them that it tells none, at the harmonics of the motion.

use nalgebra::Complex;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::errors::{Estimate, Worked};
use super::grid::Grid;
use super::harmonic_shifts::near_harmonics;
use super::model::GridModel;
use super::motion::{Motion, of_ends};
use super::real_shifts::at_real_shifts;
use crate::cancellation::Cancellation;
use crate::stationary::generator::{AbsorbingWork, RateOptions};

/// Modes beyond those that are wanted, in place of some that are none of the equation.
const SPARE: usize = 1;

/// Relative change by half of the dissipation from which a number is none of the equation.
pub(super) const ARTEFACT: f64 = 0.3;

/// Seed of the vectors that begin.
pub(super) const SEED: u64 = 0x5eed;

/// An eigenvalue on one grid.
#[derive(Clone)]
pub(super) struct GridMode {
    /// By the scheme.
    pub(super) value: Complex<f64>,
    /// What half of the dissipation changes.
    pub(super) change: Complex<f64>,
    /// What fewer vectors change, and at most what the ends of the range do.
    pub(super) error: f64,
    /// Its left vector, known but for a constant and a factor; empty where the mode oscillates.
    pub(super) left: Vec<f64>,
}

impl GridMode {
    /// Extrapolated to no dissipation.
    pub(super) fn extrapolation(&self) -> Complex<f64> {
        self.value + self.change * 2.0
    }
}

/// The slowest modes of a grid.
#[derive(Default)]
pub(super) struct GridModes {
    pub(super) modes: Vec<GridMode>,
    /// The square of half of the difference of the two slowest.
    pub(super) discriminant: Option<Estimate>,
}

impl GridModes {
    /// Of one mode alone, or none.
    pub(super) fn of(slowest: Option<GridMode>) -> Self {
        Self {
            modes: slowest.into_iter().collect(),
            discriminant: None,
        }
    }
}

/// The slowest modes of a grid, in the order of their decay rates, a few more than wanted where so many are known.
pub(super) fn modes(
    grid: &Grid,
    wanted: usize,
    motion: &Motion,
    (rates, cancellation): (&RateOptions, &Cancellation),
) -> Worked<GridModes> {
    let mut numbers = Xoshiro256PlusPlus::seed_from_u64(SEED);
    let mut work = AbsorbingWork::default();
    let enough = (wanted + SPARE, motion.rate);
    let options = (rates, cancellation);
    let mut found = at_real_shifts(grid, enough, &mut numbers, options, &mut work)?;
    if found.modes.is_empty() {
        found = near_harmonics(grid, enough, &mut numbers, options, &mut work)?;
    }
    let GridModel {
        columns,
        rows,
        products,
        modes,
    } = &mut found;
    products.grow(rows, columns, [&grid.full, &grid.half]);
    let size = columns.vectors.len().min(rows.vectors.len());
    let Some(model) = products.model(size) else {
        return Ok((GridModes::default(), work));
    };
    let all = modes.iter().filter_map(|&(value, change)| {
        let eigen = model.eigen(value)?;
        let (left, right) = (rows.combined(&eigen.rows), columns.combined(&eigen.columns));
        let product = |cell: usize| (left[cell] * right[cell]).norm();
        Some(GridMode {
            error: change + of_ends(grid, value.norm(), product, motion),
            left: match value.im {
                0.0 => real(&left),
                _ => Vec::new(),
            },
            value,
            // A real eigenvalue stays one.
            change: match value.im {
                0.0 => Complex::new(eigen.change.re, 0.0),
                _ => eigen.change,
            },
        })
    });
    let mut modes: Vec<GridMode> = all.collect();
    let discriminant = discriminant(&modes);
    modes.retain(|one| (one.change / one.value).norm() <= ARTEFACT);
    let found = GridModes {
        modes,
        discriminant,
    };
    Ok((found, work))
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
        });
    }
    let second = slowest.get(1).filter(|one| one.value.im == 0.0)?;
    let half = 0.5 * (first.value.re - second.value.re);
    Some(Estimate {
        value: half * half,
        change: half * (first.change.re - second.change.re),
        error: half.abs() * (first.error + second.error),
    })
}

/// The real parts of a vector that is real but for a complex factor.
fn real(vector: &[Complex<f64>]) -> Vec<f64> {
    let largest = vector.iter().max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let Some(turn) = largest.map(|one| one.conj() / one.norm().max(f64::MIN_POSITIVE)) else {
        return Vec::new();
    };
    vector.iter().map(|one| (one * turn).re).collect()
}
