//! Standard errors of a projected density from delete-a-group jackknife replicates, pooled over neighbours.
//!
//! With G groups of samples, replicate g is the whole estimate without group g, and the variance of a
//! value p is (G-1)/G Σ_g (p_g - mean)² (Tukey's jackknife). Eight replicates leave it uncertain by 50 %, far
//! too much for a threshold in the tail; so it is shared among neighbouring cells. What neighbours have in
//! common is not the variance but the *effective number of samples* n: a histogram has var p = p / (n V) for
//! a cell of volume V. Hence 1/n = Σ var / Σ (p/V) over a window; the ratio of sums, unlike a mean of
//! ratios, is ruled by the cells that hold the mass, and errs to the large side beside them.

use super::{Density, DensityError, EstimatedDensity, Observable, Projection, Variants};
use crate::numerics;
use crate::space::CellSpace;

/// Cells on either side of a cell whose variances are pooled with its own.
const REACH: usize = 2;

/// A window's 1/n is at least this share of that of the whole density, so that replicates that happen to
/// agree are not taken for exact.
const LEAST_SHARE: f64 = 0.1;

/// Density of an observable with standard errors, from the masses of all cells (`n_cells` values, Σ = 1)
/// and the replicates of a delete-a-group jackknife (each like `mass`). Without replicates the method does
/// no sampling, and the errors are zero.
///
/// The error of a cell is that of its own p plus one effective sample, so that empty cells have one too.
///
/// # Errors
/// [`DensityError::Axis`], [`DensityError::RepeatedAxis`], [`DensityError::Length`], or
/// [`DensityError::Replicates`] for a single replicate.
pub fn estimate(
    space: &CellSpace,
    observable: Observable,
    mass: &[f64],
    replicate_masses: &[Vec<f64>],
) -> Result<EstimatedDensity, DensityError> {
    let projection = Projection::new(space, observable)?;
    estimate_projected(&projection, observable, mass, replicate_masses)
}

/// As [`estimate`], with the map from cells to the observable worked out before.
///
/// # Errors
/// [`DensityError::Length`], or [`DensityError::Replicates`] for a single replicate.
pub(crate) fn estimate_projected(
    projection: &Projection,
    observable: Observable,
    mass: &[f64],
    replicate_masses: &[Vec<f64>],
) -> Result<EstimatedDensity, DensityError> {
    let density = projection.density(mass)?;
    let (standard_error, variants) = match replicate_masses.len() {
        0 => (vec![0.0; density.values.len()], Variants::None),
        1 => return Err(DensityError::Replicates { given: 1 }),
        _ => {
            let replicates: Result<Vec<Density>, DensityError> = replicate_masses
                .iter()
                .map(|mass| projection.density(mass))
                .collect();
            let replicates = replicates?;
            let variance = jackknife_variance(&replicates, density.values.len());
            let error = pooled_error(&density, projection.volumes(), &variance);
            let values = replicates.into_iter().map(|one| one.values).collect();
            (error, Variants::Jackknife(values))
        }
    };
    Ok(EstimatedDensity {
        standard_error,
        variants,
        ..EstimatedDensity::new(observable, density)
    })
}

/// Jackknife variance of every value.
fn jackknife_variance(replicates: &[Density], cells: usize) -> Vec<f64> {
    let values = |cell: usize| replicates.iter().map(move |one| one.values[cell]);
    let variances = (0..cells).map(|cell| numerics::jackknife_variance(values(cell)));
    variances.collect()
}

/// Standard errors from variances pooled as the module's text says.
fn pooled_error(density: &Density, volumes: &[f64], variance: &[f64]) -> Vec<f64> {
    let (rows, columns) = match density.axes.as_slice() {
        [axis] => (1, axis.count()),
        [first, second] => (first.count(), second.count()),
        _ => return vec![0.0; variance.len()],
    };
    // Variance that a single sample would give each cell.
    let of_one_sample: Vec<f64> = density
        .values
        .iter()
        .zip(volumes)
        .map(|(value, volume)| value.abs() / volume)
        .collect();
    // A window that no sample entered says nothing: what holds for the whole density is taken there.
    let ratio = |above: f64, below: f64, otherwise: f64| {
        if below > 0.0 {
            above / below
        } else {
            otherwise
        }
    };
    let whole = ratio(variance.iter().sum(), of_one_sample.iter().sum(), 0.0);
    let (window_variance, window_sample) = (
        window_sums(variance, rows, columns),
        window_sums(&of_one_sample, rows, columns),
    );
    let error = |cell: usize| {
        let local = ratio(window_variance[cell], window_sample[cell], whole);
        let inverse_samples = local.max(LEAST_SHARE * whole);
        // One sample more in the cell makes the density larger by 1/(n V).
        let value = density.values[cell].abs() + inverse_samples / volumes[cell];
        (inverse_samples * value / volumes[cell]).sqrt()
    };
    (0..variance.len()).map(error).collect()
}

