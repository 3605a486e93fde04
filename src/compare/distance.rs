//! Distances between two estimated densities, with what is uncertain about them.

use crate::density::{
    Density, DensityError, EstimatedDensity, Variants, hellinger_of_masses, negative_part,
    total_variation, total_variation_of_masses,
};
use crate::numerics;

/// A distance with its uncertainty. A distance cannot be negative, so noise alone makes one: only what exceeds `noise`
/// and `systematic` tells two densities apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// The distance, 0 to 1.
    pub value: f64,
    /// Its standard error by sampling (jackknife).
    pub error: f64,
    /// Largest change that the stated grid errors can make: the distances between the two schemes of each density that
    /// has two, and, of the total variation, the negative parts of both densities, which count as zero.
    pub systematic: f64,
    /// Distance to be expected from sampling noise alone, were both densities the same.
    pub noise: f64,
}

impl Distance {
    /// Whether the densities differ by more than noise, three standard errors and grid error together.
    pub(crate) fn is_significant(&self) -> bool {
        self.value > self.noise + 3.0 * self.error + self.systematic
    }
}

/// Total variation and Hellinger distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distances {
    /// ½ ∫ |p - q|.
    pub total_variation: Distance,
    /// √(½ ∫ (√p - √q)²).
    pub hellinger: Distance,
}

/// Estimates that vary together: masses of the one and of the other.
type Replicates = Vec<(Vec<f64>, Vec<f64>)>;

/// Distances of two estimated densities on the same cells. `shared` says that both rest on the same samples, group by
/// group, so that their replicates vary together.
///
/// # Errors
/// [`DensityError::DifferentAxes`] or [`DensityError::Length`].
pub fn distances(
    one: &EstimatedDensity,
    other: &EstimatedDensity,
    shared: bool,
) -> Result<Distances, DensityError> {
    // Says whether both are on the same cells.
    total_variation(&one.density, &other.density)?;
    let (p, q) = (one.density.masses(), other.density.masses());
    let sets = replicates(one, other, shared);
    let variance = difference_variance(&sets, p.len());
    let distance = |measure: &Measure, noise: f64| -> Result<Distance, DensityError> {
        let second =
            |estimated: &EstimatedDensity, mass: &[f64]| match estimated.variants.second_scheme() {
                Some(values) => measure(mass, &masses(estimated, values)),
                None => Ok(0.0),
            };
        let mut squared = 0.0;
        for set in &sets {
            let values: Result<Vec<f64>, _> = set.iter().map(|(p, q)| measure(p, q)).collect();
            squared += jackknife_variance(&values?);
        }
        Ok(Distance {
            value: measure(&p, &q)?,
            error: squared.sqrt(),
            systematic: second(one, &p)? + second(other, &q)?,
            noise,
        })
    };
    let mut variation = distance(&total_variation_of_masses, variation_noise(&variance))?;
    variation.systematic += negative_part(&p) + negative_part(&q);
    Ok(Distances {
        total_variation: variation,
        hellinger: distance(&hellinger_of_masses, hellinger_noise(&p, &q, &variance))?,
    })
}

type Measure = dyn Fn(&[f64], &[f64]) -> Result<f64, DensityError>;

/// Masses of other values on the cells of a density.
fn masses(estimated: &EstimatedDensity, values: &[f64]) -> Vec<f64> {
    let density = Density {
        axes: estimated.density.axes.clone(),
        values: values.to_vec(),
    };
    density.masses()
}

/// Sets of replicates; sets are independent of each other.
fn replicates(one: &EstimatedDensity, other: &EstimatedDensity, shared: bool) -> Vec<Replicates> {
    let of = |estimated: &EstimatedDensity| -> Vec<Vec<f64>> {
        match &estimated.variants {
            Variants::Jackknife(all) => all.iter().map(|one| masses(estimated, one)).collect(),
            _ => Vec::new(),
        }
    };
    let (first, second) = (of(one), of(other));
    if shared && first.len() == second.len() {
        return vec![first.into_iter().zip(second).collect()];
    }
    let (p, q) = (one.density.masses(), other.density.masses());
    vec![
        first.into_iter().map(|first| (first, q.clone())).collect(),
        second
            .into_iter()
            .map(|second| (p.clone(), second))
            .collect(),
    ]
}

