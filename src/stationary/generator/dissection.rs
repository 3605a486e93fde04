//! Elimination order of the cells: nested dissection of the box grid (George 1973).
//!
//! A box of cells is cut by a slab as thick as the stencil reaches, so that the two halves do not touch; the
//! halves come first, the slab last. What remains of a half after elimination couples only to the layers of
//! cells around it, hence fronts are known from geometry alone, and so are memory and work. A long thin grid
//! is cut across its length only, which is the block form of a band solver.

use std::ops::Range;

use crate::MAX_DIMENSION;

/// A node of the elimination tree: the cells of one slab or one leaf.
#[derive(Debug, Clone)]
pub(super) struct TreeNode {
    /// Positions of its own cells in the elimination order.
    pub(super) own: Range<usize>,
    /// The two halves that the slab separates; none for a leaf.
    pub(super) children: Option<[usize; 2]>,
    /// First node of the subtree: nodes are in post-order, a subtree is `first..=node`.
    pub(super) first: usize,
}

/// The elimination tree in post-order and the order of the cells.
#[derive(Debug, Clone)]
pub(super) struct Dissection {
    /// All nodes, children before parents, the root last.
    pub(super) nodes: Vec<TreeNode>,
    /// `order[position]` is the cell eliminated at that position.
    pub(super) order: Vec<u32>,
}

/// A box of cells, `[low, high)` on every axis; axes that the grid does not have are `[0, 1)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct GridBox {
    pub(super) low: [usize; MAX_DIMENSION],
    pub(super) high: [usize; MAX_DIMENSION],
}

/// Sizes of a grid: cells and reach of the stencil an axis (reach at least 1), and the largest leaf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    pub(super) shape: [usize; MAX_DIMENSION],
    pub(super) reach: [usize; MAX_DIMENSION],
    pub(super) leaf: usize,
    /// Axis at whose lower end the cells couple to images of one another, see `symmetric`.
    pub(super) folded: Option<usize>,
}

/// A box that is cut: its halves, if it is, and the boxes of its own cells, which come last.
pub(super) struct Cut {
    pub(super) halves: Option<[GridBox; 2]>,
    pub(super) own: Vec<GridBox>,
}

impl Grid {
    /// Cells and reach of the axes there are; the rest is one cell thick.
    pub(super) fn new(shape: &[usize], reach: &[usize], leaf: usize) -> Self {
        let pad = |values: &[usize]| {
            let mut padded = [1; MAX_DIMENSION];
            for (slot, &value) in padded.iter_mut().zip(values) {
                *slot = value.max(1);
            }
            padded
        };
        Self {
            shape: pad(shape),
            reach: pad(reach),
            leaf: leaf.max(1),
            folded: None,
        }
    }

    /// The grid of the upper half along an axis.
    pub(super) fn fold_at(self, axis: Option<usize>) -> Self {
        Self {
            folded: axis,
            ..self
        }
    }

    /// Cuts the box of all cells. The layers where images couple hold together across the whole fold, so they come
    /// last.
    pub(super) fn cut_whole(&self) -> Cut {
        let mut rest = self.whole();
        let mut fold = None;
        if let Some(axis) = self.folded
            && rest.high[axis] > self.reach[axis]
        {
            let mut layers = rest;
            layers.high[axis] = self.reach[axis];
            rest.low[axis] = self.reach[axis];
            fold = Some(layers);
        } else if self.folded.is_some() {
            return Cut {
                halves: None,
                own: vec![rest],
            };
        }
        let mut cut = self.cut_or_leaf(&rest);
        cut.own.extend(fold);
        cut
    }

    /// Cuts a box, or makes a leaf of it.
    pub(super) fn cut_or_leaf(&self, cells: &GridBox) -> Cut {
        match self.cut(cells) {
            None => Cut {
                halves: None,
                own: vec![*cells],
            },
            Some([left, right, slab]) => Cut {
                halves: Some([left, right]),
                own: vec![slab],
            },
        }
    }

    /// The box of all cells.
    pub(super) fn whole(&self) -> GridBox {
        GridBox {
            low: [0; MAX_DIMENSION],
            high: self.shape,
        }
    }

