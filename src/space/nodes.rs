//! Weights of interpolation from the nodes of one axis, and from products of them.

use super::{Axis, CellSpace};

/// Nodes along an axis of the polynomial through a state, and fewer of them, by which that is judged.
pub(crate) const NODES: usize = 6;
pub(crate) const FEWER_NODES: usize = 4;

/// Weights of nodes along one axis about a coordinate.
#[derive(Clone, Copy)]
pub(crate) struct AxisWeights {
    first: usize,
    used: usize,
    weights: [f64; NODES],
}

impl AxisWeights {
    /// Nodes with their weights.
    pub(crate) fn each(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let weights = self.weights[..self.used].iter().enumerate();
        weights.map(|(index, &weight)| (self.first + index, weight))
    }

    /// The same nodes, each of which counts one.
    pub(crate) fn counting(&self) -> Self {
        Self {
            weights: [1.0; NODES],
            ..*self
        }
    }
}

/// The weights of the nodes of an axis about a coordinate, those that lie evenly about it.
pub(crate) fn about(axis: &Axis, x: f64, nodes: usize) -> AxisWeights {
    along(axis.count(), place_of(axis, x), 0, nodes)
}

/// The weights of the nodes of an axis about a cell coordinate, `shift` nodes above those that lie evenly about it.
pub(crate) fn along(count: usize, place: f64, shift: isize, nodes: usize) -> AxisWeights {
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
pub(crate) fn each(space: &CellSpace, along: &[AxisWeights], mut visit: impl FnMut(usize, f64)) {
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

/// The place of a coordinate: of its node on an axis of modes.
pub(crate) fn place_of(axis: &Axis, x: f64) -> f64 {
    if axis.is_modes() {
        let node = axis.nodes().partition_point(|&node| node < x);
        return node as f64 + 0.5;
    }
    axis.coordinate(x)
}
