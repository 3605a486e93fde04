//! Series that carry a density along an axis in place of cells.
//!
//! p = Σ_n a_n φ_n(s) with N terms is the same as N numbers u_k = Σ_n a_n w_k P_n(s_k) φ-weights at the nodes of the
//! Gauss rule: the moments a_n = Σ_k u_k P_n(s_k) for n < N are those numbers in another basis, and Σ u_k is the mass.
//! In the basis of the nodes multiplication by any function of s is diagonal and a derivative is a dense N × N block,
//! so an axis of modes is an axis of N nodes for everything that runs along the other axes (Gottlieb and Orszag 1977;
//! *discrete ordinates* in transport).
//!
//! The weights also tell cells around the nodes: by the theorem of Chebyshev, Markov and Stieltjes the sums of the
//! first weights separate the nodes.

/// Largest number of modes of an axis: nodes are found by Newton's method to rounding up to there, and the steepest
/// density of a friction state that was met needs fewer.
pub(crate) const MOST_MODES: usize = 128;

/// What carries the density along an axis in place of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Series {
    /// Legendre polynomials over the range: for states that stay in it and have no noise.
    Legendre,
    /// Hermite polynomials times the normal density that a linear filter of white noise has.
    Hermite {
        /// Mean of the normal density.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
    /// Sines and cosines over one turn, the range, whose ends are one place.
    Fourier,
}

/// A rule on [-1, 1]: nodes, ascending, and weights, Σ = 2, exact for polynomials of degree 2 count - 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rule {
    pub(super) nodes: Vec<f64>,
    pub(super) weights: Vec<f64>,
}

/// P_n(s) and its derivative for |s| < 1, n ≥ 1.
fn legendre(n: usize, s: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, s);
    for k in 2..=n {
        let k = k as f64;
        (before, value) = (
            value,
            ((2.0 * k - 1.0) * s * value - (k - 1.0) * before) / k,
        );
    }
    (value, n as f64 * (s * value - before) / (s * s - 1.0))
}

/// Gauss's rule for Legendre polynomials with `count` ≥ 1 nodes, symmetric to the last bit.
pub(super) fn gauss_legendre(count: usize) -> Rule {
    let mut rule = Rule {
        nodes: vec![0.0; count],
        weights: vec![0.0; count],
    };
    for index in 0..count.div_ceil(2) {
        let mirror = count - 1 - index;
        let mut s = if index == mirror {
            0.0
        } else {
            -(std::f64::consts::PI * (index as f64 + 0.75) / (count as f64 + 0.5)).cos()
        };
        for _ in 0..10 {
            let (value, slope) = legendre(count, s);
            s -= value / slope;
        }
        if index == mirror {
            s = 0.0;
        }
        let slope = legendre(count, s).1;
        let weight = 2.0 / ((1.0 - s * s) * slope * slope);
        (rule.nodes[index], rule.weights[index]) = (s, weight);
        (rule.nodes[mirror], rule.weights[mirror]) = (-s, weight);
    }
    rule
}

/// P_n(s) for n < count, of which the moments Σ_k u_k P_n(s_k) of masses at nodes are made.
pub(super) fn legendre_values(count: usize, s: f64) -> Vec<f64> {
    let mut values = vec![1.0, s];
    for n in 2..count {
        let k = n as f64;
        values.push(((2.0 * k - 1.0) * s * values[n - 1] - (k - 1.0) * values[n - 2]) / k);
    }
    values.truncate(count);
    values
}

/// ∫_{-1}^s (2n + 1)/2 P_n for n < count, which is ½ (P_{n+1} - P_{n-1}): what each moment adds to the mass below s.
pub(super) fn legendre_integrals(count: usize, s: f64) -> Vec<f64> {
    let values = legendre_values(count + 1, s);
    (0..count)
        .map(|n| match n {
            0 => 0.5 * (s + 1.0),
            n => 0.5 * (values[n + 1] - values[n - 1]),
        })
        .collect()
}

/// Derivatives of the Lagrange polynomials of some nodes at these nodes: entry `k · n + i` is ℓ_i'(s_k). Rows sum to
/// zero.
pub(super) fn differentiation(nodes: &[f64]) -> Vec<f64> {
    let n = nodes.len();
    // Barycentric weights; products of distances of at most 128 nodes stay within range.
    let scale = 4.0 / (nodes[n - 1] - nodes[0]);
    let product = |i: usize| -> f64 {
        let others = (0..n).filter(|&j| j != i);
        others.map(|j| scale * (nodes[i] - nodes[j])).product()
    };
    let products: Vec<f64> = (0..n).map(product).collect();
    let mut matrix = vec![0.0; n * n];
    for k in 0..n {
        let mut diagonal = 0.0;
        for i in (0..n).filter(|&i| i != k) {
            let entry = products[k] / products[i] / (nodes[k] - nodes[i]);
            matrix[k * n + i] = entry;
            diagonal -= entry;
        }
        matrix[k * n + k] = diagonal;
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_up_to_its_degree_and_no_further() {
        for count in [1, 2, 5, 8, 33, MOST_MODES] {
            let rule = gauss_legendre(count);
            let integral = |power: i32| -> f64 {
                let terms = rule.nodes.iter().zip(&rule.weights);
                terms.map(|(s, w)| w * s.powi(power)).sum()
            };
            for power in 0..2 * count as i32 {
                let exact = if power % 2 == 0 {
                    2.0 / f64::from(power + 1)
                } else {
                    0.0
                };
                assert!((integral(power) - exact).abs() < 1e-14, "{count} {power}");
            }
            let power = 2 * count as i32;
            let missed = (integral(power) - 2.0 / f64::from(power + 1)).abs();
            assert!(count > 8 || missed > 1e-5, "{count} {missed:e}");
        }
    }

    #[test]
    fn sums_of_weights_separate_the_nodes() {
        for count in 2..=MOST_MODES {
            let rule = gauss_legendre(count);
            let mut edge = -1.0;
            for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                assert!(edge < *node && *node < edge + weight, "{count}");
                edge += weight;
            }
        }
    }

    #[test]
    fn polynomials_are_differentiated_exactly() {
        for count in [2, 3, 8, 24, MOST_MODES] {
            let rounding = 1e-11_f64.max(f64::EPSILON * (count as f64).powi(3));
            let nodes = gauss_legendre(count).nodes;
            let matrix = differentiation(&nodes);
            for power in 0..count as i32 {
                for (k, s) in nodes.iter().enumerate() {
                    let row = &matrix[k * count..(k + 1) * count];
                    let found: f64 = row.iter().zip(&nodes).map(|(d, x)| d * x.powi(power)).sum();
                    let exact = f64::from(power) * if power == 0 { 0.0 } else { s.powi(power - 1) };
                    assert!(
                        (found - exact).abs() < rounding,
                        "{count} {power} {found} {exact}"
                    );
                }
            }
        }
    }
}
