//! Duffing oscillator with Coulomb friction (the paper's first example).
//!
//! Convention of the paper's Eq. (7): κ is the viscous damping, α the linear stiffness.

use std::sync::Arc;

use multiversion::multiversion;

use super::parameters::{ALPHA, COULOMB_LEVEL, KAPPA, MU, SIGMA2, X, Y};
use super::{Lanes, Model, SwitchingSurface, Symmetry, System};

/// x' = y, y' = -κy - αx - μx³ - f_c sgn(y) + ξ.
pub(super) static MODEL: Model = Model {
    name: "coulomb",
    title: "Duffing oscillator with Coulomb friction",
    equations: &[
        "x' = y",
        "y' = -κ y - α x - μ x³ - f_c sgn(y) + ξ(t),   sgn(0) = 0",
        "E[ξ(t) ξ(t+τ)] = σ² δ(τ)",
    ],
    axes: &[X, Y],
    parameters: &[ALPHA, KAPPA, MU, COULOMB_LEVEL, SIGMA2],
    source: "the paper, Eqs. (5)-(6), with the letters of Eq. (7)",
    notes: &[
        "The paper's Eq. (5) prints α = 1 as damping and κ = 0.01 as stiffness. With that reading the marginal of x has one peak at every f_c, against the paper's Fig. 2(a); with the letters of its Eq. (7), used here, its figures come out.",
        "The marginal of y has a kink at 0, p'(0+)/p(0) = -2 f_c/σ², so it changes from two peaks to one exactly at f_c = 0.",
    ],
    bind: |values| {
        Arc::new(Coulomb {
            alpha: values[0],
            kappa: values[1],
            mu: values[2],
            f_c: values[3],
            sigma: values[4].sqrt(),
            sigma2: values[4],
        })
    },
};

struct Coulomb {
    alpha: f64,
    kappa: f64,
    mu: f64,
    f_c: f64,
    sigma: f64,
    sigma2: f64,
}

/// Sign with sgn(0) = 0, written so that it compiles to selects on vector registers.
#[inline(always)]
fn sign(value: f64) -> f64 {
    let positive = if value > 0.0 { 1.0 } else { 0.0 };
    let negative = if value < 0.0 { 1.0 } else { 0.0 };
    positive - negative
}

#[multiversion(targets = "simd")]
fn drift(parameters: &Coulomb, states: &[Lanes], drift: &mut [Lanes]) {
    let ([x, y], [x_slope, y_slope]) = (states, drift) else {
        return;
    };
    let &Coulomb {
        alpha,
        kappa,
        mu,
        f_c,
        ..
    } = parameters;
    for lane in 0..x.len() {
        let (x, y) = (x[lane], y[lane]);
        x_slope[lane] = y;
        y_slope[lane] = -kappa * y - x * (alpha + mu * x * x) - f_c * sign(y);
    }
}

impl System for Coulomb {
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

    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        vec![SwitchingSurface { axis: 1, at: 0.0 }]
    }

    fn symmetry(&self) -> Option<Symmetry> {
        Some(Symmetry {
            centre: vec![0.0, 0.0],
            reflected: vec![true, true],
        })
    }

    /// Known without friction: p ∝ exp(-(2κ/σ²)(y²/2 + αx²/2 + μx⁴/4)).
    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        let &[x, y] = state else { return None };
        let energy = 0.5 * y * y + 0.5 * self.alpha * x * x + 0.25 * self.mu * x.powi(4);
        (self.f_c == 0.0).then_some(-2.0 * self.kappa / self.sigma2 * energy)
    }
}

#[cfg(test)]
mod tests {
    use super::super::contract::{assert_stationary, bound};

    #[test]
    fn the_drift_is_the_equation() {
        let values = [
            ("alpha", 1.5),
            ("kappa", 0.2),
            ("mu", 0.25),
            ("f_c", 0.5),
            ("sigma2", 0.04),
        ];
        let system = bound("coulomb", &values);
        // -0.2·3 - 1.5·2 - 0.25·8 - 0.5 = -6.1, and +0.6 - 3 - 2 + 0.5 = -3.9.
        for (state, expected) in [
            ([2.0, 3.0], -6.1),
            ([2.0, -3.0], -3.9),
            // sgn(0) = 0, also for the negative zero.
            ([2.0, 0.0], -5.0),
            ([2.0, -0.0], -5.0),
        ] {
            let drift = system.drift_at(0.0, &state);
            assert_eq!(drift[0], state[1]);
            assert!((drift[1] - expected).abs() < 1e-14, "{drift:?}");
        }
        assert_eq!(system.additive_amplitude(0), Some(0.2));
    }

    #[test]
    fn the_density_is_known_only_without_friction() {
        let values = |f_c| [("kappa", 0.3), ("mu", 0.2), ("f_c", f_c), ("sigma2", 0.5)];
        assert_stationary(&*bound("coulomb", &values(0.0)), true);
        let rubbing = bound("coulomb", &values(0.1));
        assert_eq!(rubbing.exact_log_density(&[0.5, 0.5]), None);
    }
}
