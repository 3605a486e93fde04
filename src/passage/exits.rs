//! Shares of the processes that end by entering each part of a target.

use super::{Passage, dot};
use crate::generator::AbsorbingGenerator;
use crate::space::CellSpace;
use crate::system::BoundQuantity;

/// Which part of a target each cell inside it belongs to: the one whose level is least at its node.
pub(super) struct Exits {
    parts: usize,
    of_cells: Vec<Option<usize>>,
}

impl Exits {
    /// The parts of a passage on cells.
    pub(super) fn new(passage: &Passage, space: &CellSpace, kept: &[bool]) -> Self {
        let nearest = |state: &[f64]| {
            let levels = passage
                .exits
                .iter()
                .map(|part: &BoundQuantity| part.at(state));
            let least = levels
                .enumerate()
                .min_by(|one, other| one.1.total_cmp(&other.1));
            least.map(|(part, _)| part)
        };
        let of_cell = |cell: usize| match kept[cell] || passage.exits.is_empty() {
            true => None,
            false => nearest(&space.node(cell)),
        };
        Self {
            parts: passage.exits.len(),
            of_cells: (0..kept.len()).map(of_cell).collect(),
        }
    }

    /// For each part, the rates at which a process enters it from the cells.
    pub(super) fn rates(&self, generator: &AbsorbingGenerator) -> Vec<Vec<f64>> {
        let mut rates = vec![vec![0.0; self.of_cells.len()]; self.parts];
        for &(inside, source, rate) in &generator.entries {
            if let Some(part) = self.of_cells[inside] {
                rates[part][source] += rate;
            }
        }
        rates
    }
}

/// What other rates into a part change, at the same times in the cells.
pub(super) fn rate_change(own: &[f64], other: &[f64], times: &[f64]) -> f64 {
    dot(other, times) - dot(own, times)
}
