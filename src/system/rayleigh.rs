//! Oscillator whose damping depends on its energy: its steady state is known exactly (Caughey and Ma).

use std::sync::Arc;

use multiversion::multiversion;

use super::parameters::{ALPHA, GROWTH, MU, SATURATION, SIGMA2, X, Y};
use super::{Lanes, Model, Symmetry, System};

/// x' = y, y' = -(-a + bH)y - αx - μx³ + ξ, H the energy.
pub(super) static MODEL: Model = Model {
    name: "rayleigh",
    title: "Oscillator with energy-dependent damping, exactly solvable",
    equations: &[
        "x' = y",
        "y' = -(-a + b H) y - α x - μ x³ + ξ(t)",
        "H = y²/2 + α x²/2 + μ x⁴/4",
        "E[ξ(t) ξ(t+τ)] = σ² δ(τ)",
    ],
    axes: &[X, Y],
    parameters: &[GROWTH, SATURATION, ALPHA, MU, SIGMA2],
    source: "T. K. Caughey and F. Ma, The exact steady-state solution of a class of non-linear stochastic systems (1982)",
    notes: &[
        "The steady state is p ∝ exp(-(2/σ²)(-a H + b H²/2)): with α > 0 and μ ≥ 0 the joint density has one peak for a ≤ 0 and a crater for a > 0.",
    ],
    bind: |values| {
        Arc::new(Rayleigh {
            a: values[0],
            b: values[1],
            alpha: values[2],
            mu: values[3],
            sigma: values[4].sqrt(),
            sigma2: values[4],
        })
    },
};

struct Rayleigh {
    a: f64,
    b: f64,
    alpha: f64,
    mu: f64,
    sigma: f64,
    sigma2: f64,
}

/// H = y²/2 + αx²/2 + μx⁴/4.
#[inline(always)]
fn energy(parameters: &Rayleigh, x: f64, y: f64) -> f64 {
    let square = x * x;
    0.5 * (y * y + square * (parameters.alpha + 0.5 * parameters.mu * square))
}

#[multiversion(targets = "simd")]
fn drift(parameters: &Rayleigh, states: &[Lanes], drift: &mut [Lanes]) {
    let ([x, y], [x_slope, y_slope]) = (states, drift) else {
        return;
    };
    let &Rayleigh {
        a, b, alpha, mu, ..
    } = parameters;
    for lane in 0..x.len() {
        let (x, y) = (x[lane], y[lane]);
        x_slope[lane] = y;
        y_slope[lane] = (a - b * energy(parameters, x, y)) * y - x * (alpha + mu * x * x);
    }
}

impl System for Rayleigh {
    fn dimension(&self) -> usize {
        2
    }

    fn drift(&self, _time: f64, states: &[Lanes], slopes: &mut [Lanes]) {
        drift(self, states, slopes);
    }

    fn noise_axes(&self) -> &[usize] {
        &[1]
    }

    fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
        Some(self.sigma)
    }

    fn symmetry(&self) -> Option<Symmetry> {
        Some(Symmetry {
            centre: vec![0.0, 0.0],
            reflected: vec![true, true],
        })
    }

    /// p ∝ exp(-(2/σ²)(-aH + bH²/2)).
    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        let &[x, y] = state else { return None };
        let energy = energy(self, x, y);
        Some(2.0 / self.sigma2 * energy * (self.a - 0.5 * self.b * energy))
    }
}

#[cfg(test)]
mod tests {
    use super::super::contract::{assert_stationary, bound};

    #[test]
    fn the_drift_is_the_equation() {
        let values = [("a", 0.5), ("b", 0.25), ("mu", 2.0), ("sigma2", 0.09)];
        let system = bound("rayleigh", &values);
        // H = 9/2 + 4/2 + 2·16/4 = 14.5; y' = -(-0.5 + 3.625)·3 - 2 - 16 = -27.375.
        let drift = system.drift_at(0.0, &[2.0, 3.0]);
        assert_eq!(drift, vec![3.0, -27.375]);
    }

    #[test]
    fn the_density_solves_fokker_planck_on_both_sides_of_the_bifurcation() {
        for a in [-0.4, 0.6] {
            let values = [("a", a), ("b", 0.3), ("mu", 0.2), ("sigma2", 0.5)];
            assert_stationary(&*bound("rayleigh", &values), true);
        }
    }
}
