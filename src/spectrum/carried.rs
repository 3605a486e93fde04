//! Modes of a grid from those of a coarser one: their vectors are carried to its cells, and corrected there.
//!
//! What a pair of vectors leaves of its equations, Q r - λ r and Qᵀl - λ l, passes through factors at a shift near by,
//! and joins the two spaces that a model is made of (E. R. Davidson 1975, from both sides). Factors are a means of
//! correction alone: they may be rough, and serve several modes. The model's eigenvalue has the product of the errors
//! of both vectors.

use nalgebra::Complex;

use super::SpectrumError;
use super::grid::Grid;
use super::grid_mode::GridMode;
use super::model::{GridModel, ReducedModel, balanced, in_order, stands};
use crate::cancellation::Cancellation;
use crate::space::nodes::{self, AxisWeights};
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::{
    AbsorbingWork, RateError, RateOptions, Shifted, ShiftedPattern,
};

/// Corrections of a mode, at most.
const CORRECTIONS: usize = 8;

/// A mode shares the factors of another one from which it is no farther than this share of the distance to modes that
/// are not known. Alone, its vectors would get better below one only; the spaces that all corrections span make up for
/// more. Of six modes of `coulomb_fc` 0.6 takes eight factorisations and 1.2 six; with 2.5 they do not always stand.
const SHARED: f64 = 1.2;

/// Distance of a shift from its mode, over the decay rate of the mode: the factors must not be singular.
const BESIDE: f64 = 0.1;

/// Relative change by a correction below which changes may be due to rounding, and the share of the one before from
/// which they are.
const ROUNDING: f64 = 1e-4;
const SLOW: f64 = 0.1;

/// Nodes along an axis through which vectors are interpolated.
const NODES: usize = 4;

/// A mode that is being corrected.
struct Tracked {
    value: Complex<f64>,
    /// What the last correction changed, and the one before.
    changes: [f64; 2],
    /// The number of its shift.
    shift: usize,
}

impl Tracked {
    /// With what it may be off.
    fn known(&self) -> (Complex<f64>, f64) {
        let [last, before] = self.changes;
        let off = if stands(&(self.value, last)) {
            last
        } else {
            last.max(before)
        };
        (self.value, off)
    }

    /// Whether corrections change it no more, or no less than rounding does where two modes are almost one.
    fn stands(&self) -> bool {
        let [last, before] = self.changes;
        let is_rounding = before <= ROUNDING * self.value.norm() && last > SLOW * before;
        is_rounding || stands(&(self.value, last))
    }
}

/// The modes of a coarser grid on this one, in the order of their decay rates, so many of which stand; none where they
/// do not after some corrections, or where the factors of all shifts together exceed the limit of memory.
pub(super) fn carried(
    grid: &Grid,
    (coarse, known): (&CellSpace, &[GridMode]),
    wanted: usize,
    (rates, cancellation): (&RateOptions, &Cancellation),
    work: &mut AbsorbingWork,
) -> Result<Option<GridModel>, SpectrumError> {
    let has_series = grid.space.axes().iter().any(Axis::is_modes);
    if known.len() < wanted || has_series {
        return Ok(None);
    }
    let (places, shared) = shifts(known);
    let pattern = ShiftedPattern::new(&grid.space, &grid.full);
    if places.len() as u64 * pattern.bytes() > rates.memory_limit_bytes {
        return Ok(None);
    }
    let solver = |&place| Shifted::new(&pattern, &grid.full, place, cancellation);
    let solvers: Result<Vec<Shifted<'_>>, RateError> = places.iter().map(solver).collect();
    let mut solvers = solvers?;
    work.factorisations += solvers.len();
    let tracked = known.iter().zip(shared).map(|(mode, shift)| Tracked {
        value: mode.value,
        changes: [f64::INFINITY; 2],
        shift,
    });
    let mut found = begun(grid, coarse, known);
    let stand = corrected(
        grid,
        tracked.collect(),
        wanted,
        &mut solvers,
        (&mut found, cancellation),
    )?;
    work.passes += solvers.iter().map(|one| one.passes).sum::<usize>();
    Ok(stand.then_some(found))
}

