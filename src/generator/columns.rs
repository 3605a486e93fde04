//! The columns of the generator from the fluxes of the grid lines.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;
use sprs::CsMat;

use super::geometry::{AxisGeometry, strides};
use super::scheme::{REACH, Window};
use super::{Generator, GeneratorError};
use crate::MAX_DIMENSION;

/// Columns that are filled as one task.
const COLUMNS: usize = 2048;

/// What moves along the lines of an axis.
pub(super) enum AxisRates {
    /// Weights of the flux through every face: `lines × (count + 1)`.
    Fluxes(Vec<Window>),
    /// Rates between all nodes of an axis of modes: `lines × count × count`, from the one (slow) into the other (fast).
    Blocks(Arc<Vec<f64>>),
}

/// A generator before its columns are laid out: what moves along the lines of every axis.
pub(crate) struct LineRates {
    pub(super) axes: Vec<AxisGeometry>,
    pub(super) strides: Vec<usize>,
    /// One an axis.
    pub(super) rates: Vec<AxisRates>,
    /// Whether there are planes or walls whose fluxes something is added for ([`LineRates::sides`]).
    pub(super) has_sides: bool,
    cells: usize,
}

impl LineRates {
    /// Of axes along which nothing moves yet.
    pub(super) fn new(axes: Vec<AxisGeometry>, cells: usize) -> Self {
        Self {
            strides: strides(&axes),
            rates: Vec::with_capacity(axes.len()),
            has_sides: axes.iter().any(AxisGeometry::has_sides),
            axes,
            cells,
        }
    }

    /// Whether there are planes past which no stencil reaches.
    pub(crate) fn has_breaks(&self) -> bool {
        self.axes.iter().any(|axis| !axis.breaks.is_empty())
    }

    /// Whether the slope of the density jumps at one of them.
    pub(crate) fn has_jumps(&self) -> bool {
        let mut breaks = self.axes.iter().flat_map(|axis| &axis.breaks);
        breaks.any(|at| at.slope_jumps)
    }

    /// Whether there is such a plane across an axis at a coordinate.
    pub(crate) fn is_broken_at(&self, axis: usize, at: f64) -> bool {
        let of_axis = &self.axes[axis];
        let mut breaks = of_axis.breaks.iter();
        breaks.any(|one| {
            let [below, above] = [one.face - 1, one.face].map(|cell| of_axis.nodes[cell]);
            below < at && at < above
        })
    }

    /// The matrix and the escape.
    ///
    /// # Errors
    /// [`GeneratorError::Structure`].
    pub(crate) fn generator(&self) -> Result<Generator, GeneratorError> {
        let n_cells = self.cells;
        let mut starts = Vec::with_capacity(n_cells + 1);
        starts.push(0);
        let mut total = 0;
        let mut place = self.place(0);
        for _ in 0..n_cells {
            total += self.entries(&place);
            starts.push(total);
            self.step(&mut place);
        }
        let mut rows = vec![0_usize; total];
        let mut values = vec![0.0; total];
        let mut escape = vec![0.0; n_cells];
        let mut tasks = Vec::new();
        let (mut rest_rows, mut rest_values) = (rows.as_mut_slice(), values.as_mut_slice());
        for (chunk, escape) in escape.chunks_mut(COLUMNS).enumerate() {
            let first = chunk * COLUMNS;
            let length = starts[first + escape.len()] - starts[first];
            let (row, later_rows) = rest_rows.split_at_mut(length);
            let (value, later_values) = rest_values.split_at_mut(length);
            (rest_rows, rest_values) = (later_rows, later_values);
            tasks.push((first, row, value, escape));
        }
        tasks
            .into_par_iter()
            .for_each(|(first, mut rows, mut values, escape)| {
                let mut place = self.place(first);
                for (offset, escape) in escape.iter_mut().enumerate() {
                    let (row, later_rows) = rows.split_at_mut(self.entries(&place));
                    let (value, later_values) = values.split_at_mut(row.len());
                    (rows, values) = (later_rows, later_values);
                    *escape = self.fill(first + offset, &place, row, value);
                    self.step(&mut place);
                }
            });
        let matrix = CsMat::try_new_csc((n_cells, n_cells), starts, rows, values);
        let matrix = matrix.map_err(|(_, _, _, error)| GeneratorError::Structure {
            n_cells,
            reason: error.to_string(),
        })?;
        Ok(Generator { matrix, escape })
    }

    /// Q x, summed as by the columns of the matrix, to the bit.
    pub(crate) fn product(&self, x: &[f64]) -> Vec<f64> {
        self.product_of(x, |_| true)
    }

    /// The same of some columns.
    pub(super) fn product_of(&self, x: &[f64], wanted: impl Fn(&Coordinates) -> bool) -> Vec<f64> {
        let (mut all_rows, mut all_values) = (Vec::new(), Vec::new());
        let mut product = vec![0.0; x.len()];
        let mut place = self.place(0);
        for (cell, weight) in x.iter().enumerate() {
            if wanted(&place) {
                let entries = self.entries(&place);
                if all_rows.len() < entries {
                    all_rows.resize(entries, 0);
                    all_values.resize(entries, 0.0);
                }
                let (rows, values) = (&mut all_rows[..entries], &mut all_values[..entries]);
                self.fill(cell, &place, rows, values);
                for (&row, value) in rows.iter().zip(&*values) {
                    product[row] += value * weight;
                }
            }
            self.step(&mut place);
        }
        product
    }

