//! The density between the cells: value and derivatives at any point, from the averages over the cells around it.
//!
//! A polynomial of high order along each axis, its window moved inward at the ends of the ranges and kept on one side
//! of planes on which a derivative jumps. Two levels, of eight and of six cells; what they differ by is the error of
//! the reconstruction. Derivatives are in units of the ranges of the axes, so that curvatures along different axes can
//! be compared.

use std::ops::Range;

use super::reconstruction::{Weights, across_bend, interpolating};
use crate::density::{EstimatedDensity, Kink};
use crate::space::Axis;

/// Half the number of cells of a window, in the finer and the rougher reconstruction, and beside a bend.
pub(super) const REACH: [usize; 3] = [4, 3, 2];

/// The reconstruction beside a bend: at an end of their windows polynomials of higher degree make more of what the
/// density is off by in the nearest cells.
pub(super) const BESIDE_BEND: usize = 2;

/// Cells on either side of a bend, and one-sided terms, in reconstructions across it: the one that is read, and two by
/// which its error is known. It is off by what x⁴ makes on one side. All that differ from it on no more than four cells
/// differ by one and the same sum of that and of what x⁵ makes, which may be zero: the last one takes a fifth cell.
const ACROSS: [(usize, usize); 3] = [(4, 2), (3, 2), (5, 3)];

/// Most cells of a window, and the fewest.
const MOST_CELLS: usize = 10;
const FEWEST: usize = 4;

/// Value and derivatives at a point of a density of one or two axes; those along an axis that is not there are zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Jet {
    pub(super) value: f64,
    /// ∂/∂x, ∂/∂y.
    pub(super) first: [f64; 2],
    /// ∂²/∂x², ∂²/∂x∂y, ∂²/∂y².
    pub(super) second: [f64; 3],
    /// ∂³/∂x³, ∂³/∂x²∂y, ∂³/∂x∂y², ∂³/∂y³.
    pub(super) third: [f64; 4],
}

/// Weights that give a [`Jet`] at one point from the values of any variant of a density.
#[derive(Debug, Clone)]
pub(super) struct Stencil {
    lines: Vec<Vec<Weights>>,
    units: [f64; 2],
    columns: usize,
}

/// A density that can be looked at between its cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    estimated: &'a EstimatedDensity,
}

impl<'a> Field<'a> {
    /// `None` for other numbers of axes than one and two, and for axes with fewer cells than a window.
    pub(super) fn new(estimated: &'a EstimatedDensity) -> Option<Self> {
        let axes = &estimated.density.axes;
        let fits = axes.iter().all(|axis| axis.count() >= 2 * REACH[0]);
        (fits && matches!(axes.len(), 1 | 2)).then_some(Self { estimated })
    }

