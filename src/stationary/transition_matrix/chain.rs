//! A leaking Markov chain in the form the solvers work on, and the check of a transition matrix.
//!
//! Only the transitions between *different* states are stored, with the total probability to leave each
//! state beside them: (P p - p)_i = Σ_{j≠i} P_ij p_j - leaving_i p_i has no cancellation in its
//! coefficients, however rarely a state is left.

use std::borrow::Cow;

use rayon::prelude::*;

use super::StationaryError;
use crate::sampling::TransitionMatrix;

/// Rows that one task handles: small enough to share the work, large enough to be worth a task.
pub(super) const ROWS_A_TASK: usize = 2048;

/// Columns may miss the sum of one by rounding only.
const COLUMN_TOLERANCE: f64 = 1e-9;

/// A transition matrix that has passed its checks.
pub(super) struct SoundMatrix<'a> {
    starts: Cow<'a, [usize]>,
    columns: &'a [usize],
    values: &'a [f64],
    /// Probability to be in the sink after a step.
    pub(super) escape: &'a [f64],
    /// Number of each row in the cell space.
    pub(super) cells: &'a [usize],
    /// Probability to be elsewhere, sink included, after a step.
    leaving: Vec<f64>,
}

impl<'a> SoundMatrix<'a> {
    /// Checks sizes, order of the cells (all below `n_cells`), signs and column sums.
    pub(super) fn new(
        matrix: &'a TransitionMatrix,
        n_cells: usize,
    ) -> Result<Self, StationaryError> {
        let cells = matrix.cells.len();
        let sizes = [
            ("rows of the matrix", matrix.matrix.rows()),
            ("columns of the matrix", matrix.matrix.cols()),
            ("escape", matrix.escape.len()),
        ];
        for (part, found) in sizes {
            if found != cells {
                return Err(StationaryError::Shape { cells, part, found });
            }
        }
        if !matrix.matrix.is_csr() {
            return Err(StationaryError::Storage);
        }
        let disorder = matrix.cells.windows(2).find(|pair| pair[0] >= pair[1]);
        let outside = matrix.cells.last().filter(|&&cell| cell >= n_cells);
        if let Some(&cell) = disorder.map(|pair| &pair[1]).or(outside) {
            return Err(StationaryError::Cell { cell });
        }
        let mut checked = Self {
            starts: matrix.matrix.proper_indptr(),
            columns: matrix.matrix.indices(),
            values: matrix.matrix.data(),
            escape: &matrix.escape,
            cells: &matrix.cells,
            leaving: Vec::new(),
        };
        checked.leaving = checked.leaving_probabilities()?;
        Ok(checked)
    }

    /// Number of cells.
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    /// Entries (source, probability) of a row.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.starts[row]..self.starts[row + 1];
        let columns = self.columns[range.clone()].iter();
        columns
            .copied()
            .zip(self.values[range].iter().copied())
            .filter(|entry| entry.1 > 0.0)
    }

    /// Off-diagonal column sums, sink included; finds columns that are not probabilities.
    fn leaving_probabilities(&self) -> Result<Vec<f64>, StationaryError> {
        let probability = |value: f64| if value >= 0.0 { value } else { f64::NAN };
        let mut leaving: Vec<f64> = self.escape.iter().map(|&e| probability(e)).collect();
        let mut staying = vec![0.0; self.len()];
        for row in 0..self.len() {
            let range = self.starts[row]..self.starts[row + 1];
            for (&column, &value) in self.columns[range.clone()].iter().zip(&self.values[range]) {
                if row == column {
                    staying[column] += probability(value);
                } else {
                    leaving[column] += probability(value);
                }
            }
        }
        for (column, &cell) in self.cells.iter().enumerate() {
            let sum = leaving[column] + staying[column];
            let sound = (sum - 1.0).abs() <= COLUMN_TOLERANCE;
            if !sound {
                return Err(StationaryError::Column { cell, sum });
            }
        }
        Ok(leaving)
    }

    /// The chain on some of the rows, in the given order. What goes from them to other rows counts as
    /// leaving but is lost; pick a set that is only left through the sink.
    pub(super) fn restriction(&self, order: &[usize]) -> Chain {
        const ABSENT: u32 = u32::MAX;
        let mut place = vec![ABSENT; self.len()];
        for (state, &row) in order.iter().enumerate() {
            place[row] = state as u32;
        }
        let rows = |rows: &[usize]| {
            let (mut lengths, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
            for &row in rows {
                let before = columns.len();
                for (column, value) in self.row(row) {
                    if column != row && place[column] != ABSENT {
                        columns.push(place[column]);
                        values.push(value);
                    }
                }
                lengths.push(columns.len() - before);
            }
            (lengths, columns, values)
        };
        let parts: Vec<_> = order.par_chunks(ROWS_A_TASK).map(rows).collect();
        let mut chain = Chain {
            starts: vec![0],
            columns: Vec::with_capacity(parts.iter().map(|part| part.1.len()).sum()),
            values: Vec::with_capacity(parts.iter().map(|part| part.2.len()).sum()),
            escape: order.iter().map(|&row| self.escape[row]).collect(),
            leaving: order.iter().map(|&row| self.leaving[row]).collect(),
        };
        let mut end = 0;
        for (lengths, columns, values) in parts {
            for length in lengths {
                end += length;
                chain.starts.push(end);
            }
            chain.columns.extend(columns);
            chain.values.extend(values);
        }
        chain
    }
}

