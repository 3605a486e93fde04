//! Where grid lines cross the border of a region, what stencils read beyond it, and how sums end at it.

use super::super::assemble::line_start;
use super::super::geometry::AxisGeometry;
use super::super::scheme::REACH;
use crate::MAX_DIMENSION;
use crate::space::CellSpace;
use crate::system::{BoundQuantity, System};

/// A node nearer to the border than this share of a cell is left out of the polynomial.
const TOO_NEAR: f64 = 0.15;

/// Steps by which a crossing is narrowed.
const NARROWING: usize = 60;

/// Change of the level along a border that is rounding, over that across it.
const FLAT: f64 = 1e-9;

/// What a stencil reads beyond the end of a stretch of cells: for each of three cells there, nearest first, weights of
/// cells of the line.
type Read = [Vec<(usize, f64)>; REACH];

/// An end of a stretch of cells.
#[derive(Default)]
pub(super) struct Beyond {
    pub(super) read: Read,
    /// By how much the weights of the last cells differ from one, for a sum that ends at the border, in two ways.
    pub(super) weights: Vec<(usize, [f64; 2])>,
    /// The weight of the value on the border in what is read in each of the three cells.
    pub(super) on_border: [f64; REACH],
    /// The weight of that value in a sum, in two ways.
    pub(super) sum: [f64; 2],
}

/// An end of a stretch of cells, and where it is.
pub(super) struct Closing {
    /// What stencils read there, in each way.
    pub(super) ways: Vec<Beyond>,
    /// Where the line crosses the border.
    pub(super) crossing: f64,
}

/// A line of cells along an axis.
#[derive(Clone, Copy)]
pub(super) struct GridLine {
    pub(super) axis: usize,
    pub(super) number: usize,
    /// Its first cell, and the distance of neighbours in cell numbers.
    pub(super) first: usize,
    pub(super) stride: usize,
}

impl GridLine {
    /// The cell at a position.
    pub(super) fn at(&self, position: usize) -> usize {
        self.first + position * self.stride
    }
}

/// A region among cells.
pub(super) struct RegionCells<'a> {
    pub(super) system: &'a dyn System,
    pub(super) space: &'a CellSpace,
    pub(super) level: &'a BoundQuantity,
    pub(super) axes: &'a [AxisGeometry],
    pub(super) strides: &'a [usize],
    /// Cells of the polynomial that goes on past the border, in one way or more.
    pub(super) cells: &'a [usize],
    /// The level at the nodes.
    pub(super) levels: Vec<f64>,
}

