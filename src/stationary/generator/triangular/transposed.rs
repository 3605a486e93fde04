//! Substitution with the transposed factors: those of U from the leaves up, those of L from the root down.
//!
//! Columns of the factors are rows of what is solved here, so that all sums are products of contiguous numbers.

use super::{GRAIN, both};
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
    for column in 0..k {
        let upper = &factor.upper[column * k..=column * k + column];
        let sum = own[column] + local[column] - product(&upper[..column], &own[..column]);
        own[column] = sum / upper[column].wide();
    }
    let mut update = local.split_off(k);
    for (value, column) in update
        .iter_mut()
        .zip(factor.upper[k * k..].chunks_exact(k.max(1)))
    {
        *value -= product(column, own);
    }
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
    for column in (0..k).rev() {
        let lower = &factor.upper[column * k + column + 1..(column + 1) * k];
        let outward = &factor.lower[column * m..(column + 1) * m];
        own[column] -= product(lower, &own[column + 1..]) + product(outward, &local[k..]);
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
