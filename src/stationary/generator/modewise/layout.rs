//! Cells as places and nodes, masses at nodes as moments and back, and the generator in that basis.
//!
//! Nodes are those of the axes whose modes are taken one by one: of Legendre modes, or, where there is one, of the
//! harmonics of the phase of a forcing alone.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;
use sprs::CsMat;

use crate::space::{Axis, CellSpace, Series};
use crate::stationary::generator::dissection::Grid;

/// A grid whose cells are places on the axes whose modes are not taken one by one, times nodes of those whose modes
/// are. Moments are laid out `place · modes + mode`, of orthonormal polynomials, trigonometric ones along a phase.
#[derive(Debug, Clone)]
pub(in crate::stationary::generator) struct Layout {
    grid: Grid,
    /// The cell with a node at a place, `place · modes + node`; the inverse of `places`.
    cells: Vec<u32>,
    /// Place and node of a cell.
    split: Vec<(u32, u32)>,
    modes: usize,
    /// Polynomials at the nodes, `node · modes + mode`.
    values: Vec<f64>,
    /// The same times the weight of the node.
    weighted: Vec<f64>,
}

/// Whether a space has the phase of a forcing.
pub(in crate::stationary::generator) fn has_phase(space: &CellSpace) -> bool {
    space.axes().iter().any(Axis::is_phase)
}

/// Whether the modes of each axis are taken one by one: those of a phase, of which the forcing alone takes to others;
/// or else those that take from lower ones only.
fn separate_modes(space: &CellSpace) -> Vec<bool> {
    let has_phase = has_phase(space);
    let is_apart = |axis: &Axis| match has_phase {
        true => axis.is_phase(),
        false => axis.series() == Some(Series::Legendre),
    };
    space.axes().iter().map(is_apart).collect()
}

/// The axes whose modes are not taken one by one as a space of their own, with their numbers; `None` where that is all
/// of them or none.
pub(in crate::stationary::generator) fn others(
    space: &CellSpace,
) -> Option<(CellSpace, Vec<usize>)> {
    let apart = separate_modes(space).into_iter().enumerate();
    let kept: Vec<usize> = apart
        .filter(|(_, is_apart)| !is_apart)
        .map(|(number, _)| number)
        .collect();
    if kept.len() == space.dimension() {
        return None;
    }
    let axes = kept.iter().map(|&axis| space.axes()[axis].clone());
    Some((CellSpace::new(axes.collect()).ok()?, kept))
}

impl Layout {
    /// Of a space; `grid` is that of the places. `None` without modes that are taken one by one, or without any other
    /// axis.
    pub(in crate::stationary::generator) fn new(space: &CellSpace, grid: Grid) -> Option<Self> {
        let (places, kept) = others(space)?;
        let (mut modes, mut values, mut weights) = (1, vec![1.0], vec![1.0]);
        let mut carried = Vec::new();
        for (number, axis) in space.axes().iter().enumerate() {
            if kept.contains(&number) {
                continue;
            }
            let (count, along) = (axis.count(), axis.orthonormal_values());
            let whole = axis.to() - axis.from();
            weights = product(&weights, (0..count).map(|node| axis.width(node) / whole));
            // Kronecker product, of nodes and of modes alike.
            let mut all = vec![0.0; (modes * count).pow(2)];
            for (node, mode) in pairs(modes) {
                for (of_node, of_mode) in pairs(count) {
                    let at = (node * count + of_node) * modes * count + mode * count + of_mode;
                    all[at] = values[node * modes + mode] * along[of_node * count + of_mode];
                }
            }
            (modes, values) = (modes * count, all);
            carried.push(number);
        }
        let rows = values.chunks_exact(modes).zip(&weights);
        let weighted = rows.flat_map(|(row, weight)| row.iter().map(move |value| weight * value));
        let weighted = weighted.collect();
        let mut cells = vec![0; space.n_cells()];
        let mut split = Vec::with_capacity(space.n_cells());
        for cell in 0..space.n_cells() {
            let at: Vec<usize> = kept
                .iter()
                .map(|&axis| space.position(cell, axis))
                .collect();
            let place = places.number(&at);
            let node = carried.iter().fold(0, |node, &axis| {
                node * space.axes()[axis].count() + space.position(cell, axis)
            });
            cells[place * modes + node] = cell as u32;
            split.push((place as u32, node as u32));
        }
        Some(Self {
            grid,
            cells,
            split,
            modes,
            values,
            weighted,
        })
    }

