//! The resolvent (iω - Q)⁻¹ between observables on one grid: a model that grows until their spectra stand.

use nalgebra::{Complex, DMatrix};

use super::at_frequency::AtFrequency;
use super::grid::{Grid, ending};
use super::model::{Basis, Products, ReducedModel};
use super::motion::Motion;
use super::transfer::Transfer;
use super::{SpectrumError, dot};
use crate::cancellation::Cancellation;
use crate::stationary::generator::{
    AbsorbingSolver, AbsorbingWork, RateError, RateOptions, RateSolver, ShiftedPattern, product,
    transposed_product,
};

/// Vectors of either side for each observable by which a model grows before its spectra are looked at again.
const GROWTH: usize = 6;

/// Most vectors of either side at one real shift, for each observable.
const MOST: usize = 72;

/// Looks at what stands, after each of which vectors are added where it does not, at most.
const LOOKS: usize = 20;

/// What does not stand at frequencies above this share of the rate of the motion has a shift there, on the imaginary
/// axis; slower fluctuations have a real one.
const OSCILLATES: f64 = 0.1;

/// Vectors of either side at a frequency, for each observable: the real and imaginary parts of so many solves make as
/// many as a model grows by.
const SOLVES: usize = GROWTH / 2;

/// Vectors of either side, for each observable, that need no solve: powers of the generator.
const AT_ONCE: usize = 3;

/// A frequency that differs from that of a shift by less than this share of it has no shift of its own, as long as that
/// has no more solves than these; but by less than the other share it has none in any case.
const NEAR: f64 = 0.4;
const MOST_SOLVES: usize = 12;
const SAME: f64 = 0.02;

/// Relative change by more vectors at which a spectrum stands, and the same relative to its largest value.
const TOLERANCE: (f64, f64) = (1e-5, 1e-8);

/// Frequencies at which that is looked at.
const LOOKED_AT: usize = 60;

/// A shift is no smaller than this share of the first one.
const SLOWEST: f64 = 1e-13;

/// What the ends do to functions of the state that grow faster than linearly, over what they do to linear ones.
const STEEP: f64 = 4.0;

/// What observables do on one grid.
pub(super) struct Resolvent {
    /// By the scheme, by the same with half of its dissipation, and by the scheme with fewer vectors.
    pub(super) transfers: [Transfer; 3],
    /// What the ends of the range do to a number, at most: the vectors at the ends with what each place counts there.
    ends: Ends,
    /// Frequencies with shifts of their own, and how many solves each has; none where real shifts were enough.
    pub(super) places: Vec<(f64, usize)>,
    pub(super) work: AbsorbingWork,
}

/// Cells at the ends of the range, with the columns and the rows of the model there.
struct Ends {
    weights: Vec<f64>,
    columns: DMatrix<Complex<f64>>,
    rows: DMatrix<Complex<f64>>,
}

impl Resolvent {
    /// Of observables with these values in the cells; `begun` are the frequencies at which another grid has shifts.
    pub(super) fn new(
        grid: &Grid,
        observables: &[Vec<f64>],
        (frequencies, begun): (&[f64], &[(f64, usize)]),
        motion: &Motion,
        (rates, cancellation): (&RateOptions, &Cancellation),
    ) -> Result<Option<Self>, SpectrumError> {
        let steady = [&grid.full, &grid.half];
        let mut solver = RateSolver::new(grid.space.clone(), *rates).cancelled_by(cancellation);
        let no_escape = vec![0.0; grid.space.n_cells()];
        let mut masses: Vec<Vec<f64>> = Vec::new();
        for matrix in steady {
            let guess = masses.first().map(Vec::as_slice);
            masses.push(solver.solve(matrix, &no_escape, guess)?.mass);
        }
        let deviations = masses.iter().map(|masses| {
            let of = |values: &Vec<f64>| grid.deviation(masses, values);
            observables.iter().map(of).collect::<Vec<_>>()
        });
        let deviations: Vec<Vec<Vec<f64>>> = deviations.collect();
        let pattern = ShiftedPattern::new(&grid.space, &grid.full);
        let mut growing = Growing {
            grid,
            observables,
            deviations: &deviations,
            looked_at: some_of(frequencies),
            columns: Basis::default(),
            rows: Basis::default(),
            products: Products::default(),
            pattern: &pattern,
            places: Vec::new(),
            seen: None,
        };
        growing.begin();
        let mut work = AbsorbingWork::default();
        let options = (rates, cancellation);
        for &(frequency, solves) in begun {
            if !growing.has_room(rates) {
                break;
            }
            growing.at_frequency(frequency, solves, cancellation)?;
        }
        let is_whole = growing.size() + 1 >= grid.space.n_cells();
        let mut next = match begun {
            [] if !is_whole => growing.with_shift(motion.rate, options, &mut work)?,
            _ => growing.looked_at(),
        };
        for _ in 1..LOOKS {
            let Some(place) = next.filter(|&next| next > SLOWEST * motion.rate) else {
                break;
            };
            let oscillates = place > OSCILLATES * motion.rate;
            next = if oscillates && growing.has_room(rates) {
                growing.at_frequency(place, SOLVES, cancellation)?;
                growing.looked_at()
            } else {
                growing.with_shift(place, options, &mut work)?
            };
        }
        for place in &growing.places {
            work.factorisations += 1;
            work.passes += place.passes();
        }
        Ok(growing.finish(motion, work))
    }

