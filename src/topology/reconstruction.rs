//! Value and derivatives of a density at a point, from the averages over the cells around it.
//!
//! Averages are differences of the primitive F at the edges, p = F'. A polynomial through n averages is the derivative
//! of the one through F at n + 1 edges, so the k-th derivative of p is a weighted sum of F, hence of the averages: with
//! n cells it is exact for polynomials of degree n - 1, whatever the widths. Sampled densities are noisy, and get
//! a polynomial of low degree nearest to many averages instead. Either way the result is linear in the
//! averages: a [`Weights`] of weights, which serves every variant of a density alike.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::space::Axis;

/// Weights of the averages over neighbouring cells of one axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weights {
    /// Cell of the first weight.
    pub(super) first: usize,
    pub(super) weights: Vec<f64>,
}

impl Weights {
    /// Weighted sum of the values of a marginal.
    pub(super) fn apply(&self, values: &[f64]) -> f64 {
        let cells = &values[self.first..self.first + self.weights.len()];
        self.weights.iter().zip(cells).map(|(w, v)| w * v).sum()
    }

    /// Weighted sum over the first axis by `self` and over the second, of `columns` cells, by `other`.
    pub(super) fn apply_with(&self, other: &Self, columns: usize, values: &[f64]) -> f64 {
        let rows = self.weights.iter().enumerate();
        rows.map(|(row, weight)| {
            let start = (self.first + row) * columns;
            weight * other.apply(&values[start..start + columns])
        })
        .sum()
    }

    /// Half the sum of two lines.
    pub(super) fn mean(&self, other: &Self) -> Self {
        let first = self.first.min(other.first);
        let end = |line: &Self| line.first + line.weights.len();
        let mut weights = vec![0.0; end(self).max(end(other)) - first];
        for line in [self, other] {
            for (index, weight) in line.weights.iter().enumerate() {
                weights[line.first + index - first] += 0.5 * weight;
            }
        }
        Self { first, weights }
    }
}

/// Lines for p, p', … at `at`: the polynomial through the averages over `cells`. One line for each of the first
/// `orders` derivatives (the value is the first); none when the cells are too few.
pub(super) fn interpolating(
    axis: &Axis,
    cells: Range<usize>,
    at: f64,
    orders: usize,
) -> Option<Vec<Weights>> {
    if cells.len() < orders || cells.end > axis.count() {
        return None;
    }
    let edges = &axis.edges()[cells.start..=cells.end];
    let nodes = edges.len();
    let of_primitive = differentiation_weights(edges, at, orders);
    let line = |weights: &[f64]| {
        // Σ_i w_i F(edge i) with F = Σ of average × width below: cell j has all weights above it.
        let mut above = 0.0;
        let mut line = vec![0.0; cells.len()];
        for cell in (0..cells.len()).rev() {
            above += weights[cell + 1];
            line[cell] = above * (edges[cell + 1] - edges[cell]);
        }
        Weights {
            first: cells.start,
            weights: line,
        }
    };
    Some(of_primitive[nodes..].chunks(nodes).map(line).collect())
}

/// Lines as of [`interpolating`] for the polynomial of the given degree nearest to the averages over many cells.
pub(super) fn smoothing(
    axis: &Axis,
    cells: Range<usize>,
    at: f64,
    degree: usize,
    orders: usize,
) -> Option<Vec<Weights>> {
    nearest(axis, cells, at, (degree, 0), orders)
}

/// Lines for p and p' at a place where the curvature jumps: a polynomial through the averages over cells on both sides,
/// with so many of the terms (x - at)²₊, (x - at)³₊ and so on. Of what single cells are off by it takes less than a
/// polynomial through the cells of one side does at its end: of cells of one width a half to a tenth.
pub(super) fn across_bend(
    axis: &Axis,
    cells: Range<usize>,
    at: f64,
    terms: usize,
) -> Option<Vec<Weights>> {
    let degree = cells.len().checked_sub(terms + 1)?;
    nearest(axis, cells, at, (degree, terms), 2)
}

/// Lines for the polynomial of a degree, and so many one-sided powers from the square on, nearest to the averages.
fn nearest(
    axis: &Axis,
    cells: Range<usize>,
    at: f64,
    (degree, terms): (usize, usize),
    orders: usize,
) -> Option<Vec<Weights>> {
    let functions = degree + 1 + terms;
    if cells.len() < functions || degree + 1 < orders || cells.end > axis.count() {
        return None;
    }
    let edges = &axis.edges()[cells.start..=cells.end];
    let scale = (edges[cells.len()] - at).abs().max((edges[0] - at).abs());
    let power = |edge: f64, k: usize| ((edge - at) / scale).powi(k as i32 + 1) / (k + 1) as f64;
    let average = |cell: usize, function: usize| {
        let [from, to] = [edges[cell], edges[cell + 1]];
        let width = (to - from) / scale;
        if function <= degree {
            (power(to, function) - power(from, function)) / width
        } else {
            let k = function - degree + 1;
            (power(to.max(at), k) - power(from.max(at), k)) / width
        }
    };
    let matrix = DMatrix::from_fn(cells.len(), functions, average);
    let inverse = matrix.pseudo_inverse(1e-13).ok()?;
    let mut factor = 1.0;
    let mut lines = Vec::with_capacity(orders);
    for k in 0..orders {
        let row = inverse.row(k);
        let weights = row.iter().map(|weight| weight * factor);
        lines.push(Weights {
            first: cells.start,
            weights: weights.collect(),
        });
        factor *= (k + 1) as f64 / scale;
    }
    Some(lines)
}

