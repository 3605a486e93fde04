//! Where a passage starts, as weights of the cells: a state, or a density on other cells.
//!
//! Weights are those of interpolation: for a function of the state that is known at the nodes, the weighted sum is its
//! value at a state, or its average over a density, to sixth order. The outside of the target alone has weights.

use crate::MAX_DIMENSION;
use crate::space::{Axis, CellSpace};
use crate::system::BoundQuantity;

/// Nodes along an axis of the polynomial through a state, and fewer of them, by which that is judged.
pub(super) const NODES: usize = 6;
pub(super) const FEWER_NODES: usize = 4;

/// Shifts of the nodes that are tried, nearest first, where some of them are inside the target.
const SHIFTS: [isize; 7] = [0, 1, -1, 2, -2, 3, -3];

/// Gauss points of a cell along an axis, as shares of its width in the cell coordinate.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Points along an axis of a cell that a border of the start's region cuts.
const CUT: usize = 8;

/// Weights of nodes along one axis about a coordinate.
#[derive(Clone, Copy)]
struct AxisWeights {
    first: usize,
    used: usize,
    weights: [f64; NODES],
}

/// The weights of the nodes of an axis about a cell coordinate, `shift` nodes above those that lie evenly about it.
fn along(count: usize, place: f64, shift: isize, nodes: usize) -> AxisWeights {
    let used = nodes.min(count);
    let nearest = (place - 0.5).floor() as isize - (used as isize / 2 - 1) + shift;
    let first = nearest.clamp(0, (count - used) as isize) as usize;
    let mut weights = [0.0; NODES];
    for (index, weight) in weights[..used].iter_mut().enumerate() {
        let node = (first + index) as f64 + 0.5;
        *weight = (0..used)
            .filter(|&other| other != index)
            .fold(1.0, |product, other| {
                let other = (first + other) as f64 + 0.5;
                product * (place - other) / (node - other)
            });
    }
    AxisWeights {
        first,
        used,
        weights,
    }
}

/// Visits the nodes of a product of weights: numbers of cells, and weights.
fn each(space: &CellSpace, along: &[AxisWeights], mut visit: impl FnMut(usize, f64)) {
    let shape = space.shape();
    let total: usize = along.iter().map(|one| one.used).product();
    for number in 0..total {
        let (mut rest, mut cell, mut weight) = (number, 0, 1.0);
        for (axis, one) in along.iter().enumerate() {
            let at = rest % one.used;
            rest /= one.used;
            cell = cell * shape[axis] + one.first + at;
            weight *= one.weights[at];
        }
        visit(cell, weight);
    }
}

/// Adds a mass at a state to the weights of the nodes around it that are kept; `false` where there are none.
pub(super) fn add_state(
    space: &CellSpace,
    kept: &[bool],
    (state, mass): (&[f64], f64),
    nodes: usize,
    weights: &mut [f64],
) -> bool {
    let dimension = space.dimension();
    let places: Vec<f64> = space
        .axes()
        .iter()
        .zip(state)
        .map(|(axis, &x)| place_of(axis, x))
        .collect();
    let mut chosen: Option<(isize, Vec<AxisWeights>)> = None;
    let shifts = SHIFTS.len().pow(dimension as u32);
    for number in 0..shifts {
        let mut rest = number;
        let mut cost = 0;
        let mut product = Vec::with_capacity(dimension);
        for (axis, &place) in space.axes().iter().zip(&places) {
            let shift = SHIFTS[rest % SHIFTS.len()];
            rest /= SHIFTS.len();
            cost += shift * shift;
            product.push(along(axis.count(), place, shift, nodes));
        }
        if chosen.as_ref().is_some_and(|(least, _)| *least <= cost) {
            continue;
        }
        let mut whole = true;
        each(space, &product, |cell, _| whole &= kept[cell]);
        if whole {
            chosen = Some((cost, product));
            if cost == 0 {
                break;
            }
        }
    }
    if let Some((_, product)) = chosen {
        each(space, &product, |cell, weight| {
            weights[cell] += mass * weight
        });
        return true;
    }
    match space.find(state).filter(|&cell| kept[cell]) {
        Some(cell) => {
            weights[cell] += mass;
            true
        }
        None => false,
    }
}

/// A density on cells, as it is known to a solve.
#[derive(Clone, Copy)]
pub(super) struct KnownDensity<'a> {
    /// The cells.
    pub(super) space: &'a CellSpace,
    /// Density at a node times the local volume, one a cell.
    pub(super) unknowns: &'a [f64],
}

