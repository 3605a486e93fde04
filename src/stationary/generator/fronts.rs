//! Numerical factorisation: multifrontal LU with dense fronts (Duff and Reid 1983).
//!
//! Rows are exchanged inside a front's own cells only, which keeps the order from geometry. That is
//! enough here: -Q with one probable cell held has a field of values to the right of zero but for the
//! discretisation's wiggles, so Schur complements stay well conditioned, and refinement removes the rest.
//!
//! Work is cut into pieces that depend on sizes alone, so results are the same for any number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
};
use faer::{Accum, MatMut, MatRef, Par};

use super::number::{Number, Wide};
use super::symbolic::{Front, Symbolic};
use super::updates::Updates;
use crate::cancellation::{Cancellation, Cancelled};

/// A part of a front, by columns or (transposed) by rows.
type Block<'a, T> = MatMut<'a, T, usize, usize, isize, isize>;

/// Columns (or rows) that one task updates.
const CHUNK: usize = 192;
/// Columns that are eliminated before the rest of a front is updated.
const PANEL: usize = 128;

/// The factors of one front with k own and m boundary cells, columns contiguous.
#[derive(Debug, Clone)]
pub(super) struct Factor<T> {
    /// k × (k + m): L and U of the own cells, then U to the boundary.
    pub(super) upper: Vec<T>,
    /// m × k: L to the boundary.
    pub(super) lower: Vec<T>,
    /// Row `rows[i]` of the own cells stands at place `i` after the exchanges.
    pub(super) rows: Vec<u32>,
}

/// The numbers of a factorisation, and the memory that makes them.
#[derive(Debug)]
pub(super) struct Factors<T> {
    /// Of every front.
    pub(super) fronts: Vec<Factor<T>>,
    /// For the updates of fronts in flight; kept, because memory that is asked for anew costs as much as writing it.
    updates: Vec<T>,
}

/// Makes room for the factors.
pub(super) fn allocate<T: Number>(symbolic: &Symbolic) -> Factors<T> {
    let factor = |front: &Front| {
        let (k, m) = (front.node.own.len(), front.boundary);
        Factor {
            upper: vec![T::from_real(0.0); k * (k + m)],
            lower: vec![T::from_real(0.0); m * k],
            rows: vec![0; k],
        }
    };
    Factors {
        fronts: symbolic.fronts.iter().map(factor).collect(),
        updates: vec![T::from_real(0.0); symbolic.updates().total()],
    }
}

/// Factorises: `values` are the rates in the order of the matrix's data, scaled to about one, zero in the row and
/// column of the unknown that is held (its place in the elimination order), which gets a one on the diagonal. Cancelled
/// factors are worth nothing.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn factorise<T: Number>(
    symbolic: &Symbolic,
    values: &[T::Wide],
    held: usize,
    factors: &mut Factors<T>,
    cancellation: &Cancellation,
) -> Result<(), Cancelled> {
    if let Some(root) = symbolic.fronts.len().checked_sub(1) {
        let task = Task {
            symbolic,
            values,
            held,
            cancellation,
        };
        let updates = Updates::new(&mut factors.updates, symbolic.updates());
        task.subtree(root, &mut factors.fronts, updates)?;
    }
    cancellation.check()
}

/// What every front needs.
struct Task<'a, W> {
    symbolic: &'a Symbolic,
    values: &'a [W],
    held: usize,
    cancellation: &'a Cancellation,
}

