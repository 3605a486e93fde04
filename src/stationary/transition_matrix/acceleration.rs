//! Anderson's acceleration of a fixed-point iteration on masses (J. ACM 12, 1965; Walker and Ni, SIAM J. Numer.
//! Anal. 49, 2011): combines the latest iterates so that their changes cancel as well as they can.
//!
//! Lumping makes a weakly damped chain more diffusive than it is, so that corrections of its few slow modes fall
//! short by a constant factor. A few slow modes are what a combination of a few iterates removes.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector};

/// Entries of a combination stay within this factor of the iterate: masses stay positive.
const LARGEST_FACTOR: f64 = 4.0;

/// Relative pivot below which changes count as dependent.
const DEPENDENT: f64 = 1e-10;

/// Growth of the change over the smallest one at which the history misleads and is dropped.
const RESTART: f64 = 10.0;

/// The latest iterates of p ← G(p).
pub(super) struct Acceleration {
    window: usize,
    /// Differences of successive images and of successive changes, latest last.
    differences: VecDeque<(Vec<f64>, Vec<f64>)>,
    latest: Option<(Vec<f64>, Vec<f64>)>,
    smallest_change: f64,
}

impl Acceleration {
    /// Combines up to `window` earlier iterates with the current one.
    pub(super) fn new(window: usize) -> Self {
        Self {
            window,
            differences: VecDeque::new(),
            latest: None,
            smallest_change: f64::INFINITY,
        }
    }

    /// Takes an iterate and its image G(p), all positive; turns the image into the next iterate (Σ = 1 to rounding).
    pub(super) fn step(&mut self, iterate: &[f64], image: &mut [f64]) {
        let change: Vec<f64> = image.iter().zip(iterate).map(|(g, p)| g - p).collect();
        let length: f64 = change.iter().map(|value| value.abs()).sum();
        self.smallest_change = self.smallest_change.min(length);
        if length > RESTART * self.smallest_change {
            self.differences.clear();
            self.latest = None;
            self.smallest_change = length;
        }
        let weight: Vec<f64> = image.iter().map(|mass| 1.0 / mass).collect();
        if let Some((old_image, old_change)) = self.latest.take() {
            let images = image.iter().zip(&old_image).map(|(new, old)| new - old);
            let changes = change.iter().zip(&old_change).map(|(new, old)| new - old);
            self.differences
                .push_back((images.collect(), changes.collect()));
            if self.differences.len() > self.window {
                self.differences.pop_front();
            }
        }
        self.latest = Some((image.to_vec(), change));
        let Some(coefficients) = self.coefficients(&weight) else {
            return;
        };
        let plain = image.to_vec();
        for ((images, _), coefficient) in self.differences.iter().zip(&coefficients) {
            for (value, difference) in image.iter_mut().zip(images) {
                *value -= coefficient * difference;
            }
        }
        for (value, plain) in image.iter_mut().zip(plain) {
            *value = value.clamp(plain / LARGEST_FACTOR, plain * LARGEST_FACTOR);
        }
    }

    /// Least squares: the combination of earlier differences that comes nearest to the latest change, in the
    /// norm Σ v²/p, in which the modes of a reversible chain are orthogonal.
    fn coefficients(&self, weight: &[f64]) -> Option<Vec<f64>> {
        let (_, change) = self.latest.as_ref()?;
        let size = self.differences.len();
        let product = |a: &[f64], b: &[f64]| -> f64 {
            let terms = a.iter().zip(b).zip(weight);
            terms.map(|((a, b), weight)| a * b * weight).sum()
        };
        let column = |index: usize| self.differences[index].1.as_slice();
        let gram = DMatrix::from_fn(size, size, |i, j| product(column(i), column(j)));
        let right = DVector::from_fn(size, |i, _| product(column(i), change));
        let scale: Vec<f64> = (0..size).map(|i| gram[(i, i)].sqrt()).collect();
        if size == 0
            || scale
                .iter()
                .any(|length| !(*length > 0.0 && length.is_finite()))
        {
            return None;
        }
        let scaled = DMatrix::from_fn(size, size, |i, j| gram[(i, j)] / (scale[i] * scale[j]));
        let regular = scaled + DMatrix::identity(size, size) * DEPENDENT;
        let right = DVector::from_fn(size, |i, _| right[i] / scale[i]);
        let solved = regular.cholesky()?.solve(&right);
        let found: Vec<f64> = solved
            .iter()
            .zip(&scale)
            .map(|(x, scale)| x / scale)
            .collect();
        found.iter().all(|value| value.is_finite()).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear map towards `(0.2, 0.3, 0.5)` that contracts sum-free differences by 0.9 and 0.5.
    fn image(p: &[f64]) -> Vec<f64> {
        let steady = [0.2, 0.3, 0.5];
        let off = [p[0] - steady[0], p[1] - steady[1]];
        let next = [0.9 * off[0], 0.1 * off[0] + 0.5 * off[1]];
        vec![
            steady[0] + next[0],
            steady[1] + next[1],
            steady[2] - next[0] - next[1],
        ]
    }

    #[test]
    fn as_many_steps_as_modes_solve_a_linear_map() {
        let mut acceleration = Acceleration::new(4);
        let mut p = vec![0.4, 0.35, 0.25];
        for _ in 0..4 {
            let mut next = image(&p);
            acceleration.step(&p, &mut next);
            p = next;
        }
        // Four plain steps would leave 0.9⁴ = 0.66 of the slow mode; the regularisation leaves about 1e-9.
        let error = crate::numerics::distance(&p, &[0.2, 0.3, 0.5]);
        assert!(error < 1e-7, "{error}");
    }
}