/// Spreads a density, as far as it lies where `region` is negative (everywhere without one), over the kept nodes of
/// other cells; gives the mass that was spread.
pub(super) fn add_density(
    space: &CellSpace,
    kept: &[bool],
    density: KnownDensity<'_>,
    region: Option<&BoundQuantity>,
    weights: &mut [f64],
) -> f64 {
    let (cells, dimension) = (density.space, density.space.dimension());
    let shape = cells.shape();
    let mut spread = 0.0;
    let mut levels = vec![0.0; cells.n_cells()];
    let state_of = |places: &[f64]| -> [f64; MAX_DIMENSION] {
        let mut state = [0.0; MAX_DIMENSION];
        for ((x, axis), &place) in state.iter_mut().zip(cells.axes()).zip(places) {
            *x = axis.at_coordinate(place);
        }
        state
    };
    if let Some(region) = region {
        for (cell, level) in levels.iter_mut().enumerate() {
            let places: Vec<f64> = (0..dimension)
                .map(|axis| cells.position(cell, axis) as f64 + 0.5)
                .collect();
            *level = region.at(&state_of(&places)[..dimension]);
        }
    }
    // Whether a border may pass through a cell: a neighbour is on its other side.
    let is_cut = |cell: usize| {
        region.is_some()
            && (0..dimension).any(|axis| {
                let stride: usize = shape[axis + 1..].iter().product();
                let at = cells.position(cell, axis);
                let differs = |other: usize| (levels[other] < 0.0) != (levels[cell] < 0.0);
                (at > 0 && differs(cell - stride))
                    || (at + 1 < shape[axis] && differs(cell + stride))
            })
    };
    let mut points = vec![0.0; dimension];
    for (cell, &level) in levels.iter().enumerate() {
        let cut = is_cut(cell);
        if !cut && level > 0.0 {
            continue;
        }
        let each_axis: Vec<usize> = cells
            .axes()
            .iter()
            .map(|axis| {
                if axis.is_modes() {
                    1
                } else if cut {
                    CUT
                } else {
                    GAUSS.len()
                }
            })
            .collect();
        let total: usize = each_axis.iter().product();
        for number in 0..total {
            let mut rest = number;
            for (axis, point) in points.iter_mut().enumerate() {
                let at = rest % each_axis[axis];
                rest /= each_axis[axis];
                let share = match each_axis[axis] {
                    1 => 0.5,
                    2 => GAUSS[at],
                    many => (at as f64 + 0.5) / many as f64,
                };
                *point = cells.position(cell, axis) as f64 + share;
            }
            let state = state_of(&points);
            if cut && region.is_some_and(|region| region.at(&state[..dimension]) >= 0.0) {
                continue;
            }
            let product: Vec<AxisWeights> = points
                .iter()
                .zip(&shape)
                .map(|(&place, &count)| along(count, place, 0, NODES))
                .collect();
            let mut value = 0.0;
            each(cells, &product, |cell, weight| {
                value += weight * density.unknowns[cell]
            });
            let mass = value / total as f64;
            if mass != 0.0 && add_state(space, kept, (&state[..dimension], mass), NODES, weights) {
                spread += mass;
            }
        }
    }
    spread
}

/// The place of a coordinate: of its node on an axis of modes.
fn place_of(axis: &Axis, x: f64) -> f64 {
    if axis.is_modes() {
        let node = axis.nodes().partition_point(|&node| node < x);
        return node as f64 + 0.5;
    }
    axis.coordinate(x)
}

/// The coordinate of a place.
trait AtCoordinate {
    fn at_coordinate(&self, place: f64) -> f64;
}

impl AtCoordinate for Axis {
    fn at_coordinate(&self, place: f64) -> f64 {
        let cell = (place.max(0.0) as usize).min(self.count() - 1);
        let within = place - cell as f64;
        if within == 0.5 {
            return self.nodes()[cell];
        }
        let (from, node, to) = (
            self.edges()[cell],
            self.nodes()[cell],
            self.edges()[cell + 1],
        );
        // The parabola through edge, node and edge: to third order of the cell's width.
        let (low, high) = (node - from, to - node);
        let slope = to - from;
        let bend = 2.0 * (high - low);
        let t = within - 0.5;
        node + slope * t + bend * t * t
    }
}