impl<W: Wide> Task<'_, W> {
    /// Factorises a subtree (`factors` are those of its nodes); the m × m update of its top comes first in `updates`.
    fn subtree<T: Number<Wide = W>>(
        &self,
        top: usize,
        factors: &mut [Factor<T>],
        mut updates: Updates<'_, T>,
    ) -> Result<(), Cancelled> {
        let fronts = &self.symbolic.fronts;
        let front = &fronts[top];
        let Some((factor, below)) = factors.split_last_mut() else {
            return Ok(());
        };
        if let Some([left, right]) = front.node.children {
            let (of_left, of_right) = below.split_at_mut(left + 1 - front.node.first);
            let [first, second] = updates.below(fronts[left].updates);
            let done = rayon::join(
                || self.subtree(left, of_left, first),
                || self.subtree(right, of_right, second),
            );
            done.0.and(done.1)?;
        }
        self.cancellation.check()?;
        self.assemble(front, factor);
        let (update, children) = updates.top(front.boundary);
        update.fill(T::from_real(0.0));
        if let Some([left, right]) = front.node.children {
            let (of_left, of_right) = children.split_at(fronts[left].updates.of_top);
            extend(&fronts[left], of_left, front, factor, update);
            extend(&fronts[right], of_right, front, factor, update);
        }
        eliminate(front, factor, update, self.cancellation);
        Ok(())
    }

    /// Puts the matrix's own entries into the front.
    fn assemble<T: Number<Wide = W>>(&self, front: &Front, factor: &mut Factor<T>) {
        let (k, m) = (front.node.own.len(), front.boundary);
        factor.upper.fill(T::from_real(0.0));
        factor.lower.fill(T::from_real(0.0));
        for entry in &front.entries {
            let (row, column) = (entry.row as usize, entry.column as usize);
            // The diagonal grows by a rounding error, so that a closed set of cells that rounding separates
            // from the held one does not make the matrix singular.
            let growth = if row == column { T::SPACING } else { 0.0 };
            let rate = T::from_rate(self.values[entry.value as usize] * (1.0 + growth));
            if row < k {
                factor.upper[column * k + row] = rate;
            } else {
                factor.lower[column * m + row - k] = rate;
            }
        }
        if front.node.own.contains(&self.held) {
            let held = self.held - front.node.own.start;
            factor.upper[held * k + held] = T::from_real(1.0);
        }
    }
}

/// Adds a child's update, with which `of_child` begins; its boundary is ascending in the parent's local numbers, own
/// cells first.
fn extend<T: Number>(
    child: &Front,
    of_child: &[T],
    front: &Front,
    factor: &mut Factor<T>,
    update: &mut [T],
) {
    let (k, m) = (front.node.own.len(), front.boundary);
    let map = &child.in_parent;
    if map.is_empty() {
        return;
    }
    let split = map.partition_point(|&place| (place as usize) < k);
    let add = |into: &mut [T], from: &[T], map: &[u32], shift: usize| {
        for (&value, &place) in from.iter().zip(map) {
            let slot = &mut into[place as usize - shift];
            *slot += value;
        }
    };
    for (column, &place) in of_child.chunks_exact(map.len()).zip(map) {
        let place = place as usize;
        let upper = &mut factor.upper[place * k..(place + 1) * k];
        add(upper, &column[..split], &map[..split], 0);
        let below = if place < k {
            &mut factor.lower[place * m..(place + 1) * m]
        } else {
            &mut update[(place - k) * m..(place - k + 1) * m]
        };
        add(below, &column[split..], &map[split..], k);
    }
}

/// Eliminates the own cells of an assembled front; `update` becomes the Schur complement. Cancelled, it leaves things
/// half done: the largest fronts alone take seconds.
fn eliminate<T: Number>(
    front: &Front,
    factor: &mut Factor<T>,
    update: &mut [T],
    cancellation: &Cancellation,
) {
    let (k, m) = (front.node.own.len(), front.boundary);
    let minus = T::from_real(-1.0);
    let upper = MatMut::from_column_major_slice_mut(&mut factor.upper, k, k + m);
    factorise_rows(upper, &mut factor.rows, cancellation);
    if m == 0 {
        return;
    }
    let upper = MatRef::from_column_major_slice(&factor.upper, k, k + m);
    let (own, outward) = upper.split_at_col(k);
    // L21 U11 = A21, row by row: U11ᵀ L21ᵀ = A21ᵀ.
    let lower = MatMut::from_column_major_slice_mut(&mut factor.lower, m, k);
    let above = own.transpose();
    by_columns(lower.transpose_mut(), 0, &|_, mut rows: Block<'_, T>| {
        if cancellation.is_cancelled() {
            return;
        }
        solve_lower_triangular_in_place(above, rows.as_mut(), Par::Seq);
        drop_small(rows);
    });
    let lower = MatRef::from_column_major_slice(&factor.lower, m, k);
    let update = MatMut::from_column_major_slice_mut(update, m, m);
    by_columns(update.as_dyn_stride_mut(), 0, &|start, columns| {
        if cancellation.is_cancelled() {
            return;
        }
        let outward = outward.subcols(start, columns.ncols());
        matmul(columns, Accum::Add, lower, outward, minus, Par::Seq);
    });
}

