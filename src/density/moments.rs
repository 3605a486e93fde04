//! Means and standard deviations from cell masses, and their errors.

use super::{DensityError, Moments, Observable, Projection};
use crate::numerics::jackknife;
use crate::space::CellSpace;

/// Moments with what is known of their errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EstimatedMoments {
    /// Mean and standard deviation.
    pub(crate) moments: Moments,
    /// Their errors; `None` where nothing says how large they are.
    pub(crate) errors: Option<Moments>,
}

impl EstimatedMoments {
    /// Moments without known errors.
    pub(crate) fn unjudged(moments: Moments) -> Self {
        Self {
            moments,
            errors: None,
        }
    }

    /// Moments whose errors are their differences to other estimates.
    pub(crate) fn by_difference(moments: Moments, others: &[Moments]) -> Self {
        let sum = |of: fn(&Moments) -> f64| -> f64 {
            let differences = others.iter().map(|other| (of(other) - of(&moments)).abs());
            differences.sum()
        };
        Self {
            moments,
            errors: Some(Moments {
                mean: sum(|one| one.mean),
                standard_deviation: sum(|one| one.standard_deviation),
            }),
        }
    }

    /// The same with more error. Stays unknown where it is.
    pub(crate) fn with(self, more: Moments) -> Self {
        let errors = self.errors.map(|errors| Moments {
            mean: errors.mean + more.mean,
            standard_deviation: errors.standard_deviation + more.standard_deviation,
        });
        Self { errors, ..self }
    }

    /// Moments whose standard errors are those of delete-a-group replicates (Tukey's jackknife); unknown with fewer
    /// than two of them.
    pub(crate) fn by_replicates(moments: Moments, replicates: &[Moments]) -> Self {
        let error = |of: fn(&Moments) -> f64| jackknife(replicates.iter().map(of));
        let errors = Moments {
            mean: error(|one| one.mean),
            standard_deviation: error(|one| one.standard_deviation),
        };
        Self {
            moments,
            errors: (replicates.len() > 1).then_some(errors),
        }
    }
}

/// By how much the variances of [`moments`] are too large for a smooth density (Sheppard), one value an axis.
///
/// # Errors
/// [`DensityError::Length`].
pub(crate) fn excess_variances(space: &CellSpace, mass: &[f64]) -> Result<Vec<f64>, DensityError> {
    let axes = space.axes().iter().enumerate();
    axes.map(|(index, axis)| {
        let masses = Projection::new(space, Observable::Marginal(index))?.masses(mass)?;
        let terms = masses.iter().enumerate();
        let terms = terms.map(|(cell, mass)| mass * axis.width(cell) * axis.width(cell));
        Ok(terms.sum::<f64>() / 6.0)
    })
    .collect()
}

/// What differences of masses (Σ = 0) between two discretisations do to the average of a number that has `values` in
/// the cells, were those of one layer of cells across an axis independent of those of the next: the largest over the
/// axes.
///
/// The difference of the two averages themselves is a lone number, which passes through zero where the errors of both
/// are large and alike.
fn largest_of_layers(space: &CellSpace, differences: &[f64], values: &[f64]) -> f64 {
    let axes = space.axes().iter().enumerate().map(|(index, axis)| {
        let mut layers = vec![0.0; axis.count()];
        let cells = differences.iter().zip(values).zip(space.positions(index));
        for ((difference, value), position) in cells {
            layers[position] += difference * value;
        }
        layers.iter().map(|layer| layer * layer).sum::<f64>().sqrt()
    });
    axes.fold(0.0, f64::max)
}

/// Error of a sum over the cells that stands for an integral, where the product of weights and values has a kink on
/// faces: a twenty-fourth of the jump of its slope in the cell coordinate (midpoint rule), on `planes`, axes with
/// coordinates.
fn at_kinks(space: &CellSpace, planes: &[(usize, f64)], weights: &[f64], values: &[f64]) -> f64 {
    let jump = |&(index, at): &(usize, f64)| {
        let (axis, stride) = (
            space.axes().get(index)?,
            space.shape()[index + 1..].iter().product::<usize>(),
        );
        let face = axis
            .face_at(at)
            .filter(|face| (2..axis.count() - 1).contains(face))?;
        let cells = space.positions(index).enumerate();
        let above = cells.filter_map(|(cell, position)| (position == face).then_some(cell));
        let jumps = above.map(|cell| {
            let product = |cell: usize| weights[cell] * values[cell];
            let [far, near] = [2, 1].map(|steps| product(cell - steps * stride));
            (product(cell + stride) - product(cell)) - (near - far)
        });
        Some(jumps.sum::<f64>().abs() / 24.0)
    };
    planes.iter().filter_map(jump).sum()
}

/// What differs between two discretisations of the masses, and where they have kinks.
#[derive(Clone, Copy)]
pub(crate) struct Roughness<'a> {
    pub(crate) space: &'a CellSpace,
    pub(crate) weights: &'a [f64],
    /// Σ = 0.
    pub(crate) differences: &'a [f64],
    /// Axes with coordinates of planes on which the derivative of the density jumps.
    pub(crate) planes: &'a [(usize, f64)],
}

