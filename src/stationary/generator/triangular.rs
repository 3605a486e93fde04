//! Forward and backward substitution along the tree of fronts, for one vector or several in one pass.
//!
//! A subtree's unknowns are contiguous, so halves are solved in parallel. Sums always run in the same order, whether a
//! vector is solved alone or with others: a pass is bound by reading the factors, which several vectors then share.

pub(super) mod block;
pub(super) mod transposed;

use std::array::from_fn;

use multiversion::multiversion;

use super::fronts::Factor;
use super::number::Number;
use super::symbolic::Symbolic;

/// Subtrees with fewer unknowns are not worth a task.
const GRAIN: usize = 2000;
/// Columns of a triangle that are solved before the rest is updated.
const BLOCK: usize = 32;
/// Products with more entries are cut into two tasks.
const LARGE_PRODUCT: usize = 1 << 17;

/// Solves M x = b in place for each `x`, which is in the elimination order.
pub(super) fn solve<T: Number, const R: usize>(
    symbolic: &Symbolic,
    factors: &[Factor<T>],
    mut x: [&mut [T::Wide]; R],
) {
    if let Some(root) = symbolic.fronts.len().checked_sub(1) {
        forward(symbolic, factors, root, x.each_mut().map(|x| &mut **x));
        backward(symbolic, factors, root, x, [&[]; R]);
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

/// Cuts each vector at the same place.
fn cut_each<W, const R: usize>(x: [&mut [W]; R], at: usize) -> ([&mut [W]; R], [&mut [W]; R]) {
    let mut after: [&mut [W]; R] = from_fn(|_| Default::default());
    let mut places = after.iter_mut();
    let before = x.map(|x| {
        let (head, tail) = x.split_at_mut(at);
        if let Some(place) = places.next() {
            *place = tail;
        }
        head
    });
    (before, after)
}

/// L y = b over a subtree; gives what it adds to its boundary.
fn forward<T: Number, const R: usize>(
    symbolic: &Symbolic,
    factors: &[Factor<T>],
    top: usize,
    x: [&mut [T::Wide]; R],
) -> [Vec<T::Wide>; R] {
    let front = &symbolic.fronts[top];
    let (k, m) = (front.node.own.len(), front.boundary);
    let below = x.first().map_or(0, |x| x.len() - k);
    let mut local: [Vec<T::Wide>; R] = from_fn(|_| vec![T::Wide::default(); k + m]);
    let (unknowns, mut own) = cut_each(x, below);
    if let Some([left, right]) = front.node.children {
        let cut = symbolic.first_unknown(right) - symbolic.first_unknown(top);
        let (a, b) = cut_each(unknowns, cut);
        let updates = both(
            below > GRAIN,
            || forward(symbolic, factors, left, a),
            || forward(symbolic, factors, right, b),
        );
        for (child, updates) in [(left, updates.0), (right, updates.1)] {
            for (local, update) in local.iter_mut().zip(updates) {
                for (&place, value) in symbolic.fronts[child].in_parent.iter().zip(update) {
                    local[place as usize] += value;
                }
            }
        }
    }
    let factor = &factors[top];
    for (own, local) in own.iter_mut().zip(&local) {
        let summed: Vec<T::Wide> = own.iter().zip(local).map(|(&a, &b)| a + b).collect();
        for (slot, &row) in own.iter_mut().zip(&factor.rows) {
            *slot = summed[row as usize];
        }
    }
    for from in (0..k).step_by(BLOCK) {
        let to = (from + BLOCK).min(k);
        let left = own.each_mut().map(|own| &mut own[from..]);
        let (mut block, rest) = cut_each(left, to - from);
        for block in &mut block {
            for column in from..to {
                let (done, after) = block.split_at_mut(column - from + 1);
                let lower = &factor.upper[column * k + column + 1..column * k + to];
                subtract_one(lower, done[column - from], after);
            }
        }
        let block = block.map(|block| &*block);
        subtract_product(&factor.upper[from * k + to..], k, block, rest);
    }
    let mut update = local.map(|mut local| local.split_off(k));
    let solved = own.map(|own| &*own);
    let outward = update.each_mut().map(Vec::as_mut_slice);
    subtract_product(&factor.lower, m, solved, outward);
    update
}

/// U x = y over a subtree; `around` are the unknowns of the parent's front, own cells first.
fn backward<T: Number, const R: usize>(
    symbolic: &Symbolic,
    factors: &[Factor<T>],
    top: usize,
    x: [&mut [T::Wide]; R],
    around: [&[T::Wide]; R],
) {
    let front = &symbolic.fronts[top];
    let factor = &factors[top];
    let k = front.node.own.len();
    let below = x.first().map_or(0, |x| x.len() - k);
    let (unknowns, mut own) = cut_each(x, below);
    let mut local: [Vec<T::Wide>; R] = around.map(|around| {
        let mut local = Vec::with_capacity(k + front.boundary);
        local.resize(k, T::Wide::default());
        local.extend(front.in_parent.iter().map(|&place| around[place as usize]));
        local
    });
    let outward = local.each_ref().map(|local| &local[k..]);
    let inward = own.each_mut().map(|own| &mut **own);
    subtract_product(&factor.upper[k * k..], k, outward, inward);
    for from in (0..k).step_by(BLOCK).rev() {
        let to = (from + BLOCK).min(k);
        let left = own.each_mut().map(|own| &mut own[..to]);
        let (rest, mut block) = cut_each(left, from);
        for block in &mut block {
            for column in (from..to).rev() {
                let above = &factor.upper[column * k + from..=column * k + column];
                let (before, done) = block.split_at_mut(column - from);
                done[0] /= above[column - from].wide();
                subtract_one(&above[..column - from], done[0], before);
            }
        }
        let block = block.map(|block| &*block);
        subtract_product(&factor.upper[from * k..], k, block, rest);
    }
    if let Some([left, right]) = front.node.children {
        for (local, own) in local.iter_mut().zip(&own) {
            local[..k].copy_from_slice(own);
        }
        let local = local.each_ref().map(Vec::as_slice);
        let cut = symbolic.first_unknown(right) - symbolic.first_unknown(top);
        let (a, b) = cut_each(unknowns, cut);
        both(
            below > GRAIN,
            || backward(symbolic, factors, left, a, local),
            || backward(symbolic, factors, right, b, local),
        );
    }
}

/// y ← y - a x for one column a.
fn subtract_one<T: Number>(column: &[T], x: T::Wide, y: &mut [T::Wide]) {
    for (slot, &entry) in y.iter_mut().zip(column) {
        *slot -= entry.wide() * x;
    }
}

/// y ← y - A x for each pair; columns of A start `stride` apart and are used as far as y is long. Large products are
/// cut in two by rows.
fn subtract_product<T: Number, const R: usize>(
    matrix: &[T],
    stride: usize,
    x: [&[T::Wide]; R],
    y: [&mut [T::Wide]; R],
) {
    let (Some(rows), Some(columns)) = (y.first().map(|y| y.len()), x.first().map(|x| x.len()))
    else {
        return;
    };
    if rows * columns <= LARGE_PRODUCT || rows < 2 * BLOCK {
        columns_in_turn(matrix, stride, x, y);
        return;
    }
    let half = (rows / 2).next_multiple_of(BLOCK);
    let (above, below) = cut_each(y, half);
    rayon::join(
        || subtract_product(matrix, stride, x, above),
        || subtract_product(&matrix[half..], stride, x, below),
    );
}

/// [`subtract_product`] in one task. Four columns at a time, so that y is read and written less often, and each four
/// for all pairs, so that they are fetched once.
#[multiversion(targets = "simd")]
fn columns_in_turn<T: Number, const R: usize>(
    matrix: &[T],
    stride: usize,
    x: [&[T::Wide]; R],
    mut y: [&mut [T::Wide]; R],
) {
    let (Some(rows), Some(columns)) = (y.first().map(|y| y.len()), x.first().map(|x| x.len()))
    else {
        return;
    };
    if rows == 0 {
        return;
    }
    let column = |index: usize| &matrix[index * stride..index * stride + rows];
    let fours = columns / 4 * 4;
    for index in (0..fours).step_by(4) {
        let (a, b) = (column(index), column(index + 1));
        let (c, d) = (column(index + 2), column(index + 3));
        for (y, x) in y.iter_mut().zip(x) {
            let input = [x[index], x[index + 1], x[index + 2], x[index + 3]];
            for ((((slot, a), b), c), d) in y.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                let first = a.wide() * input[0] + b.wide() * input[1];
                let second = c.wide() * input[2] + d.wide() * input[3];
                *slot -= first + second;
            }
        }
    }
    for index in fours..columns {
        for (y, x) in y.iter_mut().zip(x) {
            for (slot, &entry) in y.iter_mut().zip(column(index)) {
                *slot -= entry.wide() * x[index];
            }
        }
    }
}
