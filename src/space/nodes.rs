//! Weights of interpolation from the nodes of one axis, and from products of them.

use std::borrow::Borrow;

use super::{Axis, CellSpace};

/// Nodes along an axis of the polynomial through a state, and fewer of them, by which that is judged.
pub(crate) const NODES: usize = 6;
pub(crate) const FEWER_NODES: usize = 4;

/// Weights of nodes along one axis about a coordinate.
#[derive(Clone)]
pub(crate) struct AxisWeights {
    first: usize,
    weights: Vec<f64>,
}

impl AxisWeights {
    /// Nodes with their weights.
    pub(crate) fn each(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let weights = self.weights.iter().enumerate();
        weights.map(|(index, &weight)| (self.first + index, weight))
    }

    /// The same nodes, each of which counts one.
    pub(crate) fn counting(&self) -> Self {
        Self {
            weights: vec![1.0; self.weights.len()],
            ..*self
        }
    }
}

/// The weights of the nodes of an axis about a coordinate: so many that lie evenly about it, or all nodes of an axis of
/// modes, along which functions are series.
pub(crate) fn about(axis: &Axis, x: f64, nodes: usize) -> AxisWeights {
    about_shifted(axis, x, 0, nodes)
}

/// The same by nodes that lie `shift` nodes higher, but on an axis of modes.
pub(crate) fn about_shifted(axis: &Axis, x: f64, shift: isize, nodes: usize) -> AxisWeights {
    if axis.is_modes() {
        return AxisWeights {
            first: 0,
            weights: axis.interpolation(x),
        };
    }
    along(axis.count(), axis.coordinate(x), shift, nodes)
}

/// The weights of the nodes of an axis about a cell coordinate, `shift` nodes above those that lie evenly about it.
pub(crate) fn along(count: usize, place: f64, shift: isize, nodes: usize) -> AxisWeights {
    let used = nodes.min(count);
    let nearest = (place - 0.5).floor() as isize - (used as isize / 2 - 1) + shift;
    let first = nearest.clamp(0, (count - used) as isize) as usize;
    let weight = |index: usize| {
        let node = (first + index) as f64 + 0.5;
        (0..used)
            .filter(|&other| other != index)
            .fold(1.0, |product, other| {
                let other = (first + other) as f64 + 0.5;
                product * (place - other) / (node - other)
            })
    };
    let weights = (0..used).map(weight).collect();
    AxisWeights { first, weights }
}

/// Visits the nodes of a product of weights: numbers of cells, and weights.
pub(crate) fn each<W: Borrow<AxisWeights>>(
    space: &CellSpace,
    along: &[W],
    mut visit: impl FnMut(usize, f64),
) {
    let shape = space.shape();
    let total: usize = along.iter().map(|one| one.borrow().weights.len()).product();
    for number in 0..total {
        let (mut rest, mut cell, mut weight) = (number, 0, 1.0);
        for (axis, one) in along.iter().enumerate() {
            let one = one.borrow();
            let at = rest % one.weights.len();
            rest /= one.weights.len();
            cell = cell * shape[axis] + one.first + at;
            weight *= one.weights[at];
        }
        visit(cell, weight);
    }
}

/// The place of a coordinate in cell coordinates; on an axis of modes linear between nodes.
pub(crate) fn place_of(axis: &Axis, x: f64) -> f64 {
    if !axis.is_modes() {
        return axis.coordinate(x);
    }
    let nodes = axis.nodes();
    let upper = nodes.partition_point(|&node| node < x);
    match (upper.checked_sub(1), nodes.get(upper)) {
        (Some(lower), Some(above)) => {
            lower as f64 + 0.5 + (x - nodes[lower]) / (above - nodes[lower])
        }
        (None, _) => 0.5,
        (Some(last), None) => last as f64 + 0.5,
    }
}
