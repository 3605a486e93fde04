//! What a map step makes of functions that are linear in cells: of each cell the linear function that is nearest to the
//! means over its paths (least squares).
//!
//! With T the mean time that is left and m the time that is spent in the step, T = m + K T. A function that is flat in
//! each cell would be that of a process to which the cells add diffusion; of linear ones no more than a term of fourth
//! order in the width is left, since what they leave out has no mean and no slope in a cell.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::layout::Layout;
use super::map::{Column, PassageMap, StartColumn};
use super::moments::{ENDED, Moments};

/// Paths from which a function is taken for linear in a cell, and the least variance of where they start, along any
/// direction, in units of its width: a cell of which the region cuts off all but a strip is flat.
const FEWEST: f64 = 24.0;
const LEAST_VARIANCE: f64 = 2e-3;

/// Place of a cell that has none.
const NOWHERE: u32 = u32::MAX;

/// Which paths are counted.
#[derive(Debug, Clone, Copy)]
pub(super) enum Counted {
    All,
    /// All but those of a group.
    Without(usize),
    /// Those with the whole time step.
    Coarse,
}

impl Counted {
    fn of(self, column: &Column) -> impl Iterator<Item = &Moments> {
        let is_coarse = matches!(self, Self::Coarse);
        let groups = column.groups.iter().enumerate();
        let is_counted = move |group: usize| match self {
            Self::All => true,
            Self::Without(left_out) => group != left_out,
            Self::Coarse => false,
        };
        let groups = groups.filter(move |(group, _)| is_counted(*group));
        let coarse = is_coarse.then_some(&column.coarse);
        groups.map(|(_, moments)| moments).chain(coarse)
    }
}

/// What a map step makes of functions, c → K c and r → r K.
pub(super) struct Operator {
    width: usize,
    /// End of the entries of each row.
    row_ends: Vec<usize>,
    ends: Vec<u32>,
    blocks: Vec<f64>,
    /// What is known of paths, a function each.
    pub(super) told: Vec<Vec<f64>>,
    /// What follows the start: for functions after the step, and means of what is known of its paths.
    pub(super) start: StartVector,
}

/// A start as an average.
pub(super) struct StartVector {
    /// Weights of functions that are linear in cells.
    pub(super) weights: Vec<f64>,
    /// Means of what is known of paths.
    pub(super) told: Vec<f64>,
}

/// A row in the making.
struct GrowingRow {
    slots: Vec<u32>,
    touched: Vec<u32>,
    blocks: Vec<f64>,
    gram: Vec<f64>,
    told: Vec<f64>,
}

impl GrowingRow {
    fn new(cells: usize, width: usize, count: usize) -> Self {
        Self {
            slots: vec![NOWHERE; cells],
            touched: Vec::new(),
            blocks: Vec::new(),
            gram: vec![0.0; width * width],
            told: vec![0.0; width * count],
        }
    }

    fn clear(&mut self) {
        for &end in &self.touched {
            self.slots[end as usize] = NOWHERE;
        }
        self.touched.clear();
        self.blocks.clear();
        self.gram.fill(0.0);
        self.told.fill(0.0);
    }

    /// Adds moments of the paths of a cell of the map; without a cell, of those from a state.
    fn add(&mut self, layout: &Layout, cell: Option<usize>, moments: &Moments) {
        let width = layout.width;
        let size = width * width;
        let moved = |rows: &[f64], count: usize| match cell {
            Some(cell) => layout.moved(cell, rows, count),
            None => rows.to_vec(),
        };
        let mut gram = moved(&moments.gram, width);
        if let Some(cell) = cell {
            layout.moved_end(cell, &mut gram);
        }
        add(&mut self.gram, &gram);
        add(
            &mut self.told,
            &moved(&moments.told, moments.told.len() / width),
        );
        for (number, &end) in moments.ends.iter().enumerate() {
            if end == NOWHERE {
                continue;
            }
            let block = &moments.blocks[number * size..(number + 1) * size];
            let block: Vec<f64> = block.iter().map(|&sum| f64::from(sum)).collect();
            let mut block = moved(&block, width);
            layout.moved_end(end as usize, &mut block);
            let slot = &mut self.slots[layout.cells[end as usize].0 as usize];
            if *slot == NOWHERE {
                *slot = self.touched.len() as u32;
                self.touched.push(layout.cells[end as usize].0);
                self.blocks.resize(self.touched.len() * size, 0.0);
            }
            add(&mut self.blocks[*slot as usize * size..][..size], &block);
        }
    }

    /// Sums of (1, u) over all paths, made of what is counted of where they end, so that probabilities sum to one.
    fn paths(&self, width: usize) -> Vec<f64> {
        let count = self.told.len() / width;
        let ended = (0..width).map(|p| self.told[p * count + ENDED]);
        let mut sums: Vec<f64> = ended.collect();
        for block in self.blocks.chunks_exact(width * width) {
            for (p, sum) in sums.iter_mut().enumerate() {
                *sum += block[p * width];
            }
        }
        sums
    }

    /// The inverse of Σ (1, u) ⊗ (1, u); of its first entry alone where paths do not tell slopes.
    fn inverse(&self, width: usize) -> DMatrix<f64> {
        let sums = self.paths(width);
        let count = sums[0].max(f64::MIN_POSITIVE);
        let mut gram = DMatrix::from_row_slice(width, width, &self.gram);
        for (p, &sum) in sums.iter().enumerate() {
            gram[(p, 0)] = sum;
            gram[(0, p)] = sum;
        }
        let mean = |p: usize| sums[p] / count;
        let spread = DMatrix::from_fn(width - 1, width - 1, |a, b| {
            gram[(a + 1, b + 1)] / count - mean(a + 1) * mean(b + 1)
        });
        let is_told = count >= FEWEST && spread.symmetric_eigenvalues().min() >= LEAST_VARIANCE;
        let inverse = gram.try_inverse().filter(|_| is_told);
        inverse.unwrap_or_else(|| {
            let mut flat = DMatrix::zeros(width, width);
            flat[(0, 0)] = 1.0 / count;
            flat
        })
    }
}