/// Variance of a number from its values without one group each; zero for fewer than two.
fn jackknife_variance(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    numerics::jackknife_variance(values.iter().copied())
}

/// Variance of the difference of the masses, a cell, with the factor by which the root of it is too small on average.
fn difference_variance(sets: &[Replicates], cells: usize) -> Vec<f64> {
    let mut variance = vec![0.0; cells];
    for set in sets.iter().filter(|set| set.len() > 1) {
        // The root of an unbiased variance of a normal number is low by 1 - 1/(4 d) with d degrees of freedom.
        let low = 1.0 - 0.25 / (set.len() - 1) as f64;
        for (cell, variance) in variance.iter_mut().enumerate() {
            let values: Vec<f64> = set.iter().map(|(p, q)| p[cell] - q[cell]).collect();
            *variance += jackknife_variance(&values) / (low * low);
        }
    }
    variance
}

/// ½ Σ E|difference| of normal differences.
fn variation_noise(variance: &[f64]) -> f64 {
    let deviations: f64 = variance.iter().map(|variance| variance.sqrt()).sum();
    0.5 * (2.0 / std::f64::consts::PI).sqrt() * deviations
}

/// √(½ Σ variance/(4p)): √p varies by the variation of p over 2√p.
fn hellinger_noise(p: &[f64], q: &[f64], variance: &[f64]) -> f64 {
    let cells = p.iter().zip(q).zip(variance);
    let terms = cells.map(|((p, q), variance)| {
        let mean = 0.5 * (p + q);
        // Where less than one sample is expected, the root is no small variation: it is at most that of the mass
        // itself.
        if mean > 0.0 {
            (0.25 * variance / mean).min(mean)
        } else {
            0.0
        }
    });
    (0.5 * terms.sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::{Observable, estimate, estimate_from_difference};
    use crate::space::{Axis, CellSpace};
    use rand::SeedableRng;
    use rand_distr::{Distribution, Poisson};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use statrs::function::erf::{erf, erfc};

    const GROUPS: usize = 32;

    fn space() -> CellSpace {
        CellSpace::new(vec![Axis::uniform(-6.0, 7.0, 260).unwrap()]).unwrap()
    }

    fn gaussian(mean: f64) -> Vec<f64> {
        let edges = space().axes()[0].edges().to_vec();
        let below = |edge: f64| 0.5 * erf((edge - mean) / 2f64.sqrt());
        let pairs = edges.windows(2);
        pairs.map(|e| below(e[1]) - below(e[0])).collect()
    }

    /// A histogram of about `samples` draws, with its delete-a-group replicates.
    fn histogram(truth: &[f64], samples: f64, seed: u64) -> EstimatedDensity {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let groups: Vec<Vec<f64>> = (0..GROUPS)
            .map(|_| {
                let count = |mass: &f64| match Poisson::new(mass * samples / GROUPS as f64) {
                    Ok(poisson) => poisson.sample(&mut random),
                    Err(_) => 0.0,
                };
                truth.iter().map(count).collect()
            })
            .collect();
        let without = |left_out: Option<usize>| -> Vec<f64> {
            let kept = groups
                .iter()
                .enumerate()
                .filter(|(g, _)| Some(*g) != left_out);
            let mut sum = vec![0.0; truth.len()];
            for (_, group) in kept {
                sum.iter_mut().zip(group).for_each(|(sum, n)| *sum += n);
            }
            let whole: f64 = sum.iter().sum();
            sum.iter().map(|n| n / whole).collect()
        };
        let all: Vec<Vec<f64>> = (0..GROUPS).map(|g| without(Some(g))).collect();
        estimate(&space(), Observable::Marginal(0), &without(None), &all).unwrap()
    }

    fn known(masses: &[f64]) -> EstimatedDensity {
        estimate(&space(), Observable::Marginal(0), masses, &[]).unwrap()
    }

    #[test]
    fn a_histogram_is_as_far_from_its_truth_as_noise_says() {
        let truth = gaussian(0.0);
        let (mut ratio, mut roots, runs) = (0.0, 0.0, 20);
        for seed in 0..runs {
            let found = distances(&histogram(&truth, 1e5, seed), &known(&truth), false).unwrap();
            let variation = found.total_variation;
            ratio += variation.value / variation.noise / runs as f64;
            roots += found.hellinger.value / found.hellinger.noise / runs as f64;
            assert!(!variation.is_significant(), "{variation:?}");
            assert_eq!(variation.systematic, 0.0);
        }
        // 120 occupied cells: a run scatters by √((π/2 - 1)/120) = 7 %, the mean of 20 by 1.5 %.
        assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
        assert!((roots - 1.0).abs() < 0.1, "{roots}");
    }

    #[test]
    fn known_gaussians_are_at_their_exact_distance_within_its_error() {
        for shift in [0.1, 1.0f64] {
            let exact = 1.0 - erfc(shift / 8f64.sqrt());
            let exact_hellinger = (-(-shift * shift / 8.0).exp_m1()).sqrt();
            let without = distances(&known(&gaussian(0.0)), &known(&gaussian(shift)), false);
            let without = without.unwrap();
            // Cells of h = 0.05: both distances of the averages are low by about h²/24 relatively.
            assert!((without.total_variation.value / exact - 1.0).abs() < 1e-3);
            assert!((without.hellinger.value / exact_hellinger - 1.0).abs() < 1e-3);
            assert_eq!(without.total_variation.error, 0.0);
            assert_eq!(without.total_variation.noise, 0.0);
            let (p, q) = (gaussian(0.0), gaussian(shift));
            let runs = 12;
            let (mut sum, mut squares, mut error) = (0.0, 0.0, 0.0);
            for seed in 0..runs {
                let (one, other) = (histogram(&p, 1e6, seed), histogram(&q, 1e6, 100 + seed));
                let found = distances(&one, &other, false).unwrap().total_variation;
                assert!(found.is_significant(), "{found:?}");
                let far = (found.value - exact).abs();
                assert!(far < 4.0 * found.error + found.noise, "{found:?} {exact}");
                sum += found.value;
                squares += found.value * found.value;
                error += found.error / runs as f64;
            }
            let mean = sum / runs as f64;
            let spread =
                ((squares / runs as f64 - mean * mean) * runs as f64 / (runs as f64 - 1.0)).sqrt();
            // The spread of 12 runs is uncertain by 1/√22 = 21 %.
            assert!((spread / error - 1.0).abs() < 0.65, "{spread:e} {error:e}");
        }
    }

    #[test]
    fn the_second_scheme_bounds_what_the_grid_may_change() {
        let (p, q) = (gaussian(0.0), gaussian(0.02));
        let difference: Vec<f64> = q.iter().zip(&p).map(|(q, p)| q - p).collect();
        let observable = Observable::Marginal(0);
        let one = estimate_from_difference(&space(), observable, &p, &difference).unwrap();
        let found = distances(&one, &known(&q), false).unwrap().total_variation;
        assert!((found.systematic - found.value).abs() < 1e-12);
        assert!(!found.is_significant());
    }

    #[test]
    fn negative_values_count_as_zero_and_are_a_part_of_the_error() {
        // Far apart, each with a tenth of all mass below zero beside it.
        let with_trough = |mean: f64| {
            let (all, beside) = (gaussian(mean), gaussian(mean + 1.0));
            let pairs = all.iter().zip(&beside);
            known(&pairs.map(|(p, q)| 1.5 * p - 0.5 * q).collect::<Vec<_>>())
        };
        let (one, other) = (with_trough(-3.0), with_trough(3.0));
        let found = distances(&one, &other, false).unwrap().total_variation;
        let below = |one: &EstimatedDensity| -> f64 {
            one.density.masses().iter().map(|mass| mass.min(0.0)).sum()
        };
        assert!(below(&one) < -0.05 && found.value <= 1.0, "{found:?}");
        let negative = -below(&one) - below(&other);
        assert!((found.systematic - negative).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn shared_samples_cancel() {
        let one = histogram(&gaussian(0.0), 1e4, 1);
        let apart = distances(&one, &one, false).unwrap().total_variation;
        let shared = distances(&one, &one, true).unwrap().total_variation;
        assert_eq!((apart.value, shared.value), (0.0, 0.0));
        assert!(apart.noise > 0.01 && shared.noise == 0.0);
    }
}