    /// At most what the ends of the range do to the half-sided spectrum of a pair at a frequency: a wall at the
    /// distance b from the mean changes the rows and the columns of the resolvent there as it changes those of a slow
    /// mode.
    pub(super) fn of_ends(&self, frequency: f64, pair: (usize, usize)) -> f64 {
        let [column, row] = self.transfers[0].responses(frequency, pair);
        let (columns, rows) = (&self.ends.columns * column, &self.ends.rows * row);
        let places = self
            .ends
            .weights
            .iter()
            .zip(columns.iter().zip(rows.iter()));
        let sizes = places.map(|(weight, (column, row))| weight * (column * row).norm());
        STEEP * sizes.sum::<f64>()
    }
}

/// A few of the frequencies, the first and the last among them.
fn some_of(frequencies: &[f64]) -> Vec<f64> {
    let last = frequencies.len().saturating_sub(1);
    let count = LOOKED_AT.min(frequencies.len());
    let places = (0..count).map(|number| number * last / count.saturating_sub(1).max(1));
    places.map(|place| frequencies[place]).collect()
}

/// A model that is growing.
struct Growing<'a> {
    grid: &'a Grid,
    observables: &'a [Vec<f64>],
    /// By the scheme and with half of its dissipation.
    deviations: &'a [Vec<Vec<f64>>],
    looked_at: Vec<f64>,
    columns: Basis,
    rows: Basis,
    products: Products,
    pattern: &'a ShiftedPattern,
    /// Frequencies with shifts of their own.
    places: Vec<AtFrequency<'a>>,
    /// The vectors of the last look, their model, and that of fewer vectors with which it was compared.
    seen: Option<(usize, [Transfer; 2])>,
}

impl<'a> Growing<'a> {
    /// Begins with what fast fluctuations are made of: the deviations and observables, and their first changes in time.
    fn begin(&mut self) {
        let cells = self.grid.space.n_cells();
        if self.columns.fill(cells) && self.rows.fill(cells) {
            return;
        }
        for (values, deviation) in self.observables.iter().zip(&self.deviations[0]) {
            let (mut column, mut row) = (deviation.clone(), self.centred(values));
            for _ in 0..AT_ONCE {
                self.columns.add(column.clone());
                self.rows.add(row.clone());
                column = self.grid.balanced(product(&self.grid.full, &column));
                row = self.centred(&transposed_product(&self.grid.full, &row));
            }
        }
    }

    /// Less its mean over the cells at each phase: constants do nothing where columns sum to zero.
    fn centred(&self, values: &[f64]) -> Vec<f64> {
        self.grid.balanced(values.to_vec())
    }

    /// Whether the factors at one more frequency are within the limit of memory.
    fn has_room(&self, rates: &RateOptions) -> bool {
        (self.places.len() + 1) as u64 * self.pattern.bytes() <= rates.memory_limit_bytes
    }

