//! Substitution with the transposed factors: those of U from the leaves up, those of L from the root down.
//!
//! Columns of the factors are rows of what is solved here, so that all sums are products of contiguous numbers. Columns
//! are taken in blocks: what the unknowns before a block take off it is summed for four columns at a time.

use multiversion::multiversion;

use super::{BLOCK, GRAIN, LARGE_PRODUCT, both};
use crate::stationary::generator::fronts::Factor;
use crate::stationary::generator::number::Number;
use crate::stationary::generator::symbolic::Symbolic;

/// Solves Mᵀ x = b in place; x is in the elimination order.
pub(in crate::stationary::generator) fn solve_transposed<T: Number>(
    symbolic: &Symbolic,
    factors: &[Factor<T>],
    x: &mut [T::Wide],
) {
    if let Some(root) = symbolic.fronts.len().checked_sub(1) {
        upward(symbolic, factors, root, x);
        downward(symbolic, factors, root, x, &[]);
    }
}

/// Uᵀ y = b over a subtree; gives what it adds to its boundary.
fn upward<T: Number>(
    symbolic: &Symbolic,
    factors: &[Factor<T>],
    top: usize,
    x: &mut [T::Wide],
) -> Vec<T::Wide> {
    let front = &symbolic.fronts[top];
    let (k, m) = (front.node.own.len(), front.boundary);
    let below = x.len() - k;
    let (unknowns, own) = x.split_at_mut(below);
    let mut local = vec![T::Wide::default(); k + m];
    if let Some([left, right]) = front.node.children {
        let cut = symbolic.first_unknown(right) - symbolic.first_unknown(top);
        let (a, b) = unknowns.split_at_mut(cut);
        let updates = both(
            below > GRAIN,
            || upward(symbolic, factors, left, a),
            || upward(symbolic, factors, right, b),
        );
        for (child, update) in [(left, updates.0), (right, updates.1)] {
            for (&place, value) in symbolic.fronts[child].in_parent.iter().zip(update) {
                local[place as usize] += value;
            }
        }
    }
    let factor = &factors[top];
    let mut update = local.split_off(k);
    for (value, added) in own.iter_mut().zip(&local) {
        *value += *added;
    }
    for from in (0..k).step_by(BLOCK) {
        let to = (from + BLOCK).min(k);
        let (done, block) = own[..to].split_at_mut(from);
        subtract_products(&factor.upper[from * k..], k, done, block);
        for column in from..to {
            let upper = &factor.upper[column * k + from..=column * k + column];
            let (before, rest) = block.split_at_mut(column - from);
            let sum = rest[0] - product(&upper[..before.len()], before);
            rest[0] = sum / upper[before.len()].wide();
        }
    }
    subtract_products(&factor.upper[k * k..], k, own, &mut update);
    update
}

/// Lᵀ x = y over a subtree; `around` are the unknowns of the parent's front, own cells first.
fn downward<T: Number>(
    symbolic: &Symbolic,
    factors: &[Factor<T>],
    top: usize,
    x: &mut [T::Wide],
    around: &[T::Wide],
) {
    let front = &symbolic.fronts[top];
    let (k, m) = (front.node.own.len(), front.boundary);
    let factor = &factors[top];
    let below = x.len() - k;
    let (unknowns, own) = x.split_at_mut(below);
    let mut local = vec![T::Wide::default(); k];
    local.extend(front.in_parent.iter().map(|&place| around[place as usize]));
    subtract_products(&factor.lower, m, &local[k..], own);
    for from in (0..k).step_by(BLOCK).rev() {
        let to = (from + BLOCK).min(k);
        let (block, done) = own[from..].split_at_mut(to - from);
        subtract_products(&factor.upper[from * k + to..], k, done, block);
        for column in (from..to).rev() {
            let lower = &factor.upper[column * k + column + 1..column * k + to];
            let (before, after) = block.split_at_mut(column - from + 1);
            before[column - from] -= product(lower, after);
        }
    }
    for (&row, value) in factor.rows.iter().zip(own.iter()) {
        local[row as usize] = *value;
    }
    own.copy_from_slice(&local[..k]);
    if let Some([left, right]) = front.node.children {
        let cut = symbolic.first_unknown(right) - symbolic.first_unknown(top);
        let (a, b) = unknowns.split_at_mut(cut);
        both(
            below > GRAIN,
            || downward(symbolic, factors, left, a, &local),
            || downward(symbolic, factors, right, b, &local),
        );
    }
}

/// y_j ← y_j - Σ a_j x; column j of the matrix starts `stride` after the one before, and is used as far as x is long.
/// Large products are cut in two by columns.
fn subtract_products<T: Number>(matrix: &[T], stride: usize, x: &[T::Wide], y: &mut [T::Wide]) {
    if x.is_empty() {
        return;
    }
    if x.len() * y.len() <= LARGE_PRODUCT || y.len() < 2 * BLOCK {
        products_in_turn(matrix, stride, x, y);
        return;
    }
    let half = (y.len() / 2).next_multiple_of(BLOCK);
    let (before, after) = y.split_at_mut(half);
    rayon::join(
        || subtract_products(matrix, stride, x, before),
        || subtract_products(&matrix[half * stride..], stride, x, after),
    );
}

/// [`subtract_products`] in one task. Four columns at a time, so that x is read less often.
#[multiversion(targets = "simd")]
fn products_in_turn<T: Number>(matrix: &[T], stride: usize, x: &[T::Wide], y: &mut [T::Wide]) {
    const LANES: usize = 8;
    let column = |index: usize| &matrix[index * stride..index * stride + x.len()];
    let whole = x.len() / LANES * LANES;
    let mut index = 0;
    while index + 4 <= y.len() {
        let columns = [0, 1, 2, 3].map(|next| column(index + next));
        let mut sums = [[T::Wide::default(); LANES]; 4];
        for from in (0..whole).step_by(LANES) {
            let x = &x[from..from + LANES];
            for (sums, column) in sums.iter_mut().zip(&columns) {
                let column = &column[from..from + LANES];
                for lane in 0..LANES {
                    sums[lane] += column[lane].wide() * x[lane];
                }
            }
        }
        for ((sums, column), y) in sums.iter().zip(&columns).zip(&mut y[index..]) {
            let mut sum = T::Wide::default();
            for (a, &x) in column[whole..].iter().zip(&x[whole..]) {
                sum += a.wide() * x;
            }
            for &lane in sums {
                sum += lane;
            }
            *y -= sum;
        }
        index += 4;
    }
    for (index, y) in y.iter_mut().enumerate().skip(index) {
        *y -= product(column(index), x);
    }
}

/// Σ a b, in a fixed order.
pub(in super::super) fn product<T: Number>(a: &[T], b: &[T::Wide]) -> T::Wide {
    let mut sums = [T::Wide::default(); 8];
    let (left, right) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = left.remainder().iter().zip(right.remainder());
    let tail: T::Wide = rest.map(|(a, &b)| a.wide() * b).sum();
    for (a, b) in left.zip(right) {
        for lane in 0..8 {
            sums[lane] += a[lane].wide() * b[lane];
        }
    }
    sums.into_iter().sum::<T::Wide>() + tail
}
