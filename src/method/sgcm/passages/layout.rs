//! The cells on which functions are linear: those of a map, or several of them as one.

use std::collections::HashMap;

use super::map::PassageMap;
use crate::MAX_DIMENSION;
use crate::space::CellSpace;

/// The cells on which functions are linear: those of the map, or pairs of them along every axis.
pub(super) struct Layout {
    /// The cell in which one of the map lies, and along each axis its width and its middle in that cell's coordinate.
    pub(super) cells: Vec<(u32, [(f64, f64); MAX_DIMENSION])>,
    /// Cells of the map that lie in each of the layout.
    pub(super) members: Vec<Vec<u32>>,
    /// Numbers of a linear function.
    pub(super) width: usize,
}

impl Layout {
    /// Cells of the map, with `merge` of them in a row along every axis as one.
    pub(super) fn new(space: &CellSpace, map: &PassageMap, merge: usize) -> Self {
        let mut places = HashMap::new();
        let mut members: Vec<Vec<u32>> = Vec::new();
        let mut cells = Vec::with_capacity(map.cells.len());
        for (place, &cell) in map.cells.iter().enumerate() {
            let (mut number, mut parts) = (0, [(1.0, 0.0); MAX_DIMENSION]);
            for (axis, edges) in space.axes().iter().enumerate() {
                let position = space.position(cell, axis);
                let first = position / merge * merge;
                let last = (first + merge).min(edges.count());
                let (low, high) = (edges.edges()[first], edges.edges()[last]);
                let middle = 0.5 * (low + high);
                let centre = 0.5 * (edges.edges()[position] + edges.edges()[position + 1]);
                let width = edges.width(position);
                parts[axis] = (width / (high - low), (centre - middle) / (high - low));
                number = number * edges.count() + first;
            }
            let next = members.len() as u32;
            let of = *places.entry(number).or_insert(next);
            if of == next {
                members.push(Vec::new());
            }
            members[of as usize].push(place as u32);
            cells.push((of, parts));
        }
        Self {
            cells,
            members,
            width: map.dimension + 1,
        }
    }

    /// Σ (1, u) ⊗ … in the coordinates of the layout, from rows of so many numbers in those of a cell.
    pub(super) fn moved(&self, cell: usize, rows: &[f64], count: usize) -> Vec<f64> {
        let mut moved = rows.to_vec();
        for p in 1..self.width {
            let (scale, shift) = self.cells[cell].1[p - 1];
            for number in 0..count {
                moved[p * count + number] = scale * rows[p * count + number] + shift * rows[number];
            }
        }
        moved
    }

    /// The same of columns.
    pub(super) fn moved_end(&self, cell: usize, block: &mut [f64]) {
        for row in block.chunks_exact_mut(self.width) {
            for q in 1..self.width {
                let (scale, shift) = self.cells[cell].1[q - 1];
                row[q] = scale * row[q] + shift * row[0];
            }
        }
    }
}
