//! Structure of the factorisation: which cells each front couples to, and where every rate goes.
//!
//! Computed once for a sparsity pattern and used again for every matrix that has it.

use sprs::CsMat;

use super::dissection::{Dissection, TreeNode};
use super::updates::UpdateSpace;

/// A stored rate and its place in a front: local row and column, own cells first, then the boundary.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    /// Index into the matrix's data.
    pub(super) value: u32,
    /// Row of the front.
    pub(super) row: u32,
    /// Column of the front.
    pub(super) column: u32,
}

/// A front: a node of the tree with its boundary.
#[derive(Debug, Clone)]
pub(super) struct Front {
    /// The node of the elimination tree.
    pub(super) node: TreeNode,
    /// Number of cells around the subtree that elimination couples.
    pub(super) boundary: usize,
    /// For each boundary cell, ascending, its local number in the parent's front; empty at the root.
    pub(super) in_parent: Vec<u32>,
    /// The rates assembled here.
    pub(super) entries: Vec<Entry>,
    /// What the updates of the subtree take.
    pub(super) updates: UpdateSpace,
}

/// The structure of all fronts, children before parents.
#[derive(Debug, Clone)]
pub(super) struct Symbolic {
    pub(super) fronts: Vec<Front>,
    /// `order[position]` is the cell eliminated at that position.
    pub(super) order: Vec<u32>,
}

/// Pattern by rows, with the index of each entry in the column-compressed data.
struct Rows {
    start: Vec<usize>,
    entries: Vec<(u32, u32)>,
}

impl Rows {
    fn new(matrix: &CsMat<f64>) -> Self {
        let n = matrix.rows();
        let mut start = vec![0; n + 1];
        for &row in matrix.indices() {
            start[row + 1] += 1;
        }
        for row in 0..n {
            start[row + 1] += start[row];
        }
        let mut next = start.clone();
        let mut entries = vec![(0, 0); matrix.nnz()];
        let mut index = 0;
        for (column, vector) in matrix.outer_iterator().enumerate() {
            for &row in vector.indices() {
                entries[next[row]] = (column as u32, index);
                next[row] += 1;
                index += 1;
            }
        }
        Self { start, entries }
    }
}

impl Symbolic {
    /// Lays out the fronts of a matrix (compressed by columns) in the given order.
    pub(super) fn new(matrix: &CsMat<f64>, tree: Dissection) -> Self {
        let n = matrix.rows();
        let rows = Rows::new(matrix);
        let mut position = vec![0u32; n];
        for (place, &cell) in tree.order.iter().enumerate() {
            position[cell as usize] = place as u32;
        }
        let mut local = vec![u32::MAX; n];
        let mut boundaries: Vec<Vec<u32>> = Vec::with_capacity(tree.nodes.len());
        let mut fronts: Vec<Front> = Vec::with_capacity(tree.nodes.len());
        for node in &tree.nodes {
            let own = node.own.clone();
            let below = node.children.into_iter().flatten();
            let below = below.flat_map(|child| &boundaries[child]).copied();
            let touched = neighbours(matrix, &rows, (&tree.order, &position), &own);
            let mut boundary: Vec<u32> = Vec::new();
            for place in touched.into_iter().chain(below) {
                if place as usize >= own.end && local[place as usize] == u32::MAX {
                    local[place as usize] = 0;
                    boundary.push(place);
                }
            }
            boundary.sort_unstable();
            number(&own, &boundary, &mut local);
            for child in node.children.into_iter().flatten() {
                let map = boundaries[child].iter();
                fronts[child].in_parent = map.map(|&place| local[place as usize]).collect();
                boundaries[child] = Vec::new();
            }
            let entries = entries(matrix, &rows, (&tree.order, &position), &own, &local);
            for place in own.clone().chain(boundary.iter().map(|&p| p as usize)) {
                local[place] = u32::MAX;
            }
            let below = node
                .children
                .map(|pair| pair.map(|child| fronts[child].updates));
            fronts.push(Front {
                node: node.clone(),
                boundary: boundary.len(),
                in_parent: Vec::new(),
                entries,
                updates: UpdateSpace::above(below.unwrap_or_default(), boundary.len()),
            });
            boundaries.push(boundary);
        }
        Self {
            fronts,
            order: tree.order,
        }
    }

    /// Place in the elimination order of the first unknown of a subtree.
    pub(super) fn first_unknown(&self, top: usize) -> usize {
        let first = self.fronts[top].node.first;
        self.fronts[first].node.own.start
    }

    /// What the updates of all fronts take.
    pub(super) fn updates(&self) -> UpdateSpace {
        self.fronts
            .last()
            .map_or_else(UpdateSpace::default, |root| root.updates)
    }

    /// Numbers in the factors.
    pub(super) fn factor_entries(&self) -> usize {
        let size =
            |front: &Front| front.node.own.len() * (front.node.own.len() + 2 * front.boundary);
        self.fronts.iter().map(size).sum()
    }
}

/// Local numbers of a front: own cells, then the boundary.
fn number(own: &std::ops::Range<usize>, boundary: &[u32], local: &mut [u32]) {
    for (index, place) in own.clone().enumerate() {
        local[place] = index as u32;
    }
    for (index, &place) in boundary.iter().enumerate() {
        local[place as usize] = (own.len() + index) as u32;
    }
}

/// Places in the elimination order of all cells that rates join to the own cells, with repetitions.
fn neighbours(
    matrix: &CsMat<f64>,
    rows: &Rows,
    (order, position): (&[u32], &[u32]),
    own: &std::ops::Range<usize>,
) -> Vec<u32> {
    let columns = matrix.indptr();
    let columns = columns.raw_storage();
    let mut touched = Vec::new();
    for &cell in &order[own.clone()] {
        let cell = cell as usize;
        let out = &matrix.indices()[columns[cell]..columns[cell + 1]];
        touched.extend(out.iter().map(|&row| position[row]));
        let into = &rows.entries[rows.start[cell]..rows.start[cell + 1]];
        touched.extend(into.iter().map(|&(column, _)| position[column as usize]));
    }
    touched
}

/// The rates whose earlier cell is one of the front's own.
fn entries(
    matrix: &CsMat<f64>,
    rows: &Rows,
    (order, position): (&[u32], &[u32]),
    own: &std::ops::Range<usize>,
    local: &[u32],
) -> Vec<Entry> {
    let columns = matrix.indptr();
    let columns = columns.raw_storage();
    let mut entries = Vec::new();
    for (index, &cell) in order[own.clone()].iter().enumerate() {
        let cell = cell as usize;
        for value in columns[cell]..columns[cell + 1] {
            let place = position[matrix.indices()[value]] as usize;
            if place >= own.start {
                entries.push(Entry {
                    value: value as u32,
                    row: local[place],
                    column: index as u32,
                });
            }
        }
        for &(column, value) in &rows.entries[rows.start[cell]..rows.start[cell + 1]] {
            let place = position[column as usize] as usize;
            if place >= own.end {
                entries.push(Entry {
                    value,
                    row: index as u32,
                    column: local[place],
                });
            }
        }
    }
    entries
}
