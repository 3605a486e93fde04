//! Means and standard deviations from cell masses.

use super::{DensityError, Moments, Observable, Projection};
use crate::space::CellSpace;

/// Mean and standard deviation of every axis, in the order of the axes, from the masses of all cells
/// (`n_cells` values, Σ = 1, not rescaled).
///
/// They are the moments of the density that is constant inside cells: centres, and h²/12 of variance within
/// a cell of width h. Against a smooth density the error of both is O(h²).
///
/// # Errors
/// [`DensityError::Length`].
pub fn moments(space: &CellSpace, mass: &[f64]) -> Result<Vec<Moments>, DensityError> {
    let axes = space.axes().iter().enumerate();
    axes.map(|(index, axis)| {
        let masses = Projection::new(space, Observable::Marginal(index))?.masses(mass)?;
        let cells = || masses.iter().enumerate();
        let mean: f64 = cells().map(|(cell, mass)| mass * axis.centre(cell)).sum();
        let spread = |cell: usize| {
            let width = axis.width(cell);
            (axis.centre(cell) - mean).powi(2) + width * width / 12.0
        };
        let variance: f64 = cells().map(|(cell, mass)| mass * spread(cell)).sum();
        Ok(Moments {
            mean,
            // Slightly negative masses must not make a root of a negative number.
            standard_deviation: variance.max(0.0).sqrt(),
        })
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Axis, Grading};

    #[test]
    fn uniform_density_has_its_exact_moments_on_any_cells() {
        let grading = Grading {
            at: vec![0.5],
            smallest: 0.02,
        };
        let x = Axis::graded(-1.0, 3.0, 40, &grading).unwrap();
        let y = Axis::uniform(0.0, 6.0, 3).unwrap();
        let space = CellSpace::new(vec![x, y]).unwrap();
        let mass: Vec<f64> = (0..120).map(|cell| space.volume(cell) / 24.0).collect();
        let found = moments(&space, &mass).unwrap();
        for (found, (mean, variance)) in found.iter().zip([(1.0, 16.0 / 12.0), (3.0, 3.0f64)]) {
            assert!((found.mean - mean).abs() < 1e-12);
            assert!((found.standard_deviation - variance.sqrt()).abs() < 1e-12);
        }
    }

    #[test]
    fn gaussian_standard_deviation_converges_with_order_two() {
        let error = |count: usize| {
            let axis = Axis::uniform(-8.0, 8.0, count).unwrap();
            let edges = axis.edges().to_vec();
            let space = CellSpace::new(vec![axis]).unwrap();
            let cdf = |x: f64| 0.5 * statrs::function::erf::erfc(-(x - 0.3) / 2f64.sqrt());
            let mass: Vec<f64> = edges.windows(2).map(|e| cdf(e[1]) - cdf(e[0])).collect();
            let found = moments(&space, &mass).unwrap()[0];
            assert!((found.mean - 0.3).abs() < 1e-9);
            found.standard_deviation - 1.0
        };
        // Sheppard: the variance is high by h²/6, the standard deviation by h²/12.
        let h: f64 = 16.0 / 64.0;
        assert!((error(64) / (h * h / 12.0) - 1.0).abs() < 0.02);
        assert!((error(64) / error(128) - 4.0).abs() < 0.05);
    }
}