/// A Markov chain with sink, without the diagonal of its transition matrix.
#[derive(Debug, Clone, Default)]
pub(super) struct Chain {
    /// `starts[i]..starts[i + 1]` are the entries of row i, the transitions into state i.
    pub(super) starts: Vec<usize>,
    /// Source of each transition.
    pub(super) columns: Vec<u32>,
    /// Probability of each transition.
    pub(super) values: Vec<f64>,
    /// Probability of each state to go to the sink.
    pub(super) escape: Vec<f64>,
    /// Probability of each state to go anywhere else, sink included.
    pub(super) leaving: Vec<f64>,
}

impl Chain {
    /// Number of states.
    pub(super) fn len(&self) -> usize {
        self.escape.len()
    }

    /// Σ_{j≠i} P_ij p_j.
    pub(super) fn inflow(&self, state: usize, p: &[f64]) -> f64 {
        let range = self.starts[state]..self.starts[state + 1];
        let entries = self.columns[range.clone()].iter().zip(&self.values[range]);
        entries.map(|(&from, value)| value * p[from as usize]).sum()
    }

    /// out = P p, parallel over rows; each sum has its own fixed order.
    pub(super) fn apply(&self, p: &[f64], out: &mut [f64]) {
        let product = |(task, rows): (usize, &mut [f64])| {
            for (row, value) in rows.iter_mut().enumerate() {
                let state = task * ROWS_A_TASK + row;
                *value = self.inflow(state, p) + (1.0 - self.leaving[state]) * p[state];
            }
        };
        out.par_chunks_mut(ROWS_A_TASK)
            .enumerate()
            .for_each(product);
    }

    /// Mass that goes to the sink in one step.
    pub(super) fn escaping(&self, p: &[f64]) -> f64 {
        self.escape.iter().zip(p).map(|(e, p)| e * p).sum()
    }

    /// L1 norm of P p - λ p with λ = 1 - (escaping mass), for Σ p = 1.
    pub(super) fn residual(&self, p: &[f64]) -> f64 {
        let escaping = self.escaping(p);
        let defect = |state: usize| {
            (self.inflow(state, p) - (self.leaving[state] - escaping) * p[state]).abs()
        };
        let parts: Vec<f64> = (0..self.len()).into_par_iter().map(defect).collect();
        parts.iter().sum()
    }
}

/// Scales masses to Σ = 1 after lifting each to at least `floor`; non-finite ones become `floor`.
pub(super) fn normalise(p: &mut [f64], floor: f64) {
    for value in p.iter_mut() {
        *value = if value.is_finite() {
            value.max(floor)
        } else {
            floor
        };
    }
    let total: f64 = p.iter().sum();
    for value in p.iter_mut() {
        *value /= total;
    }
}
