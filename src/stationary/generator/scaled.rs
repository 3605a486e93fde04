//! Factors of one matrix between places, real or complex, and solves with them.

use faer::Mat;
use sprs::CsMat;

use super::fronts::{Factor, allocate, factorise};
use super::number::{Number, Wide};
use super::symbolic::Symbolic;
use super::triangular::{self, block::solve_block, transposed::solve_transposed};
use crate::cancellation::{Cancellation, Cancelled};

/// Factors of a matrix over `scale`.
pub(super) struct Scaled<T> {
    pub(super) fronts: Vec<Factor<T>>,
    pub(super) scale: f64,
}

/// Share of its largest mass that a stand-in's own steady state must have in the held cell: with less, another cell is
/// held.
const LEAST_HELD: f64 = 0.1;

/// Cells that are tried one after the other.
pub(super) const TRIED: usize = 3;

/// Whether the steady state of a stand-in has mass enough at the held place, beside that with the largest.
pub(super) fn is_held_well(masses: &[f64], held: usize, largest: usize) -> bool {
    masses[held].abs() >= LEAST_HELD * masses[largest].abs()
}

/// The place with the largest mass, whatever its sign.
pub(super) fn largest(masses: &[f64]) -> usize {
    (0..masses.len()).fold(0, |best, place| {
        match masses[place].abs() > masses[best].abs() {
            true => place,
            false => best,
        }
    })
}

/// Takes a place out of rates by columns of a pattern: nothing comes from it, and nothing goes to it.
pub(super) fn hold(rates: &mut [f64], pattern: &CsMat<f64>, place: usize) {
    let starts = pattern.indptr();
    let starts = starts.raw_storage();
    rates[starts[place]..starts[place + 1]].fill(0.0);
    let entries = rates.iter_mut().zip(pattern.indices());
    let row = entries.filter(|(_, row)| **row == place);
    row.for_each(|(rate, _)| *rate = 0.0);
}

/// Factors of rates between places, with the place at a position in the order of elimination held.
pub(super) fn factors<T: Number>(
    symbolic: &Symbolic,
    mut rates: Vec<T::Wide>,
    held: Option<usize>,
    cancellation: &Cancellation,
) -> Result<Scaled<T>, Cancelled> {
    let largest = rates
        .iter()
        .fold(0.0_f64, |most, rate| most.max(rate.size()));
    let scale = match largest > 0.0 && largest.is_finite() {
        true => largest.log2().round().exp2(),
        false => 1.0,
    };
    rates
        .iter_mut()
        .for_each(|rate| *rate = *rate * scale.recip());
    let mut factors = allocate(symbolic);
    let held = held.unwrap_or(usize::MAX);
    factorise(symbolic, &rates, held, &mut factors, cancellation)?;
    // The room for updates is given back: there are as many factors as harmonics.
    let fronts = factors.fronts;
    Ok(Scaled { fronts, scale })
}

impl<T: Number> Scaled<T> {
    /// Solves in place, place by place; the place at `held` in the order of elimination is zero.
    pub(super) fn solve<const R: usize>(
        &self,
        symbolic: &Symbolic,
        held: Option<usize>,
        vectors: &mut [Vec<T::Wide>; R],
    ) {
        let mut ordered = vectors.each_ref().map(|vector| in_order(symbolic, vector));
        if let Some(held) = held {
            let zero = |vector: &mut Vec<T::Wide>| vector[held] = T::Wide::default();
            ordered.iter_mut().for_each(zero);
        }
        let each = ordered.each_mut().map(Vec::as_mut_slice);
        triangular::solve(symbolic, &self.fronts, each);
        for (vector, ordered) in vectors.iter_mut().zip(&ordered) {
            self.put_back(symbolic, ordered, vector);
        }
    }

    /// The same with the transposed factors, and no place held.
    pub(super) fn solve_transposed(&self, symbolic: &Symbolic, vector: &mut [T::Wide]) {
        let mut ordered = in_order(symbolic, vector);
        solve_transposed(symbolic, &self.fronts, &mut ordered);
        self.put_back(symbolic, &ordered, vector);
    }

    /// Solves for each of many vectors, place by place, in the precision of the factors, which have no place held; or
    /// with the transposed factors.
    pub(super) fn solve_block(
        &self,
        symbolic: &Symbolic,
        vectors: &mut [Vec<T::Wide>],
        is_transposed: bool,
    ) {
        let order = &symbolic.order;
        let number =
            |place: usize, vector: usize| T::from_rate(vectors[vector][order[place] as usize]);
        let mut block = Mat::from_fn(order.len(), vectors.len(), number);
        solve_block(symbolic, &self.fronts, block.as_mut(), is_transposed);
        for (vector, solved) in vectors.iter_mut().zip(block.col_iter()) {
            for (&place, value) in order.iter().zip(solved.iter()) {
                vector[place as usize] = value.wide() * self.scale.recip();
            }
        }
    }

    fn put_back(&self, symbolic: &Symbolic, ordered: &[T::Wide], vector: &mut [T::Wide]) {
        for (&place, &value) in symbolic.order.iter().zip(ordered) {
            vector[place as usize] = value * self.scale.recip();
        }
    }
}

/// Numbers of places in the order of elimination.
fn in_order<W: Copy>(symbolic: &Symbolic, vector: &[W]) -> Vec<W> {
    let order = symbolic.order.iter();
    order.map(|&place| vector[place as usize]).collect()
}