    /// The grid of the places.
    pub(in crate::stationary::generator) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Number of places.
    pub(in crate::stationary::generator) fn places(&self) -> usize {
        self.cells.len() / self.modes
    }

    /// Number of modes, of all axes that have them together.
    pub(in crate::stationary::generator) fn modes(&self) -> usize {
        self.modes
    }

    /// The cells with the nodes of a place.
    pub(in crate::stationary::generator) fn cells_at(&self, place: usize) -> &[u32] {
        &self.cells[place * self.modes..][..self.modes]
    }

    /// Place and node of a cell.
    pub(in crate::stationary::generator) fn split(&self, cell: usize) -> (usize, usize) {
        let (place, node) = self.split[cell];
        (place as usize, node as usize)
    }

    /// The place of a cell.
    pub(in crate::stationary::generator) fn place(&self, cell: usize) -> usize {
        self.split[cell].0 as usize
    }

    /// Moments of masses of cells, with another number in place of one of them.
    pub(in crate::stationary::generator) fn moments(
        &self,
        masses: &[f64],
        given: (usize, f64),
    ) -> Vec<f64> {
        self.sum_over_nodes(&self.values, masses, given)
    }

    /// The transpose of [`Layout::masses`], with another number in place of one of the cells'.
    pub(in crate::stationary::generator) fn moments_by_weights(
        &self,
        values: &[f64],
        given: (usize, f64),
    ) -> Vec<f64> {
        self.sum_over_nodes(&self.weighted, values, given)
    }

    /// Sums over the nodes of a place, a column of `by` a mode.
    fn sum_over_nodes(&self, by: &[f64], masses: &[f64], (cell, given): (usize, f64)) -> Vec<f64> {
        let mut moments = vec![0.0; masses.len()];
        let places = moments.par_chunks_exact_mut(self.modes).with_min_len(64);
        let cells = self.cells.par_chunks_exact(self.modes);
        places.zip(cells).for_each(|(moments, cells)| {
            for (&at, values) in cells.iter().zip(by.chunks_exact(self.modes)) {
                let at = at as usize;
                let mass = if at == cell { given } else { masses[at] };
                for (moment, value) in moments.iter_mut().zip(values) {
                    *moment += mass * value;
                }
            }
        });
        moments
    }

    /// Masses of cells with these moments.
    pub(in crate::stationary::generator) fn masses(&self, moments: &[f64]) -> Vec<f64> {
        self.at_nodes(&self.weighted, moments)
    }

    /// The transpose of [`Layout::moments`].
    pub(in crate::stationary::generator) fn values_of(&self, moments: &[f64]) -> Vec<f64> {
        self.at_nodes(&self.values, moments)
    }

    /// Sums over the modes of a place, a row of `by` a node.
    fn at_nodes(&self, by: &[f64], moments: &[f64]) -> Vec<f64> {
        let mut at_nodes = vec![0.0; moments.len()];
        let places = at_nodes.par_chunks_exact_mut(self.modes).with_min_len(64);
        let given = moments.par_chunks_exact(self.modes);
        places.zip(given).for_each(|(masses, moments)| {
            let nodes = by.chunks_exact(self.modes);
            for (mass, values) in masses.iter_mut().zip(nodes) {
                *mass = values.iter().zip(moments).map(|(a, b)| a * b).sum();
            }
        });
        let mut masses = vec![0.0; moments.len()];
        for (&cell, value) in self.cells.iter().zip(at_nodes) {
            masses[cell as usize] = value;
        }
        masses
    }
}

/// All pairs of numbers below `count`.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |first| (0..count).map(move |second| (first, second)))
}

