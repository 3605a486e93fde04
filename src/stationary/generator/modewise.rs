//! Factors of a generator mode by mode: of the cells of the other axes for every mode, no mode with another.
//!
//! Legendre moments of a bounded state without noise take from lower ones only: its drift, a polynomial of the first
//! degree, leaves the degree of a polynomial as it is (∫ p b f' with f of degree m needs moments up to m). What the
//! state does to the other coordinates, its force, is weak. So in the basis of the moments the generator is nearly
//! lower triangular, block by block, with a generator of the other axes for each mode on the diagonal; that triangle,
//! solved by forward substitution, stands in for the whole. Some tens of iterations of GMRES make good what it leaves
//! out, whatever the number of modes. Factors grow in proportion to that number; those of all modes together grow with
//! its square, and their work with its cube.

mod layout;
#[cfg(test)]
mod tests;

use rayon::prelude::*;
use sprs::CsMat;

use super::dissection::Dissection;
use super::scaled::{Scaled, TRIED, factors, hold, is_held_well, largest};
use super::symbolic::Symbolic;
use super::triangular::{self, transposed::product, transposed::solve_transposed};
use crate::cancellation::{Cancellation, Cancelled};
use layout::blocks;
pub(super) use layout::{Layout, has_phase, others};

/// The factors.
pub(super) struct ModeFactors {
    layout: Layout,
    symbolic: Symbolic,
    modes: Vec<Scaled<f32>>,
    /// Rates from lower modes into higher ones at a place, `place · count²/2 + row (row - 1)/2 + column`.
    below: Vec<f32>,
    /// The stand-in's own steady state.
    null: Vec<f64>,
    /// The cell held. The lowest mode is held at its place.
    pub(super) held: usize,
}

