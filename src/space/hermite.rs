//! Gauss's rule for a normal density, and cells around its nodes: what an axis of Hermite modes is made of.
//!
//! p = w(s) Σ_n a_n He_n(s), w the standard normal density, with N terms is the same as the N numbers u_k = W_k Σ_n a_n
//! He_n(s_k) at the nodes of the rule (`series.rs` has the same for Legendre polynomials). White noise through a linear
//! filter keeps this form: its generator has the eigenvalues -n/τ on it, without error.

use nalgebra::{DMatrix, SymmetricEigen};

use super::series::Rule;
use crate::numerics::bisected;

/// Standard deviations on either side of the mean that an axis of Hermite modes spans at least: 2e-9 of the mass lies
/// beyond.
pub(crate) const NORMAL_RANGE: f64 = 6.0;

/// Distance of the ends of the range from the outermost nodes, in standard deviations.
const BEYOND_NODES: f64 = 0.5;

/// Orthonormal Hermite polynomials h_{n-1} and h_n at s, n ≥ 1.
fn orthonormal(n: usize, s: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, s);
    for k in 1..n {
        let k = k as f64;
        (before, value) = (value, (s * value - k.sqrt() * before) / (k + 1.0).sqrt());
    }
    (before, value)
}

/// Orthonormal Hermite polynomials h_n(s) for n < count, of which the moments of masses at nodes are made.
pub(super) fn hermite_values(count: usize, s: f64) -> Vec<f64> {
    let mut values = vec![1.0, s];
    for n in 2..count {
        let k = n as f64;
        values.push((s * values[n - 1] - (k - 1.0).sqrt() * values[n - 2]) / k.sqrt());
    }
    values.truncate(count);
    values
}

/// ∫_{-∞}^s w h_n for n < count, which is -w h_{n-1}/√n: what each moment adds to the mass below s.
pub(super) fn hermite_integrals(count: usize, s: f64) -> Vec<f64> {
    let values = hermite_values(count, s);
    let density = (-0.5 * s * s).exp() / (2.0 * std::f64::consts::PI).sqrt();
    (0..count)
        .map(|n| match n {
            0 => normal_below(s),
            n => -density * values[n - 1] / (n as f64).sqrt(),
        })
        .collect()
}

/// ∫_{-∞}^x of the standard normal density.
fn normal_below(x: f64) -> f64 {
    0.5 * statrs::function::erf::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// Gauss's rule for the standard normal density with `count` ≥ 2 nodes, Σ weights = 1, symmetric to the last bit.
pub(super) fn gauss_hermite(count: usize) -> Rule {
    let jacobi = DMatrix::from_fn(count, count, |i, j| match i.abs_diff(j) {
        1 => (i.max(j) as f64).sqrt(),
        _ => 0.0,
    });
    let mut starts: Vec<f64> = SymmetricEigen::new(jacobi)
        .eigenvalues
        .iter()
        .copied()
        .collect();
    starts.sort_by(f64::total_cmp);
    let mut rule = Rule {
        nodes: vec![0.0; count],
        weights: vec![0.0; count],
    };
    let root = (count as f64).sqrt();
    for (index, start) in starts.into_iter().enumerate().take(count.div_ceil(2)) {
        let mirror = count - 1 - index;
        let mut s = if index == mirror { 0.0 } else { start };
        for _ in 0..2 {
            let (before, value) = orthonormal(count, s);
            s -= value / (root * before);
        }
        if index == mirror {
            s = 0.0;
        }
        let weight = 1.0 / (count as f64 * orthonormal(count, s).0.powi(2));
        (rule.nodes[index], rule.weights[index]) = (s, weight);
        (rule.nodes[mirror], rule.weights[mirror]) = (-s, weight);
    }
    rule
}

/// Edges of cells around the nodes that hold the weights as masses of a standard normal density; the ends lie beyond
/// the nodes.
pub(super) fn normal_edges(rule: &Rule) -> Vec<f64> {
    let count = rule.nodes.len();
    let end = NORMAL_RANGE.max(rule.nodes[count - 1] + BEYOND_NODES);
    let mut edges = vec![-end];
    let mut sum = 0.0;
    for weight in &rule.weights[..count - 1] {
        sum += weight;
        edges.push(normal_quantile(sum));
    }
    edges.push(end);
    // From the nearer end, so that mirrored cells are alike to the last bit.
    for index in 1..=count / 2 {
        edges[count - index] = -edges[index];
    }
    if count.is_multiple_of(2) {
        edges[count / 2] = 0.0;
    }
    edges
}

/// The x with ∫_{-∞}^x of the standard normal density = `share`, up to 1/2 or a little more, by bisection.
fn normal_quantile(share: f64) -> f64 {
    bisected((-37.0, 37.0), 100, |middle| normal_below(middle) < share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::MOST_MODES;

    #[test]
    fn the_rule_has_the_moments_of_a_normal_density_up_to_its_degree_and_no_further() {
        for count in [2, 3, 6, 11, 24] {
            let rule = gauss_hermite(count);
            let moment = |power: i32| -> f64 {
                let terms = rule.nodes.iter().zip(&rule.weights);
                terms.map(|(s, w)| w * s.powi(power)).sum()
            };
            let mut exact = 1.0;
            for power in (0..2 * count as i32).step_by(2) {
                exact *= f64::from((power - 1).max(1));
                assert!(
                    (moment(power) / exact - 1.0).abs() < 1e-11,
                    "{count} {power}"
                );
                let scale = exact * f64::from(power + 1);
                assert!(moment(power + 1).abs() < 1e-12 * scale, "{count} {power}");
            }
            // The first that it misses is count! too low.
            exact *= f64::from(2 * count as i32 - 1);
            let factorial: f64 = (1..=count).map(|n| n as f64).product();
            let missed = (exact - moment(2 * count as i32)) / factorial;
            assert!(
                count > 11 || (missed - 1.0).abs() < 1e-6,
                "{count} {missed}"
            );
        }
    }

    #[test]
    fn cells_hold_the_nodes_and_are_mirrored() {
        for count in 2..=MOST_MODES {
            let rule = gauss_hermite(count);
            let edges = normal_edges(&rule);
            for (index, node) in rule.nodes.iter().enumerate() {
                assert!(edges[index] < *node && *node < edges[index + 1], "{count}");
                assert_eq!(edges[index], -edges[count - index]);
                assert_eq!(*node, -rule.nodes[count - 1 - index]);
            }
        }
    }
}