    pub(super) fn axes(&self) -> &'a [Axis] {
        &self.estimated.density.axes
    }

    /// Its averages over the cells.
    pub(super) fn values(&self) -> &'a [f64] {
        &self.estimated.density.values
    }

    /// The same by a second discretisation, where there is one.
    pub(super) fn second_scheme(&self) -> Option<&'a [f64]> {
        self.estimated.variants.second_scheme()
    }

    /// Centre of a cell.
    pub(super) fn centre(&self, cell: usize) -> Vec<f64> {
        match self.axes() {
            [first, second] => {
                let columns = second.count();
                vec![first.centre(cell / columns), second.centre(cell % columns)]
            }
            axes => axes.iter().map(|axis| axis.centre(cell)).collect(),
        }
    }

    /// The cell that holds a point; `None` outside.
    pub(super) fn cell_at(&self, at: &[f64]) -> Option<usize> {
        let mut pairs = self.axes().iter().zip(at);
        pairs.try_fold(0, |cell, (axis, &at)| {
            Some(cell * axis.count() + axis.find(at)?)
        })
    }

    /// Unit of an axis: the length of its range.
    pub(super) fn unit(&self, k: usize) -> f64 {
        self.axes()
            .get(k)
            .map_or(1.0, |axis| axis.to() - axis.from())
    }

    /// Width of the cell of an axis that holds a coordinate, in units of the axis.
    pub(super) fn cell_width(&self, k: usize, at: f64) -> f64 {
        let axis = &self.axes()[k];
        let cell = axis.find(at.clamp(axis.from(), axis.to())).unwrap_or(0);
        axis.width(cell) / self.unit(k)
    }

    /// The stencil of a point inside the ranges. Where a plane with a jump of the derivative passes through the point,
    /// the side above it is taken.
    pub(super) fn stencil(&self, at: &[f64], level: usize) -> Option<Stencil> {
        let axes = self.axes();
        let mut lines = Vec::with_capacity(axes.len());
        for (k, axis) in axes.iter().enumerate() {
            let orders = if axes.len() == 1 {
                4
            } else {
                4.min(2 * REACH[level])
            };
            let window = self.window(k, at[k], REACH[level])?;
            lines.push(interpolating(axis, window, at[k], orders)?);
        }
        Some(Stencil {
            lines,
            units: [self.unit(0), self.unit(1)],
            columns: axes.last().map_or(1, Axis::count),
        })
    }

    /// Stencils of value and slope at a place on a plane across an axis where the density bends, from cells on both
    /// sides: that which is read and two others. None where cells are too few, where another plane is among them, and
    /// where the plane cuts a cell, which belongs to neither side.
    pub(super) fn stencils_across(&self, at: &[f64], across: usize) -> Option<[Stencil; 3]> {
        let [read, rough, other] = ACROSS.map(|one| self.stencil_across(at, across, one));
        Some([read?, rough?, other?])
    }

    fn stencil_across(
        &self,
        at: &[f64],
        across: usize,
        (reach, terms): (usize, usize),
    ) -> Option<Stencil> {
        let axes = self.axes();
        let axis = axes.get(across)?;
        let face = axis.face_at(at[across])?;
        let cells = face.checked_sub(reach)?..face + reach;
        let ends = *axis.edges().get(cells.start)?..*axis.edges().get(cells.end)?;
        let kinks = self.estimated.structure.kinks.iter();
        let mut others = kinks.filter(|kink| kink.axis == across && kink.at != at[across]);
        if others.any(|kink| ends.contains(&kink.at)) {
            return None;
        }
        let mut lines = Vec::with_capacity(axes.len());
        for (k, axis) in axes.iter().enumerate() {
            lines.push(if k == across {
                across_bend(axis, cells.clone(), at[k], terms)?
            } else {
                interpolating(axis, self.window(k, at[k], reach.min(REACH[0]))?, at[k], 2)?
            });
        }
        Some(Stencil {
            lines,
            units: [self.unit(0), self.unit(1)],
            columns: axes.last().map_or(1, Axis::count),
        })
    }

    /// The jet of the density itself.
    pub(super) fn jet(&self, at: &[f64]) -> Option<Jet> {
        Some(self.stencil(at, 0)?.jet(&self.estimated.density.values))
    }

    /// The plane with a jump of the derivative across an axis that lies within a cell and a half of a coordinate.
    pub(super) fn plane_near(&self, k: usize, at: f64) -> Option<f64> {
        let width = self.cell_width(k, at) * self.unit(k);
        let kinks = self.estimated.structure.kinks.iter();
        let jumps = kinks.filter(|kink| kink.axis == k && !kink.is_bend());
        let mut near = jumps.filter(|kink| (kink.at - at).abs() <= 1.5 * width);
        near.next().map(|kink| kink.at)
    }

    /// The end of the range of an axis in whose outermost cell a coordinate lies.
    pub(super) fn end_near(&self, k: usize, at: f64) -> Option<f64> {
        let axis = &self.axes()[k];
        let last = axis.count() - 1;
        match axis.find(at)? {
            0 => Some(axis.from()),
            cell if cell == last => Some(axis.to()),
            _ => None,
        }
    }

    /// The interval of an axis about a coordinate that lies in the range and on one side of every such plane.
    pub(super) fn side(&self, k: usize, at: f64, reach: f64) -> (f64, f64) {
        let axis = &self.axes()[k];
        let (mut low, mut high) = ((at - reach).max(axis.from()), (at + reach).min(axis.to()));
        for kink in self
            .estimated
            .structure
            .kinks
            .iter()
            .filter(|kink| kink.axis == k && !kink.is_bend())
        {
            if kink.at <= at {
                low = low.max(kink.at);
            } else {
                high = high.min(kink.at);
            }
        }
        (low, high)
    }

    /// The cells of the finer reconstruction around a coordinate.
    pub(super) fn window_at(&self, k: usize, at: f64) -> Option<Range<usize>> {
        self.window(k, at, REACH[0])
    }

    /// Cells around a coordinate: as many on either side, moved inward at the ends and away from kinks.
    pub(super) fn window(&self, k: usize, at: f64, reach: usize) -> Option<Range<usize>> {
        let axis = &self.axes()[k];
        let cell = axis.find(at.clamp(axis.from(), axis.to()))?;
        let nearer_below = at - axis.edges()[cell] < axis.edges()[cell + 1] - at;
        let middle = if nearer_below { cell } else { cell + 1 };
        let on_axis = self.estimated.structure.kinks.iter();
        let on_axis = on_axis.filter(|kink| kink.axis == k);
        let planes: Vec<&Kink> = on_axis.collect();
        let (mut low, mut high) = between(axis, at, &planes);
        if high < low + FEWEST {
            // Across a bend polynomials err less than across a jump: of bends that lie too close only the nearest is
            // kept, where it leaves room, else none.
            let (bends, jumps): (Vec<&Kink>, Vec<&Kink>) =
                planes.into_iter().partition(|kink| kink.is_bend());
            let distance = |kink: &Kink| (kink.at - at).abs();
            let nearest = bends
                .iter()
                .min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let kept: Vec<&Kink> = jumps.iter().chain(nearest).copied().collect();
            (low, high) = between(axis, at, &kept);
            if high < low + FEWEST {
                (low, high) = between(axis, at, &jumps);
            }
        }
        let length = 2 * reach;
        if high < low + length {
            return (high >= low + FEWEST).then_some(low..high);
        }
        let first = middle.saturating_sub(reach).clamp(low, high - length);
        Some(first..first + length)
    }
}

