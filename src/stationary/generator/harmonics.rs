//! Factors of a generator under periodic forcing, harmonic by harmonic of the phase.
//!
//! With p = Σ_k c_k e^{2πiks}, s the phase in periods, the average of the generator over a period takes no harmonic
//! to another: what is left on the diagonal is Q₀ - ikω for each, Q₀ the averaged generator of the other axes. So
//! there is one complex matrix of the size of the problem without forcing a harmonic, all with the same pattern;
//! negative ones are conjugates. What the forcing adds as its cosine and sine takes a harmonic to its two neighbours,
//! even ones to odd ones and back: the even harmonics are solved first, and what they send is taken off the right
//! sides of the odd ones. What odd ones send back, and what couples harmonics that are further apart, some tens of
//! iterations of GMRES make good, more the larger the motion is against the spread of the density, whatever the
//! number of harmonics.
//!
//! Memory and work grow in proportion to the number of harmonics; with factors of all nodes of the phase together they
//! grow with its square and its cube.

mod blocks;
#[cfg(test)]
mod tests;

use faer::c32;
use rayon::prelude::*;
use sprs::CsMat;

use super::dissection::Dissection;
use super::modewise::Layout;
use super::scaled::{Scaled, TRIED, factors, is_held_well, largest};
use super::symbolic::Symbolic;
use crate::cancellation::{Cancellation, Cancelled};
use blocks::{Blocks, Wave, blocks};

/// The factors.
pub(super) struct HarmonicFactors {
    layout: Layout,
    symbolic: Symbolic,
    blocks: Blocks,
    /// Of the averaged generator, with the held place held, over its scale.
    mean: Scaled<f32>,
    /// Of the averaged generator minus ikω, k = 1, 2, …
    waves: Vec<Scaled<c32>>,
    /// Steady state of the averaged generator, one at the held place.
    null: Vec<f64>,
    /// Position of the held place in the order of elimination.
    position: usize,
    /// The cell held.
    pub(super) held: usize,
}

/// A right side, or what solves it: the mean over a period at each place, and harmonics.
struct Parts {
    mean: Vec<f64>,
    waves: Vec<Vec<Wave>>,
}

