//! Where a passage starts, as weights of the cells: a state, and fields between nodes.
//!
//! Weights are those of interpolation: for a function of the state that is known at the nodes, the weighted sum is its
//! value at a state, or its average over a density, to sixth order. The outside of the target alone has weights.

use super::tensor::{gathered, whole};
use crate::MAX_DIMENSION;
use crate::space::{Axis, CellSpace};
use crate::system::BoundQuantity;

/// Nodes along an axis of the polynomial through a state, and fewer of them, by which that is judged.
pub(super) const NODES: usize = 6;
pub(super) const FEWER_NODES: usize = 4;

/// Shifts of the nodes that are tried, nearest first, where some of them are inside the target.
const SHIFTS: [isize; 7] = [0, 1, -1, 2, -2, 3, -3];

/// Weights of nodes along one axis about a coordinate.
#[derive(Clone, Copy)]
pub(super) struct AxisWeights {
    first: usize,
    used: usize,
    weights: [f64; NODES],
}

impl AxisWeights {
    /// Nodes with their weights.
    pub(super) fn each(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let weights = self.weights[..self.used].iter().enumerate();
        weights.map(|(index, &weight)| (self.first + index, weight))
    }

    /// The same nodes, each of which counts one.
    pub(super) fn counting(&self) -> Self {
        Self {
            weights: [1.0; NODES],
            ..*self
        }
    }
}

/// The weights of the nodes of an axis about a coordinate, those that lie evenly about it.
pub(super) fn about(axis: &Axis, x: f64, nodes: usize) -> AxisWeights {
    along(axis.count(), place_of(axis, x), 0, nodes)
}

/// The weights of the nodes of an axis about a cell coordinate, `shift` nodes above those that lie evenly about it.
pub(super) fn along(count: usize, place: f64, shift: isize, nodes: usize) -> AxisWeights {
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
pub(super) fn each(space: &CellSpace, along: &[AxisWeights], mut visit: impl FnMut(usize, f64)) {
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

/// Visits the nodes around a state that are kept, with the weights of interpolation there: numbers of cells, and
/// weights.
/// `false` where there are none.
fn around(
    space: &CellSpace,
    kept: &[bool],
    state: &[f64],
    nodes: usize,
    mut visit: impl FnMut(usize, f64),
) -> bool {
    let dimension = space.dimension();
    let mut places = [0.0; MAX_DIMENSION];
    for ((place, axis), &x) in places.iter_mut().zip(space.axes()).zip(state) {
        *place = place_of(axis, x);
    }
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
        each(space, &product, visit);
        return true;
    }
    let only = space.find(state).filter(|&cell| kept[cell]);
    if let Some(cell) = only {
        visit(cell, 1.0);
    }
    only.is_some()
}

/// Adds a mass at a state to the weights of the nodes around it that are kept; `false` where there are none.
pub(super) fn add_state(
    space: &CellSpace,
    kept: &[bool],
    (state, mass): (&[f64], f64),
    nodes: usize,
    weights: &mut [f64],
) -> bool {
    around(space, kept, state, nodes, |cell, weight| {
        weights[cell] += mass * weight;
    })
}

/// A field that is known at the kept nodes of one space, at the nodes of another; `None` inside the target.
pub(super) fn at_nodes_of(
    other: &CellSpace,
    (space, kept): (&CellSpace, &[bool]),
    until: &BoundQuantity,
    field: &[f64],
) -> Vec<Option<f64>> {
    let axes: Vec<Vec<AxisWeights>> = (space.axes().iter().zip(other.axes()))
        .map(|(own, other)| {
            let nodes = other.nodes().iter();
            nodes.map(|&x| about(own, x, NODES)).collect()
        })
        .collect();
    let values = gathered(field, &space.shape(), &axes);
    let is_whole = whole(kept, &space.shape(), &axes);
    let one = |cell: usize| {
        let state = other.node(cell);
        if until.at(&state) < 0.0 || space.find(&state).is_none() {
            return None;
        }
        if is_whole[cell] {
            return Some(values[cell]);
        }
        let mut value = 0.0;
        around(space, kept, &state, NODES, |cell, weight| {
            value += weight * field[cell];
        })
        .then_some(value)
    };
    (0..other.n_cells()).map(one).collect()
}

/// The place of a coordinate: of its node on an axis of modes.
pub(super) fn place_of(axis: &Axis, x: f64) -> f64 {
    if axis.is_modes() {
        let node = axis.nodes().partition_point(|&node| node < x);
        return node as f64 + 0.5;
    }
    axis.coordinate(x)
}

/// The coordinate of a place.
pub(super) trait AtCoordinate {
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
