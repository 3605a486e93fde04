//! Solves x = b + K x, and finds the largest eigenvalue of K on the way (GMRES and Arnoldi's method in one).

use nalgebra::DMatrix;

use super::operator::Operator;
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::dot;
use crate::stationary::Triangle;

/// Size of the residual, over that of b, at which a solution is good enough.
const REDUCTION: f64 = 1e-10;

/// Vectors between two starts, and starts.
const VECTORS: usize = 250;
const STARTS: usize = 8;

/// A start that takes less than this from the residual is the last one.
const PROGRESS: f64 = 0.5;

/// A solution.
pub(super) struct LinearSolution {
    pub(super) function: Vec<f64>,
    /// Size of the residual over that of b.
    pub(super) residual: f64,
    /// One minus the largest eigenvalue of K.
    pub(super) loss: f64,
}

/// x = b + K x.
pub(super) fn solve(
    operator: &Operator,
    b: &[f64],
    cancellation: &Cancellation,
) -> Result<LinearSolution, Cancelled> {
    let size = dot(b, b).sqrt();
    let mut solved = LinearSolution {
        function: vec![0.0; b.len()],
        residual: if size > 0.0 { 1.0 } else { 0.0 },
        loss: f64::NAN,
    };
    let mut left = b.to_vec();
    for _ in 0..STARTS {
        if solved.residual <= REDUCTION {
            break;
        }
        let (change, loss) = cycle(operator, &left, REDUCTION * size, cancellation)?;
        let changed: Vec<f64> = solved
            .function
            .iter()
            .zip(&change)
            .map(|(a, b)| a + b)
            .collect();
        let after = operator.apply(&changed);
        let parts = b.iter().zip(&changed).zip(&after);
        let next: Vec<f64> = parts.map(|((b, x), after)| b - x + after).collect();
        let residual = dot(&next, &next).sqrt() / size;
        // The largest eigenvalue stands in the first vectors already; later ones know more of small ones.
        solved.loss = solved.loss.min(loss);
        let is_quick = residual < PROGRESS * solved.residual;
        if residual < solved.residual {
            (solved.function, solved.residual, left) = (changed, residual, next);
        }
        if !is_quick {
            break;
        }
    }
    Ok(solved)
}

/// What the smallest residual in a space of Krylov's adds to x, and the eigenvalue of I - K nearest to zero in it.
fn cycle(
    operator: &Operator,
    left: &[f64],
    wanted: f64,
    cancellation: &Cancellation,
) -> Result<(Vec<f64>, f64), Cancelled> {
    let size = dot(left, left).sqrt();
    let mut vectors = vec![scaled(left, 1.0 / size)];
    let mut triangle = Triangle::new(size);
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let weights = loop {
        cancellation.check()?;
        let last = &vectors[vectors.len() - 1];
        let after = operator.apply(last);
        let mut next: Vec<f64> = last
            .iter()
            .zip(&after)
            .map(|(x, after)| x - after)
            .collect();
        let before = dot(&next, &next).sqrt();
        let mut column = vec![0.0; vectors.len()];
        // Twice is enough.
        for _ in 0..2 {
            for (overlap, vector) in column.iter_mut().zip(&vectors) {
                let more = dot(&next, vector);
                *overlap += more;
                for (value, other) in next.iter_mut().zip(vector) {
                    *value -= more * other;
                }
            }
        }
        let length = dot(&next, &next).sqrt();
        let has_more = length > 1e-14 * before;
        let below = if has_more { length } else { 0.0 };
        let residual = triangle.push(column.clone(), below);
        column.push(below);
        columns.push(column);
        if !has_more || columns.len() == VECTORS || residual <= 0.5 * wanted {
            break triangle.solve().0;
        }
        vectors.push(scaled(&next, 1.0 / length));
    };
    let mut change = vec![0.0; left.len()];
    for (weight, vector) in weights.iter().zip(&vectors) {
        for (value, other) in change.iter_mut().zip(vector) {
            *value += weight * other;
        }
    }
    Ok((change, least_eigenvalue(&columns)))
}

fn scaled(vector: &[f64], scale: f64) -> Vec<f64> {
    vector.iter().map(|value| scale * value).collect()
}

/// The least real part of the eigenvalues of a Hessenberg matrix, by its columns down to the entry below the diagonal.
fn least_eigenvalue(columns: &[Vec<f64>]) -> f64 {
    let n = columns.len();
    let entry = |row: usize, column: usize| columns[column].get(row).copied().unwrap_or(0.0);
    let values = DMatrix::from_fn(n, n, entry).complex_eigenvalues();
    values.iter().map(|value| value.re).fold(f64::NAN, f64::min)
}