impl RegionCells<'_> {
    /// Whether a cell is outside of the region.
    pub(super) fn keeps(&self, cell: usize) -> bool {
        self.levels[cell] >= 0.0
    }

    /// What stencils read beyond an end of a stretch, in each way.
    pub(super) fn beyond(
        &self,
        line: &GridLine,
        (from, to): (usize, usize),
        is_upper: bool,
    ) -> Closing {
        let (inner, outer) = if is_upper {
            (to - 1, to)
        } else {
            (from, from - 1)
        };
        let crossing = self.crossing(line, inner, outer);
        let gradient = self.gradient(line, crossing);
        let Some(is_zero) = self.is_zero(line, &gradient, inner, is_upper) else {
            // What comes in is what the border has.
            let nothing = |_: &usize| Beyond {
                on_border: [1.0; REACH],
                ..Beyond::default()
            };
            let ways = self.cells.iter().map(nothing).collect();
            return Closing { ways, crossing };
        };
        let cells = self.share_of_a_cell(line.axis, inner, outer, crossing);
        let shares = shares_of_normal(&gradient, line.axis);
        let through =
            |&most: &usize| through_cells((from, to), is_upper, (is_zero, cells), (most, shares));
        let ways = self.cells.iter().map(through).collect();
        Closing { ways, crossing }
    }

    /// The state at which a line crosses the border, and the local volume there.
    pub(super) fn on_border(&self, line: &GridLine, crossing: f64) -> ([f64; MAX_DIMENSION], f64) {
        let state = self.state(line, crossing);
        let axes = self.space.axes().iter().zip(&state);
        let stretches = axes.filter_map(|(axis, &x)| axis.stretch_at(x));
        (state, stretches.product())
    }

    /// Where the line crosses the border between two neighbouring nodes, by bracketed secants.
    fn crossing(&self, line: &GridLine, inner: usize, outer: usize) -> f64 {
        let nodes = &self.axes[line.axis].nodes;
        let cell = |position: usize| self.levels[line.at(position)];
        let at = |x: f64| self.level.at(&self.state(line, x)[..self.axes.len()]);
        let (mut a, mut b) = (nodes[inner], nodes[outer]);
        let (mut level_a, mut level_b) = (cell(inner), cell(outer));
        let mut kept_side = 0_i32;
        for _ in 0..NARROWING {
            if (b - a).abs() <= 4.0 * f64::EPSILON * a.abs().max(b.abs()) || level_a == 0.0 {
                break;
            }
            let share = level_a / (level_a - level_b);
            let middle = if share.is_finite() && kept_side.abs() < 3 {
                a + share.clamp(0.0, 1.0) * (b - a)
            } else {
                0.5 * (a + b)
            };
            let level = at(middle);
            if level >= 0.0 {
                // Illinois: an end that stays has its weight halved.
                (a, level_a) = (middle, level);
                level_b = if kept_side > 0 {
                    0.5 * level_b
                } else {
                    level_b
                };
                kept_side = kept_side.max(0) + 1;
            } else {
                (b, level_b) = (middle, level);
                level_a = if kept_side < 0 {
                    0.5 * level_a
                } else {
                    level_a
                };
                kept_side = kept_side.min(0) - 1;
            }
            if kept_side.abs() > 3 {
                kept_side = 0;
            }
        }
        a
    }

    /// Distance of a crossing from the inner node, in cells.
    fn share_of_a_cell(&self, axis: usize, inner: usize, outer: usize, crossing: f64) -> f64 {
        let axis = &self.space.axes()[axis];
        let position = |x: f64| axis.coordinate(x);
        let (inner, outer) = (axis.nodes()[inner], axis.nodes()[outer]);
        let share = (position(crossing) - position(inner)) / (position(outer) - position(inner));
        share.clamp(0.0, 1.0)
    }

    /// A state on a line.
    fn state(&self, line: &GridLine, x: f64) -> [f64; MAX_DIMENSION] {
        let mut state = line_start(self.axes, self.strides, line.axis, line.number);
        state[line.axis] = x;
        state
    }

    /// Change of the level by a cell along each axis, at a crossing.
    fn gradient(&self, line: &GridLine, crossing: f64) -> Vec<f64> {
        let state = self.state(line, crossing);
        let level = |axis: usize, by: f64| {
            let mut state = state;
            state[axis] += by;
            self.level.at(&state[..self.axes.len()])
        };
        let change = |axis: usize| {
            let widths = &self.axes[axis].widths;
            let by = 0.5 * widths.iter().sum::<f64>() / widths.len() as f64;
            level(axis, by) - level(axis, -by)
        };
        (0..self.axes.len()).map(change).collect()
    }

    /// Whether the density is zero at the border; `None` where it ends there without a word: along an axis without
    /// noise nothing comes in through a border that stands across it.
    fn is_zero(
        &self,
        line: &GridLine,
        gradient: &[f64],
        inner: usize,
        is_upper: bool,
    ) -> Option<bool> {
        let axis = line.axis;
        let others = gradient
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != axis);
        let along = others.map(|(_, change)| change.abs()).sum::<f64>();
        if self.system.is_noisy(axis) || along > FLAT * gradient[axis].abs() {
            return Some(true);
        }
        let state = self.state(line, self.axes[axis].nodes[inner]);
        let drift = self.system.drift_at(0.0, &state[..self.axes.len()])[axis];
        let outward = if is_upper { drift } else { -drift };
        (outward > 0.0).then_some(false)
    }
}

