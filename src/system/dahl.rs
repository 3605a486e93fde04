//! Duffing oscillator with Dahl friction (the paper's second example, with Dahl's law restored).
//!
//! The friction force λz comes from an internal displacement z that follows y elastically at first and
//! saturates at ±f_c/λ under steady sliding.

use std::sync::Arc;

use multiversion::multiversion;

use super::parameters::{ALPHA, DAHL_LEVEL, KAPPA, LAMBDA, MU, SIGMA2, X, Y, Z};
use super::{Lanes, Model, SwitchingSurface, Symmetry, System};

/// x' = y, y' = -κy - αx - μx³ - λz + ξ, z' = y - (λ|y|/f_c) z.
pub(super) static MODEL: Model = Model {
    name: "dahl",
    title: "Duffing oscillator with Dahl friction",
    equations: &[
        "x' = y",
        "y' = -κ y - α x - μ x³ - λ z + ξ(t)",
        "z' = y - (λ |y| / f_c) z,   |z| ≤ f_c/λ",
        "E[ξ(t) ξ(t+τ)] = σ² δ(τ)",
    ],
    axes: &[X, Y, Z],
    parameters: &[ALPHA, KAPPA, MU, LAMBDA, DAHL_LEVEL, SIGMA2],
    source: "the paper, Eqs. (7)-(9), with z as last factor of z'; P. R. Dahl, A solid friction model (1968)",
    notes: &[
        "The paper's Eqs. (8) and (9) print x as the last factor of z'. Dahl's law has z, and with it the paper's claims hold; the printed equations are the model `dahl_eq8`, which has no steady state.",
        "The friction force λ z stays within ±f_c. The internal displacement z is an axis of the cell space like x and y.",
    ],
    bind: |values| {
        Arc::new(Dahl {
            alpha: values[0],
            kappa: values[1],
            mu: values[2],
            lambda: values[3],
            f_c: values[4],
            sigma: values[5].sqrt(),
        })
    },
};

struct Dahl {
    alpha: f64,
    kappa: f64,
    mu: f64,
    lambda: f64,
    f_c: f64,
    sigma: f64,
}

#[multiversion(targets = "simd")]
fn drift(parameters: &Dahl, states: &[Lanes], drift: &mut [Lanes]) {
    let ([x, y, z], [x_slope, y_slope, z_slope]) = (states, drift) else {
        return;
    };
    let &Dahl {
        alpha,
        kappa,
        mu,
        lambda,
        f_c,
        ..
    } = parameters;
    let saturation = lambda / f_c;
    for lane in 0..x.len() {
        let (x, y, z) = (x[lane], y[lane], z[lane]);
        x_slope[lane] = y;
        y_slope[lane] = -kappa * y - x * (alpha + mu * x * x) - lambda * z;
        z_slope[lane] = y - saturation * y.abs() * z;
    }
}

impl System for Dahl {
    fn dimension(&self) -> usize {
        3
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

    fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        let limit = self.f_c / self.lambda;
        (axis == 2).then_some((-limit, limit))
    }

    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        vec![SwitchingSurface { axis: 1, at: 0.0 }]
    }

    fn symmetry(&self) -> Option<Symmetry> {
        Some(Symmetry {
            centre: vec![0.0; 3],
            reflected: vec![true; 3],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::contract::bound;

    #[test]
    fn the_drift_is_the_equation() {
        let values = [
            ("alpha", -1.0),
            ("kappa", 0.1),
            ("mu", 1.0),
            ("lambda", 0.5),
            ("f_c", 0.25),
            ("sigma2", 0.04),
        ];
        let system = bound("dahl", &values);
        // y' = 0.1·2 + 3 - 27 - 0.5·0.4 = -24; z' = -2 - (0.5·2/0.25)·0.4 = -3.6.
        let drift = system.drift_at(0.0, &[3.0, -2.0, 0.4]);
        assert_eq!(drift[0], -2.0);
        assert!((drift[1] + 24.0).abs() < 1e-13, "{drift:?}");
        assert!((drift[2] + 3.6).abs() < 1e-14, "{drift:?}");
        assert_eq!(system.bounds(2), Some((-0.5, 0.5)));
        // Sliding at the limit leaves z where it is.
        assert_eq!(system.drift_at(0.0, &[0.0, 2.0, 0.5])[2], 0.0);
    }
}