/// Weights of function values at `nodes` for the value and the first `orders` derivatives at a point, one row of
/// weights after the other (Fornberg 1988, *Math. Comp.* 51, 699).
fn differentiation_weights(nodes: &[f64], at: f64, orders: usize) -> Vec<f64> {
    let n = nodes.len();
    let mut weights = vec![0.0; (orders + 1) * n];
    weights[0] = 1.0;
    let mut product = 1.0;
    let mut offset = nodes[0] - at;
    for i in 1..n {
        let top = i.min(orders);
        let mut next = 1.0;
        let previous = offset;
        offset = nodes[i] - at;
        for j in 0..i {
            let gap = nodes[i] - nodes[j];
            next *= gap;
            if j + 1 == i {
                for k in (0..=top).rev() {
                    let lower = if k > 0 {
                        k as f64 * weights[(k - 1) * n + i - 1]
                    } else {
                        0.0
                    };
                    weights[k * n + i] =
                        product * (lower - previous * weights[k * n + i - 1]) / next;
                }
            }
            for k in (0..=top).rev() {
                let lower = if k > 0 {
                    k as f64 * weights[(k - 1) * n + j]
                } else {
                    0.0
                };
                weights[k * n + j] = (offset * weights[k * n + j] - lower) / gap;
            }
        }
        product = next;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grading;

    fn axis(count: usize) -> Axis {
        let grading = Grading {
            at: vec![0.2],
            smallest: 0.6 / count as f64,
        };
        Axis::graded(-1.0, 1.5, count, &grading).unwrap()
    }

    fn averages(axis: &Axis, primitive: impl Fn(f64) -> f64) -> Vec<f64> {
        let edges = axis.edges().windows(2);
        edges
            .map(|e| (primitive(e[1]) - primitive(e[0])) / (e[1] - e[0]))
            .collect()
    }

    #[test]
    fn polynomials_are_reconstructed_exactly_on_graded_cells() {
        let axis = axis(40);
        // p = 1 + 2x - 3x² + 4x³: at 0.3 p = 1.438, p' = 1.28, p'' = 1.2.
        let values = averages(&axis, |x| x + x * x - x.powi(3) + x.powi(4));
        let cell = axis.find(0.3).unwrap();
        let through = interpolating(&axis, cell - 2..cell + 3, 0.3, 3).unwrap();
        let nearest = smoothing(&axis, cell - 6..cell + 8, 0.3, 3, 3).unwrap();
        for lines in [through, nearest] {
            for (line, expected) in lines.iter().zip([1.438, 1.28, 1.2]) {
                let found = line.apply(&values);
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
        }
    }

    #[test]
    fn the_order_of_a_second_derivative_from_eight_cells_is_six() {
        let error = |count: usize| {
            let axis = Axis::uniform(-1.0, 1.0, count).unwrap();
            let values = averages(&axis, |x| (3.0 * x).sin() / 3.0);
            let middle = count / 2;
            let lines = interpolating(&axis, middle - 4..middle + 4, 0.0, 3).unwrap();
            (lines[2].apply(&values) + 9.0).abs()
        };
        let order = (error(20) / error(40)).log2();
        assert!((order - 6.0).abs() < 0.2, "{order}");
    }

    #[test]
    fn lines_of_two_axes_multiply() {
        let axes = [axis(20), Axis::uniform(-1.0, 1.0, 14).unwrap()];
        // p = (1 + x²)(2 + y): mixed derivative 2x.
        let x = averages(&axes[0], |x| x + x.powi(3) / 3.0);
        let y = averages(&axes[1], |y| 2.0 * y + 0.5 * y * y);
        let values: Vec<f64> = x
            .iter()
            .flat_map(|a| y.iter().map(move |b| a * b))
            .collect();
        let cell = axes[0].find(0.1).unwrap();
        let first = interpolating(&axes[0], cell - 2..cell + 2, 0.1, 2).unwrap();
        let second = interpolating(&axes[1], 5..9, 0.0, 2).unwrap();
        let mixed = first[1].apply_with(&second[1], 14, &values);
        assert!((mixed - 0.2).abs() < 1e-10);
    }

    #[test]
    fn too_few_cells_give_nothing() {
        let axis = axis(10);
        assert!(interpolating(&axis, 0..2, 0.0, 3).is_none());
        assert!(interpolating(&axis, 8..11, 0.0, 3).is_none());
        assert!(smoothing(&axis, 0..4, 0.0, 4, 3).is_none());
    }
}
