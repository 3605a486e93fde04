//! Forward and backward substitution along the tree of fronts.
//!
//! A subtree's unknowns are contiguous, so halves are solved in parallel. Sums always run in the same order.

use multiversion::multiversion;

use super::fronts::{Factor, Number};
use super::symbolic::Symbolic;

/// Subtrees with fewer unknowns are not worth a task.
const GRAIN: usize = 2000;
/// Columns of a triangle that are solved before the rest is updated.
const BLOCK: usize = 32;

/// Solves M x = b in place; `x` is in the elimination order.
pub(super) fn solve<T: Number>(symbolic: &Symbolic, factors: &[Factor<T>], x: &mut [f64]) {
    if let Some(root) = symbolic.fronts.len().checked_sub(1) {
        forward(symbolic, factors, root, x);
        backward(symbolic, factors, root, x, &[]);
    }
}

/// Runs both tasks, in parallel when they are large.
fn both<A: Send, B: Send>(
    large: bool,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if large { rayon::join(a, b) } else { (a(), b()) }
}

/// L y = b over a subtree; gives what it adds to its boundary.
fn forward<T: Number>(
    symbolic: &Symbolic,
    factors: &[Factor<T>],
    top: usize,
    x: &mut [f64],
) -> Vec<f64> {
    let front = &symbolic.fronts[top];
    let (k, m) = (front.node.own.len(), front.boundary);
    let below = x.len() - k;
    let mut local = vec![0.0; k + m];
    let (unknowns, own) = x.split_at_mut(below);
    if let Some([left, right]) = front.node.children {
        let cut = symbolic.first_unknown(right) - symbolic.first_unknown(top);
        let (a, b) = unknowns.split_at_mut(cut);
        let updates = both(
            below > GRAIN,
            || forward(symbolic, factors, left, a),
            || forward(symbolic, factors, right, b),
        );
        for (child, update) in [(left, updates.0), (right, updates.1)] {
            for (&place, value) in symbolic.fronts[child].in_parent.iter().zip(update) {
                local[place as usize] += value;
            }
        }
    }
    let factor = &factors[top];
    let summed: Vec<f64> = own.iter().zip(&local).map(|(a, b)| a + b).collect();
    for (slot, &row) in own.iter_mut().zip(&factor.rows) {
        *slot = summed[row as usize];
    }
    for from in (0..k).step_by(BLOCK) {
        let to = (from + BLOCK).min(k);
        let (block, rest) = own[from..].split_at_mut(to - from);
        for column in from..to {
            let (done, after) = block.split_at_mut(column - from + 1);
            let lower = &factor.upper[column * k + column + 1..column * k + to];
            subtract_one(lower, done[column - from], after);
        }
        subtract_product(&factor.upper[from * k + to..], k, block, rest);
    }
    let mut update = local.split_off(k);
    subtract_product(&factor.lower, m, own, &mut update);
    update
}

/// U x = y over a subtree; `around` are the unknowns of the parent's front, own cells first.
fn backward<T: Number>(
    symbolic: &Symbolic,
    factors: &[Factor<T>],
    top: usize,
    x: &mut [f64],
    around: &[f64],
) {
    let front = &symbolic.fronts[top];
    let factor = &factors[top];
    let k = front.node.own.len();
    let (unknowns, own) = x.split_at_mut(x.len() - k);
    let mut local = Vec::with_capacity(k + front.boundary);
    local.resize(k, 0.0);
    local.extend(front.in_parent.iter().map(|&place| around[place as usize]));
    subtract_product(&factor.upper[k * k..], k, &local[k..], own);
    for from in (0..k).step_by(BLOCK).rev() {
        let to = (from + BLOCK).min(k);
        let (rest, block) = own[..to].split_at_mut(from);
        for column in (from..to).rev() {
            let above = &factor.upper[column * k + from..=column * k + column];
            let (before, done) = block.split_at_mut(column - from);
            done[0] /= above[column - from].wide();
            subtract_one(&above[..column - from], done[0], before);
        }
        subtract_product(&factor.upper[from * k..], k, block, rest);
    }
    if let Some([left, right]) = front.node.children {
        local[..k].copy_from_slice(own);
        let cut = symbolic.first_unknown(right) - symbolic.first_unknown(top);
        let large = unknowns.len() > GRAIN;
        let (a, b) = unknowns.split_at_mut(cut);
        both(
            large,
            || backward(symbolic, factors, left, a, &local),
            || backward(symbolic, factors, right, b, &local),
        );
    }
}

/// y ← y - a x for one column a.
fn subtract_one<T: Number>(column: &[T], x: f64, y: &mut [f64]) {
    for (slot, &entry) in y.iter_mut().zip(column) {
        *slot -= entry.wide() * x;
    }
}

/// y ← y - A x; columns of A start `stride` apart and are used as far as y is long. Four columns at a time, so
/// that y is read and written less often.
#[multiversion(targets = "simd")]
fn subtract_product<T: Number>(matrix: &[T], stride: usize, x: &[f64], y: &mut [f64]) {
    let rows = y.len();
    if rows == 0 {
        return;
    }
    let column = |index: usize| &matrix[index * stride..index * stride + rows];
    let mut inputs = x.chunks_exact(4);
    let mut index = 0;
    for input in inputs.by_ref() {
        let (a, b) = (column(index), column(index + 1));
        let (c, d) = (column(index + 2), column(index + 3));
        index += 4;
        for ((((slot, a), b), c), d) in y.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            let first = a.wide() * input[0] + b.wide() * input[1];
            let second = c.wide() * input[2] + d.wide() * input[3];
            *slot -= first + second;
        }
    }
    for &input in inputs.remainder() {
        for (slot, &entry) in y.iter_mut().zip(column(index)) {
            *slot -= entry.wide() * input;
        }
        index += 1;
    }
}