    /// Adds vectors at a shift on the imaginary axis: at the known one that is near, if there is one.
    fn at_frequency(
        &mut self,
        frequency: f64,
        solves: usize,
        cancellation: &Cancellation,
    ) -> Result<(), SpectrumError> {
        let frequency = self.grid.beside_the_force(frequency);
        let is_near = |known: &AtFrequency<'_>| {
            let off = (known.frequency / frequency - 1.0).abs();
            off < if known.solves < MOST_SOLVES {
                NEAR
            } else {
                SAME
            }
        };
        let index = match self.places.iter().position(is_near) {
            Some(index) => index,
            None => {
                let on = (self.pattern, self.grid);
                let sides = (&self.deviations[0][..], self.observables);
                let place = AtFrequency::new(on, frequency, sides, cancellation)?;
                self.places.push(place);
                self.places.len() - 1
            }
        };
        for _ in 0..solves {
            for [column, row] in self.places[index].solve() {
                self.columns.add(column);
                self.rows.add(row);
            }
            cancellation.check().map_err(RateError::from)?;
        }
        Ok(())
    }

    /// Takes up the vectors that are new; the shift that would serve what does not stand.
    fn looked_at(&mut self) -> Option<f64> {
        let matrices = [&self.grid.full, &self.grid.half];
        self.products.grow(&self.rows, &self.columns, matrices);
        self.unsettled()
    }

    /// Adds vectors at a shift until the spectra stand; the shift that would serve what does not, where they do not.
    fn with_shift(
        &mut self,
        shift: f64,
        (rates, cancellation): (&RateOptions, &Cancellation),
        work: &mut AbsorbingWork,
    ) -> Result<Option<f64>, SpectrumError> {
        let (matrix, ends) = ending(&self.grid.full, shift);
        let mut solver = AbsorbingSolver::new(&self.grid.space, *rates, cancellation).rough();
        let (stage, _) = solver.stage(&matrix, &ends, &self.deviations[0][0])?;
        let mut chains: Vec<Option<(Vec<f64>, Vec<f64>)>> = Vec::new();
        for (values, deviation) in self.observables.iter().zip(&self.deviations[0]) {
            chains.push(Some((deviation.clone(), self.centred(values))));
        }
        let mut stands = None;
        for step in 1..=MOST {
            for chain in &mut chains {
                let Some((column, row)) = chain.take() else {
                    continue;
                };
                let column = self.grid.balanced(solver.times(&stage, &column)?);
                let row = self.centred(&solver.expected(&stage, &row)?.values());
                if self.columns.add(column) && self.rows.add(row) {
                    let newest = |basis: &Basis| basis.vectors.last().cloned();
                    *chain = newest(&self.columns).zip(newest(&self.rows));
                }
            }
            let has_ended = chains.iter().all(Option::is_none);
            if step % GROWTH == 0 || has_ended {
                stands = self.looked_at();
                if stands.is_none() || has_ended {
                    break;
                }
            }
        }
        work.add(solver.work);
        Ok(stands)
    }

    /// The model with so many vectors of either side, with what passes on what observables do.
    fn model(&self, size: usize) -> Option<(ReducedModel, [DMatrix<f64>; 3])> {
        let model = self.products.model(size)?;
        let size = size
            .min(self.columns.vectors.len())
            .min(self.rows.vectors.len());
        let count = self.observables.len();
        let rows = DMatrix::from_fn(count, size, |one, vector| {
            dot(&self.observables[one], &self.columns.vectors[vector])
        });
        let columns = |deviations: &[Vec<f64>]| {
            DMatrix::from_fn(size, count, |vector, one| {
                dot(&deviations[one], &self.rows.vectors[vector])
            })
        };
        let sides = [
            rows,
            columns(&self.deviations[0]),
            columns(&self.deviations[1]),
        ];
        Some((model, sides))
    }

    /// That of the scheme, with so many vectors.
    fn transfer(&self, size: usize) -> Option<Transfer> {
        let (model, [rows, columns, _]) = self.model(size)?;
        model.transfer(&model.first, &rows, &columns)
    }

    fn size(&self) -> usize {
        self.columns.vectors.len().min(self.rows.vectors.len())
    }

    /// Vectors of a model that is one growth smaller.
    fn smaller(&self) -> usize {
        let growth = GROWTH * self.observables.len();
        self.products.fewer(self.size(), growth)
    }

    /// Where the spectra do not stand yet: the largest frequency or the slowest rate that more vectors change.
    fn unsettled(&mut self) -> Option<f64> {
        let size = self.size();
        let fewer = match self.seen.take() {
            Some((known, [last, _])) if known < size => Some(last),
            _ => self.transfer(self.smaller()),
        };
        let (Some(all), Some(fewer)) = (self.transfer(size), fewer) else {
            return Some(0.0);
        };
        let mut worst: Option<(f64, f64)> = None;
        for observable in 0..self.observables.len() {
            let powers = self.looked_at.iter().map(|&frequency| {
                let [one, other] = [&all, &fewer].map(|one| one.power(frequency, observable));
                (frequency, one.abs(), (one - other).abs())
            });
            let powers: Vec<(f64, f64, f64)> = powers.collect();
            let largest = powers
                .iter()
                .fold(0.0, |most: f64, (_, power, _)| most.max(*power));
            for (frequency, power, change) in powers {
                let allowed = TOLERANCE.0 * power + TOLERANCE.1 * largest;
                let over = change / allowed;
                // NaN is not settled.
                let is_settled = over <= 1.0;
                if !is_settled && worst.is_none_or(|(_, known)| over > known) {
                    worst = Some((frequency, over));
                }
            }
        }
        let slowest = all
            .poles()
            .map(|pole| pole.norm())
            .fold(f64::INFINITY, f64::min);
        self.seen = Some((size, [all, fewer]));
        worst.map(|(frequency, _)| frequency.max(slowest))
    }

    fn finish(self, motion: &Motion, work: AbsorbingWork) -> Option<Resolvent> {
        let (model, [rows, columns, other_columns]) = self.model(self.size())?;
        let full = model.transfer(&model.first, &rows, &columns)?;
        let half = model.transfer(&model.second, &rows, &other_columns)?;
        let (_, [_, fewer]) = self.seen?;
        let (places, weights) = motion.at_ends(&self.grid.space);
        let [columns, rows] = model.at_places(&places, (&self.rows, &self.columns));
        let [columns, rows] = full.at_places(&columns, &rows);
        Some(Resolvent {
            transfers: [full, half, fewer],
            places: (self.places.iter().map(|one| (one.frequency, one.solves))).collect(),
            ends: Ends {
                weights,
                columns,
                rows,
            },
            work,
        })
    }
}
