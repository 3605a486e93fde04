//! Deviations on two axes: the angle φ of the deviation v is a diffusion of its own, with period π, and λ an average
//! over its stationary density.
//!
//! With s = (cos φ, sin φ) and n = (-sin φ, cos φ), Itô's formula gives
//!
//! ```text
//! dφ = [n·A s - Σ (s·B_k s)(n·B_k s)] dt + Σ n·B_k s dW_k
//! λ = E[s·A s + ½ Σ ((n·B_k s)² - (s·B_k s)²)]
//! ```
//!
//! All of these are trigonometric polynomials of 2φ of at most second degree, so that the Fourier coefficients q_k of
//! the density obey equations in which each has its neighbours alone. They are cut off at a number of modes, which is
//! doubled until half as many more change nothing.

use super::Exponent;
use super::banded::Banded;
use super::waves::{Complex, Matrix, Waves};

/// Modes at first, and at most.
const MODES: [usize; 2] = [16, 1 << 16];

/// Change, relative to the sizes of A and B², at which more modes are not tried.
const TOLERANCE: f64 = 1e-14;

/// What rounding leaves, relative to the same.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// A coefficient smaller than that, relative to its matrix, is rounding.
const NOTHING: f64 = 1e-14;

/// The largest exponent of dv = A v dt + Σ B_k v dW_k.
pub(super) fn largest(a: &Matrix, noises: &[Matrix]) -> Exponent {
    let turning = |b: &&Matrix| Waves::across(b).size() > NOTHING * size_of(b);
    let scale = size_of(a) + noises.iter().map(|b| size_of(b).powi(2)).sum::<f64>();
    let exactly = |value: f64| Exponent {
        value,
        error: ROUNDING * scale,
    };
    let Some(first) = noises.iter().find(turning) else {
        return exactly(growth_without_turning(a, noises));
    };
    let keeps =
        |m: &Matrix, angle: f64| Waves::across(m).value(angle).abs() <= NOTHING * size_of(m) * 8.0;
    let kept = Waves::across(first)
        .zeros()
        .into_iter()
        .find(|&angle| keeps(a, angle) && noises.iter().all(|b| keeps(b, angle)));
    if let Some(angle) = kept {
        return exactly(growth_of_triangles(a, noises, angle));
    }
    let angular = Angular::new(a, noises);
    let mut modes = MODES[0];
    loop {
        let value = angular.growth(3 * modes / 2);
        let change = (value - angular.growth(modes)).abs();
        modes *= 2;
        // A change that is not a number is not small.
        if change <= TOLERANCE * scale || modes > MODES[1] {
            let change = if change.is_finite() { change } else { scale };
            return Exponent {
                value: if value.is_finite() { value } else { 0.0 },
                error: change + ROUNDING * scale,
            };
        }
    }
}

fn size_of(m: &Matrix) -> f64 {
    m.iter().flatten().fold(0.0, |most, x| most.max(x.abs()))
}

/// λ where every noise stretches all directions alike: the largest real part of the eigenvalues of A, less ½ Σ b_k².
fn growth_without_turning(a: &Matrix, noises: &[Matrix]) -> f64 {
    let half = 0.5 * (a[0][0] - a[1][1]);
    let beyond = (half * half + a[0][1] * a[1][0]).max(0.0).sqrt();
    let mean = |m: &Matrix| 0.5 * (m[0][0] + m[1][1]);
    let losses: f64 = noises.iter().map(|b| 0.5 * mean(b).powi(2)).sum();
    mean(a) + beyond - losses
}

/// λ where all matrices keep one direction: they are triangular beside it, and the exponents are those of the
/// diagonals.
fn growth_of_triangles(a: &Matrix, noises: &[Matrix], angle: f64) -> f64 {
    let kept = |m: &Matrix| Waves::along(m).value(angle);
    let other = |m: &Matrix| m[0][0] + m[1][1] - kept(m);
    let growth = |diagonal: &dyn Fn(&Matrix) -> f64| {
        let losses: f64 = noises.iter().map(|b| 0.5 * diagonal(b).powi(2)).sum();
        diagonal(a) - losses
    };
    growth(&kept).max(growth(&other))
}

/// Drift and diffusion of the angle, and the growth that is averaged.
struct Angular {
    drift: Waves,
    diffusion: Waves,
    growth: Waves,
}

impl Angular {
    fn new(a: &Matrix, noises: &[Matrix]) -> Self {
        let mut angular = Self {
            drift: Waves::across(a),
            diffusion: Waves::default(),
            growth: Waves::along(a),
        };
        for b in noises {
            let (along, across) = (Waves::along(b), Waves::across(b));
            let squared = (across * across).times(0.5);
            angular.drift = angular.drift - along * across;
            angular.diffusion = angular.diffusion + squared;
            angular.growth = angular.growth + squared - (along * along).times(0.5);
        }
        angular
    }

    /// λ with so many modes. With p = Σ q_k e^{2ikφ}/π and q_0 = 1, what flows by the angle is the same everywhere:
    /// Σ_j (2i D_{k-j} - a_{k-j}/k) q_j = 0 for every k > 0.
    fn growth(&self, modes: usize) -> f64 {
        let mut equations = Banded::new(2 * modes);
        for k in 1..=modes as i64 {
            let row = 2 * (k as usize - 1);
            for j in k - 2..=k + 2 {
                let (d, a) = (self.diffusion.at(k - j), self.drift.at(k - j));
                let by_k = 1.0 / k as f64;
                let factor = Complex::new(-2.0 * d.im - by_k * a.re, 2.0 * d.re - by_k * a.im);
                match j {
                    0 => {
                        equations.add_right(row, -factor.re);
                        equations.add_right(row + 1, -factor.im);
                    }
                    // q_{-k} is the conjugate of q_k.
                    j => {
                        let sign = if j < 0 { -1.0 } else { 1.0 };
                        let column = 2 * (j.unsigned_abs() as usize - 1);
                        equations.add(row, column, factor.re);
                        equations.add(row, column + 1, -sign * factor.im);
                        equations.add(row + 1, column, factor.im);
                        equations.add(row + 1, column + 1, sign * factor.re);
                    }
                }
            }
        }
        let found = equations.solve();
        let mode = |k: usize| Complex::new(found[2 * k - 2], found[2 * k - 1]);
        let mean = |k: usize| 2.0 * (self.growth.at(k as i64).conjugate() * mode(k)).re;
        self.growth.at(0).re + mean(1) + mean(2)
    }
}
