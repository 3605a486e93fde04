//! The steady state of a system with one axis, free of subtraction: without flux the density is
//! p ∝ (1/b²) exp ∫ (2a/b²) dx, with drift a and noise intensity b².
//!
//! Every cell is correct to many digits *of its own value*, however deep the valleys between: where barriers are many times the
//! noise, weights of wells that no linear solver can tell from rounding come out of a quadrature. Polynomials through
//! Gauss-Legendre points on panels of each cell give the exponent and its integral.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::space::Axis;
use crate::system::{LANES, Lanes, System};

/// Gauss-Legendre points on a panel.
const NODES: usize = 8;
/// Panels a cell; eight points on each of eight panels fill a batch.
const PANELS: usize = LANES / NODES;

/// The steady state on the cells of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct OneAxis {
    /// Mass of every cell, Σ = 1; length is the number of cells.
    pub masses: Vec<f64>,
    /// Largest relative change of a cell's mass when half as many panels are used.
    pub error: f64,
    /// Mean and variance of the coordinate.
    pub moments: (f64, f64),
}

/// The steady state without flux through the ends; `None` where drift and noise do not allow it: more than one axis, noise that vanishes or is
/// not finite somewhere.
pub fn one_axis(system: &dyn System, axis: &Axis) -> Option<OneAxis> {
    if system.dimension() != 1 || system.period().is_some() {
        return None;
    }
    let rule = Rule::new();
    let fine = integrate(system, axis, &rule, PANELS)?;
    let coarse = integrate(system, axis, &rule, PANELS / 2)?;
    let pairs = fine.masses.iter().zip(&coarse.masses);
    let change = pairs.map(|(a, b)| if *a > 0.0 { (b / a - 1.0).abs() } else { 0.0 });
    Some(OneAxis {
        error: change.fold(0.0, f64::max),
        ..fine
    })
}

/// Points and weights on [0, 1], and the integrals of the polynomial through values at the points from 0 to each of them.
struct Rule {
    points: [f64; NODES],
    weights: [f64; NODES],
    integrals: [[f64; NODES]; NODES],
}

