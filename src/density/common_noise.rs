//! How much of the sampling noise two cells have in common: what their *difference* is uncertain by.
//!
//! A solve spreads the noise of a transition: densities of near cells err alike, and a slow mode (more mass in
//! one well, less in the other) moves whole regions together. The height of a peak over its saddle is a difference,
//! in which common noise cancels. With var the jackknife variance over the replicates, the share that is left
//! at a lag L between cells is pooled over all pairs of cells at that lag,
//!
//! ```text
//! share(L) = Σ var(p_a - p_b) / Σ (var p_a + var p_b),    so var(p_a - p_b) ≈ share(L) (s_a² + s_b²),
//! ```
//!
//! a variogram over twice the variance (Matheron 1963). Independent cells have 1, equal ones 0. A few replicates
//! do for a number that so many pairs share. The share is made to grow with the lag, so that noise which comes
//! and goes does not pass for common, and does not exceed 1: the errors can only become smaller than those of
//! independent cells.

use super::Density;

/// Longest lag along each axis of a joint density; cells farther apart are taken for independent. The work is
/// this squared times the cells.
const LONGEST_LAG: usize = 12;

/// Least share, so that replicates which happen to agree do not make a difference exact.
const LEAST_SHARE: f64 = 0.02;

/// Share of the noise of two cells that their difference keeps, by their lag along each axis. The default is that
/// of independent cells, 1 at every lag.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CommonNoise {
    /// Numbers of lags, the lag 0 included, along rows and columns.
    lags: [usize; 2],
    /// One share a pair of lags, the lag of columns fastest.
    shares: Vec<f64>,
    columns: usize,
}

impl CommonNoise {
    /// From the replicates of a density over one or two axes.
    pub(super) fn from_replicates(density: &Density, replicates: &[Density]) -> Self {
        let (rows, columns, lags) = match density.axes.as_slice() {
            [axis] => (1, axis.count(), [1, axis.count()]),
            [first, second] => {
                let lags = |count: usize| count.min(LONGEST_LAG + 1);
                let (rows, columns) = (first.count(), second.count());
                (rows, columns, [lags(rows), lags(columns)])
            }
            _ => return Self::default(),
        };
        let deviations = deviations(replicates, rows * columns);
        let mut shares = vec![0.0; lags[0] * lags[1]];
        for down in 0..lags[0] {
            for right in 0..lags[1] {
                let mut share = pooled_share(&deviations, (rows, columns), (down, right));
                // The larger of those at shorter lags, which are done already.
                if down > 0 {
                    share = share.max(shares[(down - 1) * lags[1] + right]);
                }
                if right > 0 {
                    share = share.max(shares[down * lags[1] + right - 1]);
                }
                shares[down * lags[1] + right] = share;
            }
        }
        Self {
            lags,
            shares,
            columns,
        }
    }

    /// The share that the difference of the values of two cells keeps, more than 0 and at most 1.
    pub fn share(&self, first: usize, second: usize) -> f64 {
        let columns = self.columns.max(1);
        let down = (first / columns).abs_diff(second / columns);
        let right = (first % columns).abs_diff(second % columns);
        if down < self.lags[0] && right < self.lags[1] {
            self.shares[down * self.lags[1] + right]
        } else {
            1.0
        }
    }
}

/// Deviations of the replicates from their mean, for each cell all replicates in turn.
fn deviations(replicates: &[Density], cells: usize) -> Vec<Vec<f64>> {
    let groups = replicates.len() as f64;
    let of_cell = |cell: usize| {
        let values = || {
            replicates
                .iter()
                .map(move |replicate| replicate.values[cell])
        };
        let mean = values().sum::<f64>() / groups;
        values().map(|value| value - mean).collect()
    };
    (0..cells).map(of_cell).collect()
}

/// The share at one lag, over all pairs of cells, those along both diagonals alike.
fn pooled_share(
    deviations: &[Vec<f64>],
    (rows, columns): (usize, usize),
    (down, right): (usize, usize),
) -> f64 {
    let (mut difference, mut separate) = (0.0, 0.0);
    for row in 0..rows - down {
        for column in 0..columns - right {
            let corner = row * columns + column;
            let opposite = corner + down * columns + right;
            let across = (corner + right, corner + down * columns);
            for (a, b) in [(corner, opposite), across] {
                for (a, b) in deviations[a].iter().zip(&deviations[b]) {
                    difference += (a - b) * (a - b);
                    separate += a * a + b * b;
                }
            }
        }
    }
    if separate > 0.0 {
        (difference / separate).clamp(LEAST_SHARE, 1.0)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// Eight replicates over `axes`, made by a function that is given fresh white noise.
    fn shares(axes: &[Axis], shape: impl Fn(&[f64]) -> Vec<f64>) -> CommonNoise {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(4);
        let cells = axes.iter().map(Axis::count).product();
        let mut one = || {
            let white: Vec<f64> = (0..cells).map(|_| random.sample(StandardNormal)).collect();
            Density {
                axes: axes.to_vec(),
                values: shape(&white),
            }
        };
        let replicates: Vec<Density> = (0..8).map(|_| one()).collect();
        CommonNoise::from_replicates(&replicates[0], &replicates)
    }

    fn axis(count: usize) -> Axis {
        Axis::uniform(0.0, 1.0, count).unwrap()
    }

    #[test]
    fn white_noise_shares_nothing_and_a_common_factor_everything() {
        // The correlation of 1500 pairs of 7 degrees of freedom each is 0 to 0.01 (one standard deviation).
        let white = shares(&[axis(40), axis(40)], <[f64]>::to_vec);
        for (a, b) in [(820, 821), (820, 860), (820, 861), (820, 819 + 120)] {
            assert!(white.share(a, b) > 0.95, "{a} {b}: {}", white.share(a, b));
        }
        let common = shares(&[axis(40)], |white| vec![1.0 + white[0]; 40]);
        assert_eq!(common.share(3, 30), LEAST_SHARE);
        assert_eq!(CommonNoise::default().share(7, 900), 1.0);
    }

    #[test]
    fn a_moving_sum_has_the_share_of_its_overlap() {
        // Sums of 10 cells overlap in 10 - L: the variance of a difference is L/10 of that of two separate sums.
        let moving = shares(&[axis(4000)], |white| {
            let sum = |at: usize| (0..10).map(|k| white[(at + k) % white.len()]).sum();
            (0..white.len()).map(sum).collect()
        });
        // 400 independent stretches × 7 degrees of freedom: 3 %.
        for lag in [1, 2, 5] {
            let share = moving.share(100, 100 + lag);
            assert!(
                (share / (lag as f64 / 10.0) - 1.0).abs() < 0.1,
                "{lag}: {share}"
            );
        }
        assert!(moving.share(100, 130) > 0.9);
    }

    #[test]
    fn lags_beyond_the_longest_are_independent_and_signs_of_a_lag_do_not_matter() {
        let axes = [axis(30), axis(20)];
        let common = shares(&axes, |white| vec![white[0]; 600]);
        let cell = |row: usize, column: usize| row * 20 + column;
        assert_eq!(common.share(cell(0, 0), cell(13, 0)), 1.0);
        assert_eq!(
            common.share(cell(5, 9), cell(7, 4)),
            common.share(cell(5, 4), cell(7, 9))
        );
        assert_eq!(common.share(cell(5, 9), cell(7, 4)), LEAST_SHARE);
    }
}
