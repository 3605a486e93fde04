//! The nodes of all cells as batches of states.

use crate::space::CellSpace;
use crate::system::{BoundQuantity, LANES, Lanes};

/// Hands over the nodes of all cells in their order: the number of the first cell of a batch, and the states from there
/// on, `states[axis][lane]`. Lanes behind the last cell repeat it.
pub(super) fn for_all_nodes(space: &CellSpace, mut look: impl FnMut(usize, &[Lanes])) {
    let mut states = vec![[0.0; LANES]; space.dimension()];
    let cells = space.n_cells();
    for first in (0..cells).step_by(LANES) {
        for (axis, (cut, lanes)) in space.axes().iter().zip(&mut states).enumerate() {
            for (lane, slot) in lanes.iter_mut().enumerate() {
                let cell = (first + lane).min(cells - 1);
                *slot = cut.nodes()[space.position(cell, axis)];
            }
        }
        look(first, &states);
    }
}

/// The values of a quantity at the nodes of all cells; zero where it has none.
pub(super) fn values_at_nodes(space: &CellSpace, quantity: &BoundQuantity) -> Vec<f64> {
    let mut values = Vec::with_capacity(space.n_cells() + LANES);
    for_all_nodes(space, |_, states| {
        let found = quantity.values(states);
        values.extend(found.map(|value| if value.is_finite() { value } else { 0.0 }));
    });
    values.truncate(space.n_cells());
    values
}