    /// Cuts a box: (left half, right half, slab between). `None` when it is small enough to be a leaf or too
    /// thin to be cut.
    pub(super) fn cut(&self, cells: &GridBox) -> Option<[GridBox; 3]> {
        if cells.count() <= self.leaf {
            return None;
        }
        let slab = |axis: usize| cells.count() / cells.length(axis) * self.reach[axis];
        let axis = (0..MAX_DIMENSION)
            .filter(|&axis| cells.length(axis) >= self.reach[axis] + 2)
            .min_by_key(|&axis| slab(axis))?;
        let from = cells.low[axis] + (cells.length(axis) - self.reach[axis]) / 2;
        let (mut left, mut right, mut middle) = (*cells, *cells, *cells);
        left.high[axis] = from;
        middle.low[axis] = from;
        middle.high[axis] = from + self.reach[axis];
        right.low[axis] = from + self.reach[axis];
        Some([left, right, middle])
    }
}

impl GridBox {
    pub(super) fn length(&self, axis: usize) -> usize {
        self.high[axis] - self.low[axis]
    }

    pub(super) fn count(&self) -> usize {
        (0..MAX_DIMENSION).map(|axis| self.length(axis)).product()
    }

    /// Numbers of the cells of the box, C order.
    fn push_cells(&self, shape: &[usize; MAX_DIMENSION], order: &mut Vec<u32>) {
        for a in self.low[0]..self.high[0] {
            for b in self.low[1]..self.high[1] {
                for c in self.low[2]..self.high[2] {
                    let row = ((a * shape[1] + b) * shape[2] + c) * shape[3];
                    order.extend((self.low[3]..self.high[3]).map(|d| (row + d) as u32));
                }
            }
        }
    }
}

impl Dissection {
    /// Dissects the whole grid.
    pub(super) fn new(grid: &Grid) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            order: Vec::with_capacity(grid.whole().count()),
        };
        tree.add(grid, grid.cut_whole());
        tree
    }

    fn add(&mut self, grid: &Grid, cut: Cut) -> usize {
        let first = self.nodes.len();
        let children = cut
            .halves
            .map(|halves| halves.map(|half| self.add(grid, grid.cut_or_leaf(&half))));
        let start = self.order.len();
        for own in cut.own {
            own.push_cells(&grid.shape, &mut self.order);
        }
        self.nodes.push(TreeNode {
            own: start..self.order.len(),
            children,
            first,
        });
        self.nodes.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_is_ordered_once_and_halves_do_not_touch() {
        let grid = Grid::new(&[13, 9, 7], &[3, 2, 1], 20);
        let tree = Dissection::new(&grid);
        let mut sorted = tree.order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..13 * 9 * 7));
        let place = |cell: u32| {
            let cell = cell as usize;
            [cell / 63, cell / 7 % 9, cell % 7]
        };
        for node in &tree.nodes {
            let Some([left, right]) = node.children else {
                continue;
            };
            let span = |child: usize| {
                let child = &tree.nodes[child];
                &tree.order[tree.nodes[child.first].own.start..child.own.end]
            };
            for &a in span(left) {
                for &b in span(right) {
                    let (a, b) = (place(a), place(b));
                    // The reach of a star stencil: apart along one axis by more than its reach.
                    let apart = (0..3).any(|axis| a[axis].abs_diff(b[axis]) > grid.reach[axis]);
                    assert!(apart, "{a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn a_folded_grid_orders_every_cell_once_and_its_fold_last() {
        for shape in [[13, 9], [3, 9], [30, 4]] {
            let grid = Grid::new(&shape, &[3, 2], 20).fold_at(Some(0));
            let order = Dissection::new(&grid).order;
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.iter().copied().eq(0..(shape[0] * shape[1]) as u32));
            let fold = 3.min(shape[0]) * shape[1];
            let last = &order[order.len() - fold..];
            assert!(last.iter().all(|&cell| (cell as usize) < fold));
        }
    }

    #[test]
    fn leaves_are_small_and_the_root_slab_crosses_the_short_side() {
        let grid = Grid::new(&[100, 20], &[3, 3], 64);
        let tree = Dissection::new(&grid);
        let root = tree.nodes.last().unwrap();
        assert_eq!(root.own.len(), 60);
        let leaves = tree.nodes.iter().filter(|node| node.children.is_none());
        assert!(leaves.into_iter().all(|leaf| leaf.own.len() <= 64));
    }
}
