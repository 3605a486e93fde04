//! The generator of a process that ends, as it is handed on: entries, and the rates at which it ends.

use sprs::CsMat;

use crate::MAX_DIMENSION;

/// A part of the rate at which a process ends from a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ending {
    /// The cell inside the region that is entered, or the last one before the end of the range.
    pub cell: usize,
    /// The axis through whose end the process leaves the range, and whether it is the upper end; `None` where it enters
    /// the region.
    pub end: Option<(usize, bool)>,
    /// The cell from which.
    pub source: usize,
    /// Rate, per unit time.
    pub rate: f64,
}

/// What a density that is not zero on the border of a region does to the cells beside it: with v its value at a state
/// there, rates times v come into cells, and sums count weights times v more.
#[derive(Debug, Clone)]
pub(crate) struct BorderValue {
    /// The state on the border; the first entries count, one an axis.
    pub state: [f64; MAX_DIMENSION],
    /// Cells and rates, each any number of times.
    pub rates: Vec<(usize, f64)>,
    /// Weights of sums, in two ways as those of cells are.
    pub sum: [f64; 2],
}

/// The generator on the cells outside of a region.
#[derive(Debug, Clone)]
pub(crate) struct AbsorbingGenerator {
    /// Entries of Q, `n × n` over all cells of the space, per unit time: row, column, rate. A place may have several,
    /// which sum. Cells inside the region are coupled to none, and have one.
    pub rates: Vec<(usize, usize, f64)>,
    /// Which cells are outside of the region: their nodes are.
    pub kept: Vec<bool>,
    /// Rate at which the process ends from a cell: it enters the region, or leaves the range of the cells.
    pub ends: Vec<f64>,
    /// Parts of that, which sum to it.
    pub endings: Vec<Ending>,
    /// Weights with which the unknowns sum to the mass outside of the region: zero inside, one away from the border,
    /// where the density does not end between two nodes. In two ways, which differ where the border is oblique.
    pub weights: [Vec<f64>; 2],
    /// What a density on the border would do, of every place where a line of the grid crosses it.
    pub on_border: Vec<BorderValue>,
}

impl AbsorbingGenerator {
    /// Q by columns.
    pub(crate) fn matrix(&self) -> CsMat<f64> {
        let cells = self.kept.len();
        // Entries by their columns.
        let mut starts = vec![0; cells + 1];
        for &(_, column, _) in &self.rates {
            starts[column + 1] += 1;
        }
        for column in 0..cells {
            starts[column + 1] += starts[column];
        }
        let mut places = starts.clone();
        let mut sorted = vec![(0, 0.0); self.rates.len()];
        for &(row, column, rate) in &self.rates {
            sorted[places[column]] = (row, rate);
            places[column] += 1;
        }
        let mut sums = vec![0.0; cells];
        let mut seen = vec![usize::MAX; cells];
        let (mut ends, mut rows, mut data) = (vec![0], Vec::new(), Vec::new());
        for column in 0..cells {
            let first = rows.len();
            for &(row, rate) in &sorted[starts[column]..starts[column + 1]] {
                if seen[row] != column {
                    seen[row] = column;
                    sums[row] = 0.0;
                    rows.push(row);
                }
                sums[row] += rate;
            }
            rows[first..].sort_unstable();
            data.extend(rows[first..].iter().map(|&row: &usize| sums[row]));
            ends.push(rows.len());
        }
        CsMat::new_csc((cells, cells), ends, rows, data)
    }
}

/// What another generator on the same cells differs by.
#[derive(Debug, Clone, Default)]
pub(crate) struct RateChange {
    /// Changes of entries of Q, any number of them for a place, which sum.
    pub rates: Vec<(usize, usize, f64)>,
    /// Changes of the rates at which the process ends from a cell.
    pub ends: Vec<f64>,
    /// Parts of those.
    pub endings: Vec<Ending>,
}
