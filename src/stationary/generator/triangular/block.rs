//! Substitution for a block of vectors at once, in the precision of the factors.
//!
//! Products of dense blocks read the factors once for all vectors, and a vector takes a fraction of the time of
//! substitution in double precision. What single precision leaves is for the caller to correct.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
    solve_unit_upper_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, Mat, MatMut, MatRef, Par};

use super::{GRAIN, both};
use crate::stationary::generator::fronts::Factor;
use crate::stationary::generator::number::Number;
use crate::stationary::generator::symbolic::Symbolic;

/// Solves M X = B in place, or Mᵀ X = B; a row of the block is an unknown, in the elimination order.
pub(in crate::stationary::generator) fn solve_block<T: Number>(
    symbolic: &Symbolic,
    factors: &[Factor<T>],
    mut block: MatMut<'_, T>,
    is_transposed: bool,
) {
    let substitution = Substitution {
        symbolic,
        factors,
        is_transposed,
    };
    if let Some(root) = symbolic.fronts.len().checked_sub(1) {
        substitution.upward(root, block.as_mut());
        let vectors = block.ncols();
        substitution.downward(root, block, Mat::zeros(0, vectors).as_ref());
    }
}

/// The factors, and which way through them.
struct Substitution<'a, T> {
    symbolic: &'a Symbolic,
    factors: &'a [Factor<T>],
    is_transposed: bool,
}

impl<T: Number> Substitution<'_, T> {
    /// The factors of a front's own cells, U to its boundary and L to it.
    fn parts(&self, top: usize) -> [MatRef<'_, T>; 3] {
        let front = &self.symbolic.fronts[top];
        let (k, m) = (front.node.own.len(), front.boundary);
        let factor = &self.factors[top];
        let upper = MatRef::from_column_major_slice(&factor.upper, k, k + m);
        let (own, outward) = upper.split_at_col(k);
        let lower = MatRef::from_column_major_slice(&factor.lower, m, k);
        [own, outward, lower]
    }

    /// From the leaves up: with L, or with Uᵀ; gives what a subtree adds to its boundary.
    fn upward(&self, top: usize, block: MatMut<'_, T>) -> Mat<T> {
        let front = &self.symbolic.fronts[top];
        let (k, m) = (front.node.own.len(), front.boundary);
        let (below, vectors) = (block.nrows() - k, block.ncols());
        let (unknowns, mut own) = block.split_at_row_mut(below);
        let mut local = Mat::<T>::zeros(k + m, vectors);
        if let Some([left, right]) = front.node.children {
            let cut = self.symbolic.first_unknown(right) - self.symbolic.first_unknown(top);
            let (a, b) = unknowns.split_at_row_mut(cut);
            let updates = both(
                below > GRAIN,
                || self.upward(left, a),
                || self.upward(right, b),
            );
            for (child, update) in [(left, updates.0), (right, updates.1)] {
                let places = &self.symbolic.fronts[child].in_parent;
                for vector in 0..vectors {
                    for (&place, &value) in places.iter().zip(update.col(vector).iter()) {
                        local[(place as usize, vector)] += value;
                    }
                }
            }
        }
        let [inner, outward, lower] = self.parts(top);
        let (mut summed, mut update) = local.split_at_row_mut(k);
        summed += &own;
        if self.is_transposed {
            own.copy_from(&summed);
            solve_lower_triangular_in_place(inner.transpose(), own.as_mut(), Par::Seq);
            subtract_product(update.as_mut(), outward.transpose(), own.as_ref());
        } else {
            let rows = &self.factors[top].rows;
            for vector in 0..vectors {
                for (place, &row) in rows.iter().enumerate() {
                    own[(place, vector)] = summed[(row as usize, vector)];
                }
            }
            solve_unit_lower_triangular_in_place(inner, own.as_mut(), Par::Seq);
            subtract_product(update.as_mut(), lower, own.as_ref());
        }
        update.to_owned()
    }

    /// From the root down: with U, or with Lᵀ; `around` are the unknowns of the parent's front, own cells first.
    fn downward(&self, top: usize, block: MatMut<'_, T>, around: MatRef<'_, T>) {
        let front = &self.symbolic.fronts[top];
        let (k, m) = (front.node.own.len(), front.boundary);
        let (below, vectors) = (block.nrows() - k, block.ncols());
        let (unknowns, mut own) = block.split_at_row_mut(below);
        let mut local = Mat::<T>::zeros(k + m, vectors);
        for vector in 0..vectors {
            for (place, &other) in front.in_parent.iter().enumerate() {
                local[(k + place, vector)] = around[(other as usize, vector)];
            }
        }
        let outside = local.as_ref().subrows(k, m);
        let [inner, outward, lower] = self.parts(top);
        if self.is_transposed {
            subtract_product(own.as_mut(), lower.transpose(), outside);
            solve_unit_upper_triangular_in_place(inner.transpose(), own.as_mut(), Par::Seq);
            let rows = &self.factors[top].rows;
            for vector in 0..vectors {
                for (place, &row) in rows.iter().enumerate() {
                    local[(row as usize, vector)] = own[(place, vector)];
                }
            }
            own.copy_from(local.as_ref().subrows(0, k));
        } else {
            subtract_product(own.as_mut(), outward, outside);
            solve_upper_triangular_in_place(inner, own.as_mut(), Par::Seq);
            local.as_mut().subrows_mut(0, k).copy_from(&own);
        }
        if let Some([left, right]) = front.node.children {
            let cut = self.symbolic.first_unknown(right) - self.symbolic.first_unknown(top);
            let (a, b) = unknowns.split_at_row_mut(cut);
            both(
                below > GRAIN,
                || self.downward(left, a, local.as_ref()),
                || self.downward(right, b, local.as_ref()),
            );
        }
    }
}

/// Y ← Y - A X.
fn subtract_product<T: Number>(y: MatMut<'_, T>, a: MatRef<'_, T>, x: MatRef<'_, T>) {
    let minus = T::from_real(-1.0);
    matmul(y, Accum::Add, a, x, minus, Par::Seq);
}