/// Sums over the cells within [`REACH`] of each cell along both axes, cut at the ends of the ranges.
fn window_sums(values: &[f64], rows: usize, columns: usize) -> Vec<f64> {
    let window = |at: usize, count: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(count);
    let mut along_rows = vec![0.0; values.len()];
    for row in 0..rows {
        let line = &values[row * columns..(row + 1) * columns];
        for column in 0..columns {
            along_rows[row * columns + column] = line[window(column, columns)].iter().sum();
        }
    }
    let mut sums = vec![0.0; values.len()];
    for row in 0..rows {
        for near in window(row, rows) {
            for column in 0..columns {
                sums[row * columns + column] += along_rows[near * columns + column];
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Poisson};
    use rand_xoshiro::Xoshiro256PlusPlus;

    const GROUPS: usize = 8;

    /// Masses of a histogram of `samples` draws of p ∝ exp(-x²/2), and its 8 delete-a-group replicates.
    fn histogram(space: &CellSpace, samples: f64, seed: u64) -> (Vec<f64>, Vec<Vec<f64>>) {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let cells = space.n_cells();
        let weight = |cell| {
            let r2: f64 = space.centre(cell).iter().map(|x| x * x).sum();
            (-0.5 * r2).exp() * space.volume(cell)
        };
        let total: f64 = (0..cells).map(weight).sum();
        let mut counts = vec![vec![0.0; cells]; GROUPS];
        for group in &mut counts {
            for (cell, count) in group.iter_mut().enumerate() {
                let mean = samples / GROUPS as f64 * weight(cell) / total;
                *count = Poisson::new(mean).unwrap().sample(&mut random);
            }
        }
        let without = |skipped: usize| -> Vec<f64> {
            let kept = || (0..GROUPS).filter(|&group| group != skipped);
            let sums: Vec<f64> = (0..cells)
                .map(|c| kept().map(|g| counts[g][c]).sum())
                .collect();
            let total: f64 = sums.iter().sum();
            sums.iter().map(|sum| sum / total).collect()
        };
        (without(GROUPS), (0..GROUPS).map(without).collect())
    }

    #[test]
    fn errors_of_a_histogram_are_multinomial() {
        let axis = |count| Axis::uniform(-4.0, 4.0, count).unwrap();
        let space = CellSpace::new(vec![axis(40), axis(30)]).unwrap();
        let samples = 2e5;
        let (mass, replicates) = histogram(&space, samples, 3);
        let observables = [
            Observable::Joint(0, 1),
            Observable::Joint(1, 0),
            Observable::Marginal(0),
        ];
        // Relative error of an error from k pooled cells of 7 degrees of freedom is about √(1/14k): 5 % in
        // 5×5 windows, 12 % in windows of 5; five of them bound all cells.
        for (observable, tolerance) in observables.into_iter().zip([0.3, 0.3, 0.6]) {
            let estimated = estimate(&space, observable, &mass, &replicates).unwrap();
            let volumes = estimated.density.volumes();
            let (mut sum, mut cells) = (0.0, 0.0);
            for (cell, &value) in estimated.density.values.iter().enumerate() {
                // Where there are enough samples for the ratio to be about its mean.
                if value * volumes[cell] * samples > 50.0 {
                    let expected = (value / volumes[cell] / samples).sqrt();
                    let ratio = estimated.standard_error[cell] / expected;
                    assert!(
                        (ratio - 1.0).abs() < tolerance,
                        "{observable:?} {cell}: {ratio}"
                    );
                    sum += ratio;
                    cells += 1.0;
                }
            }
            assert!((sum / cells - 1.0f64).abs() < 0.1, "{}", sum / cells);
        }
    }

    #[test]
    fn no_cell_of_a_sampled_density_is_exact() {
        let space = CellSpace::new(vec![Axis::uniform(-12.0, 12.0, 60).unwrap()]).unwrap();
        let samples = 1e4;
        let (mut mass, mut replicates) = histogram(&space, samples, 5);
        // Replicates that agree on a whole window by chance, and cells no sample entered.
        for replicate in &mut replicates {
            replicate[22..27].copy_from_slice(&mass[22..27]);
        }
        mass[40] = 0.0;
        let estimated = estimate(&space, Observable::Marginal(0), &mass, &replicates).unwrap();
        let one_sample = 1.0 / samples / space.volume(0);
        let least = estimated
            .standard_error
            .iter()
            .copied()
            .fold(f64::MAX, f64::min);
        assert_eq!(mass[0], 0.0);
        // √LEAST_SHARE = 0.32 where they agree; about 1 elsewhere, the whole-density 1/n being uncertain by 30 %.
        assert!(least > 0.3 * one_sample, "{least} of {one_sample}");
    }

    #[test]
    fn without_sampling_the_errors_are_zero_and_one_replicate_is_refused() {
        let space = CellSpace::new(vec![Axis::uniform(0.0, 1.0, 4).unwrap()]).unwrap();
        let mass = vec![0.25; 4];
        let exact = estimate(&space, Observable::Marginal(0), &mass, &[]).unwrap();
        assert_eq!(exact.standard_error, vec![0.0; 4]);
        let single = estimate(
            &space,
            Observable::Marginal(0),
            &mass,
            std::slice::from_ref(&mass),
        );
        assert_eq!(single.unwrap_err(), DensityError::Replicates { given: 1 });
    }
}
