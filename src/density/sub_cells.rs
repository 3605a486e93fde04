//! Masses inside cells: each cell is cut into sub-cells, whose masses follow from those of the cells around by a
//! polynomial.
//!
//! Along each axis the mass below a coordinate is interpolated through the edges of several cells, so that the
//! sub-cells of a cell hold exactly its mass. Windows do not reach across planes on which the derivative of the density
//! jumps. Along an axis of modes the series itself is integrated over sub-cells, which cut the bins over which its
//! density is laid out.

use std::ops::Range;

use super::series_map::{layout_axis, used_modes};
use crate::space::Axis;

/// Sub-cells of a product of axes, and the weights that give their masses from those of the cells.
#[derive(Debug, Clone)]
pub(super) struct SubCells {
    axes: Vec<Lines>,
}

/// The sub-cells of one axis.
#[derive(Debug, Clone)]
struct Lines {
    /// Cells of the axis, or its nodes.
    cells: usize,
    /// Cells that are cut: those of the axis, or the bins over which a series is laid out.
    whole: usize,
    /// `count + 1` edges of sub-cells.
    edges: Vec<f64>,
    /// Of each sub-cell the first cell that has a weight.
    first: Vec<usize>,
    /// Weights for the mass of each sub-cell.
    mass: Vec<Vec<f64>>,
    /// Weights for the slope of the density times the square of its width: the change of mass from end to end.
    slope: Vec<Vec<f64>>,
}

impl SubCells {
    /// Cuts every cell into `parts` along each axis; polynomials go through `window` cells, in the last cell before an
    /// end through the second number of them, and series have all of their modes, of a coarse map some less. `planes`
    /// are axes with coordinates at which the derivative jumps.
    pub(super) fn new(
        axes: &[&Axis],
        parts: usize,
        (windows, is_coarse): ([usize; 2], bool),
        planes: &[(usize, f64)],
    ) -> Self {
        let lines = axes.iter().enumerate().map(|(index, axis)| {
            if axis.is_modes() {
                return Lines::of_series(axis, parts, is_coarse);
            }
            let own = planes.iter().filter(|(plane, _)| *plane == index);
            let faces: Vec<usize> = own.filter_map(|(_, at)| axis.face_at(*at)).collect();
            Lines::new(axis, parts, windows, &faces)
        });
        Self {
            axes: lines.collect(),
        }
    }

    /// Number of sub-cells.
    pub(super) fn count(&self) -> usize {
        self.axes.iter().map(Lines::count).product()
    }

    /// Lower and upper edge of a sub-cell along each axis; the last axis is the fastest.
    pub(super) fn edges(&self, mut number: usize, edges: &mut [(f64, f64)]) {
        for (lines, slot) in self.axes.iter().zip(edges).rev() {
            let place = number % lines.count();
            number /= lines.count();
            *slot = (lines.edges[place], lines.edges[place + 1]);
        }
    }

    /// The cell that holds a sub-cell, along one axis.
    pub(super) fn cell(&self, number: usize, axis: usize) -> usize {
        let faster: usize = self.axes[axis + 1..].iter().map(Lines::count).product();
        let lines = &self.axes[axis];
        number / faster % lines.count() * lines.whole / lines.count()
    }

    /// Masses of all sub-cells, and for each axis the change of mass along it from one end of the sub-cell to the
    /// other.
    pub(super) fn apply(&self, masses: &[f64]) -> Vec<Vec<f64>> {
        let mut shape: Vec<usize> = self.axes.iter().map(|lines| lines.cells).collect();
        let mut found = vec![masses.to_vec()];
        for (index, lines) in self.axes.iter().enumerate() {
            let sloping = lines.along(&found[0], &shape, index, &lines.slope);
            for one in &mut found {
                *one = lines.along(one, &shape, index, &lines.mass);
            }
            found.push(sloping);
            shape[index] = lines.count();
        }
        found
    }
}

impl Lines {
    fn new(axis: &Axis, parts: usize, windows: [usize; 2], faces: &[usize]) -> Self {
        let mut lines = Self {
            cells: axis.count(),
            whole: axis.count(),
            edges: Vec::new(),
            first: Vec::new(),
            mass: Vec::new(),
            slope: Vec::new(),
        };
        for cell in 0..axis.count() {
            let is_last = !axis.is_closed() && (cell == 0 || cell + 1 == axis.count());
            let window = windows[usize::from(is_last)];
            let cells = cells_around(cell, window, axis.count(), faces);
            let nodes = &axis.edges()[cells.start..=cells.end];
            let (from, width) = (axis.edges()[cell], axis.width(cell));
            let edge = |part: usize| {
                if part == parts {
                    axis.edges()[cell + 1]
                } else {
                    from + width * part as f64 / parts as f64
                }
            };
            for part in 0..parts {
                let (low, high) = (edge(part), edge(part + 1));
                let below = [low, 0.5 * (low + high), high].map(|at| mass_below(nodes, at));
                let weights = |of: &dyn Fn(f64, f64, f64) -> f64| {
                    let numbers = 0..cells.len();
                    numbers
                        .map(|i| of(below[0][i], below[1][i], below[2][i]))
                        .collect()
                };
                lines.edges.push(low);
                lines.first.push(cells.start);
                lines.mass.push(weights(&|a, _, c| c - a));
                lines
                    .slope
                    .push(weights(&|a, b, c| 4.0 * (a - 2.0 * b + c)));
            }
        }
        lines.edges.push(axis.to());
        lines
    }