/// The cells on the same side of every plane as a coordinate: the first, and the one after the last.
fn between(axis: &Axis, at: f64, planes: &[&Kink]) -> (usize, usize) {
    let (mut low, mut high) = (0, axis.count());
    for kink in planes {
        let Some((below, above)) = sides(axis, kink.at) else {
            continue;
        };
        // Both ends of the sides of a face are that face.
        if at >= kink.at.max(axis.edges()[below]) {
            low = low.max(above);
        } else {
            high = high.min(below);
        }
    }
    (low, high)
}

/// Where the cells wholly below a plane end, and where those wholly above it begin: a cell that the plane cuts belongs
/// to neither side.
pub(super) fn sides(axis: &Axis, plane: f64) -> Option<(usize, usize)> {
    match axis.face_at(plane) {
        Some(face) => Some((face, face)),
        None => axis.find(plane).map(|cell| (cell, cell + 1)),
    }
}

impl Stencil {
    /// Root of the sum of the squares of the weights of the slope along an axis, in inverse units of its coordinate.
    pub(super) fn slope_weight(&self, k: usize) -> f64 {
        let line = self.lines.get(k).and_then(|lines| lines.get(1));
        let weights = line.map_or(&[][..], |line| line.weights.as_slice());
        weights
            .iter()
            .map(|weight| weight * weight)
            .sum::<f64>()
            .sqrt()
    }

    /// Value and derivatives that some values of the cells give.
    pub(super) fn jet(&self, values: &[f64]) -> Jet {
        let mut jet = Jet::default();
        let [a, b] = self.units;
        if let [lines] = self.lines.as_slice() {
            let of = |order: usize| lines.get(order).map_or(0.0, |line| line.apply(values));
            jet.value = of(0);
            jet.first[0] = a * of(1);
            jet.second[0] = a * a * of(2);
            jet.third[0] = a * a * a * of(3);
            return jet;
        }
        let [rows, columns] = self.lines.as_slice() else {
            return jet;
        };
        // Along the second axis first: each order once for every row of the window.
        let (first, length) = (rows[0].first, rows[0].weights.len());
        let mut along = [[0.0; MOST_CELLS]; 4];
        for (order, line) in columns.iter().enumerate().take(4) {
            for (row, slot) in along[order].iter_mut().enumerate().take(length) {
                let start = (first + row) * self.columns;
                *slot = line.apply(&values[start..start + self.columns]);
            }
        }
        let of = |i: usize, j: usize| -> f64 {
            let (Some(line), true) = (rows.get(i), j < columns.len()) else {
                return 0.0;
            };
            let pairs = line.weights.iter().zip(&along[j]);
            pairs.map(|(weight, value)| weight * value).sum::<f64>()
                * a.powi(i as i32)
                * b.powi(j as i32)
        };
        jet.value = of(0, 0);
        jet.first = [of(1, 0), of(0, 1)];
        jet.second = [of(2, 0), of(1, 1), of(0, 2)];
        jet.third = [of(3, 0), of(2, 1), of(1, 2), of(0, 3)];
        jet
    }

    /// The value alone.
    pub(super) fn value(&self, values: &[f64]) -> f64 {
        match self.lines.as_slice() {
            [lines] => lines[0].apply(values),
            [rows, columns] => rows[0].apply_with(&columns[0], self.columns, values),
            _ => 0.0,
        }
    }
}

/// An eigenvalue of a Hessian with its direction (a unit vector, in units of the axes).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Curvature {
    pub(super) value: f64,
    pub(super) direction: [f64; 2],
}

impl Jet {
    /// Both principal curvatures, the lower first. Of one axis the second has direction zero.
    pub(super) fn principal(&self) -> [Curvature; 2] {
        let [xx, xy, yy] = self.second;
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let radius = half.hypot(xy);
        let angle = 0.5 * xy.atan2(half);
        let upper = [angle.cos(), angle.sin()];
        let lower = [-upper[1], upper[0]];
        [
            Curvature {
                value: mean - radius,
                direction: lower,
            },
            Curvature {
                value: mean + radius,
                direction: upper,
            },
        ]
    }

    /// Slope along a direction.
    pub(super) fn slope(&self, direction: [f64; 2]) -> f64 {
        self.first[0] * direction[0] + self.first[1] * direction[1]
    }

    /// Second derivative along a direction.
    pub(super) fn curvature(&self, direction: [f64; 2]) -> f64 {
        let [xx, xy, yy] = self.second;
        let [u, v] = direction;
        u * u * xx + 2.0 * u * v * xy + v * v * yy
    }

    /// Third derivative with two factors along `v` and one along `w`.
    pub(super) fn bend(&self, v: [f64; 2], w: [f64; 2]) -> f64 {
        let [xxx, xxy, xyy, yyy] = self.third;
        let xx = xxx * w[0] + xxy * w[1];
        let xy = xxy * w[0] + xyy * w[1];
        let yy = xyy * w[0] + yyy * w[1];
        v[0] * v[0] * xx + 2.0 * v[0] * v[1] * xy + v[1] * v[1] * yy
    }
}