/// All products, the later factor fastest.
fn product(first: &[f64], later: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
    let each = first.iter().flat_map(|a| later.clone().map(move |b| a * b));
    each.collect()
}

/// A generator as moments see it.
pub(super) struct Blocks {
    /// Pattern between places, by columns.
    pub(super) starts: Vec<usize>,
    pub(super) rows: Vec<usize>,
    /// Rates of each mode into itself, `entry · modes + mode`.
    pub(super) rates: Vec<f64>,
    /// Rates from lower modes into higher ones at a place, see [`super::ModeFactors`].
    pub(super) below: Vec<f32>,
}

/// What the moments of one place send: rows, their rates, and the triangle at the place itself.
type Column = (Vec<usize>, Vec<f64>, Vec<f32>);

/// The generator's blocks between places in the basis of the moments: their diagonals, and of those that stay at a
/// place the lower triangle.
pub(super) fn blocks(layout: &Layout, matrix: &CsMat<f64>) -> Blocks {
    let columns: Vec<Column> = (0..layout.places())
        .into_par_iter()
        .with_min_len(16)
        .map(|place| column(layout, matrix, place))
        .collect();
    let (mut starts, mut rows, mut rates, mut below) = (vec![0], Vec::new(), vec![], vec![]);
    for (of_rows, of_rates, triangle) in columns {
        rows.extend(of_rows);
        rates.extend(of_rates);
        below.extend(triangle);
        starts.push(rows.len());
    }
    Blocks {
        starts,
        rows,
        rates,
        below,
    }
}

fn column(layout: &Layout, matrix: &CsMat<f64>, place: usize) -> Column {
    let n = layout.modes;
    let starts = matrix.indptr();
    let starts = starts.raw_storage();
    let cells = &layout.cells[place * n..][..n];
    let entries = |cell: u32| {
        let range = starts[cell as usize]..starts[cell as usize + 1];
        range.map(|entry| (layout.split[matrix.indices()[entry]], matrix.data()[entry]))
    };
    let mut rows: Vec<u32> = cells
        .iter()
        .flat_map(|&cell| entries(cell).map(|((row, _), _)| row))
        .chain([place as u32])
        .collect();
    rows.sort_unstable();
    rows.dedup();
    let mut rates = vec![0.0; rows.len() * n];
    let mut own = vec![0.0; n * n];
    for (from, &cell) in cells.iter().enumerate() {
        let weighted = &layout.weighted[from * n..][..n];
        for ((row, to), rate) in entries(cell) {
            let to = to as usize;
            if row as usize == place {
                own[from * n + to] += rate;
                continue;
            }
            let values = &layout.values[to * n..][..n];
            let slot = rows.partition_point(|&one| one < row) * n;
            let slots = rates[slot..slot + n].iter_mut();
            for ((slot, value), weight) in slots.zip(values).zip(weighted) {
                *slot += rate * value * weight;
            }
        }
    }
    // In the basis of the moments: (values)ᵀ · own · weighted, `own` by columns.
    let square = |values| MatRef::from_column_major_slice(values, n, n);
    let (mut half, mut whole) = (vec![0.0; n * n], vec![0.0; n * n]);
    let (values, back) = (square(&layout.values), square(&layout.weighted).transpose());
    let into = MatMut::from_column_major_slice_mut(&mut half, n, n);
    matmul(into, Accum::Replace, values, square(&own), 1.0, Par::Seq);
    let into = MatMut::from_column_major_slice_mut(&mut whole, n, n);
    matmul(into, Accum::Replace, square(&half), back, 1.0, Par::Seq);
    let slot = rows.partition_point(|&one| (one as usize) < place) * n;
    let mut triangle = Vec::with_capacity(n * (n - 1) / 2);
    for mode in 0..n {
        rates[slot + mode] += whole[mode * n + mode];
        triangle.extend((0..mode).map(|lower| whole[lower * n + mode] as f32));
    }
    let rows = rows.into_iter().map(|row| row as usize);
    (rows.collect(), rates, triangle)
}