    /// Of an axis of modes, each bin over which its density is laid out cut into parts.
    fn of_series(axis: &Axis, parts: usize, is_coarse: bool) -> Self {
        let bins = layout_axis(axis);
        let count = bins.count() * parts;
        let (from, length) = (bins.from(), bins.to() - bins.from());
        // Halves of sub-cells, from which slopes follow.
        let halves = 0..=2 * count;
        let places = halves.map(|half| from + length * half as f64 / (2 * count) as f64);
        let places: Vec<f64> = places.collect();
        let weights = axis.series_weights(&places, used_modes(axis, is_coarse));
        let pairs = weights.chunks_exact(2 * axis.count());
        let joined = |sign: f64| {
            let of_pair = |pair: &[f64]| -> Vec<f64> {
                let (low, high) = pair.split_at(axis.count());
                low.iter().zip(high).map(|(a, b)| b + sign * a).collect()
            };
            pairs.clone().map(of_pair).collect::<Vec<_>>()
        };
        let slope = joined(-1.0).into_iter();
        let slope = slope.map(|row| row.into_iter().map(|weight| 4.0 * weight).collect());
        Self {
            cells: axis.count(),
            whole: bins.count(),
            edges: places.into_iter().step_by(2).collect(),
            first: vec![0; count],
            mass: joined(1.0),
            slope: slope.collect(),
        }
    }

    fn count(&self) -> usize {
        self.first.len()
    }

    /// Weighted sums along one axis of an array of the given shape.
    fn along(
        &self,
        values: &[f64],
        shape: &[usize],
        axis: usize,
        weights: &[Vec<f64>],
    ) -> Vec<f64> {
        let outer: usize = shape[..axis].iter().product();
        let inner: usize = shape[axis + 1..].iter().product();
        let mut sums = vec![0.0; outer * self.count() * inner];
        for (block, slots) in sums.chunks_mut(self.count() * inner).enumerate() {
            let block = &values[block * self.cells * inner..];
            for (row, slots) in slots.chunks_mut(inner).enumerate() {
                for (offset, weight) in weights[row].iter().enumerate() {
                    let start = (self.first[row] + offset) * inner;
                    for (slot, value) in slots.iter_mut().zip(&block[start..start + inner]) {
                        *slot += weight * value;
                    }
                }
            }
        }
        sums
    }
}

/// As many cells around one as wanted, moved inward at the ends, on one side of the faces.
fn cells_around(cell: usize, window: usize, count: usize, faces: &[usize]) -> Range<usize> {
    let below = faces.iter().copied().filter(|&face| face <= cell);
    let above = faces.iter().copied().filter(|&face| face > cell);
    let (low, high) = (below.max().unwrap_or(0), above.min().unwrap_or(count));
    let length = window.min(high - low);
    let first = cell.saturating_sub(window / 2).clamp(low, high - length);
    first..first + length
}

/// Weights of the masses of cells for the mass below a coordinate, interpolated through their edges.
fn mass_below(edges: &[f64], at: f64) -> Vec<f64> {
    let lagrange = |index: usize| -> f64 {
        let others = edges
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index);
        others
            .map(|(_, edge)| (at - edge) / (edges[index] - edge))
            .product()
    };
    // A cell counts at every edge above it.
    let mut weights: Vec<f64> = (1..edges.len()).map(lagrange).collect();
    for index in (1..weights.len()).rev() {
        weights[index - 1] += weights[index];
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grading;

    #[test]
    fn sub_cells_have_the_masses_of_a_polynomial_and_add_up_to_their_cells() {
        let grading = Grading {
            at: vec![0.5],
            smallest: 0.05,
        };
        let x = Axis::graded(-1.0, 2.0, 12, &grading).unwrap();
        let y = Axis::uniform(0.0, 1.0, 8).unwrap();
        let of_x = |x: f64| x + x.powi(3) - 0.2 * x.powi(5);
        let of_y = |y: f64| 2.0 * y - y.powi(2);
        let pieces = |edges: &[f64], of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            edges.windows(2).map(|e| of(e[1]) - of(e[0])).collect()
        };
        let (along_x, along_y) = (pieces(x.edges(), &of_x), pieces(y.edges(), &of_y));
        let masses: Vec<f64> = along_x
            .iter()
            .flat_map(|a| along_y.iter().map(move |b| a * b))
            .collect();
        let cut = SubCells::new(&[&x, &y], 3, ([5; 2], false), &[]);
        let found = cut.apply(&masses);
        assert_eq!(cut.count(), 36 * 24);
        let mut edges = [(0.0, 0.0); 2];
        let mut sums = vec![0.0; masses.len()];
        for (number, mass) in found[0].iter().enumerate() {
            cut.edges(number, &mut edges);
            let [(a, b), (c, d)] = edges;
            let expected = (of_x(b) - of_x(a)) * (of_y(d) - of_y(c));
            assert!((mass - expected).abs() < 1e-12, "{number}");
            // The density of y is 2 - 2 y.
            let slope = (of_x(b) - of_x(a)) * -2.0 * (d - c).powi(2);
            assert!((found[2][number] - slope).abs() < 1e-12);
            sums[cut.cell(number, 0) * 8 + cut.cell(number, 1)] += mass;
        }
        let same = sums.iter().zip(&masses);
        assert!(same.into_iter().all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn a_kink_on_a_face_is_kept() {
        let axis = Axis::uniform(-1.0, 1.0, 8).unwrap();
        let below = |x: f64| x * x.abs();
        let masses: Vec<f64> = axis
            .edges()
            .windows(2)
            .map(|e| below(e[1]) - below(e[0]))
            .collect();
        let cut = SubCells::new(&[&axis], 4, ([5; 2], false), &[(0, 0.0)]);
        let found = cut.apply(&masses);
        let mut edges = [(0.0, 0.0)];
        for (number, mass) in found[0].iter().enumerate() {
            cut.edges(number, &mut edges);
            let expected = below(edges[0].1) - below(edges[0].0);
            assert!((mass - expected).abs() < 1e-14);
        }
    }
}
