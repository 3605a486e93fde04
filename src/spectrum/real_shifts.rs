//! Slow modes by a model that is made at one or a few real shifts.
//!
//! The first shift is the rate of the motion. A mode that is much slower has a shift of its own.

use nalgebra::Complex;
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::SpectrumError;
use super::grid::{Grid, ending};
use super::model::{GridModel, Products, REACH, ReducedModel, balanced, in_order, standing};
use crate::cancellation::Cancellation;
use crate::numerics::sort_ascending;
use crate::stationary::generator::{AbsorbingSolver, AbsorbingWork, RateOptions};

/// Vectors of either side by which a model grows before its eigenvalues are looked at again.
const GROWTH: usize = 12;

/// Most vectors of either side at one shift.
const MOST: usize = 144;

/// So many vectors at the first shift that tell nothing: the modes are of another kind.
const IN_VAIN: usize = 48;

/// Most shifts.
const SHIFTS: usize = 3;

/// A mode this many times slower than the shift has a shift of its own.
const SLOWER: f64 = 30.0;

/// An eigenvalue that does not decay is zero but for rounding up to this share of the shift.
const ROUNDING: f64 = 1e-9;

/// Slowest decay beside the shift that is looked for.
const SLOWEST: f64 = 1e-13;

/// Modes of a grid, up to the first that does not stand; none where so many lie about the shift that the model tells
/// no part of them.
pub(super) fn at_real_shifts(
    grid: &Grid,
    (wanted, rate): (usize, f64),
    numbers: &mut Xoshiro256PlusPlus,
    (rates, cancellation): (&RateOptions, &Cancellation),
    work: &mut AbsorbingWork,
) -> Result<GridModel, SpectrumError> {
    let cells = grid.space.n_cells();
    let mut random = || -> Vec<f64> {
        (0..cells)
            .map(|_| numbers.random_range(-1.0..1.0))
            .collect()
    };
    let mut found = GridModel::default();
    if found.columns.fill(cells) && found.rows.fill(cells) {
        (found.products).grow(&found.rows, &found.columns, [&grid.full, &grid.half]);
        let size = found.columns.vectors.len();
        let standing = Standing::new(&found.products, size, wanted, rate);
        (found.modes, found.hides) = (standing.modes, standing.hides);
        return Ok(found);
    }
    let mut shift = rate;
    for _ in 0..SHIFTS {
        let (matrix, ends) = ending(&grid.full, shift);
        let mut solver = AbsorbingSolver::new(&grid.space, *rates, cancellation);
        let (stage, mut column) = solver.stage(&matrix, &ends, &balanced(random()))?;
        let mut row = solver.expected(&stage, &random())?.values();
        let begun = found.columns.vectors.len();
        loop {
            let grows = found.columns.add(balanced(column)) && found.rows.add(row);
            let used = found.columns.vectors.len() - begun;
            if !grows || used >= MOST {
                break;
            }
            if used.is_multiple_of(GROWTH) {
                (found.products).grow(&found.rows, &found.columns, [&grid.full, &grid.half]);
                let size = found.columns.vectors.len();
                let standing = Standing::new(&found.products, size, wanted, rate);
                found.modes = standing.modes;
                found.hides |= standing.hides;
                if found.hides || standing.is_enough || (found.modes.is_empty() && used >= IN_VAIN)
                {
                    break;
                }
            }
            let last = found.columns.vectors.len() - 1;
            column = solver.times(&stage, &found.columns.vectors[last])?;
            row = solver.expected(&stage, &found.rows.vectors[last])?.values();
        }
        work.add(solver.work);
        if found.hides {
            break;
        }
        let slowest = found.modes.first().map_or(shift, |(one, _)| -one.re);
        if slowest * SLOWER >= shift || slowest <= SLOWEST * rate {
            break;
        }
        shift = slowest;
    }
    Ok(found)
}

/// The eigenvalues of a model that fewer vectors give as well, each with what they change.
///
/// They are told from the one nearest to the first shift on, up to the first that does not stand: of those that are as
/// near none is missing. What is farther than `REACH` shifts away oscillates too fast, and is left out where there are
/// enough without it.
struct Standing {
    modes: Vec<(Complex<f64>, f64)>,
    is_enough: bool,
    /// Whether a mode is so slow that rounding hides its rate, as an exchange over a high barrier is: the steady state,
    /// which alone should not decay, is not among these.
    hides: bool,
}

impl Standing {
    fn new(products: &Products, size: usize, wanted: usize, shift: f64) -> Self {
        let of = |size: usize| products.model(size).as_ref().map(ReducedModel::eigenvalues);
        let (Some(all), Some(fewer)) = (of(size), of(products.fewer(size, GROWTH / 2))) else {
            let modes = Vec::new();
            return Self {
                modes,
                is_enough: false,
                hides: false,
            };
        };
        let away = |value: Complex<f64>| (value - shift).norm();
        let is_hidden = |one: &Complex<f64>| one.re >= 0.0 && one.norm() <= ROUNDING * shift;
        let hides = all.iter().any(is_hidden);
        let mut all: Vec<Complex<f64>> = all.into_iter().filter(|one| one.re < 0.0).collect();
        sort_ascending(&mut all, |one| away(*one));
        let farthest = all.len();
        let mut modes = standing(&all, &fewer);
        let within = modes
            .iter()
            .filter(|(value, _)| away(*value) <= REACH * shift)
            .count();
        let reaches = modes.len() == farthest || within < modes.len();
        modes.truncate(within.max(wanted));
        in_order(&mut modes, |(value, _)| *value);
        Self {
            is_enough: reaches && modes.len() >= wanted,
            hides,
            modes,
        }
    }
}