impl ModeFactors {
    /// Of a generator, with the cell `held` held or, where the stand-in's own steady state has little mass there,
    /// another.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub(super) fn new(
        layout: Layout,
        matrix: &CsMat<f64>,
        held: usize,
        cancellation: &Cancellation,
    ) -> Result<Self, Cancelled> {
        cancellation.check()?;
        let blocks = blocks(&layout, matrix);
        let (places, count) = (layout.places(), layout.modes());
        let pattern = CsMat::new_csc(
            (places, places),
            blocks.starts,
            blocks.rows,
            vec![1.0; blocks.rates.len() / count],
        );
        let symbolic = Symbolic::new(&pattern, Dissection::new(layout.grid()));
        let rates = |mode: usize| -> Vec<f64> {
            let of_mode = blocks.rates.iter().skip(mode).step_by(count);
            of_mode.copied().collect()
        };
        // Only the lowest mode has a steady state: the others die out.
        let modes = (0..count).into_par_iter().map(|mode| {
            let held = (mode == 0).then(|| layout.place(held));
            mode_factors(&symbolic, &pattern, rates(mode), held, cancellation)
        });
        let modes: Result<Vec<Scaled<f32>>, Cancelled> = modes.collect();
        let mut this = Self {
            modes: modes?,
            null: Vec::new(),
            layout,
            symbolic,
            below: blocks.below,
            held,
        };
        let lowest = rates(0);
        for tried in 1..=TRIED {
            this.null = this.steady(&pattern, &lowest);
            let best = largest(&this.null);
            if is_held_well(&this.null, this.held, best) || tried == TRIED {
                break;
            }
            this.held = best;
            let place = Some(this.layout.place(best));
            this.modes[0] = mode_factors(
                &this.symbolic,
                &pattern,
                lowest.clone(),
                place,
                cancellation,
            )?;
        }
        Ok(this)
    }

    /// The stand-in's steady state, one in the lowest mode at the held place; `lowest` are the rates of that mode.
    fn steady(&self, pattern: &CsMat<f64>, lowest: &[f64]) -> Vec<f64> {
        let (places, count) = (self.layout.places(), self.layout.modes());
        let held = self.layout.place(self.held);
        let starts = pattern.indptr();
        let starts = starts.raw_storage();
        // What the held place sends is balanced by the rest.
        let mut sent = vec![0.0; places * count];
        for entry in starts[held]..starts[held + 1] {
            sent[pattern.indices()[entry] * count] = -lowest[entry];
        }
        let [null] = self.substitute([sent], 1.0);
        null
    }

    /// The stand-in's M⁻¹ r for each r, zero at the held cell, in one pass through the factors.
    pub(super) fn apply<const R: usize>(&self, residuals: [&[f64]; R]) -> [Vec<f64>; R] {
        let cell = self.held;
        let moments = residuals.map(|residual| {
            // What the held cell lacks, as all balances together are zero.
            let lacking = residual[cell] - residual.iter().sum::<f64>();
            self.layout.moments(residual, (cell, lacking))
        });
        let mut solved = self.substitute(moments, 0.0);
        for vector in &mut solved {
            let share = vector[cell] / self.null[cell];
            for (value, null) in vector.iter_mut().zip(&self.null) {
                *value -= share * null;
            }
            vector[cell] = 0.0;
        }
        solved
    }

    /// M⁻ᵀ r, zero at the held cell: every step of [`ModeFactors::apply`] transposed, in the opposite order.
    pub(super) fn apply_transposed(&self, residual: &[f64]) -> Vec<f64> {
        let cell = self.held;
        let pairs = residual.iter().zip(&self.null).enumerate();
        let others = pairs.filter(|(index, _)| *index != cell);
        let shared: f64 = others.map(|(_, (value, null))| value * null).sum();
        let given = -shared / self.null[cell];
        let moments = self.layout.moments_by_weights(residual, (cell, given));
        let moments = self.substitute_transposed(moments);
        let mut solved = self.layout.values_of(&moments);
        let lacking = solved[cell];
        solved.iter_mut().for_each(|value| *value -= lacking);
        solved
    }

    /// Backward substitution from the highest mode down, with the transposed factors; the lowest mode of the held place
    /// is zero.
    fn substitute_transposed(&self, mut moments: Vec<f64>) -> Vec<f64> {
        let (places, count) = (self.layout.places(), self.layout.modes());
        let triangle = count * (count - 1) / 2;
        let order = &self.symbolic.order;
        for (number, mode) in self.modes.iter().enumerate().rev() {
            let right = |&place: &u32| moments[place as usize * count + number];
            let mut values: Vec<f64> = order.iter().map(right).collect();
            solve_transposed(&self.symbolic, &mode.fronts, &mut values);
            for (&place, value) in order.iter().zip(&values) {
                moments[place as usize * count + number] = value / mode.scale;
            }
            if number == 0 {
                moments[self.layout.place(self.held) * count] = 0.0;
            }
            let row = number * number.saturating_sub(1) / 2;
            for place in 0..places {
                let rates = &self.below[place * triangle + row..][..number];
                let (lower, own) = moments[place * count..][..=number].split_at_mut(number);
                for (moment, rate) in lower.iter_mut().zip(rates) {
                    *moment -= f64::from(*rate) * own[0];
                }
            }
        }
        moments
    }

    /// Forward substitution from the lowest mode up: from moments of the right sides, place by place, to masses of the
    /// cells, with the lowest mode of the held place as given.
    fn substitute<const R: usize>(&self, right: [Vec<f64>; R], held: f64) -> [Vec<f64>; R] {
        let (places, count) = (self.layout.places(), self.layout.modes());
        let triangle = count * (count - 1) / 2;
        let order = &self.symbolic.order;
        let mut moments = right;
        for (number, mode) in self.modes.iter().enumerate() {
            let row = number * number.saturating_sub(1) / 2;
            let mut ordered = moments.each_ref().map(|moments| {
                let left = |&place: &u32| {
                    let place = place as usize;
                    let at_place = &moments[place * count..][..number + 1];
                    let rates = &self.below[place * triangle + row..][..number];
                    at_place[number] - product(rates, &at_place[..number])
                };
                let mut values = vec![0.0; places];
                values
                    .par_iter_mut()
                    .with_min_len(512)
                    .zip(order)
                    .for_each(|(value, place)| *value = left(place));
                values
            });
            if number == 0 {
                let place = self.layout.place(self.held);
                let position = order.iter().position(|&one| one as usize == place);
                for values in &mut ordered {
                    values[position.unwrap_or(0)] = held * mode.scale;
                }
            }
            let vectors = ordered.each_mut().map(Vec::as_mut_slice);
            triangular::solve(&self.symbolic, &mode.fronts, vectors);
            for (moments, values) in moments.iter_mut().zip(&ordered) {
                for (&place, value) in order.iter().zip(values) {
                    moments[place as usize * count + number] = value / mode.scale;
                }
            }
        }
        moments.map(|moments| self.layout.masses(&moments))
    }

    /// Bytes of the factors.
    pub(super) fn bytes(&self) -> u64 {
        let numbers = self.symbolic.factor_entries() * self.modes.len() + self.below.len();
        (numbers * size_of::<f32>()) as u64
    }
}

/// Factorises the rates of a mode between places, with a place held if one is given.
fn mode_factors(
    symbolic: &Symbolic,
    pattern: &CsMat<f64>,
    mut rates: Vec<f64>,
    held: Option<usize>,
    cancellation: &Cancellation,
) -> Result<Scaled<f32>, Cancelled> {
    let position = held.and_then(|held| {
        hold(&mut rates, pattern, held);
        let mut order = symbolic.order.iter();
        order.position(|&place| place as usize == held)
    });
    factors(symbolic, rates, position, cancellation)
}
