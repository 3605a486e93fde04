//! Linear equations of which each has unknowns near its own number alone.

/// Unknowns before and behind an equation's own that it may have.
pub(super) const REACH: usize = 5;

/// Places of a row: exchanged rows reach twice as far behind.
const WIDTH: usize = 3 * REACH + 1;

/// Equations A x = b with a band of [`REACH`] on either side.
#[derive(Debug, Clone)]
pub(super) struct Banded {
    /// Row i holds A(i, j) at j - i + REACH.
    rows: Vec<[f64; WIDTH]>,
    right: Vec<f64>,
}

impl Banded {
    /// So many equations, all zero.
    pub(super) fn new(count: usize) -> Self {
        Self {
            rows: vec![[0.0; WIDTH]; count],
            right: vec![0.0; count],
        }
    }

    /// Adds to A(row, column), which must lie in the band; nothing where there is no such column.
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        if column < self.rows.len() {
            self.rows[row][column + REACH - row] += value;
        }
    }

    /// Adds to b.
    pub(super) fn add_right(&mut self, row: usize, value: f64) {
        self.right[row] += value;
    }

    /// The solution, by elimination with exchange of rows; not finite where the equations are singular.
    pub(super) fn solve(mut self) -> Vec<f64> {
        let count = self.rows.len();
        for pivot in 0..count {
            let below = pivot..count.min(pivot + REACH + 1);
            let size = |row: usize| self.rows[row][pivot + REACH - row].abs();
            let largest = below.clone().max_by(|&a, &b| size(a).total_cmp(&size(b)));
            let largest = largest.unwrap_or(pivot);
            let columns = pivot..count.min(pivot + 2 * REACH + 1);
            if largest != pivot {
                for column in columns.clone() {
                    let (a, b) = (column + REACH - pivot, column + REACH - largest);
                    let own = self.rows[pivot][a];
                    self.rows[pivot][a] = std::mem::replace(&mut self.rows[largest][b], own);
                }
                self.right.swap(pivot, largest);
            }
            for row in below.skip(1) {
                let factor = self.rows[row][pivot + REACH - row] / self.rows[pivot][REACH];
                if factor == 0.0 {
                    continue;
                }
                for column in columns.clone() {
                    let own = self.rows[pivot][column + REACH - pivot];
                    self.rows[row][column + REACH - row] -= factor * own;
                }
                self.right[row] -= factor * self.right[pivot];
            }
        }
        let mut found = self.right;
        for row in (0..count).rev() {
            let behind = row + 1..count.min(row + 2 * REACH + 1);
            let known = behind.map(|column| self.rows[row][column + REACH - row] * found[column]);
            let known: f64 = known.sum();
            found[row] = (found[row] - known) / self.rows[row][REACH];
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::{Banded, REACH};

    #[test]
    fn equations_that_need_exchanged_rows_are_solved() {
        let count = 23;
        let entry = |row: usize, column: usize| match row == column {
            true => 1e-9,
            false => ((7 * row + 3 * column) as f64).sin(),
        };
        let exact = |column: usize| (0.7 * column as f64).cos();
        let mut equations = Banded::new(count);
        for row in 0..count {
            for column in row.saturating_sub(REACH)..count.min(row + REACH + 1) {
                equations.add(row, column, entry(row, column));
                equations.add_right(row, entry(row, column) * exact(column));
            }
        }
        for (column, found) in equations.solve().into_iter().enumerate() {
            assert!((found - exact(column)).abs() < 1e-11, "{column}: {found}");
        }
    }
}
