//! Trigonometric polynomials on an axis that closes on itself: derivatives, values and integrals from masses at even
//! nodes.
//!
//! A density p(s) = Σ_{|k| ≤ K} c_k e^{2πiks}, s in turns, is the same as the N = 2K + 1 masses u_j = p(s_j)/N at nodes
//! a cell apart: c_k = Σ_j u_j e^{-2πiks_j} (the trapezoidal rule, exact up to degree 2K). Derivatives are those of the
//! trigonometric polynomials that are one at a node and zero at the others (C. Canuto et al., *Spectral Methods*,
//! 2006).

use std::f64::consts::{PI, SQRT_2, TAU};

/// Derivatives at the nodes of the trigonometric polynomials that are one at a node: entry `k · count + i` is ℓ_i'(node
/// k), for an odd number of nodes on a turn of this length. Rows and columns sum to zero.
pub(super) fn fourier_derivatives(count: usize, length: f64) -> Vec<f64> {
    let entry = |k: usize, i: usize| match k.abs_diff(i) {
        0 => 0.0,
        distance => {
            let sign = if distance.is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
            let size = 0.5 * sign / (PI * distance as f64 / count as f64).sin();
            if k > i { size } else { -size }
        }
    };
    let entries = (0..count * count).map(|at| TAU / length * entry(at / count, at % count));
    entries.collect()
}

/// The first `count` of 1, √2 cos 2πs, √2 sin 2πs, √2 cos 4πs, …: orthonormal over a turn, and over an odd number of
/// even nodes on it that is at least as large.
pub(super) fn waves(count: usize, s: f64) -> Vec<f64> {
    let wave = |number: usize| {
        let (sine, cosine) = (TAU * number.div_ceil(2) as f64 * s).sin_cos();
        match number {
            0 => 1.0,
            _ if number % 2 == 1 => SQRT_2 * cosine,
            _ => SQRT_2 * sine,
        }
    };
    (0..count).map(wave).collect()
}

/// What the mass at a node adds to the density at a place that many turns after it, times the length of the turn: 1 + 2
/// Σ cos 2πks over so many harmonics.
pub(super) fn cardinal(s: f64, harmonics: usize) -> f64 {
    let terms = (1..=harmonics).map(|k| (TAU * k as f64 * s).cos());
    1.0 + 2.0 * terms.sum::<f64>()
}

/// Integrals of the series over bins with these edges, all in turns: entry `bin · nodes + node` is what the mass at a
/// node adds to a bin, by so many harmonics.
pub(super) fn fourier_integrals(nodes: &[f64], edges: &[f64], harmonics: usize) -> Vec<f64> {
    let below = |s: f64| {
        let terms = (1..=harmonics).map(|k| (TAU * k as f64 * s).sin() / (PI * k as f64));
        s + terms.sum::<f64>()
    };
    let bins = edges.windows(2);
    bins.flat_map(|bin| {
        nodes
            .iter()
            .map(|node| below(bin[1] - node) - below(bin[0] - node))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use crate::space::Axis;

    /// A trigonometric polynomial of degree 3 on a turn of length 2 from -0.5, and its derivative.
    fn wave(x: f64) -> (f64, f64) {
        let rate = std::f64::consts::PI;
        let (a, b) = (rate * x, 3.0 * rate * x);
        (
            0.5 + 0.2 * a.cos() - 0.1 * b.sin(),
            rate * (-0.2 * a.sin() - 0.3 * b.cos()),
        )
    }

    #[test]
    fn trigonometric_polynomials_are_differentiated_and_laid_out_exactly() {
        for harmonics in [3, 4, 9] {
            let axis = Axis::fourier(-0.5, 1.5, harmonics).unwrap();
            let count = axis.count();
            assert_eq!((count, axis.mode_number()), (2 * harmonics + 1, harmonics));
            let matrix = axis.differentiation();
            let masses: Vec<f64> = axis
                .nodes()
                .iter()
                .map(|&x| wave(x).0 * axis.width(0))
                .collect();
            for (row, &x) in matrix.chunks_exact(count).zip(axis.nodes()) {
                let terms = row.iter().zip(axis.nodes());
                let slope: f64 = terms.map(|(d, &node)| d * wave(node).0).sum();
                assert!((slope - wave(x).1).abs() < 1e-12, "{harmonics} {x}");
            }
            // At a place, of a turn of length 2, and over bins.
            for x in [-0.5, 0.13, 1.5] {
                let terms = axis.weights_at(x, harmonics).into_iter().zip(&masses);
                let value: f64 = terms.map(|(weight, mass)| weight * mass / 2.0).sum();
                assert!((value - wave(x).0).abs() < 1e-13, "{harmonics} {x}");
            }
            let edges = [-0.5, 0.0, 0.7, 1.5];
            let weights = axis.series_weights(&edges, count);
            for (bin, weights) in edges.windows(2).zip(weights.chunks_exact(count)) {
                let found: f64 = weights.iter().zip(&masses).map(|(w, m)| w * m).sum();
                let steps = 2000;
                let width = (bin[1] - bin[0]) / f64::from(steps);
                let middles = (0..steps).map(|step| bin[0] + (f64::from(step) + 0.5) * width);
                let exact: f64 = middles.map(|x| wave(x).0 * width).sum();
                assert!((found - exact).abs() < 1e-6, "{harmonics} {bin:?}");
            }
        }
    }

    #[test]
    fn an_axis_that_closes_on_itself_has_a_harmonic_at_least() {
        assert!(Axis::fourier(0.0, 1.0, 0).is_err());
        assert!(Axis::fourier(0.0, 1.0, 64).is_err());
        assert!(Axis::fourier(1.0, 1.0, 3).is_err());
        let axis = Axis::fourier(0.0, 1.0, 8).unwrap();
        assert_eq!(axis.refined(1.4).mode_number(), 10);
        assert_eq!(axis.find(0.999), Some(16));
        assert!(axis.is_sound());
    }
}
