//! Distances between two densities, or two mass vectors, on the same cells.

use super::projection::check_length;
use super::{Density, DensityError};
use crate::space::Axis;

/// Hellinger distance √(½ Σ (√p - √q)²) of two densities, 0 to 1. Negative values count as zero, and what is left is
/// normalised again.
///
/// # Errors
/// [`DensityError::DifferentAxes`] unless both have the same axes; [`DensityError::Length`].
pub fn hellinger(first: &Density, second: &Density) -> Result<f64, DensityError> {
    let (first, second) = common_masses(first, second)?;
    hellinger_of_masses(&first, &second)
}

/// Total-variation distance ½ ∫ |p - q| of two densities, 0 to 1. Negative values count as zero, and what is left is
/// normalised again.
///
/// # Errors
/// [`DensityError::DifferentAxes`] unless both have the same axes; [`DensityError::Length`].
pub fn total_variation(first: &Density, second: &Density) -> Result<f64, DensityError> {
    let (first, second) = common_masses(first, second)?;
    total_variation_of_masses(&first, &second)
}

/// ½ ∫ |p - q| of two densities as they are, whatever their signs and sums.
///
/// # Errors
/// [`DensityError::DifferentAxes`] unless both have the same axes; [`DensityError::Length`].
pub(crate) fn half_difference(first: &Density, second: &Density) -> Result<f64, DensityError> {
    let (first, second) = common_masses(first, second)?;
    Ok(half_sum(&first, &second))
}

/// Hellinger distance of two mass vectors over the same cells, 0 to 1. Negative values count as zero, and what is left
/// is normalised again: of masses that sum to more than one the distance could exceed one.
///
/// # Errors
/// [`DensityError::Length`] when they differ in length.
pub fn hellinger_of_masses(first: &[f64], second: &[f64]) -> Result<f64, DensityError> {
    check_length(second, first.len())?;
    // The sum of squares, not 1 - Σ √(pq), which would lose half the digits of a small distance.
    let [first, second] = [first, second].map(shares);
    let cells = first.iter().zip(&second);
    let sum: f64 = cells.map(|(p, q)| (p.sqrt() - q.sqrt()).powi(2)).sum();
    Ok((0.5 * sum).sqrt().min(1.0))
}

/// Total-variation distance ½ Σ |p - q| of two mass vectors over the same cells, 0 to 1. Negative values count as zero,
/// and what is left is normalised again.
///
/// # Errors
/// [`DensityError::Length`] when they differ in length.
pub fn total_variation_of_masses(first: &[f64], second: &[f64]) -> Result<f64, DensityError> {
    check_length(second, first.len())?;
    let [first, second] = [first, second].map(shares);
    Ok(half_sum(&first, &second).min(1.0))
}

/// The negative part of masses that sum to one: so far they are from those that distances take them for, as total
/// variation.
pub(crate) fn negative_part(masses: &[f64]) -> f64 {
    masses.iter().map(|mass| (-mass).max(0.0)).sum()
}

/// The shares of all positive mass.
fn shares(masses: &[f64]) -> Vec<f64> {
    let positive = masses.iter().map(|mass| mass.max(0.0));
    let sum: f64 = positive.clone().sum();
    positive.map(|mass| mass / sum).collect()
}

fn half_sum(first: &[f64], second: &[f64]) -> f64 {
    let cells = first.iter().zip(second);
    0.5 * cells.map(|(p, q)| (p - q).abs()).sum::<f64>()
}

/// Masses of two densities on the same cells.
fn common_masses(first: &Density, second: &Density) -> Result<(Vec<f64>, Vec<f64>), DensityError> {
    let [one, other] = [first, second].map(|density| density.axes.iter().map(Axis::edges));
    if !one.eq(other) {
        return Err(DensityError::DifferentAxes);
    }
    let volumes = first.volumes();
    let masses = |density: &Density| {
        check_length(&density.values, volumes.len())?;
        let cells = density.values.iter().zip(&volumes);
        Ok(cells.map(|(value, volume)| value * volume).collect())
    };
    Ok((masses(first)?, masses(second)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::function::erf::erfc;

    fn gaussian(mean: f64, count: usize) -> Density {
        let axis = Axis::uniform(-9.0, 9.0, count).unwrap();
        let cdf = |x: f64| 0.5 * erfc((mean - x) / 2f64.sqrt());
        let values = axis.edges().windows(2);
        let values = values
            .map(|e| (cdf(e[1]) - cdf(e[0])) / (e[1] - e[0]))
            .collect();
        Density {
            axes: vec![axis],
            values,
        }
    }

    #[test]
    fn distances_of_shifted_gaussians_are_exact_to_order_h_squared() {
        for shift in [0.01, 1.0, 3.0f64] {
            // 400 cells: h = 0.045, and averaging over a cell changes either distance by O(h²) relatively.
            let (p, q) = (gaussian(0.0, 400), gaussian(shift, 400));
            let exact_hellinger = (-(-shift * shift / 8.0f64).exp_m1()).sqrt();
            let exact_variation = 1.0 - erfc(shift / 8f64.sqrt());
            assert!((hellinger(&p, &q).unwrap() / exact_hellinger - 1.0).abs() < 2e-3);
            assert!((total_variation(&p, &q).unwrap() / exact_variation - 1.0).abs() < 2e-3);
        }
    }

    #[test]
    fn disjoint_masses_are_at_distance_one_and_equal_ones_at_zero() {
        let (p, q) = ([0.5, 0.5, 0.0, 0.0], [0.0, 0.0, 0.25, 0.75]);
        assert_eq!(hellinger_of_masses(&p, &q), Ok(1.0));
        assert_eq!(total_variation_of_masses(&p, &q), Ok(1.0));
        assert_eq!(hellinger_of_masses(&p, &p), Ok(0.0));
        // Negative masses leave more than one of positive ones.
        let (over, under) = ([1.5, -0.5], [-0.5, 1.5]);
        assert_eq!(hellinger_of_masses(&over, &under), Ok(1.0));
        assert_eq!(hellinger_of_masses(&over, &[1.0, 0.0]), Ok(0.0));
        assert_eq!(total_variation_of_masses(&over, &under), Ok(1.0));
        assert_eq!(total_variation_of_masses(&over, &[1.0, 0.0]), Ok(0.0));
        assert_eq!((negative_part(&over), negative_part(&p)), (0.5, 0.0));
        assert_eq!(total_variation_of_masses(&q, &q), Ok(0.0));
    }

    #[test]
    fn different_cells_are_refused() {
        let (p, q) = (gaussian(0.0, 40), gaussian(0.0, 41));
        assert_eq!(hellinger(&p, &q), Err(DensityError::DifferentAxes));
        assert_eq!(total_variation(&p, &q), Err(DensityError::DifferentAxes));
        assert!(hellinger_of_masses(&[1.0], &[0.5, 0.5]).is_err());
    }
}
