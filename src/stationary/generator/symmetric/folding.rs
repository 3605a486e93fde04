//! Whether a generator is symmetric, and the same generator on half of the cells.

use sprs::CsMat;

use crate::space::{Axis, CellSpace};

/// Deviation from symmetry, relative to the largest rate (or change), that is rounding.
const ROUNDING: f64 = 1e-11;

/// Whether rates and escape are the same counted from the other end.
pub(super) fn is_centrosymmetric(matrix: &CsMat<f64>, escape: &[f64]) -> bool {
    let (rows, rates) = (matrix.indices(), matrix.data());
    let Some(last) = matrix.rows().checked_sub(1) else {
        return false;
    };
    let starts = matrix.indptr();
    let starts = starts.raw_storage();
    let mirrored = |values: &[usize], sum: usize| {
        let pairs = values.iter().zip(values.iter().rev());
        pairs
            .take(values.len().div_ceil(2))
            .all(|(a, b)| a + b == sum)
    };
    mirrored(starts, rates.len())
        && mirrored(rows, last)
        && is_symmetric(rates)
        && is_symmetric(escape)
}

/// Whether numbers are the same from the other end, to rounding of the largest.
pub(super) fn is_symmetric(values: &[f64]) -> bool {
    let largest = values
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    let pairs = values.iter().zip(values.iter().rev());
    let mut half = pairs.take(values.len() / 2);
    half.all(|(a, b)| (a - b).abs() <= ROUNDING * largest)
}

/// The upper half of the cells along one axis, each standing for itself and its mirror image.
pub(super) struct Folding {
    /// The axis that is halved.
    pub(super) axis: usize,
    /// The half. Of its axes only the numbers of cells mean anything.
    pub(super) half: CellSpace,
    /// The cell of the whole space that each cell of the half is, ascending.
    upper: Vec<u32>,
    /// The cell of the half that each cell of the whole is, or is the image of.
    place: Vec<u32>,
}

impl Folding {
    /// Halves the longest axis of cells with an even number of them.
    pub(super) fn new(space: &CellSpace) -> Option<Self> {
        let axes = space.axes().iter().enumerate();
        let even = axes.filter(|(_, axis)| !axis.is_modes() && axis.count() % 2 == 0);
        let (axis, longest) = even.max_by_key(|(_, axis)| axis.count())?;
        let middle = longest.count() / 2;
        let mut axes = space.axes().to_vec();
        axes[axis] = Axis::uniform(0.0, 1.0, middle).ok()?;
        let half = CellSpace::new(axes).ok()?;
        let cells = 0..space.n_cells();
        let upper: Vec<u32> = cells
            .filter(|&cell| space.position(cell, axis) >= middle)
            .map(|cell| cell as u32)
            .collect();
        let mut place = vec![0; space.n_cells()];
        for (index, &cell) in upper.iter().enumerate() {
            let cell = cell as usize;
            place[cell] = index as u32;
            place[space.n_cells() - 1 - cell] = index as u32;
        }
        Some(Self {
            axis,
            half,
            upper,
            place,
        })
    }

    /// Sums of cells and their images.
    pub(super) fn fold(&self, values: &[f64]) -> Vec<f64> {
        let last = values.len() - 1;
        let sum = |&cell: &u32| values[cell as usize] + values[last - cell as usize];
        self.upper.iter().map(sum).collect()
    }

    /// Shares a cell's value with its image.
    pub(super) fn unfold(&self, values: &[f64]) -> Vec<f64> {
        let share = |&index: &u32| 0.5 * values[index as usize];
        self.place.iter().map(share).collect()
    }

    /// The generator of the sums, and their escape.
    pub(super) fn generator(&self, matrix: &CsMat<f64>, escape: &[f64]) -> (CsMat<f64>, Vec<f64>) {
        let cells = self.upper.len();
        let starts = matrix.indptr();
        let starts = starts.raw_storage();
        let (mut start, mut rows, mut rates) = (vec![0], Vec::new(), Vec::new());
        let mut column: Vec<(usize, f64)> = Vec::new();
        for &cell in &self.upper {
            let entries = starts[cell as usize]..starts[cell as usize + 1];
            column.clear();
            column.extend(entries.map(|entry| {
                let row = self.place[matrix.indices()[entry]] as usize;
                (row, matrix.data()[entry])
            }));
            column.sort_by_key(|entry| entry.0);
            let first = rows.len();
            for &(row, rate) in &column {
                match rates.last_mut() {
                    Some(last) if rows.len() > first && rows.last() == Some(&row) => *last += rate,
                    _ => {
                        rows.push(row);
                        rates.push(rate);
                    }
                }
            }
            start.push(rows.len());
        }
        let escape = self.upper.iter().map(|&cell| escape[cell as usize]);
        (
            CsMat::new_csc((cells, cells), start, rows, rates),
            escape.collect(),
        )
    }
}