    /// The same of what moves along all axes but one.
    pub(super) fn product_across(
        &self,
        x: &[f64],
        axis: usize,
        wanted: impl Fn(&Coordinates) -> bool,
    ) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        let mut place = self.place(0);
        for (cell, weight) in x.iter().enumerate() {
            if wanted(&place) {
                for other in (0..self.axes.len()).filter(|other| *other != axis) {
                    let (stride, own) = (self.strides[other], place[other]);
                    let mut left = 0.0;
                    let reached = self.reached(&place, other);
                    let escape = self.each_rate(&place, other, reached, |to, rate| {
                        if to != own {
                            product[cell + to * stride - own * stride] += rate * weight;
                            left += rate;
                        }
                    });
                    product[cell] -= (left + escape) * weight;
                }
            }
            self.step(&mut place);
        }
        product
    }
}

/// Positions of a cell along all axes.
pub(super) type Coordinates = [usize; MAX_DIMENSION];

impl LineRates {
    /// The place of a cell.
    fn place(&self, cell: usize) -> Coordinates {
        let mut place = [0; MAX_DIMENSION];
        let axes = self.axes.iter().zip(&self.strides);
        for (position, (geometry, stride)) in place.iter_mut().zip(axes) {
            *position = cell / stride % geometry.count();
        }
        place
    }

    /// Goes on to the next cell, without the divisions of [`LineRates::place`].
    fn step(&self, place: &mut Coordinates) {
        for (position, geometry) in place.iter_mut().zip(&self.axes).rev() {
            *position += 1;
            if *position < geometry.count() {
                return;
            }
            *position = 0;
        }
    }

    /// Number of entries of a column.
    fn entries(&self, place: &Coordinates) -> usize {
        let sides = self.sides(place);
        self.entries_of_star(place) + self.entries_of_sides(place, &sides)
    }

    /// Number of cells on the lines through a cell that its column reaches.
    fn entries_of_star(&self, place: &Coordinates) -> usize {
        let axes = 0..self.axes.len();
        1 + axes
            .map(|axis| self.reached(place, axis).len() - 1)
            .sum::<usize>()
    }

    /// Positions along an axis that a column of the matrix may reach.
    pub(super) fn reached(&self, place: &Coordinates, axis: usize) -> Range<usize> {
        let (position, geometry) = (place[axis], &self.axes[axis]);
        let end = (position + geometry.reach + 1).min(geometry.count());
        position.saturating_sub(geometry.reach)..end
    }

    /// Writes a column, rows ascending, and returns its escape rate.
    fn fill(
        &self,
        cell: usize,
        place: &Coordinates,
        rows: &mut [usize],
        values: &mut [f64],
    ) -> f64 {
        let sides = self.sides(place);
        if sides.is_empty() {
            return self.fill_star(cell, place, rows, values);
        }
        let star = self.entries_of_star(place);
        let escape = self.fill_star(cell, place, &mut rows[..star], &mut values[..star]);
        let found = rows[..star]
            .iter()
            .copied()
            .zip(values[..star].iter().copied());
        let mut all: BTreeMap<usize, f64> = found.collect();
        for side in &sides {
            self.each_of_side(cell, place, side, |row, rate| {
                *all.entry(row).or_insert(0.0) += rate
            });
        }
        for ((row, value), found) in rows.iter_mut().zip(values).zip(all) {
            (*row, *value) = found;
        }
        escape
    }

    /// Writes what moves along the lines through a cell.
    fn fill_star(
        &self,
        cell: usize,
        place: &Coordinates,
        rows: &mut [usize],
        values: &mut [f64],
    ) -> f64 {
        let (mut diagonal, mut escape, mut next) = (0.0, 0.0, 0);
        let mut put = |row: usize, entry: f64, next: &mut usize| {
            (rows[*next], values[*next]) = (row, entry);
            diagonal -= entry;
            *next += 1;
        };
        // Below the diagonal the rows rise with the first axis first, above it with the last axis first.
        for axis in 0..self.axes.len() {
            let (stride, position) = (self.strides[axis], place[axis]);
            let below = self.reached(place, axis).start..position;
            escape += self.each_rate(place, axis, below, |to, entry| {
                put(cell - (position - to) * stride, entry, &mut next);
            });
        }
        let middle = next;
        next += 1;
        for axis in (0..self.axes.len()).rev() {
            let (stride, position) = (self.strides[axis], place[axis]);
            let above = position + 1..self.reached(place, axis).end;
            self.each_rate(place, axis, above, |to, entry| {
                put(cell + (to - position) * stride, entry, &mut next);
            });
        }
        rows[middle] = cell;
        // What enters no other cell and does not leave stays.
        values[middle] = diagonal - escape;
        escape
    }

    /// Tells the rates from a cell into the cells at some positions along an axis, and returns the rate into the sink
    /// through the axis's ends.
    pub(super) fn each_rate(
        &self,
        place: &Coordinates,
        axis: usize,
        positions: Range<usize>,
        mut tell: impl FnMut(usize, f64),
    ) -> f64 {
        let (count, position) = (self.axes[axis].count(), place[axis]);
        let others = self.axes.iter().zip(place).enumerate();
        let others = others.filter(|(other, _)| *other != axis);
        let line = others.fold(0, |line, (_, (other, at))| line * other.count() + at);
        let faces = match &self.rates[axis] {
            AxisRates::Blocks(blocks) => {
                let rates = &blocks[(line * count + position) * count..][..count];
                positions.for_each(|to| tell(to, rates[to]));
                return 0.0;
            }
            AxisRates::Fluxes(fluxes) => &fluxes[line * (count + 1)..][..count + 1],
        };
        // Weight of this cell in the flux through a face.
        let weight = |face: usize| {
            let index = (position + REACH).wrapping_sub(face);
            faces[face].get(index).copied().unwrap_or(0.0)
        };
        let mut lower = weight(positions.start);
        for to in positions {
            let upper = weight(to + 1);
            tell(to, lower - upper);
            lower = upper;
        }
        weight(count) - weight(0)
    }
}
