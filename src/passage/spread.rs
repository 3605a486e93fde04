//! A start that is spread as a density: its mass in a region, brought from the cells of the density to those of a
//! passage.
//!
//! Cells that the region's border cuts are integrated up to it: along the axis that is steepest across the border to
//! the place where each line crosses it, over lines that lie close to each other.

use super::start::{AtCoordinate as _, AxisWeights, NODES, add_state, along, each};
use crate::MAX_DIMENSION;
use crate::space::CellSpace;

/// Gauss points of an interval, as shares of its length.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Lines along another axis of a cell that a border cuts; half as many where nodes are fewer.
const LINES: usize = 8;

/// Halvings by which a crossing is found within a cell.
const HALVINGS: usize = 40;

/// Spreads a density (at the nodes of `cells`, times local volumes), as far as it lies where `region` is negative, over
/// the kept nodes of other cells, with so many nodes an axis about each point; gives the mass that was spread.
pub(super) fn add_density(
    (space, kept): (&CellSpace, &[bool]),
    (cells, unknowns): (&CellSpace, &[f64]),
    region: impl Fn(&[f64]) -> f64,
    nodes: usize,
    weights: &mut [f64],
) -> f64 {
    let shape = cells.shape();
    let spread = Spread {
        cells,
        region,
        lines: if nodes == NODES { LINES } else { LINES / 2 },
    };
    let levels = spread.levels();
    let mut sum = 0.0;
    for (cell, &level) in levels.iter().enumerate() {
        let cut = spread.is_near_border(&levels, cell);
        if !cut && level >= 0.0 {
            continue;
        }
        let points = if cut {
            spread.cut(cell)
        } else {
            spread.whole(cell)
        };
        for (places, share) in points {
            let product: Vec<AxisWeights> = places
                .iter()
                .zip(&shape)
                .map(|(&place, &count)| along(count, place, 0, nodes))
                .collect();
            let mut value = 0.0;
            each(cells, &product, |cell, weight| {
                value += weight * unknowns[cell];
            });
            let mass = value * share;
            let state = spread.state(&places);
            let state = &state[..cells.dimension()];
            if mass != 0.0 && add_state(space, kept, (state, mass), nodes, weights) {
                sum += mass;
            }
        }
    }
    sum
}

/// Cells with a region.
struct Spread<'a, R> {
    cells: &'a CellSpace,
    region: R,
    lines: usize,
}

/// A point in cell coordinates, and the share of a cell that it stands for.
type Point = (Vec<f64>, f64);

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

    /// The level at all nodes.
    fn levels(&self) -> Vec<f64> {
        let one = |cell: usize| (self.region)(&self.cells.node(cell));
        (0..self.cells.n_cells()).map(one).collect()
    }

    /// Whether a cell and one of those around it, corners among them, are on both sides of the border.
    fn is_near_border(&self, levels: &[f64], cell: usize) -> bool {
        let (shape, dimension) = (self.cells.shape(), self.cells.dimension());
        (0..3_usize.pow(dimension as u32)).any(|number| {
            let (mut rest, mut other) = (number, 0);
            for (axis, &count) in shape.iter().enumerate() {
                let at = self.cells.position(cell, axis) + rest % 3;
                rest /= 3;
                other = other * count + at.saturating_sub(1).min(count - 1);
            }
            (levels[other] < 0.0) != (levels[cell] < 0.0)
        })
    }

    /// Points of a cell that lies in the region.
    fn whole(&self, cell: usize) -> Vec<Point> {
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

    /// Points of a cell that the border may cut.
    fn cut(&self, cell: usize) -> Vec<Point> {
        let corner = self.corner(cell);
        let middle: Vec<f64> = corner.iter().map(|place| place + 0.5).collect();
        let change = |axis: usize| {
            let at = |share: f64| {
                let mut places = middle.clone();
                places[axis] += share;
                self.level(&places)
            };
            (at(0.5) - at(-0.5)).abs()
        };
        let axes = (0..corner.len()).filter(|&axis| !self.cells.axes()[axis].is_modes());
        let steepest = axes.max_by(|&one, &other| change(one).total_cmp(&change(other)));
        let Some(steepest) = steepest else {
            return self.whole(cell);
        };
        let even: Vec<f64> = (0..self.lines)
            .map(|line| (line as f64 + 0.5) / self.lines as f64)
            .collect();
        let lines = product(&corner, |axis| match axis == steepest {
            true => vec![0.0],
            false => self.shares(axis, &even),
        });
        let of_line = |(start, share): Point| {
            let inside = self.inside(&start, steepest);
            inside.into_iter().flat_map(move |(from, to)| {
                let start = start.clone();
                GAUSS.map(|at| {
                    let mut places = start.clone();
                    places[steepest] += from + at * (to - from);
                    (places, 0.5 * share * (to - from))
                })
            })
        };
        lines.into_iter().flat_map(of_line).collect()
    }

    /// The part of a line through a cell that is in the region, from its start along an axis: up to one crossing in
    /// either half.
    fn inside(&self, start: &[f64], axis: usize) -> Vec<(f64, f64)> {
        let level = |share: f64| {
            let mut places = start.to_vec();
            places[axis] += share;
            self.level(&places)
        };
        let half = |from: f64, to: f64| {
            let is_inside = [from, to].map(|at| level(at) < 0.0);
            if is_inside[0] == is_inside[1] {
                return is_inside[0].then_some((from, to));
            }
            let (mut a, mut b) = (from, to);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (a + b);
                match (level(middle) < 0.0) == is_inside[0] {
                    true => a = middle,
                    false => b = middle,
                }
            }
            Some(if is_inside[0] { (from, a) } else { (b, to) })
        };
        [(0.0, 0.5), (0.5, 1.0)]
            .into_iter()
            .filter_map(|(from, to)| half(from, to))
            .collect()
    }
}

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
