//! Integrated autocorrelation times by Sokal's windowing.

/// A window ends at this many autocorrelation times (Sokal, "Monte Carlo methods in statistical mechanics", 1997): what
/// is cut off is then below e⁻⁵ of an exponential, and longer windows add noise.
const WINDOW: f64 = 5.0;

/// What a stationary series says of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Correlation {
    /// Mean.
    pub(super) mean: f64,
    /// Integrated autocorrelation time ½ + Σ ρ_k, in records; never below ½.
    pub(super) time: f64,
    /// Long-run variance: the variance of a mean over n records is this over n.
    pub(super) long_run_variance: f64,
}

/// Correlation of several realisations of one stationary series, `series[realisation][record]`, all of one length.
/// The mean is that of all: where realisations stay in different places, they are seen to be correlated for ever.
pub(super) fn correlation(series: &[Vec<f64>]) -> Correlation {
    let records = series.first().map_or(0, Vec::len);
    let values = (series.len() * records).max(1) as f64;
    let mean = series.iter().flatten().sum::<f64>() / values;
    let covariance = |lag: usize| {
        let pairs = |one: &Vec<f64>| -> f64 {
            let later = one[lag..].iter();
            one.iter()
                .zip(later)
                .map(|(a, b)| (a - mean) * (b - mean))
                .sum()
        };
        series.iter().map(pairs).sum::<f64>() / (series.len() * (records - lag)).max(1) as f64
    };
    let variance = covariance(0);
    let mut time = 0.5;
    if variance > 0.0 {
        for lag in 1..records / 2 {
            time += covariance(lag) / variance;
            if lag as f64 >= WINDOW * time {
                break;
            }
        }
    }
    let time = time.max(0.5);
    Correlation {
        mean,
        time,
        long_run_variance: 2.0 * time * variance,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// x' = a x + √(1-a²) ξ: ρ_k = a^k, variance 1.
    fn autoregressive(a: f64, realisations: usize, records: usize) -> Vec<Vec<f64>> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut series = Vec::new();
        for _ in 0..realisations {
            let mut x = normal();
            let mut of_one = Vec::new();
            for _ in 0..records {
                of_one.push(3.0 + x);
                x = a * x + (1.0 - a * a).sqrt() * normal();
            }
            series.push(of_one);
        }
        series
    }

    #[test]
    fn an_autoregressive_series_has_its_exact_time() {
        for a in [0.0, 0.5, 0.9, 0.98] {
            let found = correlation(&autoregressive(a, 100, 2000));
            let exact = 0.5 * (1.0 + a) / (1.0 - a);
            // Relative error √(2(2W+1)/n) with a window of W = 5τ records, n = 2e5 (Madras and Sokal 1988); e⁻⁵ is cut
            // off.
            let error = (2.0 * (2.0 * WINDOW * exact + 1.0) / 2e5_f64).sqrt() + 0.007;
            assert!(
                (found.time / exact - 1.0).abs() < 4.0 * error,
                "{a}: {found:?} {exact}"
            );
            let deviation = (2.0 * exact / 2e5).sqrt();
            assert!((found.mean - 3.0).abs() < 4.0 * deviation, "{a}: {found:?}");
        }
    }

    #[test]
    fn realisations_that_stay_apart_are_correlated_as_long_as_they_are_watched() {
        let stuck = [vec![1.0; 100], vec![-1.0; 100]];
        assert!(correlation(&stuck).time > 25.0);
    }

    #[test]
    fn a_constant_series_has_no_variance() {
        let found = correlation(&[vec![2.0; 10]]);
        assert_eq!((found.mean, found.long_run_variance), (2.0, 0.0));
        assert_eq!(correlation(&[]).long_run_variance, 0.0);
    }
}
