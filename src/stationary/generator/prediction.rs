//! Memory and work of a factorisation, from the geometry of the grid alone.
//!
//! A front of a node with k own cells and m boundary cells stores k² + 2 k m numbers for good and m² until its
//! parent has taken them, and costs 2k³/3 + 2k²m + 2km² operations. How the m² share memory: [`UpdateSpace`].

use super::dissection::{Cut, Grid, GridBox};
use super::updates::UpdateSpace;
use crate::MAX_DIMENSION;

/// What factorising takes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Prediction {
    /// Numbers in the factors.
    pub(super) factor_entries: f64,
    /// Room for the updates of fronts in flight, whatever the number of threads.
    pub(super) updates: UpdateSpace,
    /// Floating-point operations of one factorisation.
    pub(super) operations: f64,
}

impl Prediction {
    /// Adds a front whose children are done: `self` sums the children.
    fn with_front(self, own: usize, boundary: usize) -> Self {
        let (k, m) = (own as f64, boundary as f64);
        Self {
            factor_entries: self.factor_entries + k * k + 2.0 * k * m,
            updates: self.updates,
            operations: self.operations + k * (2.0 / 3.0 * k * k + 2.0 * k * m + 2.0 * m * m),
        }
    }

    /// Bytes at the peak, for numbers of the given size.
    pub(super) fn bytes(&self, number: usize) -> f64 {
        (self.factor_entries + self.updates.total() as f64) * number as f64
    }
}

/// Cells outside a box, inside the grid, that a star stencil reaches from it.
fn boundary(grid: &Grid, cells: &GridBox) -> usize {
    (0..MAX_DIMENSION)
        .map(|axis| {
            let below = cells.low[axis].min(grid.reach[axis]);
            let above = (grid.shape[axis] - cells.high[axis]).min(grid.reach[axis]);
            cells.count() / cells.length(axis) * (below + above)
        })
        .sum()
}

/// Predicts by walking the tree of boxes, without any matrix.
pub(super) fn predict(grid: &Grid) -> Prediction {
    walk(grid, &grid.cut_whole(), 0)
}

/// Of a box that is cut, with so many cells around it.
fn walk(grid: &Grid, cut: &Cut, around: usize) -> Prediction {
    let mut children = Prediction::default();
    let mut below = [UpdateSpace::default(); 2];
    for (half, below) in cut.halves.iter().flatten().zip(&mut below) {
        let of = walk(grid, &grid.cut_or_leaf(half), boundary(grid, half));
        children.factor_entries += of.factor_entries;
        children.operations += of.operations;
        *below = of.updates;
    }
    children.updates = UpdateSpace::above(below, around);
    let own = cut.own.iter().map(GridBox::count).sum();
    children.with_front(own, around)
}
