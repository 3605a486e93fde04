//! The columns of the generator from the fluxes of the grid lines.

use rayon::prelude::*;
use sprs::CsMat;

use super::geometry::AxisGeometry;
use super::scheme::{REACH, Window};
use super::{Generator, GeneratorError};

/// Columns that are filled as one task.
const COLUMNS: usize = 2048;

/// Everything a column needs.
struct Columns<'a> {
    axes: &'a [AxisGeometry],
    strides: &'a [usize],
    fluxes: &'a [Vec<Window>],
}

/// Fills the matrix from the fluxes of all lines along every axis.
pub(super) fn columns(
    axes: &[AxisGeometry],
    strides: &[usize],
    fluxes: &[Vec<Window>],
    n_cells: usize,
) -> Result<Generator, GeneratorError> {
    let columns = Columns {
        axes,
        strides,
        fluxes,
    };
    let mut starts = Vec::with_capacity(n_cells + 1);
    starts.push(0);
    let mut total = 0;
    for cell in 0..n_cells {
        total += columns.entries(cell);
        starts.push(total);
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
            for (offset, escape) in escape.iter_mut().enumerate() {
                let (row, later_rows) = rows.split_at_mut(columns.entries(first + offset));
                let (value, later_values) = values.split_at_mut(row.len());
                (rows, values) = (later_rows, later_values);
                *escape = columns.fill(first + offset, row, value);
            }
        });
    let matrix = CsMat::try_new_csc((n_cells, n_cells), starts, rows, values);
    let matrix = matrix.map_err(|(_, _, _, error)| GeneratorError::Structure {
        n_cells,
        reason: error.to_string(),
    })?;
    Ok(Generator { matrix, escape })
}

impl Columns<'_> {
    fn position(&self, cell: usize, axis: usize) -> usize {
        cell / self.strides[axis] % self.axes[axis].count()
    }

    /// Number of entries of a column.
    fn entries(&self, cell: usize) -> usize {
        let along = |(axis, geometry): (usize, &AxisGeometry)| {
            let position = self.position(cell, axis);
            position.min(geometry.reach) + (geometry.count() - 1 - position).min(geometry.reach)
        };
        1 + self.axes.iter().enumerate().map(along).sum::<usize>()
    }

    /// Writes a column, rows ascending, and returns its escape rate.
    fn fill(&self, cell: usize, rows: &mut [usize], values: &mut [f64]) -> f64 {
        let (mut diagonal, mut escape) = (0.0, 0.0);
        let mut next = 0;
        // Below the diagonal the rows rise with the first axis first, above it with the last axis first.
        for axis in 0..self.axes.len() {
            let window = self.window(cell, axis);
            for (distance, entry) in window.0.iter().enumerate().take(REACH) {
                if let Some(entry) = entry {
                    rows[next] = cell - (REACH - distance) * self.strides[axis];
                    values[next] = *entry;
                    diagonal -= entry;
                    next += 1;
                }
            }
            escape += window.1;
        }
        let place = next;
        next += 1;
        for axis in (0..self.axes.len()).rev() {
            let window = self.window(cell, axis);
            for (distance, entry) in window.0.iter().enumerate().skip(REACH + 1) {
                if let Some(entry) = entry {
                    rows[next] = cell + (distance - REACH) * self.strides[axis];
                    values[next] = *entry;
                    diagonal -= entry;
                    next += 1;
                }
            }
        }
        rows[place] = cell;
        // What enters no other cell and does not leave stays.
        values[place] = diagonal - escape;
        escape
    }

    /// Rates from a cell into the cells along an axis (`None` past the ends), and into the sink through its ends.
    fn window(&self, cell: usize, axis: usize) -> ([Option<f64>; 2 * REACH + 1], f64) {
        let geometry = &self.axes[axis];
        let (count, stride, reach) = (geometry.count(), self.strides[axis], geometry.reach);
        let position = self.position(cell, axis);
        let (outer, inner) = (cell / (stride * count), cell % stride);
        let start = (outer * stride + inner) * (count + 1);
        let faces = &self.fluxes[axis][start..start + count + 1];
        // Weight of this cell in the flux through a face.
        let weight = |face: usize| {
            let place = (position + REACH).wrapping_sub(face);
            if place < 2 * REACH {
                faces[face][place]
            } else {
                0.0
            }
        };
        let mut window = [None; 2 * REACH + 1];
        for (place, entry) in window.iter_mut().enumerate() {
            let row = (position + place).wrapping_sub(REACH);
            if row < count && row.abs_diff(position) <= reach {
                *entry = Some(weight(row) - weight(row + 1));
            }
        }
        (window, weight(count) - weight(0))
    }
}
