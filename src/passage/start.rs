//! Where a passage starts, as weights of the cells: a state, and fields between nodes.
//!
//! Weights are those of interpolation: for a function of the state that is known at the nodes, the weighted sum is its
//! value at a state, or its average over a density, to sixth order. The outside of the target alone has weights.

use super::tensor::{gathered, whole};
use crate::MAX_DIMENSION;
use crate::space::nodes::{AxisWeights, NODES, about, about_shifted, each};
use crate::space::{Axis, CellSpace};

/// Shifts of the nodes that are tried, nearest first, where some of them are inside the target.
const SHIFTS: [isize; 7] = [0, 1, -1, 2, -2, 3, -3];

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
    let mut chosen: Option<(isize, Vec<AxisWeights>)> = None;
    let shifts = SHIFTS.len().pow(dimension as u32);
    for number in 0..shifts {
        let mut rest = number;
        let mut cost = 0;
        let mut product = Vec::with_capacity(dimension);
        for (axis, &x) in space.axes().iter().zip(state) {
            let shift = SHIFTS[rest % SHIFTS.len()];
            rest /= SHIFTS.len();
            cost += shift * shift;
            product.push(about_shifted(axis, x, shift, nodes));
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

/// A field that is known at the kept nodes of one space, at the nodes of another; `None` inside the target, where
/// `levels` of those nodes are negative.
pub(super) fn at_nodes_of(
    other: &CellSpace,
    cells: (&CellSpace, &[bool]),
    levels: &[f64],
    field: &[f64],
) -> Vec<Option<f64>> {
    let places: Vec<Vec<f64>> = other
        .axes()
        .iter()
        .map(|axis| axis.nodes().to_vec())
        .collect();
    let near = |state: &[f64]| at_state(cells, state, NODES, field);
    let is_inside = |node: usize, _: &[f64]| levels[node] < 0.0;
    at_states_of(&places, cells, is_inside, field, near)
}

/// A field that is known at the kept nodes of a space, at a state, by polynomials through so many nodes an axis.
pub(super) fn at_state(
    (space, kept): (&CellSpace, &[bool]),
    state: &[f64],
    nodes: usize,
    field: &[f64],
) -> Option<f64> {
    let mut value = 0.0;
    around(space, kept, state, nodes, |cell, weight| {
        value += weight * field[cell];
    })
    .then_some(value)
}

/// A field that is known at the kept nodes of a space, at all states with some coordinates along each axis, those of
/// the last axis fastest; `None` inside the target, as is told of a state with its number. What it is at a state near
/// the target, `near` says.
pub(super) fn at_states_of(
    places: &[Vec<f64>],
    (space, kept): (&CellSpace, &[bool]),
    is_inside: impl Fn(usize, &[f64]) -> bool,
    field: &[f64],
    near: impl Fn(&[f64]) -> Option<f64>,
) -> Vec<Option<f64>> {
    let axes: Vec<Vec<AxisWeights>> = (space.axes().iter().zip(places))
        .map(|(own, places)| places.iter().map(|&x| about(own, x, NODES)).collect())
        .collect();
    let values = gathered(field, &space.shape(), &axes);
    let is_whole = whole(kept, &space.shape(), &axes);
    let one = |number: usize| {
        let (mut rest, mut state) = (number, [0.0; MAX_DIMENSION]);
        for (x, places) in state.iter_mut().zip(places).rev() {
            *x = places[rest % places.len()];
            rest /= places.len();
        }
        let state = &state[..places.len()];
        if is_inside(number, state) || space.find(state).is_none() {
            return None;
        }
        if is_whole[number] {
            return Some(values[number]);
        }
        near(state)
    };
    (0..values.len()).map(one).collect()
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