/// What stencils read beyond an end of a stretch by the polynomial through so many of its last cells, and through zero
/// where it is; the zero is so many cells beyond the last one. The shares are those of [`shares_of_normal`].
fn through_cells(
    (from, to): (usize, usize),
    is_upper: bool,
    (is_zero, cells): (bool, f64),
    (most, shares): (usize, [f64; 2]),
) -> Beyond {
    let skip = usize::from(is_zero && cells < TOO_NEAR && to - from > 1);
    let most = most - skip;
    let used = most.min(to - from - skip);
    // Places of the nodes, and of the zero, with the end's last node at 0 and inward negative.
    let mut places: Vec<f64> = (skip..skip + used).map(|back| -(back as f64)).collect();
    if is_zero {
        places.push(cells);
    }
    let place = |back: usize| if is_upper { to - 1 - back } else { from + back };
    let at_nodes = |weights: Vec<f64>, share: f64| -> Vec<(usize, f64)> {
        let nodes = weights.into_iter().take(used).enumerate();
        nodes
            .map(|(back, weight)| (place(back + skip), share * weight))
            .collect()
    };
    let sum = beyond_the_sum(&places, cells);
    let of_border = |weights: &[f64]| match weights.last() {
        Some(&last) if is_zero => last,
        _ => 0.0,
    };
    let sum_on_border = of_border(&sum);
    let changes = at_nodes(sum, -1.0);
    let reads: [Vec<f64>; REACH] = std::array::from_fn(|far| lagrange(&places, 1.0 + far as f64));
    Beyond {
        on_border: std::array::from_fn(|far| of_border(&reads[far])),
        sum: shares.map(|share| -share * sum_on_border),
        read: reads.map(|weights| at_nodes(weights, 1.0)),
        weights: changes
            .into_iter()
            .map(|(position, change)| (position, shares.map(|share| share * change)))
            .collect(),
    }
}

/// What sums along an axis count for where the border is oblique: they miss the same along each. Once that is its share
/// in the square of the normal, once all for the axis that the normal is nearest to.
fn shares_of_normal(gradient: &[f64], axis: usize) -> [f64; 2] {
    let squares: f64 = gradient.iter().map(|change| change * change).sum();
    let share = gradient[axis].powi(2) / squares.max(f64::MIN_POSITIVE);
    let steeper = |(other, change): (usize, &f64)| {
        change.abs() > gradient[axis].abs()
            || (other < axis && change.abs() == gradient[axis].abs())
    };
    let is_nearest = !gradient.iter().enumerate().any(steeper);
    [share, f64::from(u8::from(is_nearest))]
}

/// What a sum over nodes at 0, -1, … counts beyond a place before 1/2, for the polynomial through values at some
/// places: the sum is the integral up to 1/2 less a 24th of the slope there (Euler and Maclaurin).
fn beyond_the_sum(places: &[f64], place: f64) -> Vec<f64> {
    let length = 0.5 - place;
    let (middle, half) = (0.5 * (0.5 + place), 0.5 * length);
    let gauss = [
        (-0.6_f64.sqrt(), 5.0 / 9.0),
        (0.0, 8.0 / 9.0),
        (0.6_f64.sqrt(), 5.0 / 9.0),
    ];
    let mut all = vec![0.0; places.len()];
    let mut add = |at: f64, factor: f64| {
        let weights = lagrange(places, at);
        let pairs = all.iter_mut().zip(weights);
        pairs.for_each(|(sum, weight)| *sum += factor * weight);
    };
    for (point, weight) in gauss {
        add(middle + half * point, half * weight);
    }
    // A difference that is exact for polynomials of fourth degree.
    for (step, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
        add(0.5 + step, -weight / (12.0 * 24.0));
    }
    all
}

/// Weights of values at some places in the polynomial through them, at another place.
pub(crate) fn lagrange(places: &[f64], at: f64) -> Vec<f64> {
    let weight = |index: usize| {
        let others = places
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index);
        others.fold(1.0, |product, (_, place)| {
            product * (at - place) / (places[index] - place)
        })
    };
    (0..places.len()).map(weight).collect()
}

/// Weights of values at some places in the slope at one of these of the polynomial through them.
pub(crate) fn lagrange_slopes(places: &[f64], own: usize) -> Vec<f64> {
    let others = || (0..places.len()).filter(move |&other| other != own);
    let apart = |one: usize, other: usize| places[one] - places[other];
    let weight = |index: usize| {
        if index == own {
            return others().map(|other| 1.0 / apart(own, other)).sum();
        }
        let between = others().filter(|&other| other != index);
        let shares = between.map(|other| apart(own, other) / apart(index, other));
        shares.product::<f64>() / apart(index, own)
    };
    (0..places.len()).map(weight).collect()
}