impl Rule {
    fn new() -> Self {
        let (points, weights) = gauss();
        // Legendre polynomials shifted to [0, 1]; ∫₀ˣ P_n = (P_{n+1} - P_{n-1}) / (2 (2n+1)).
        let legendre = |x: f64| {
            let u = 2.0 * x - 1.0;
            let mut values = [1.0; NODES + 1];
            values[1] = u;
            for n in 1..NODES {
                let k = n as f64;
                values[n + 1] = ((2.0 * k + 1.0) * u * values[n] - k * values[n - 1]) / (k + 1.0);
            }
            values
        };
        let at: Vec<[f64; NODES + 1]> = points.iter().map(|&x| legendre(x)).collect();
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
    order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
    let (mut points, mut weights) = ([0.0; NODES], [0.0; NODES]);
    for (slot, index) in order.into_iter().enumerate() {
        points[slot] = 0.5 + 0.5 * eigen.eigenvalues[index];
        weights[slot] = eigen.eigenvectors[(0, index)].powi(2);
    }
    (points, weights)
}

/// Drift and noise intensity at a batch of places.
fn look(system: &dyn System, places: &Lanes) -> (Lanes, Lanes) {
    let states = [*places];
    let mut drift = [[0.0; LANES]];
    system.drift(0.0, &states, &mut drift);
    let mut intensity = [0.0; LANES];
    for channel in 0..system.noise_axes().len() {
        let mut amplitude = [0.0; LANES];
        system.amplitude(channel, 0.0, &states, &mut amplitude);
        for (sum, b) in intensity.iter_mut().zip(amplitude) {
            *sum += b * b;
        }
    }
    (drift[0], intensity)
}

fn integrate(system: &dyn System, axis: &Axis, rule: &Rule, panels: usize) -> Option<OneAxis> {
    let count = axis.count();
    // Logarithms of the integrals over each cell of p and of p times the distance from its lower edge and its square.
    let (mut logs, mut firsts, mut seconds) =
        (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    let mut exponent = 0.0;
    for cell in 0..count {
        let (from, width) = (axis.edges()[cell], axis.width(cell) / panels as f64);
        let mut places = [from; LANES];
        for (lane, place) in places.iter_mut().enumerate().take(panels * NODES) {
            *place = from + width * ((lane / NODES) as f64 + rule.points[lane % NODES]);
        }
        let (drift, intensity) = look(system, &places);
        let start = exponent;
        let mut sums = [0.0; 3];
        for panel in 0..panels {
            let lanes = panel * NODES..(panel + 1) * NODES;
            let usable = lanes
                .clone()
                .all(|l| drift[l].is_finite() && intensity[l].is_finite() && intensity[l] > 0.0);
            if !usable {
                return None;
            }
            let rate: Vec<f64> = lanes
                .clone()
                .map(|l| 2.0 * drift[l] / intensity[l])
                .collect();
            for node in 0..NODES {
                let lane = panel * NODES + node;
                let rise: f64 = rule.integrals[node]
                    .iter()
                    .zip(&rate)
                    .map(|(w, r)| w * r)
                    .sum();
                let weight = rule.weights[node] * width * (exponent + width * rise - start).exp()
                    / intensity[lane];
                let offset = places[lane] - from;
                sums[0] += weight;
                sums[1] += weight * offset;
                sums[2] += weight * offset * offset;
            }
            let rise: f64 = rule.weights.iter().zip(&rate).map(|(w, r)| w * r).sum();
            exponent += width * rise;
        }
        logs[cell] = start + sums[0].ln();
        firsts[cell] = sums[1] / sums[0];
        seconds[cell] = sums[2] / sums[0];
    }
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut masses: Vec<f64> = logs.iter().map(|log| (log - largest).exp()).collect();
    let total: f64 = masses.iter().sum();
    if !total.is_finite() || total <= 0.0 {
        return None;
    }
    masses.iter_mut().for_each(|mass| *mass /= total);
    let mean: f64 = (0..count)
        .map(|i| masses[i] * (axis.edges()[i] + firsts[i]))
        .sum();
    let variance: f64 = (0..count)
        .map(|i| {
            let edge = axis.edges()[i] - mean;
            masses[i] * (edge * edge + 2.0 * edge * firsts[i] + seconds[i])
        })
        .sum();
    Some(OneAxis {
        masses,
        error: 0.0,
        moments: (mean, variance),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// dx = (h + x - x³) dt + σ dW.
    struct Tilted {
        h: f64,
        sigma2: f64,
    }

    impl System for Tilted {
        fn dimension(&self) -> usize {
            1
        }
        fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
            for (slope, x) in drift[0].iter_mut().zip(&states[0]) {
                *slope = self.h + x - x.powi(3);
            }
        }
        fn noise_axes(&self) -> &[usize] {
            &[0]
        }
        fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
            Some(self.sigma2.sqrt())
        }
    }

    #[test]
    fn cells_of_a_shallow_well_have_all_their_digits_beside_a_deep_one() {
        // Depths differ by more than 100 times the noise: e^-100 of the mass is in the left well.
        let system = Tilted {
            h: 0.38,
            sigma2: 0.014,
        };
        let axis = Axis::uniform(-1.9, 1.9, 200).unwrap();
        let found = one_axis(&system, &axis).unwrap();
        let potential = |x: f64| -system.h * x - 0.5 * x * x + 0.25 * x.powi(4);
        let p = |x: f64| (-2.0 / system.sigma2 * (potential(x) - potential(1.15))).exp();
        let mass = |cell: usize| {
            let (from, width) = (axis.edges()[cell], axis.width(cell));
            (0..1000)
                .map(|i| p(from + width * (f64::from(i) + 0.5) / 1000.0))
                .sum::<f64>()
        };
        let left = axis.find(-0.6).unwrap();
        assert!(found.masses[left] > 0.0 && found.masses[left] < 1e-40);
        for cell in [left - 3, left + 5] {
            let (ratio, expected) = (
                found.masses[cell] / found.masses[left],
                mass(cell) / mass(left),
            );
            // The midpoint rule on 1000 points is off by (p''/p) h²/24e6, below 1e-6.
            assert!((ratio / expected - 1.0).abs() < 1e-6, "{ratio} {expected}");
        }
        assert!(found.error < 1e-8, "{}", found.error);
    }

    #[test]
    fn moments_are_those_of_the_density() {
        // A normal density of variance σ²/2: far inside the range.
        struct Linear;
        impl System for Linear {
            fn dimension(&self) -> usize {
                1
            }
            fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
                for (slope, x) in drift[0].iter_mut().zip(&states[0]) {
                    *slope = 0.3 - x;
                }
            }
            fn noise_axes(&self) -> &[usize] {
                &[0]
            }
            fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
                Some(0.5)
            }
        }
        let axis = Axis::uniform(-3.0, 4.0, 60).unwrap();
        let (mean, variance) = one_axis(&Linear, &axis).unwrap().moments;
        assert!((mean - 0.3).abs() < 1e-12 && (variance - 0.125).abs() < 1e-12);
    }
}
