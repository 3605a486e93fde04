//! The rate at which a process ends that has lasted long: the least eigenvalue of -Q, from the vectors that moments
//! need.
//!
//! Each vector is -Q⁻¹ times the one before. They turn toward the quasi-stationary density, and the largest eigenvalue
//! of -Q⁻¹ on the space that they span comes near 1/r much sooner than the last of them does.

use nalgebra::DMatrix;

use super::dot;

/// Largest eigenvalue of an operator on the span of all given vectors but the last, each the operator times the one
/// before; `None` where none is real and positive.
pub(super) fn largest_eigenvalue(powers: &[Vec<f64>]) -> Option<f64> {
    let size = powers.len().checked_sub(1).filter(|&size| size > 0)?;
    let mut basis: Vec<Vec<f64>> = Vec::new();
    // w_j = Σ_i basis_i triangle(i, j), for vectors of length one.
    let mut triangle = DMatrix::<f64>::zeros(size, size);
    let lengths: Vec<f64> = powers
        .iter()
        .map(|vector| dot(vector, vector).sqrt())
        .collect();
    for (column, (vector, length)) in powers.iter().zip(&lengths).take(size).enumerate() {
        let mut rest: Vec<f64> = vector.iter().map(|value| value / length).collect();
        for _ in 0..2 {
            for (row, known) in basis.iter().enumerate() {
                let overlap = dot(known, &rest);
                triangle[(row, column)] += overlap;
                rest.iter_mut()
                    .zip(known)
                    .for_each(|(x, y)| *x -= overlap * y);
            }
        }
        let left = dot(&rest, &rest).sqrt();
        triangle[(column, column)] = left;
        if left.partial_cmp(&1e-10) != Some(std::cmp::Ordering::Greater) {
            // The vectors before span all there is.
            return match column {
                0 => None,
                _ => largest_eigenvalue(&powers[..=column]),
            };
        }
        rest.iter_mut().for_each(|value| *value /= left);
        basis.push(rest);
    }
    // The operator times w_j is w_{j + 1}.
    let image = DMatrix::from_fn(size, size, |row, column| {
        dot(&basis[row], &powers[column + 1]) / lengths[column]
    });
    let inverse = triangle.try_inverse()?;
    let projected = image * inverse;
    // Eigenvalues of a matrix that is not finite are looked for without end.
    projected
        .iter()
        .all(|entry| entry.is_finite())
        .then_some(())?;
    let eigenvalues = projected.complex_eigenvalues();
    let real = eigenvalues
        .iter()
        .filter(|one| one.im.abs() <= 1e-9 * one.re);
    real.map(|one| one.re).max_by(f64::total_cmp)
}