impl Roughness<'_> {
    /// Error of the average of a number that has `values` in the cells: [`largest_of_layers`] and [`at_kinks`].
    pub(crate) fn of(&self, values: &[f64]) -> f64 {
        largest_of_layers(self.space, self.differences, values)
            + at_kinks(self.space, self.planes, self.weights, values)
    }

    /// The same of the moments of a number.
    pub(crate) fn of_moments(&self, values: &[f64], moments: &Moments) -> Moments {
        let spread = moments.standard_deviation.max(f64::MIN_POSITIVE);
        let aside = values.iter().map(|value| (value - moments.mean) / spread);
        let aside: Vec<f64> = aside.collect();
        let squares = aside.iter().map(|aside| 0.5 * (aside * aside - 1.0));
        let squares: Vec<f64> = squares.collect();
        Moments {
            mean: spread * self.of(&aside),
            standard_deviation: spread * self.of(&squares),
        }
    }
}

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

    #[test]
    fn a_difference_that_cancels_in_a_moment_is_not_taken_for_none() {
        let axes = [4, 2].map(|count| Axis::uniform(0.0, count as f64, count).unwrap());
        let space = CellSpace::new(axes.to_vec()).unwrap();
        let mass = [0.125; 8];
        // Along x -1, +1, +1, -1 in units of 1e-3: no change of the mean.
        let difference = [-1.0, -1.0, 1.0, 1.0, 1.0, 1.0, -1.0, -1.0].map(|one| 5e-4 * one);
        let values: Vec<f64> = (0..8).map(|cell| space.centre(cell)[0]).collect();
        let own = moments(&space, &mass).unwrap()[0];
        let second: Vec<f64> = mass.iter().zip(&difference).map(|(m, d)| m + d).collect();
        let other = moments(&space, &second).unwrap()[0];
        let plain = EstimatedMoments::by_difference(own, &[other])
            .errors
            .unwrap();
        assert!(plain.mean < 1e-15);
        // √(1.5² + 0.5² + 0.5² + 1.5²) for the layers of x; those of y cancel.
        let roughness = Roughness {
            space: &space,
            weights: &mass,
            differences: &difference,
            planes: &[],
        };
        let found = roughness.of_moments(&values, &own);
        assert!(
            (found.mean - 1e-3 * 5_f64.sqrt()).abs() < 1e-12,
            "{found:?}"
        );
    }

    #[test]
    fn replicates_give_the_standard_error_of_a_mean() {
        // Without one of four numbers each: Tukey's jackknife of their mean is its standard error.
        let numbers = [1.0, 2.0, 4.0, 9.0];
        let sum: f64 = numbers.iter().sum();
        let of = |mean: f64| Moments {
            mean,
            standard_deviation: 1.0,
        };
        let replicates = numbers.map(|number| of((sum - number) / 3.0));
        let found = EstimatedMoments::by_replicates(of(sum / 4.0), &replicates);
        let squares: f64 = numbers.iter().map(|one| (one - sum / 4.0).powi(2)).sum();
        let errors = found.errors.unwrap();
        assert!((errors.mean - (squares / 12.0).sqrt()).abs() < 1e-14);
        assert_eq!(errors.standard_deviation, 0.0);
        assert_eq!(
            EstimatedMoments::by_replicates(of(1.0), &[of(1.0)]).errors,
            None
        );
    }

    #[test]
    fn variances_are_too_large_by_what_is_said() {
        let axis = Axis::uniform(-8.0, 8.0, 40).unwrap();
        let edges = axis.edges().to_vec();
        let space = CellSpace::new(vec![axis]).unwrap();
        let cdf = |x: f64| 0.5 * statrs::function::erf::erfc(-x / 2f64.sqrt());
        let mass: Vec<f64> = edges.windows(2).map(|e| cdf(e[1]) - cdf(e[0])).collect();
        let variance = moments(&space, &mass).unwrap()[0]
            .standard_deviation
            .powi(2);
        let excess = excess_variances(&space, &mass).unwrap()[0];
        assert!(
            (variance - 1.0 - excess).abs() < 1e-6 && excess > 0.02,
            "{variance} {excess}"
        );
    }

    #[test]
    fn a_kink_on_a_face_makes_the_error_that_is_said() {
        // ∫ exp(-2|x|) |x| dx = 1/2 by midpoints.
        let axis = Axis::uniform(-10.0, 10.0, 200).unwrap();
        let (centres, width) = (axis.centres(), axis.width(0));
        let space = CellSpace::new(vec![axis]).unwrap();
        let weights: Vec<f64> = centres
            .iter()
            .map(|x| width * (-2.0 * x.abs()).exp())
            .collect();
        let values: Vec<f64> = centres.iter().map(|x| x.abs()).collect();
        let sum: f64 = weights.iter().zip(&values).map(|(w, v)| w * v).sum();
        let said = at_kinks(&space, &[(0, 0.0)], &weights, &values);
        let off = (sum - 0.5).abs();
        // The slope beside the kink is taken half a cell from it.
        assert!((0.6..1.4).contains(&(said / off)), "{said:e} {off:e}");
        assert_eq!(at_kinks(&space, &[(0, 0.03)], &weights, &values), 0.0);
    }
}
