//! Null vector of a generator by banded elimination, for tests: slow, simple, and independent of the solvers.

use sprs::CsMat;

/// The vector u with Q u = 0 in every row but `fixed`, Σ u = 1, refined until it stands still.
pub(super) fn null_vector(generator: &CsMat<f64>, fixed: usize) -> Vec<f64> {
    let n = generator.rows();
    let entries = || {
        let columns = generator.outer_iterator().enumerate();
        columns.flat_map(|(column, entries)| {
            let entries: Vec<_> = entries.iter().map(|(row, value)| (row, *value)).collect();
            entries
                .into_iter()
                .map(move |(row, value)| (row, column, value))
        })
    };
    let width = entries()
        .map(|(row, column, _)| row.abs_diff(column))
        .max()
        .unwrap();
    let stored = 2 * width + 1;
    let mut band = vec![0.0; n * stored];
    let mut right = vec![0.0; n];
    for (row, column, value) in entries().filter(|entry| entry.0 != fixed) {
        if column == fixed {
            right[row] -= value;
        } else {
            band[row * stored + column + width - row] = value;
        }
    }
    band[fixed * stored + width] = 1.0;
    right[fixed] = 1.0;
    eliminate(&mut band, width);
    let mut unknowns = right.clone();
    substitute(&band, width, &mut unknowns);
    for _ in 0..10 {
        let mut residual = vec![0.0; n];
        for (row, column, value) in entries() {
            residual[row] -= value * unknowns[column];
        }
        residual[fixed] = 0.0;
        substitute(&band, width, &mut residual);
        for (unknown, change) in unknowns.iter_mut().zip(&residual) {
            *unknown += change;
        }
        let size = |values: &[f64]| values.iter().map(|value| value.abs()).sum::<f64>();
        if size(&residual) < 1e-12 * size(&unknowns) {
            let total: f64 = unknowns.iter().sum();
            return unknowns.iter().map(|value| value / total).collect();
        }
    }
    panic!("banded elimination without pivoting did not converge");
}

/// LU factors in place, without pivoting.
fn eliminate(band: &mut [f64], width: usize) {
    let stored = 2 * width + 1;
    let n = band.len() / stored;
    for pivot in 0..n {
        let (above, below) = band.split_at_mut((pivot + 1) * stored);
        let pivot_row = &above[pivot * stored..];
        let later = below.chunks_mut(stored).take(width).enumerate();
        for (row, values) in later.map(|(offset, values)| (offset + 1, values)) {
            let factor = values[width - row] / pivot_row[width];
            values[width - row] = factor;
            if factor != 0.0 {
                let targets = &mut values[width - row + 1..=2 * width - row];
                for (target, value) in targets.iter_mut().zip(&pivot_row[width + 1..]) {
                    *target -= factor * value;
                }
            }
        }
    }
}

/// Solves with the factors, in place.
fn substitute(band: &[f64], width: usize, values: &mut [f64]) {
    let stored = 2 * width + 1;
    let n = values.len();
    for row in 0..n {
        let first = row.saturating_sub(width);
        let factors = &band[row * stored + first + width - row..row * stored + width];
        let sum: f64 = factors
            .iter()
            .zip(&values[first..row])
            .map(|(a, b)| a * b)
            .sum();
        values[row] -= sum;
    }
    for row in (0..n).rev() {
        let last = (row + width).min(n - 1);
        let factors = &band[row * stored + width + 1..=row * stored + last + width - row];
        let sum: f64 = factors
            .iter()
            .zip(&values[row + 1..=last])
            .map(|(a, b)| a * b)
            .sum();
        values[row] = (values[row] - sum) / band[row * stored + width];
    }
}
