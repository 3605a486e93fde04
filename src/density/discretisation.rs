//! Densities whose error is that of a grid, not of sampling: the difference between two discretisations.

use super::{Density, DensityError, EstimatedDensity, Observable, Projection, Variants};
use crate::space::CellSpace;

/// Height of a wiggle from trough to crest, over the depth of its troughs below zero: what is below zero is the lower
/// half of a wiggle about a positive density at most.
pub(crate) const WIGGLE: f64 = 8.0;

/// Density of an observable from the masses of all cells, with the difference to a second discretisation (masses,
/// Σ = 0) as its error. Where two solutions happen to cross, the difference says too little, so every error is the root
/// mean square over the cell and its neighbours.
///
/// # Errors
/// [`DensityError::Axis`], [`DensityError::RepeatedAxis`] or [`DensityError::Length`].
pub(crate) fn estimate_from_difference(
    space: &CellSpace,
    observable: Observable,
    mass: &[f64],
    difference: &[f64],
) -> Result<EstimatedDensity, DensityError> {
    let projection = Projection::new(space, observable)?;
    let density = projection.density(mass)?;
    let difference = projection.density(difference)?;
    let both = density.values.iter().zip(&difference.values);
    let second = both.map(|(value, change)| value + change).collect();
    Ok(estimate_from_second(observable, density, second))
}

/// As [`estimate_from_difference`] from the densities by both discretisations (of the second its values alone).
pub(crate) fn estimate_from_second(
    observable: Observable,
    density: Density,
    second: Vec<f64>,
) -> EstimatedDensity {
    EstimatedDensity {
        standard_error: errors_by_schemes(&density, &second),
        variants: Variants::Scheme(second),
        ..EstimatedDensity::new(observable, density)
    }
}

/// What two discretisations differ by, as an error of each value.
pub(crate) fn errors_by_schemes(density: &Density, second: &[f64]) -> Vec<f64> {
    let both = second.iter().zip(&density.values);
    let mut squares: Vec<f64> = both.map(|(a, b)| (a - b) * (a - b)).collect();
    let mut stride = squares.len();
    for axis in &density.axes {
        stride /= axis.count();
        squares = neighbour_means(&squares, axis.count(), stride);
    }
    squares.into_iter().map(f64::sqrt).collect()
}

impl EstimatedDensity {
    /// Whether the cells' masses are integrals of the density itself, free of any scheme: that of a system with one
    /// axis by quadrature, or a closed form.
    pub(crate) fn is_by_quadrature(&self) -> bool {
        self.negligible == 0.0
    }

    /// Share of the maximum below which heights tell nothing: what the solver leaves, or more where the density is
    /// negative. A density is nowhere so: values below zero are wiggles of the scheme, and what is not clearly higher
    /// than they are deep is one of them. Noise has errors of its own.
    pub(crate) fn negligible_height(&self) -> f64 {
        let maximum = self.density.maximum().max(f64::MIN_POSITIVE);
        if self.is_noisy() {
            return self.negligible;
        }
        let values = self.density.values.iter().copied();
        let deepest = values.fold(0.0, f64::min).abs();
        self.negligible.max(WIGGLE * deepest / maximum)
    }
}

/// Mean over each value and its neighbours along one axis of `count` cells, `stride` values apart.
fn neighbour_means(values: &[f64], count: usize, stride: usize) -> Vec<f64> {
    let mean = |index: usize| {
        let place = index / stride % count;
        let (low, high) = (place.min(1), (count - 1 - place).min(1));
        let first = index - low * stride;
        let terms = low + high + 1;
        let sum: f64 = (0..terms).map(|term| values[first + term * stride]).sum();
        sum / terms as f64
    };
    (0..values.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;

    #[test]
    fn a_zero_crossing_does_not_hide_the_error() {
        let axis = Axis::uniform(0.0, 4.0, 4).unwrap();
        let space = CellSpace::new(vec![axis]).unwrap();
        let difference = [3e-3, 0.0, -3e-3, 0.0];
        let estimate =
            estimate_from_difference(&space, Observable::Marginal(0), &[0.25; 4], &difference)
                .unwrap();
        let expected = [4.5e-6_f64, 6e-6, 3e-6, 4.5e-6].map(f64::sqrt);
        for (found, expected) in estimate.standard_error.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15);
        }
    }

    #[test]
    fn wiggles_about_nothing_are_negligible() {
        let axis = Axis::uniform(0.0, 4.0, 4).unwrap();
        let space = CellSpace::new(vec![axis]).unwrap();
        let of = |mass: [f64; 4]| {
            let observable = Observable::Marginal(0);
            estimate_from_difference(&space, observable, &mass, &[0.0; 4])
                .unwrap()
                .negligible_height()
        };
        assert_eq!(of([0.5, 0.5, 0.0, 0.0]), crate::density::NEGLIGIBLE);
        assert!((of([0.5, 0.5, -1e-3, 1e-3]) - 16e-3).abs() < 1e-15);
    }

    #[test]
    fn neighbours_along_both_axes_are_pooled() {
        let x = Axis::uniform(0.0, 3.0, 3).unwrap();
        let y = Axis::uniform(0.0, 2.0, 2).unwrap();
        let space = CellSpace::new(vec![x, y]).unwrap();
        let mut difference = [0.0; 6];
        difference[0] = 6e-3;
        let observable = Observable::Joint(0, 1);
        let estimate =
            estimate_from_difference(&space, observable, &[1.0 / 6.0; 6], &difference).unwrap();
        let squares: Vec<f64> = estimate.standard_error.iter().map(|e| e * e).collect();
        // 36e-6 over 2 cells along x, then over 2 along y; nothing beyond the neighbours.
        for (cell, expected) in [9e-6, 9e-6, 6e-6, 6e-6, 0.0, 0.0].iter().enumerate() {
            assert!((squares[cell] - expected).abs() < 1e-18);
        }
    }
}
