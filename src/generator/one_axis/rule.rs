//! Gauss-Legendre quadrature on the unit interval, and a system's drift and noise at a batch of places.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::numerics::sort_ascending;
use crate::system::{LANES, Lanes, System};

/// Gauss-Legendre points on a panel.
pub(crate) const NODES: usize = 8;

/// Points and weights on [0, 1], and the integrals of the polynomial through values at the points from 0 to each of
/// them.
pub(in crate::generator) struct Rule {
    pub(in crate::generator) points: [f64; NODES],
    pub(in crate::generator) weights: [f64; NODES],
    pub(in crate::generator) integrals: [[f64; NODES]; NODES],
}

impl Rule {
    pub(in crate::generator) fn new() -> Self {
        let (points, weights) = gauss();
        // Legendre polynomials shifted to [0, 1]; ∫₀ˣ P_n = (P_{n+1} - P_{n-1}) / (2 (2n+1)).
        let at = points.map(|x| legendre(2.0 * x - 1.0));
        let mut integrals = [[0.0; NODES]; NODES];
        for to in 0..NODES {
            for from in 0..NODES {
                // Coefficient of P_n: (2n+1) Σ w f P_n, by the quadrature exact.
                integrals[to][from] = (0..NODES)
                    .map(|n| {
                        let below = if n == 0 { -1.0 } else { at[to][n - 1] };
                        let integral = 0.5 * (at[to][n + 1] - below);
                        weights[from] * at[from][n] * integral
                    })
                    .sum();
            }
        }
        Self {
            points,
            weights,
            integrals,
        }
    }
}

/// Gauss-Legendre points and weights on [0, 1] by Golub and Welsch.
fn gauss() -> ([f64; NODES], [f64; NODES]) {
    let beside = |k: usize| {
        let k = k as f64;
        k / (4.0 * k * k - 1.0).sqrt()
    };
    let matrix = DMatrix::from_fn(NODES, NODES, |i, j| match i.abs_diff(j) {
        1 => beside(i.max(j)),
        _ => 0.0,
    });
    let eigen = SymmetricEigen::new(matrix);
    let mut order: Vec<usize> = (0..NODES).collect();
    sort_ascending(&mut order, |&place| eigen.eigenvalues[place]);
    let (mut points, mut weights) = ([0.0; NODES], [0.0; NODES]);
    for (slot, index) in order.into_iter().enumerate() {
        points[slot] = 0.5 + 0.5 * eigen.eigenvalues[index];
        weights[slot] = eigen.eigenvectors[(0, index)].powi(2);
    }
    (points, weights)
}

/// Drift and noise intensity at a batch of places.
pub(in crate::generator) fn look(system: &dyn System, places: &Lanes) -> (Lanes, Lanes) {
    let states = [*places];
    let mut drift = [[0.0; LANES]];
    system.drift(0.0, &states, &mut drift);
    let mut intensity = [0.0; LANES];
    for noise in system.noises() {
        for (sum, b) in intensity.iter_mut().zip(noise.amplitudes(0.0, &states)) {
            *sum += b * b;
        }
    }
    (drift[0], intensity)
}

/// The Legendre polynomials P_0 to P_8 at a place between -1 and 1.
pub(in crate::generator) fn legendre(u: f64) -> [f64; NODES + 1] {
    let mut values = [1.0; NODES + 1];
    values[1] = u;
    for n in 1..NODES {
        let k = n as f64;
        values[n + 1] = ((2.0 * k + 1.0) * u * values[n] - k * values[n - 1]) / (k + 1.0);
    }
    values
}