/// Corrects modes until so many of the slowest stand; whether they do.
fn corrected(
    grid: &Grid,
    mut tracked: Vec<Tracked>,
    wanted: usize,
    solvers: &mut [Shifted<'_>],
    (found, cancellation): (&mut GridModel, &Cancellation),
) -> Result<bool, SpectrumError> {
    for correction in 0..=CORRECTIONS {
        (found.products).grow(&found.rows, &found.columns, [&grid.full, &grid.half]);
        let Some(model) = found.products.model(found.columns.vectors.len()) else {
            return Ok(false);
        };
        tracked = followed(&tracked, &model.eigenvalues());
        in_order(&mut tracked, |one| one.value);
        let standing = tracked.iter().take_while(|one| one.stands()).count();
        if standing >= wanted.min(tracked.len()) {
            found.modes = tracked.iter().map(Tracked::known).collect();
            found.standing = standing;
            return Ok(true);
        }
        if correction == CORRECTIONS {
            break;
        }
        for (number, solver) in solvers.iter_mut().enumerate() {
            let moving = tracked
                .iter()
                .filter(|one| one.shift == number && !one.stands());
            let values: Vec<Complex<f64>> = moving.map(|one| one.value).collect();
            correct(grid, &model, &values, solver, found);
            cancellation.check().map_err(RateError::from)?;
        }
    }
    Ok(false)
}

/// Shifts, and the number of that which each mode shares. The modes are in the order of their decay rates, and what is
/// not known decays as fast as the last one at least.
fn shifts(known: &[GridMode]) -> (Vec<Complex<f64>>, Vec<usize>) {
    let values: Vec<Complex<f64>> = known.iter().map(|mode| mode.value).collect();
    let slowest = |most: f64, value: &Complex<f64>| most.max(-value.re);
    let unknown = values.iter().fold(0.0, slowest);
    let mut places: Vec<Complex<f64>> = Vec::new();
    let shared = values.iter().map(|&value| {
        let serves = |place: &Complex<f64>| (value - place).norm() <= SHARED * (unknown + place.re);
        places.iter().position(serves).unwrap_or_else(|| {
            places.push(value + BESIDE * value.re.abs());
            places.len() - 1
        })
    });
    let shared = shared.collect();
    (places, shared)
}

/// The spaces that the vectors of a coarser grid span.
fn begun(grid: &Grid, coarse: &CellSpace, known: &[GridMode]) -> GridModel {
    let mut found = GridModel::default();
    let spaces = (coarse, &grid.space);
    let weights = interpolation(coarse, &grid.space);
    let (from, to) = (coarse.volumes(), grid.space.volumes());
    for mode in known {
        let densities = mode
            .columns
            .iter()
            .zip(&from)
            .map(|(mass, volume)| mass / volume);
        let densities: Vec<Complex<f64>> = densities.collect();
        let masses = interpolated(spaces, &weights, &densities);
        let masses = masses
            .into_iter()
            .zip(&to)
            .map(|(density, volume)| density * volume);
        let row = interpolated(spaces, &weights, &mode.rows);
        add(&mut found, &masses.collect::<Vec<_>>(), &row);
    }
    found
}

/// Adds the parts of a column and of a row. A direction that adds nothing to one side is left out of both.
fn add(found: &mut GridModel, column: &[Complex<f64>], row: &[Complex<f64>]) {
    for part in [|one: &Complex<f64>| one.re, |one: &Complex<f64>| one.im] {
        let of = |vector: &[Complex<f64>]| vector.iter().map(part).collect::<Vec<f64>>();
        if found.columns.add(balanced(of(column))) && !found.rows.add(of(row)) {
            found.columns.vectors.pop();
        }
    }
}

/// Weights of the nodes of each axis about the centres of the cells of another space.
fn interpolation(from: &CellSpace, to: &CellSpace) -> Vec<Vec<AxisWeights>> {
    let axes = from.axes().iter().zip(to.axes());
    let along = axes.map(|(axis, other)| {
        let centres = other.centres();
        centres
            .iter()
            .map(|&at| nodes::about(axis, at, NODES))
            .collect()
    });
    along.collect()
}

/// Values at the cells of another space.
fn interpolated(
    (from, to): (&CellSpace, &CellSpace),
    weights: &[Vec<AxisWeights>],
    values: &[Complex<f64>],
) -> Vec<Complex<f64>> {
    let mut along: Vec<&AxisWeights> = weights.iter().map(|axis| &axis[0]).collect();
    let cells = 0..to.n_cells();
    let value = cells.map(|cell| {
        for (axis, one) in along.iter_mut().enumerate() {
            *one = &weights[axis][to.position(cell, axis)];
        }
        let mut sum = Complex::default();
        nodes::each(from, &along, |node, weight| sum += values[node] * weight);
        sum
    });
    value.collect()
}

/// Follows each value, and its conjugate, to the nearest eigenvalue that no other has taken: a pair may become two real
/// modes, or these a pair.
fn followed(tracked: &[Tracked], values: &[Complex<f64>]) -> Vec<Tracked> {
    let with_conjugate = |value: Complex<f64>| {
        let conjugate = (value.im != 0.0).then(|| value.conj());
        std::iter::once(value).chain(conjugate)
    };
    let all = values.iter().copied().flat_map(with_conjugate);
    let mut free: Vec<Complex<f64>> = all.collect();
    let mut found: Vec<Tracked> = Vec::new();
    for one in tracked {
        for before in with_conjugate(one.value) {
            let away = |value: &Complex<f64>| (value - before).norm();
            let nearest =
                (0..free.len()).min_by(|&a, &b| away(&free[a]).total_cmp(&away(&free[b])));
            let Some(nearest) = nearest.map(|nearest| free.swap_remove(nearest)) else {
                continue;
            };
            let value = Complex::new(nearest.re, nearest.im.abs());
            // Both of a pair are one mode.
            if value.im == 0.0 || found.iter().all(|known| known.value != value) {
                found.push(Tracked {
                    value,
                    changes: [away(&nearest), one.changes[0]],
                    shift: one.shift,
                });
            }
        }
    }
    found
}

/// Q x - λ x of a vector of length one; or of the transposed matrix.
fn left_over(
    grid: &Grid,
    value: Complex<f64>,
    vector: &[Complex<f64>],
    is_transposed: bool,
) -> Vec<Complex<f64>> {
    let mut left: Vec<Complex<f64>> = vector.iter().map(|one| -value * one).collect();
    for (column, rates) in grid.full.outer_iterator().enumerate() {
        for (row, &rate) in rates.iter() {
            if is_transposed {
                left[column] += vector[row] * rate;
            } else {
                left[row] += vector[column] * rate;
            }
        }
    }
    let length = left.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
    left.iter_mut().for_each(|one| *one /= length);
    left
}

/// Adds what corrects the vectors of eigenvalues that share a shift.
fn correct(
    grid: &Grid,
    model: &ReducedModel,
    values: &[Complex<f64>],
    solver: &mut Shifted<'_>,
    found: &mut GridModel,
) {
    let (mut columns, mut rows) = (Vec::new(), Vec::new());
    for &value in values {
        let Some(eigen) = model.eigen(value) else {
            continue;
        };
        let left = [
            (found.columns.combined(&eigen.columns), false),
            (found.rows.combined(&eigen.rows), true),
        ];
        let [column, row] =
            left.map(|(vector, is_transposed)| left_over(grid, value, &vector, is_transposed));
        columns.push(column);
        rows.push(row);
    }
    solver.pass(&mut columns, false);
    solver.pass(&mut rows, true);
    for (column, row) in columns.iter().zip(&rows) {
        add(found, column, row);
    }
}
