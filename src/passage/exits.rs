//! Shares of the processes that end by entering each part of a target.

use super::dot;
use crate::generator::Ending;
use crate::space::CellSpace;
use crate::system::BoundQuantity;

/// Which part of a target a process comes to: the one whose level is least where it ends.
pub(super) struct Exits<'a> {
    parts: &'a [BoundQuantity],
    space: &'a CellSpace,
}

impl<'a> Exits<'a> {
    /// Parts, negative inside each, on cells.
    pub(super) fn new(parts: &'a [BoundQuantity], space: &'a CellSpace) -> Self {
        Self { parts, space }
    }

    /// The part that a process comes to: at the node of the cell that it enters, or on the end of an axis that is a
    /// border, as that of a displacement without noise is.
    fn part(&self, ending: &Ending) -> Option<usize> {
        let mut state = self.space.node(ending.cell);
        if let Some((axis, is_upper)) = ending.end {
            let range = &self.space.axes()[axis];
            state[axis] = if is_upper { range.to() } else { range.from() };
        }
        self.part_at(&state)
    }

    /// The part that a state on a border, or beyond it, belongs to.
    pub(super) fn part_at(&self, state: &[f64]) -> Option<usize> {
        let levels = self.parts.iter().map(|part| part.at(state)).enumerate();
        let least = levels.min_by(|one, other| one.1.total_cmp(&other.1));
        least.map(|(part, _)| part)
    }

    /// For each part, the rates at which a process comes to it from the cells, of those at which it ends.
    pub(super) fn rates(&self, endings: &[Ending]) -> Vec<Vec<f64>> {
        let mut rates = vec![vec![0.0; self.space.n_cells()]; self.parts.len()];
        for ending in endings.iter().filter(|_| !self.parts.is_empty()) {
            if let Some(part) = self.part(ending) {
                rates[part][ending.source] += ending.rate;
            }
        }
        rates
    }
}

/// What other rates into a part change, at the same times in the cells.
pub(super) fn rate_change(own: &[f64], other: &[f64], times: &[f64]) -> f64 {
    dot(other, times) - dot(own, times)
}
