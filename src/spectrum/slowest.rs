//! The slowest mode alone, on one grid, by inverse iteration of its two vectors beside zero.
//!
//! An exchange between states that happens rarely has an eigenvalue so near to zero, and so far from all others, that a
//! few solves suffice. What half of the dissipation changes of it is small beside what it changes of other vectors:
//! both vectors are iterated until that stands too.

use nalgebra::Complex;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::dot;
use super::errors::Worked;
use super::grid::{Grid, ending};
use super::grid_mode::GridMode;
use super::model::balanced;
use super::modes::{ARTEFACT, GridModes, SEED};
use super::motion::{Motion, of_ends};
use crate::cancellation::Cancellation;
use crate::stationary::generator::{AbsorbingSolver, AbsorbingWork, RateOptions, product};

/// First shift, over the rate at which states change.
const FIRST: f64 = 1e-2;

/// Later shifts are as far from zero as the eigenvalue is found to be, over the rate at which states change no nearer
/// than this.
const NEAREST: f64 = 1e-13;

/// Shifts, and steps at each of them, at most.
const SHIFTS: usize = 4;
const STEPS: usize = 12;

/// Change by a step, relative to the eigenvalue, at which it stands, and at which what half of the dissipation changes
/// of it does.
const TOLERANCE: (f64, f64) = (1e-9, 1e-5);

/// The two-sided Rayleigh quotient of a row and a column.
#[derive(Clone, Copy)]
struct RayleighQuotient {
    value: f64,
    /// What half of the dissipation changes.
    change: f64,
}

impl RayleighQuotient {
    /// How far it is from another, relative to the eigenvalue, in what is allowed; NaN where one is no number.
    fn off(self, other: Self) -> f64 {
        let size = self.value.abs();
        let value = (self.value - other.value).abs() / (TOLERANCE.0 * size);
        value.max((self.change - other.change).abs() / (TOLERANCE.1 * size))
    }
}

/// The mode of a grid with the eigenvalue nearest to zero; none where that is complex, or one of several that are about
/// as slow, between which a few steps do not tell.
pub(super) fn slowest(
    grid: &Grid,
    motion: &Motion,
    (rates, cancellation): (&RateOptions, &Cancellation),
) -> Worked<GridModes> {
    let mut numbers = Xoshiro256PlusPlus::seed_from_u64(SEED);
    let mut random = || -> Vec<f64> {
        let cells = 0..grid.space.n_cells();
        cells.map(|_| numbers.random_range(-1.0..1.0)).collect()
    };
    let (mut column, mut row) = (balanced(random()), balanced(random()));
    let mut work = AbsorbingWork::default();
    let mut last: Option<RayleighQuotient> = None;
    let mut shift = FIRST * motion.rate;
    for _ in 0..SHIFTS {
        let (matrix, ends) = ending(&grid.full, shift);
        let mut solver = AbsorbingSolver::new(&grid.space, *rates, cancellation);
        let (stage, mut times) = solver.stage(&matrix, &ends, &column)?;
        let mut stands = false;
        for step in 0..STEPS {
            if step > 0 {
                times = solver.times(&stage, &column)?;
            }
            column = unit(balanced(times));
            row = unit(balanced(solver.expected(&stage, &row)?.values()));
            times = Vec::new();
            let found = of_vectors(grid, &row, &column);
            stands = last.is_some_and(|last| found.off(last) <= 1.0);
            last = Some(found);
            // A shift as near to zero as the eigenvalue is serves better.
            let is_far = found.value.abs() < 0.1 * shift && step > 1;
            if stands || is_far {
                break;
            }
        }
        work.add(solver.work);
        if stands {
            let found = last.and_then(|step| mode(grid, step, (&row, &column), motion));
            return Ok((GridModes::of(found), work));
        }
        let size = last.map_or(0.0, |step| step.value.abs());
        shift = size.max(NEAREST * motion.rate).min(shift);
    }
    Ok((GridModes::default(), work))
}

/// The eigenvalue that two vectors give, and what half of the dissipation changes of it.
fn of_vectors(grid: &Grid, row: &[f64], column: &[f64]) -> RayleighQuotient {
    let overlap = dot(row, column);
    let [full, half] = [&grid.full, &grid.half].map(|matrix| dot(row, &product(matrix, column)));
    RayleighQuotient {
        value: full / overlap,
        change: (half - full) / overlap,
    }
}

/// The mode, unless it is none of the equation.
fn mode(
    grid: &Grid,
    step: RayleighQuotient,
    (row, column): (&[f64], &[f64]),
    motion: &Motion,
) -> Option<GridMode> {
    let rows = motion.centred(row.iter().map(|&one| one.into()).collect());
    let overlap = dot(row, column);
    let product = |cell: usize| (rows[cell] * (column[cell] / overlap)).norm();
    let at_ends = of_ends(grid, step.value.abs(), product, motion);
    let fewer = TOLERANCE.1 * step.value.abs();
    let is_mode = step.value < 0.0 && step.change.abs() <= ARTEFACT * step.value.abs();
    is_mode.then(|| GridMode {
        value: Complex::new(step.value, 0.0),
        change: Complex::new(step.change, 0.0),
        stands: true,
        error: fewer + at_ends,
        columns: column.iter().map(|&one| one.into()).collect(),
        rows,
    })
}

/// A vector of length one.
fn unit(mut vector: Vec<f64>) -> Vec<f64> {
    let length = dot(&vector, &vector).sqrt();
    vector.iter_mut().for_each(|value| *value /= length);
    vector
}