impl HarmonicFactors {
    /// Of a generator, with the cell `held` held or, where the averaged generator's steady state has little mass there,
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
        let symbolic = Symbolic::new(&blocks.pattern, Dissection::new(layout.grid()));
        let waves = (0..blocks.turning.len()).into_par_iter().map(|number| {
            let rates = blocks.of_wave(number);
            factors(&symbolic, rates, None, cancellation)
        });
        let waves: Result<Vec<Scaled<c32>>, Cancelled> = waves.collect();
        let (waves, mut held) = (waves?, held);
        for tried in 1..=TRIED {
            let place = layout.split(held).0;
            let position = symbolic.order.iter().position(|&one| one as usize == place);
            let position = position.unwrap_or(0);
            let rates = blocks.with_held(place);
            let mean = factors(&symbolic, rates, Some(position), cancellation)?;
            let null = steady(&symbolic, &blocks, &mean, (place, position));
            let best = largest(&null);
            if is_held_well(&null, place, best) || tried == TRIED {
                return Ok(Self {
                    layout,
                    symbolic,
                    blocks,
                    mean,
                    waves,
                    null,
                    position,
                    held,
                });
            }
            held = layout.cells_at(best)[0] as usize;
        }
        Err(Cancelled)
    }

    /// M⁻¹ r for each r, zero at the held cell.
    pub(super) fn apply<const R: usize>(&self, residuals: [&[f64]; R]) -> [Vec<f64>; R] {
        let cell = self.held;
        let mut parts = residuals.map(|residual| {
            // What the held cell lacks, as all balances together are zero.
            let lacking = residual[cell] - residual.iter().sum::<f64>();
            self.parts(&self.layout.moments(residual, (cell, lacking)))
        });
        self.solve_half(&mut parts, 0);
        for part in &mut parts {
            self.send(part);
        }
        self.solve_half(&mut parts, 1);
        parts.map(|part| {
            let mut solved = self.layout.masses(&self.moments(&part));
            let (place, _) = self.layout.split(cell);
            let share = solved[cell] / self.null[place];
            for (at, &null) in self.null.iter().enumerate() {
                for &one in self.layout.cells_at(at) {
                    solved[one as usize] -= share * null;
                }
            }
            solved[cell] = 0.0;
            solved
        })
    }

    /// M⁻ᵀ r, zero at the held cell: every step of [`HarmonicFactors::apply`] transposed, in the opposite order.
    pub(super) fn apply_transposed(&self, residual: &[f64]) -> Vec<f64> {
        let cell = self.held;
        let (place, _) = self.layout.split(cell);
        let at_place = |(at, null): (usize, &f64)| {
            let cells = self.layout.cells_at(at).iter().map(|&one| one as usize);
            let others = cells.filter(|&one| one != cell);
            null * others.map(|one| residual[one]).sum::<f64>()
        };
        let shared: f64 = self.null.iter().enumerate().map(at_place).sum();
        let given = -shared / self.null[place];
        let mut parts = self.parts(&self.layout.moments_by_weights(residual, (cell, given)));
        self.solve_half_transposed(&mut parts, 1);
        self.send_transposed(&mut parts);
        self.solve_half_transposed(&mut parts, 0);
        let mut solved = self.layout.values_of(&self.moments(&parts));
        let lacking = solved[cell];
        solved.iter_mut().for_each(|value| *value -= lacking);
        solved
    }

    /// Moments as mean and harmonics.
    fn parts(&self, moments: &[f64]) -> Parts {
        let count = self.layout.modes();
        let of_mode = |mode: usize| moments.iter().skip(mode).step_by(count).copied();
        let wave = |number: usize| {
            let pairs = of_mode(2 * number + 1).zip(of_mode(2 * number + 2));
            pairs
                .map(|(cosine, sine)| Wave::new(cosine, -sine))
                .collect()
        };
        Parts {
            mean: of_mode(0).collect(),
            waves: (0..self.waves.len()).map(wave).collect(),
        }
    }

    /// The moments back.
    fn moments(&self, parts: &Parts) -> Vec<f64> {
        let count = self.layout.modes();
        let mut moments = vec![0.0; parts.mean.len() * count];
        for (place, at_place) in moments.chunks_exact_mut(count).enumerate() {
            at_place[0] = parts.mean[place];
            for (pair, wave) in at_place[1..].chunks_exact_mut(2).zip(&parts.waves) {
                (pair[0], pair[1]) = (wave[place].re, -wave[place].im);
            }
        }
        moments
    }

    /// Solves the even harmonics, the mean among them, or the odd ones.
    fn solve_half<const R: usize>(&self, parts: &mut [Parts; R], odd: usize) {
        let mut means = parts.each_mut().map(|part| std::mem::take(&mut part.mean));
        let mut waves: Vec<[Vec<Wave>; R]> = (0..self.waves.len())
            .map(|number| {
                parts
                    .each_mut()
                    .map(|part| std::mem::take(&mut part.waves[number]))
            })
            .collect();
        rayon::join(
            || {
                if odd == 0 {
                    // The held place is as given, which is nothing.
                    self.mean
                        .solve(&self.symbolic, Some(self.position), &mut means);
                }
            },
            || {
                let numbered = waves.par_iter_mut().enumerate();
                let half = numbered.filter(|(number, _)| (number + 1) % 2 == odd);
                half.for_each(|(number, waves)| {
                    self.waves[number].solve(&self.symbolic, None, waves);
                });
            },
        );
        for (part, mean) in parts.iter_mut().zip(means) {
            part.mean = mean;
        }
        for (number, waves) in waves.into_iter().enumerate() {
            for (part, wave) in parts.iter_mut().zip(waves) {
                part.waves[number] = wave;
            }
        }
    }

    /// Solves the even harmonics, the mean among them, or the odd ones, with the transposed factors.
    fn solve_half_transposed(&self, parts: &mut Parts, odd: usize) {
        let Parts { mean, waves } = parts;
        rayon::join(
            || {
                if odd == 0 {
                    self.mean.solve_transposed(&self.symbolic, mean);
                    mean[self.symbolic.order[self.position] as usize] = 0.0;
                }
            },
            || {
                let numbered = waves.par_iter_mut().enumerate();
                let half = numbered.filter(|(number, _)| (number + 1) % 2 == odd);
                half.for_each(|(number, wave)| {
                    // The adjoint: what turns forward turns backward.
                    wave.iter_mut().for_each(|value| *value = value.conj());
                    self.waves[number].solve_transposed(&self.symbolic, wave);
                    wave.iter_mut().for_each(|value| *value = value.conj());
                });
            },
        );
    }

    /// Takes off the right sides of odd harmonics what even ones send.
    fn send(&self, parts: &mut Parts) {
        let Parts { mean, waves } = parts;
        let (odd, even): (Vec<_>, Vec<_>) = waves
            .iter_mut()
            .enumerate()
            .partition(|(number, _)| number % 2 == 0);
        odd.into_par_iter().for_each(|(number, wave)| {
            // Harmonic `number + 1`, whose neighbours are the mean or the wave before, and the wave after.
            match number {
                0 => self.blocks.mean_forward(mean, wave),
                _ => self.blocks.forward(even[number / 2 - 1].1, wave),
            }
            if let Some((_, next)) = even.get(number / 2) {
                self.blocks.backward(next, wave);
            }
        });
    }

    /// The transpose of [`HarmonicFactors::send`].
    fn send_transposed(&self, parts: &mut Parts) {
        let Parts { mean, waves } = parts;
        let (odd, even): (Vec<_>, Vec<_>) = waves
            .iter_mut()
            .enumerate()
            .partition(|(number, _)| number % 2 == 0);
        if let Some((_, first)) = odd.first() {
            self.blocks.mean_forward_transposed(first, mean);
        }
        even.into_par_iter().for_each(|(number, wave)| {
            let after = number.div_ceil(2);
            self.blocks.backward_transposed(odd[after - 1].1, wave);
            if let Some((_, next)) = odd.get(after) {
                self.blocks.forward_transposed(next, wave);
            }
        });
    }

    /// Bytes of the factors.
    pub(super) fn bytes(&self) -> u64 {
        let numbers = self.symbolic.factor_entries() * self.layout.modes();
        (numbers * size_of::<f32>()) as u64 + self.blocks.bytes()
    }
}

/// Steady state of the averaged generator, one at the held place.
fn steady(
    symbolic: &Symbolic,
    blocks: &Blocks,
    mean: &Scaled<f32>,
    (place, position): (usize, usize),
) -> Vec<f64> {
    // What the held place sends is balanced by the rest.
    let mut sent = vec![0.0; symbolic.order.len()];
    for entry in blocks.column(place) {
        sent[blocks.pattern.indices()[entry]] = -blocks.mean[entry];
    }
    let mut found = [sent];
    mean.solve(symbolic, Some(position), &mut found);
    let [mut null] = found;
    null[place] = 1.0;
    null
}
