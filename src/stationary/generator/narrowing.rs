//! A generator of reach one that resembles a given one, for factors that are an order smaller.
//!
//! Column j of Q is a difference formula for the backward operator at cell j: Σ_i Q_ij f(x_i) ≈ (L f)(x_j). Its
//! first and second moments along an axis are drift and diffusion in units of cells. The narrow matrix has the
//! same moments on the nearest neighbours alone, hence the same slow modes to second order; diffusion is
//! raised to a share of the drift, or the shortest waves would be left without damping.

use sprs::CsMat;

use crate::space::CellSpace;

/// Least diffusion as a share of the drift; 1 is first-order upwinding.
const LEAST_DIFFUSION: f64 = 0.3;

/// Reach of a matrix: the largest distance in cells along each axis between coupled cells.
pub(super) fn reach(space: &CellSpace, matrix: &CsMat<f64>) -> Vec<usize> {
    let positions = Positions::new(space);
    let mut reach = vec![0; space.dimension()];
    for (column, vector) in matrix.outer_iterator().enumerate() {
        for &row in vector.indices() {
            for (axis, largest) in reach.iter_mut().enumerate() {
                let distance = positions
                    .get(row, axis)
                    .abs_diff(positions.get(column, axis));
                *largest = distance.max(*largest);
            }
        }
    }
    reach
}

/// Positions of all cells along all axes, so that no division is repeated per rate.
struct Positions {
    table: Vec<u32>,
    axes: usize,
}

impl Positions {
    fn new(space: &CellSpace) -> Self {
        let axes = space.dimension();
        let cells = 0..space.n_cells();
        let table =
            cells.flat_map(|cell| (0..axes).map(move |axis| space.position(cell, axis) as u32));
        Self {
            table: table.collect(),
            axes,
        }
    }

    fn get(&self, cell: usize, axis: usize) -> usize {
        self.table[cell * self.axes + axis] as usize
    }
}

/// The narrow stand-in for `matrix`; every column keeps its sum. Rates between the modes of a place are kept as they
/// are.
pub(super) fn narrow(space: &CellSpace, matrix: &CsMat<f64>) -> CsMat<f64> {
    let positions = Positions::new(space);
    let shape = space.shape();
    let axes = space.dimension();
    let modes: Vec<usize> = (0..axes)
        .filter(|&axis| space.axes()[axis].is_modes())
        .collect();
    let mut start = vec![0];
    let (mut rows, mut rates) = (Vec::new(), Vec::new());
    for (cell, column) in matrix.outer_iterator().enumerate() {
        let mut moments = [(0.0, 0.0); crate::MAX_DIMENSION];
        let mut sum = 0.0;
        let mut kept = Vec::new();
        for (&row, &rate) in column.indices().iter().zip(column.data()) {
            if modes
                .iter()
                .any(|&axis| positions.get(row, axis) != positions.get(cell, axis))
            {
                kept.push((row, rate));
                continue;
            }
            sum += rate;
            for (axis, moment) in moments.iter_mut().enumerate().take(axes) {
                let from = positions.get(cell, axis) as f64;
                let offset = positions.get(row, axis) as f64 - from;
                moment.0 += rate * offset;
                moment.1 += rate * offset * offset;
            }
        }
        let (mut below, mut above) = (Vec::new(), Vec::new());
        let mut stride = 1;
        for axis in (0..axes).rev() {
            let (drift, spread) = moments[axis];
            let spread = spread.max(LEAST_DIFFUSION * drift.abs());
            let place = positions.get(cell, axis);
            if space.axes()[axis].is_modes() {
                stride *= shape[axis];
                continue;
            }
            if place > 0 {
                below.push((cell - stride, 0.5 * (spread - drift)));
            }
            if place + 1 < shape[axis] {
                above.push((cell + stride, 0.5 * (spread + drift)));
            }
            stride *= shape[axis];
        }
        let away: f64 = below.iter().chain(&above).map(|entry| entry.1).sum();
        let entries = below.into_iter().chain([(cell, sum - away)]).chain(above);
        kept.extend(entries);
        kept.sort_unstable_by_key(|entry| entry.0);
        for (row, rate) in kept {
            rows.push(row);
            rates.push(rate);
        }
        start.push(rows.len());
    }
    CsMat::new_csc(matrix.shape(), start, rows, rates)
}
