//! Quadratics fitted by least squares to cell averages in a window of cells, and their principal directions.
//!
//! The average of u² over a cell of centre c and width h is c² + h²/12, whatever the widths of its neighbours.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::FeatureKind;
use crate::density::EstimatedDensity;
use crate::space::Axis;

/// Centre and width of a cell in units of the window around the feature's cell.
pub(super) struct Scale {
    pub(super) origin: f64,
    pub(super) unit: f64,
}

impl Scale {
    pub(super) fn new(axis: &Axis, at: usize, window: &Range<usize>) -> Self {
        let length = axis.edges()[window.end] - axis.edges()[window.start];
        Self {
            origin: axis.centre(at),
            unit: 0.5 * length,
        }
    }

    /// Averages of u and u² over a cell.
    fn averages(&self, axis: &Axis, cell: usize) -> (f64, f64) {
        let centre = (axis.centre(cell) - self.origin) / self.unit;
        let width = axis.width(cell) / self.unit;
        (centre, centre * centre + width * width / 12.0)
    }

    /// Nearest coordinate that lies in the window.
    pub(super) fn clamp(&self, axis: &Axis, window: &Range<usize>, coordinate: f64) -> f64 {
        let end = |edge: usize| (axis.edges()[edge] - self.origin) / self.unit;
        coordinate.clamp(end(window.start), end(window.end))
    }
}

/// 1, u, u² (the rest zero) or 1, u, v, u², uv, v², from each axis' (u, u²) or their averages.
pub(super) fn basis(terms: &[(f64, f64)]) -> [f64; 6] {
    match *terms {
        [(u, uu)] => [1.0, u, uu, 0.0, 0.0, 0.0],
        [(u, uu), (v, vv)] => [1.0, u, v, uu, u * v, vv],
        _ => [0.0; 6],
    }
}

/// Coefficients, in the order of [`basis`], of the quadratic whose cell averages are nearest to the values of
/// the window: 3 for one axis, 6 for two. `None` when an axis has fewer than three cells.
pub(super) fn fit(
    estimated: &EstimatedDensity,
    windows: &[Range<usize>],
    scales: &[Scale],
) -> Option<Vec<f64>> {
    if windows.iter().any(|window| window.len() < 3) {
        return None;
    }
    let axes = &estimated.density.axes;
    let averages = |k: usize| -> Vec<(f64, f64)> {
        let cells = windows[k].clone();
        cells
            .map(|cell| scales[k].averages(&axes[k], cell))
            .collect()
    };
    let values = &estimated.density.values;
    let mut sums = NormalEquations::default();
    if let [window] = windows {
        for (u, cell) in averages(0).into_iter().zip(window.clone()) {
            sums.add(basis(&[u]), values[cell]);
        }
        return sums.solve::<3>();
    }
    let (first, second) = (averages(0), averages(1));
    for (&u, row) in first.iter().zip(windows[0].clone()) {
        for (&v, column) in second.iter().zip(windows[1].clone()) {
            sums.add(basis(&[u, v]), values[row * axes[1].count() + column]);
        }
    }
    sums.solve::<6>()
}

/// Sums of a least-squares fit.
#[derive(Default)]
struct NormalEquations {
    matrix: [[f64; 6]; 6],
    right: [f64; 6],
}

impl NormalEquations {
    fn add(&mut self, row: [f64; 6], value: f64) {
        for (i, &term) in row.iter().enumerate() {
            self.right[i] += term * value;
            for (sum, &other) in self.matrix[i].iter_mut().zip(&row) {
                *sum += term * other;
            }
        }
    }

    /// Solution for the first `N` coefficients; `None` if the window does not determine them.
    fn solve<const N: usize>(&self) -> Option<Vec<f64>> {
        let matrix = SMatrix::<f64, N, N>::from_fn(|i, j| self.matrix[i][j]);
        let right = SVector::<f64, N>::from_fn(|i, _| self.right[i]);
        let solution = matrix.cholesky()?.solve(&right);
        Some(solution.iter().copied().collect())
    }
}

/// Quadratic through the 3×3 cells around a cell of a density over two axes: the coefficients of u, v, u²,
/// uv, v², where u and v are in units of half the length of the three cells, from the cell's centre.
pub(super) fn local_quadratic(estimated: &EstimatedDensity, cell: usize) -> Option<[f64; 5]> {
    let [first, second] = estimated.density.axes.as_slice() else {
        return None;
    };
    let three = |axis: &Axis, at: usize| {
        let low = at.saturating_sub(1).min(axis.count().saturating_sub(3));
        low..(low + 3).min(axis.count())
    };
    let at = [cell / second.count(), cell % second.count()];
    let windows = [three(first, at[0]), three(second, at[1])];
    let scales = [
        Scale::new(first, at[0], &windows[0]),
        Scale::new(second, at[1], &windows[1]),
    ];
    let found = fit(estimated, &windows, &scales)?;
    Some([found[1], found[2], found[3], found[4], found[5]])
}

/// One of the two principal directions of a quadratic in two variables.
pub(super) struct Principal {
    pub(super) direction: [f64; 2],
    pub(super) slope: f64,
    pub(super) curvature: f64,
}

impl Principal {
    /// Whether a critical point of the kind is sought along this direction: for a valley along both, its
    /// saddle being a maximum along one and a minimum along the other.
    pub(super) fn suits(&self, kind: FeatureKind) -> bool {
        match kind {
            FeatureKind::Peak | FeatureKind::Ring => self.curvature < 0.0,
            FeatureKind::Crater => self.curvature > 0.0,
            FeatureKind::Valley => self.curvature != 0.0,
        }
    }
}

/// Principal directions of c₀u + c₁v + c₂u² + c₃uv + c₄v².
pub(super) fn principal_directions([sx, sy, xx, xy, yy]: [f64; 5]) -> [Principal; 2] {
    let (xx, yy) = (2.0 * xx, 2.0 * yy);
    let (sine, cosine) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
    [[cosine, sine], [-sine, cosine]].map(|[x, y]| Principal {
        direction: [x, y],
        slope: sx * x + sy * y,
        curvature: xx * x * x + 2.0 * xy * x * y + yy * y * y,
    })
}
