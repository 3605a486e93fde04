//! The fold of a tilted double well, known exactly.

/// Distance of a point (h, a) from 27 h² = 4 a³, in a box with sides of these lengths.
pub(crate) fn off_the_fold([h, a]: [f64; 2], [of_h, of_a]: [f64; 2]) -> f64 {
    (27.0 * h * h - 4.0 * a.powi(3)) / (54.0 * h * of_h).hypot(12.0 * a * a * of_a)
}