fn add(to: &mut [f64], more: &[f64]) {
    for (sum, value) in to.iter_mut().zip(more) {
        *sum += value;
    }
}

impl Operator {
    /// The operator of some paths of a map, with a start that has a weight (1, s) in each cell.
    pub(super) fn new(
        map: &PassageMap,
        counted: Counted,
        layout: &Layout,
        weights: &[Vec<f64>],
    ) -> Self {
        let (width, rows, count) = (layout.width, layout.members.len(), map.asked.count());
        let size = width * width;
        let mut operator = Self {
            width,
            row_ends: Vec::with_capacity(rows),
            ends: Vec::new(),
            blocks: Vec::new(),
            told: vec![Vec::with_capacity(rows * width); count],
            start: StartVector::new(map, counted, layout, weights),
        };
        let mut row = GrowingRow::new(rows, width, count);
        for members in &layout.members {
            row.clear();
            for &member in members {
                for moments in counted.of(&map.columns[member as usize]) {
                    row.add(layout, Some(member as usize), moments);
                }
            }
            let inverse = row.inverse(width);
            let mut order: Vec<usize> = (0..row.touched.len()).collect();
            order.sort_unstable_by_key(|&slot| row.touched[slot]);
            for slot in order {
                operator.ends.push(row.touched[slot]);
                let block = &row.blocks[slot * size..(slot + 1) * size];
                let block = &inverse * DMatrix::from_row_slice(width, width, block);
                operator.blocks.extend(block.transpose().iter());
            }
            operator.row_ends.push(operator.ends.len());
            let told = &inverse * DMatrix::from_row_slice(width, count, &row.told);
            for (number, function) in operator.told.iter_mut().enumerate() {
                function.extend((0..width).map(|p| told[(p, number)]));
            }
        }
        operator
    }

    fn entries(&self, row: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let first = row.checked_sub(1).map_or(0, |before| self.row_ends[before]);
        let size = self.width * self.width;
        let entries = first..self.row_ends[row];
        entries.map(move |entry| {
            let block = &self.blocks[entry * size..(entry + 1) * size];
            (self.ends[entry] as usize, block)
        })
    }

    /// Number of cells.
    pub(super) fn rows(&self) -> usize {
        self.row_ends.len()
    }

    /// K c.
    pub(super) fn apply(&self, function: &[f64]) -> Vec<f64> {
        let width = self.width;
        let mut after = vec![0.0; function.len()];
        let rows = after.par_chunks_mut(width).with_min_len(256).enumerate();
        rows.for_each(|(row, sums)| {
            for (end, block) in self.entries(row) {
                let of_end = &function[end * width..(end + 1) * width];
                for (sum, weights) in sums.iter_mut().zip(block.chunks_exact(width)) {
                    let terms = weights.iter().zip(of_end);
                    *sum += terms.map(|(weight, value)| weight * value).sum::<f64>();
                }
            }
        });
        after
    }

    /// r K, for weights of functions.
    pub(super) fn applied_to_weights(&self, weights: &[f64]) -> Vec<f64> {
        let width = self.width;
        let mut after = vec![0.0; weights.len()];
        for (row, own) in weights.chunks_exact(width).enumerate() {
            for (end, block) in self.entries(row) {
                let sums = &mut after[end * width..(end + 1) * width];
                for (weight, block) in own.iter().zip(block.chunks_exact(width)) {
                    for (sum, value) in sums.iter_mut().zip(block) {
                        *sum += weight * value;
                    }
                }
            }
        }
        after
    }
}

impl StartVector {
    /// The start with a weight (1, s) in each cell of the map; from a state weights do not matter.
    pub(super) fn new(
        map: &PassageMap,
        counted: Counted,
        layout: &Layout,
        weights: &[Vec<f64>],
    ) -> Self {
        let (width, rows, count) = (layout.width, layout.members.len(), map.asked.count());
        let size = width * width;
        let mut start = Self {
            weights: vec![0.0; rows * width],
            told: vec![0.0; count],
        };
        let (mut row, mut total) = (GrowingRow::new(rows, width, count), 0.0);
        let one = [vec![1.0], vec![0.0; width - 1]].concat();
        for column in &map.starts {
            row.clear();
            let (column, weight) = match column {
                StartColumn::State(column) => (column, &one),
                StartColumn::Cell(cell, own) => {
                    (own.as_ref().unwrap_or(&map.columns[*cell]), &weights[*cell])
                }
            };
            for moments in counted.of(column) {
                row.add(layout, None, moments);
            }
            for (slot, &end) in row.touched.iter().enumerate() {
                let block = &row.blocks[slot * size..(slot + 1) * size];
                let sums = &mut start.weights[end as usize * width..(end as usize + 1) * width];
                for (weight, block) in weight.iter().zip(block.chunks_exact(width)) {
                    for (sum, value) in sums.iter_mut().zip(block) {
                        *sum += weight * value;
                    }
                }
            }
            for (weight, told) in weight.iter().zip(row.told.chunks_exact(count)) {
                for (sum, value) in start.told.iter_mut().zip(told) {
                    *sum += weight * value;
                }
            }
            let paths = row.paths(width);
            total += weight.iter().zip(&paths).map(|(a, b)| a * b).sum::<f64>();
        }
        let all = start.weights.iter_mut().chain(&mut start.told);
        all.for_each(|value| *value /= total);
        start
    }
}

#[cfg(test)]
mod tests;
