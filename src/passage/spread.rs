//! The mass of a density in a region, at points between the nodes of its cells.
//!
//! Cells that the region's border cuts are integrated up to it: along the axis that is steepest across the border to
//! the place where each line crosses it, over lines that lie close to each other.

use super::crossing::crossing;
use super::dips::{dip, may_dip};
use super::start::{AtCoordinate as _, add_state};
use super::tensor::{gathered, scattered, whole};
use crate::MAX_DIMENSION;
use crate::space::CellSpace;
use crate::space::nodes::{AxisWeights, about, along, each};

/// Gauss points of an interval, as shares of its length.
pub(super) const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Lines along another axis of a cell that a border cuts; half as many where nodes are fewer.
pub(super) const LINES: usize = 8;

/// Cells with a region.
pub(super) struct Spread<'a, R> {
    pub(super) cells: &'a CellSpace,
    /// A density at the nodes, times local volumes.
    pub(super) unknowns: &'a [f64],
    pub(super) region: R,
    pub(super) lines: usize,
    /// Nodes of a polynomial along an axis.
    pub(super) nodes: usize,
}

/// A point in cell coordinates, and the share of a cell that it stands for or the mass there.
pub(super) type Point = (Vec<f64>, f64);

impl<R: Fn(&[f64]) -> f64> Spread<'_, R> {
    fn state(&self, places: &[f64]) -> [f64; MAX_DIMENSION] {
        let mut state = [0.0; MAX_DIMENSION];
        for ((x, axis), &place) in state.iter_mut().zip(self.cells.axes()).zip(places) {
            *x = axis.at_coordinate(place);
        }
        state
    }

    fn level(&self, places: &[f64]) -> f64 {
        (self.region)(&self.state(places)[..places.len()])
    }

    /// Lower ends of a cell in cell coordinates.
    fn corner(&self, cell: usize) -> Vec<f64> {
        let axes = 0..self.cells.dimension();
        axes.map(|axis| self.cells.position(cell, axis) as f64)
            .collect()
    }

    /// The masses of points, of their shares of a cell.
    pub(super) fn masses(&self, points: Vec<Point>) -> impl Iterator<Item = Point> {
        let shape = self.cells.shape();
        points.into_iter().map(move |(places, share)| {
            let product: Vec<AxisWeights> = places
                .iter()
                .zip(&shape)
                .map(|(&place, &count)| along(count, place, 0, self.nodes))
                .collect();
            let mut value = 0.0;
            each(self.cells, &product, |cell, weight| {
                value += weight * self.unknowns[cell];
            });
            (places, value * share)
        })
    }

    /// Adds masses at points one by one; gives their sum.
    pub(super) fn add(
        &self,
        points: &[Point],
        (space, kept): (&CellSpace, &[bool]),
        weights: &mut [f64],
    ) -> f64 {
        let mut sum = 0.0;
        for (places, mass) in points {
            let state = self.state(places);
            let state = (&state[..self.cells.dimension()], *mass);
            if *mass != 0.0 && add_state(space, kept, state, self.nodes, weights) {
                sum += mass;
            }
        }
        sum
    }

    /// Places of the points of whole cells along each axis.
    pub(super) fn points(&self) -> Vec<Vec<f64>> {
        let of_axis = |axis: usize| {
            let cells = 0..self.cells.axes()[axis].count();
            let shares = self.shares(axis, &GAUSS);
            let points =
                cells.flat_map(|cell| shares.clone().into_iter().map(move |share| (cell, share)));
            points.map(|(cell, share)| cell as f64 + share).collect()
        };
        (0..self.cells.dimension()).map(of_axis).collect()
    }

    /// The masses at the points of whole cells, all at once.
    pub(super) fn masses_of_whole(&self, points: &[Vec<f64>], is_whole: &[bool]) -> Vec<f64> {
        let shape = self.cells.shape();
        let all = points.iter().zip(&shape);
        let from: Vec<Vec<AxisWeights>> = all
            .map(|(points, &count)| {
                let points = points.iter();
                points
                    .map(|&place| along(count, place, 0, self.nodes))
                    .collect()
            })
            .collect();
        let mut masses = gathered(self.unknowns, &shape, &from);
        let share = is_whole.len() as f64 / masses.len() as f64;
        for (number, mass) in masses.iter_mut().enumerate() {
            let (mut rest, mut cell, mut stride) = (number, 0, 1);
            for axis in (0..shape.len()).rev() {
                let count = points[axis].len();
                cell += rest % count * shape[axis] / count * stride;
                rest /= count;
                stride *= shape[axis];
            }
            *mass *= if is_whole[cell] { share } else { 0.0 };
        }
        masses
    }

    /// Adds masses at all combinations of places, all points at once but those beside the target; gives their sum.
    pub(super) fn add_even(
        &self,
        points: &[Vec<f64>],
        masses: &[f64],
        (space, kept): (&CellSpace, &[bool]),
        weights: &mut [f64],
    ) -> f64 {
        let all = points.iter().zip(self.cells.axes()).zip(space.axes());
        let to: Vec<Vec<AxisWeights>> = all
            .map(|((points, own), other)| {
                let points = points.iter();
                points
                    .map(|&place| about(other, own.at_coordinate(place), self.nodes))
                    .collect()
            })
            .collect();
        let reaches = whole(kept, &space.shape(), &to);
        let (mut masses, mut aside) = (masses.to_vec(), Vec::new());
        for (number, mass) in masses.iter_mut().enumerate() {
            if *mass != 0.0 && !reaches[number] {
                let mut rest = number;
                let places = points.iter().rev().map(|points| {
                    let place = points[rest % points.len()];
                    rest /= points.len();
                    place
                });
                let mut places: Vec<f64> = places.collect();
                places.reverse();
                aside.push((places, std::mem::take(mass)));
            }
        }
        let sum: f64 = masses.iter().sum();
        let spread = scattered(&masses, &space.shape(), &to);
        let pairs = weights.iter_mut().zip(spread);
        pairs.for_each(|(weight, mass)| *weight += mass);
        sum + self.add(&aside, (space, kept), weights)
    }

    /// Of each cell, whether it and one of those around it, corners among them, are on both sides of the border, or
    /// may be where the region is narrower than a cell.
    pub(super) fn near_border(&self, levels: &[f64]) -> Vec<bool> {
        // What lies on either side within one cell along every axis, spread axis by axis.
        let mut sides: Vec<[bool; 2]> = levels
            .iter()
            .map(|&level| {
                let is_inside = level < 0.0;
                [is_inside, !is_inside]
            })
            .collect();
        self.add_dips(levels, &mut sides);
        let mut stride = levels.len();
        for &count in &self.cells.shape() {
            stride /= count;
            let before = sides.clone();
            for (cell, both) in sides.iter_mut().enumerate() {
                let position = cell / stride % count;
                let lower = (position > 0).then(|| before[cell - stride]);
                let upper = (position + 1 < count).then(|| before[cell + stride]);
                for one in [lower, upper].into_iter().flatten() {
                    *both = [both[0] || one[0], both[1] || one[1]];
                }
            }
        }
        sides
            .into_iter()
            .map(|[inside, outside]| inside && outside)
            .collect()
    }

    /// Sets both sides of cells between whose nodes the level may have the other sign than at them.
    fn add_dips(&self, levels: &[f64], sides: &mut [[bool; 2]]) {
        let mut stride = levels.len();
        for (axis, count) in self.cells.axes().iter().zip(self.cells.shape()) {
            stride /= count;
            if axis.is_modes() {
                continue;
            }
            for (cell, &level) in levels.iter().enumerate() {
                let position = cell / stride % count;
                let at = |steps: usize| levels[cell + steps * stride];
                let before = (position > 0).then(|| levels[cell - stride]);
                let after = (position + 2 < count).then(|| at(2));
                if position + 1 < count && may_dip(before, [level, at(1)], after) {
                    sides[cell] = [true; 2];
                    sides[cell + stride] = [true; 2];
                }
            }
        }
    }

    /// Which cells lie in the region as a whole, and points of those that its border cuts; `levels` are those of the
    /// region at the nodes.
    pub(super) fn parts(&self, levels: &[f64]) -> (Vec<bool>, Vec<Point>) {
        let mut is_whole = vec![false; levels.len()];
        let mut cut = Vec::new();
        let is_near_border = self.near_border(levels);
        for (cell, &level) in levels.iter().enumerate() {
            let parts = is_near_border[cell].then(|| self.cut(cell));
            match parts {
                Some(Some(points)) => cut.extend(points),
                Some(None) => is_whole[cell] = true,
                None => is_whole[cell] = level < 0.0,
            }
        }
        (is_whole, cut)
    }

    /// Points of a cell that lies in the region.
    pub(super) fn whole(&self, cell: usize) -> Vec<Point> {
        let corner = self.corner(cell);
        let shares = |axis: usize| self.shares(axis, &GAUSS);
        product(&corner, shares)
    }

    /// Shares of an axis's cell: the middle on an axis of modes.
    fn shares(&self, axis: usize, shares: &[f64]) -> Vec<f64> {
        match self.cells.axes()[axis].is_modes() {
            true => vec![0.5],
            false => shares.to_vec(),
        }
    }

    /// Points of a cell that the border may cut; `None` where all of it lies in the region.
    pub(super) fn cut(&self, cell: usize) -> Option<Vec<Point>> {
        let corner = self.corner(cell);
        let middle: Vec<f64> = corner.iter().map(|place| place + 0.5).collect();
        let change = |axis: usize| {
            let at = |share: f64| {
                let mut places = middle.clone();
                places[axis] += share;
                self.level(&places)
            };
            let [low, middle, high] = [-0.5, 0.0, 0.5].map(at);
            (middle - low).abs() + (high - middle).abs()
        };
        let axes = (0..corner.len()).filter(|&axis| !self.cells.axes()[axis].is_modes());
        let steepest = axes.max_by(|&one, &other| change(one).total_cmp(&change(other)));
        // Modes alone: none of them is cut.
        let Some(steepest) = steepest else {
            let is_inside = self.level(&middle) < 0.0;
            return (!is_inside).then(Vec::new);
        };
        let even: Vec<f64> = (0..self.lines)
            .map(|line| (line as f64 + 0.5) / self.lines as f64)
            .collect();
        let lines = product(&corner, |axis| match axis == steepest {
            true => vec![0.0],
            false => self.shares(axis, &even),
        });
        let parts: Vec<_> = lines
            .into_iter()
            .map(|(start, share)| (self.inside(&start, steepest), start, share))
            .collect();
        if parts.iter().all(|(inside, _, _)| *inside == WHOLE) {
            return None;
        }
        let of_line = |(inside, start, share): (Vec<(f64, f64)>, Vec<f64>, f64)| {
            inside.into_iter().flat_map(move |(from, to)| {
                let start = start.clone();
                GAUSS.map(|at| {
                    let mut places = start.clone();
                    places[steepest] += from + at * (to - from);
                    (places, 0.5 * share * (to - from))
                })
            })
        };
        Some(parts.into_iter().flat_map(of_line).collect())
    }

    /// The parts of a line through a cell that are in the region, from its start along an axis: up to one crossing in
    /// either half, or two where the region or its gap is narrower than that.
    fn inside(&self, start: &[f64], axis: usize) -> Vec<(f64, f64)> {
        let level = |share: f64| {
            let mut places = start.to_vec();
            places[axis] += share;
            self.level(&places)
        };
        let ends = [0.0, 0.5, 1.0].map(|at| (at, level(at)));
        let mut parts = Vec::new();
        for [low, high] in [[ends[0], ends[1]], [ends[1], ends[2]]] {
            let is_inside = low.1 < 0.0;
            let at = |one: (f64, f64), other: (f64, f64)| crossing(&level, [one, other]);
            if is_inside != (high.1 < 0.0) {
                let at = at(low, high);
                parts.push(if is_inside { (low.0, at) } else { (at, high.0) });
            } else if let Some(place) = dip(&mut |share| level(share), [low, high]) {
                let lowest = (place, level(place));
                let (first, last) = (at(low, lowest), at(lowest, high));
                match is_inside {
                    true => parts.extend([(low.0, first), (last, high.0)]),
                    false => parts.push((first, last)),
                }
            } else if is_inside {
                parts.push((low.0, high.0));
            }
        }
        parts
    }
}

/// Both halves of a line, as [`Spread::inside`] has them where all of it is.
const WHOLE: [(f64, f64); 2] = [(0.0, 0.5), (0.5, 1.0)];

/// All combinations of places in a cell, each with the same share.
fn product(corner: &[f64], shares: impl Fn(usize) -> Vec<f64>) -> Vec<Point> {
    let mut all = vec![Vec::new()];
    for (axis, from) in corner.iter().enumerate() {
        let shares = shares(axis);
        all = all
            .into_iter()
            .flat_map(|places: Vec<f64>| {
                let next = shares
                    .iter()
                    .map(|share| [places.clone(), vec![from + share]].concat());
                next.collect::<Vec<_>>()
            })
            .collect();
    }
    let share = 1.0 / all.len() as f64;
    all.into_iter().map(|places| (places, share)).collect()
}