/// Blocked LU of the k rows of own cells: rows exchanged among all of them, panel by panel.
fn factorise_rows<T: Number>(
    mut upper: MatMut<'_, T>,
    rows: &mut [u32],
    cancellation: &Cancellation,
) {
    let (k, columns) = upper.shape();
    let minus = T::from_real(-1.0);
    for (place, row) in rows.iter_mut().enumerate() {
        *row = place as u32;
    }
    let scratch = lu_in_place_scratch::<u32, T>(k, PANEL, Par::Seq, faer::Spec::default());
    let mut memory = MemBuffer::new(scratch);
    let (mut forward, mut inverse) = (vec![0u32; k], vec![0u32; k]);
    for from in (0..k).step_by(PANEL) {
        if cancellation.is_cancelled() {
            return;
        }
        let width = PANEL.min(k - from);
        let left = k - from;
        let (before, rest) = upper
            .as_mut()
            .submatrix_mut(from, 0, left, columns)
            .split_at_col_mut(from);
        let (mut panel, after) = rest.split_at_col_mut(width);
        let stack = MemStack::new(&mut memory);
        lu_in_place(
            panel.as_mut(),
            &mut forward[..left],
            &mut inverse[..left],
            Par::Seq,
            stack,
            faer::Spec::default(),
        );
        drop_small(panel.as_mut().as_dyn_stride_mut());
        let forward = &forward[..left];
        let old = rows[from..].to_vec();
        for (slot, &source) in rows[from..].iter_mut().zip(forward) {
            *slot = old[source as usize];
        }
        exchange(before.as_dyn_stride_mut(), forward);
        let panel = panel.as_ref();
        let (top, below) = panel.split_at_row(width);
        by_columns(after.as_dyn_stride_mut(), 0, &|_, mut columns| {
            exchange(columns.as_mut(), forward);
            let (mut first, other) = columns.split_at_row_mut(width);
            solve_unit_lower_triangular_in_place(top, first.as_mut(), Par::Seq);
            drop_small(first.as_mut());
            matmul(other, Accum::Add, below, first.as_ref(), minus, Par::Seq);
        });
    }
}

/// Drops entries below the floor. Columns or rows must be contiguous.
fn drop_small<T: Number>(block: Block<'_, T>) {
    let block = if block.row_stride() == 1 {
        block
    } else {
        block.transpose_mut()
    };
    let Some(block) = block.try_as_col_major_mut() else {
        return;
    };
    for column in block.col_iter_mut() {
        for entry in column.iter_mut() {
            // Selects rather than branches.
            *entry = entry.floored();
        }
    }
}

/// Reorders the rows of a block, whose columns are contiguous: row `source[i]` goes to place `i`. Most stay where they
/// are.
fn exchange<T: Number>(block: Block<'_, T>, source: &[u32]) {
    let places = 0u32..;
    let moved = places.zip(source).filter(|(place, from)| place != *from);
    let moved: Vec<(u32, u32)> = moved.map(|(place, &from)| (place, from)).collect();
    let Some(block) = block.try_as_col_major_mut().filter(|_| !moved.is_empty()) else {
        return;
    };
    let mut taken = Vec::with_capacity(moved.len());
    for column in block.col_iter_mut() {
        let Some(column) = column.try_as_col_major_mut() else {
            return;
        };
        let column = column.as_slice_mut();
        taken.clear();
        taken.extend(moved.iter().map(|&(_, from)| column[from as usize]));
        for (&(place, _), &value) in moved.iter().zip(&taken) {
            column[place as usize] = value;
        }
    }
}

/// Runs `task(first column, columns)` on pieces of [`CHUNK`] columns, in parallel.
fn by_columns<T: Number, Task>(block: Block<'_, T>, start: usize, task: &Task)
where
    Task: Fn(usize, Block<'_, T>) + Sync,
{
    let columns = block.ncols();
    if columns <= CHUNK {
        if columns > 0 {
            task(start, block);
        }
        return;
    }
    let half = columns.div_ceil(CHUNK) / 2 * CHUNK;
    let (left, right) = block.split_at_col_mut(half);
    rayon::join(
        || by_columns(left, start, task),
        || by_columns(right, start + half, task),
    );
}
