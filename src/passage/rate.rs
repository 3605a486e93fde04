//! The rate at which a process ends that has lasted long: the least eigenvalue of -Q.
//!
//! -Q⁻¹ turns any start toward the quasi-stationary density. The largest eigenvalue of -Q⁻¹ on the space that a start
//! and its images span (W. E. Arnoldi 1951) comes near 1/r much sooner than the last image is near that density.

use nalgebra::{DMatrix, DVector};

use super::dot;

/// Relative change of the rate by one more vector at which it stands.
const TOLERANCE: f64 = 1e-6;

/// Most vectors that are made for a rate.
const VECTORS: usize = 24;

/// A new vector this small, relative to what it was before the others were taken out of it, is rounding.
const NOTHING: f64 = 1e-10;

/// Distance of the shift of inverse iteration from an eigenvalue that is known, as a factor.
const BESIDE: f64 = 1.0 + 1e-9;

/// Steps of inverse iteration.
const INVERSE_STEPS: usize = 2;

/// The rate, and its density of any length and sign; `image` is -Q⁻¹ times a vector. The rate is 0 where no eigenvalue
/// is real and positive.
///
/// # Errors
/// Those of `image`.
pub(super) fn slowest<E>(
    start: &[f64],
    mut image: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<(f64, Vec<f64>), E> {
    let length = dot(start, start).sqrt();
    let mut basis = vec![
        start
            .iter()
            .map(|value| value / length)
            .collect::<Vec<f64>>(),
    ];
    // image(basis_j) = Σ_i projected(i, j) basis_i.
    let mut projected = DMatrix::<f64>::zeros(VECTORS + 1, VECTORS);
    let mut rate = 0.0;
    for column in 0..VECTORS {
        let mut next = image(&basis[column])?;
        let size = dot(&next, &next).sqrt();
        for _ in 0..2 {
            for (row, known) in basis.iter().enumerate() {
                let overlap = dot(known, &next);
                projected[(row, column)] += overlap;
                next.iter_mut()
                    .zip(known)
                    .for_each(|(x, y)| *x -= overlap * y);
            }
        }
        let left = dot(&next, &next).sqrt();
        projected[(column + 1, column)] = left;
        let used = column + 1;
        let time = largest(&projected.view((0, 0), (used, used)).into_owned());
        let before = std::mem::replace(&mut rate, time.map_or(0.0, |time| 1.0 / time));
        let spans_more = left > NOTHING * size;
        if !spans_more || (rate > 0.0 && (rate - before).abs() <= TOLERANCE * rate) {
            break;
        }
        basis.push(next.iter().map(|value| value / left).collect());
    }
    let size = basis.len().min(VECTORS);
    let weights = lasting(&projected.view((0, 0), (size, size)).into_owned(), rate);
    let mut vector = vec![0.0; start.len()];
    for (weight, known) in weights.iter().zip(&basis) {
        vector
            .iter_mut()
            .zip(known)
            .for_each(|(x, y)| *x += weight * y);
    }
    Ok((rate, vector))
}

/// The largest eigenvalue that is real and positive.
fn largest(projected: &DMatrix<f64>) -> Option<f64> {
    // Eigenvalues of a matrix that is not finite are looked for without end.
    projected
        .iter()
        .all(|entry| entry.is_finite())
        .then_some(())?;
    let eigenvalues = projected.complex_eigenvalues();
    let real = eigenvalues
        .iter()
        .filter(|one| one.re > 0.0 && one.im.abs() <= 1e-9 * one.re);
    real.map(|one| one.re).max_by(f64::total_cmp)
}

/// The vector of an eigenvalue 1/rate, by inverse iteration; zeros where there is none.
fn lasting(projected: &DMatrix<f64>, rate: f64) -> DVector<f64> {
    let size = projected.nrows();
    let shift = BESIDE / rate;
    let shifted = projected - DMatrix::identity(size, size) * shift;
    let factors = shifted.full_piv_lu();
    let mut vector = DVector::zeros(size);
    vector.iter_mut().take(1).for_each(|first| *first = 1.0);
    for _ in 0..INVERSE_STEPS {
        match factors.solve(&vector) {
            Some(next) if shift.is_finite() && next.norm() > 0.0 => vector = next.normalize(),
            _ => return DVector::zeros(size),
        }
    }
    vector
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slowest_of_many_rates_is_found_with_its_vector() {
        // -Q⁻¹ is diagonal with 1/(k + 1)²: rates 1, 4, 9, …; the start has all of them alike.
        let start = vec![1.0; 60];
        let image = |vector: &[f64]| -> Result<Vec<f64>, std::convert::Infallible> {
            let rates = (0..vector.len()).map(|k| ((k + 1) * (k + 1)) as f64);
            Ok(vector.iter().zip(rates).map(|(x, rate)| x / rate).collect())
        };
        let Ok((rate, vector)) = slowest(&start, image);
        assert!((rate - 1.0).abs() < TOLERANCE, "{rate}");
        let others = vector[1..].iter().fold(0.0f64, |most, x| most.max(x.abs()));
        // The rate is stationary about its vector, which is known to the root of what is known of the rate.
        assert!(others < TOLERANCE.sqrt() * vector[0].abs(), "{others:e}");
    }

    #[test]
    fn a_rotation_has_no_rate_that_is_real() {
        let image =
            |v: &[f64]| -> Result<Vec<f64>, std::convert::Infallible> { Ok(vec![v[1], -v[0]]) };
        let Ok((rate, vector)) = slowest(&[1.0, 0.0], image);
        assert_eq!((rate, vector), (0.0, vec![0.0, 0.0]));
    }
}
