//! A generator as harmonics of the phase see it: its average over a period, and its first harmonic, which takes a
//! harmonic of the density to its neighbours.

use std::f64::consts::{SQRT_2, TAU};
use std::ops::Range;

use faer::c32;
use nalgebra::Complex;
use rayon::prelude::*;
use sprs::CsMat;

use crate::stationary::generator::modewise::Layout;
use crate::stationary::generator::number::Number;
use crate::stationary::generator::scaled::hold;

/// A number of a harmonic at a place: cosine minus i times sine, of orthonormal functions.
pub(super) type Wave = Complex<f64>;

/// The blocks. Rates between places are by columns, as entries of the pattern.
pub(super) struct Blocks {
    /// Pattern between places; its numbers mean nothing.
    pub(super) pattern: CsMat<f64>,
    /// Average over the phase.
    pub(super) mean: Vec<f64>,
    /// First harmonic: the average of rate · e^{-2πis}.
    first: Vec<c32>,
    /// Of each harmonic k = 1, 2, … what the phase's own drift adds to its diagonal, -ikω.
    pub(super) turning: Vec<Wave>,
}

/// Column of a place: rows, averages and first harmonics.
type Column = Vec<(usize, f64, Wave)>;

/// The blocks of a generator.
pub(super) fn blocks(layout: &Layout, matrix: &CsMat<f64>) -> Blocks {
    let places = layout.places();
    let columns: Vec<Column> = (0..places)
        .into_par_iter()
        .with_min_len(16)
        .map(|place| column(layout, matrix, place))
        .collect();
    let (mut starts, mut rows, mut mean, mut first) = (vec![0], Vec::new(), vec![], vec![]);
    for column in columns {
        for (row, average, harmonic) in column {
            rows.push(row);
            mean.push(average);
            first.push(c32::from_rate(harmonic));
        }
        starts.push(rows.len());
    }
    let ones = vec![1.0; rows.len()];
    Blocks {
        pattern: CsMat::new_csc((places, places), starts, rows, ones),
        mean,
        first,
        turning: turning(layout, matrix),
    }
}

/// e^{-2πiks} at the middle of the node's cell.
fn turned(k: usize, node: usize, count: usize) -> Wave {
    let (sine, cosine) = (TAU * k as f64 * (node as f64 + 0.5) / count as f64).sin_cos();
    Wave::new(cosine, -sine)
}

fn column(layout: &Layout, matrix: &CsMat<f64>, place: usize) -> Column {
    let count = layout.modes();
    let starts = matrix.indptr();
    let starts = starts.raw_storage();
    let mut found: Column = Vec::new();
    for (node, &cell) in layout.cells_at(place).iter().enumerate() {
        let cell = cell as usize;
        let wave = turned(1, node, count) / count as f64;
        for entry in starts[cell]..starts[cell + 1] {
            let (row, to) = layout.split(matrix.indices()[entry]);
            // Rates into other nodes are the phase's own drift, which is in `turning`.
            if to != node {
                continue;
            }
            let rate = matrix.data()[entry];
            let slot = found.partition_point(|one| one.0 < row);
            if found.get(slot).is_none_or(|one| one.0 != row) {
                found.insert(slot, (row, 0.0, Wave::default()));
            }
            found[slot].1 += rate / count as f64;
            found[slot].2 += wave * rate;
        }
    }
    found
}

/// What the drift of the phase, the same everywhere, makes of each harmonic.
fn turning(layout: &Layout, matrix: &CsMat<f64>) -> Vec<Wave> {
    let count = layout.modes();
    let cells = layout.cells_at(0);
    let of_wave = |k: usize| {
        let sums = cells.iter().enumerate().map(|(node, &cell)| {
            let column = matrix.outer_view(cell as usize);
            let entries = column.iter().flat_map(|column| {
                let rates = column.indices().iter().zip(column.data());
                rates.collect::<Vec<_>>()
            });
            let into = entries.filter_map(|(&row, rate)| {
                let (place, to) = layout.split(row);
                let is_turned = place == 0 && to != node;
                is_turned.then(|| turned(k, to, count) * turned(k, node, count).conj() * *rate)
            });
            into.sum::<Wave>()
        });
        sums.sum::<Wave>() / count as f64
    };
    (1..=count / 2).map(of_wave).collect()
}

impl Blocks {
    /// Entries of a column.
    pub(super) fn column(&self, place: usize) -> Range<usize> {
        let starts = self.pattern.indptr();
        let starts = starts.raw_storage();
        starts[place]..starts[place + 1]
    }

    /// Rates of a harmonic into itself, by its number from 0 for the first.
    pub(super) fn of_wave(&self, number: usize) -> Vec<Wave> {
        let mut rates: Vec<Wave> = self.mean.iter().map(|&rate| rate.into()).collect();
        for (place, column) in self.pattern.outer_iterator().enumerate() {
            let rows = column.indices().iter();
            let entries = self.column(place).zip(rows);
            for (entry, _) in entries.filter(|(_, row)| **row == place) {
                rates[entry] += self.turning[number];
            }
        }
        rates
    }

    /// Averages with those of a row and a column at zero.
    pub(super) fn with_held(&self, place: usize) -> Vec<f64> {
        let mut rates = self.mean.clone();
        hold(&mut rates, &self.pattern, place);
        rates
    }

    /// Takes what a harmonic sends to the next one off its right side.
    pub(super) fn forward(&self, from: &[Wave], into: &mut [Wave]) {
        self.scatter(into, |place, rate| rate * from[place]);
    }

    /// Takes what a harmonic sends to the one before off its right side.
    pub(super) fn backward(&self, from: &[Wave], into: &mut [Wave]) {
        self.scatter(into, |place, rate| rate.conj() * from[place]);
    }

    /// Takes what the mean sends to the first harmonic off its right side.
    pub(super) fn mean_forward(&self, mean: &[f64], into: &mut [Wave]) {
        self.scatter(into, |place, rate| rate * (SQRT_2 * mean[place]));
    }

    /// The transpose of [`Blocks::forward`].
    pub(super) fn forward_transposed(&self, from: &[Wave], into: &mut [Wave]) {
        self.gather(into, |row, rate| rate.conj() * from[row]);
    }

    /// The transpose of [`Blocks::backward`].
    pub(super) fn backward_transposed(&self, from: &[Wave], into: &mut [Wave]) {
        self.gather(into, |row, rate| rate * from[row]);
    }

    /// The transpose of [`Blocks::mean_forward`].
    pub(super) fn mean_forward_transposed(&self, from: &[Wave], into: &mut [f64]) {
        let mut sums = vec![Wave::default(); into.len()];
        self.gather(&mut sums, |row, rate| rate.conj() * from[row]);
        for (slot, sum) in into.iter_mut().zip(sums) {
            *slot += SQRT_2 * sum.re;
        }
    }

    fn scatter(&self, into: &mut [Wave], sent: impl Fn(usize, Wave) -> Wave) {
        let rows = self.pattern.indices();
        for place in 0..into.len() {
            for entry in self.column(place) {
                into[rows[entry]] -= sent(place, self.first[entry].wide());
            }
        }
    }

    fn gather(&self, into: &mut [Wave], sent: impl Fn(usize, Wave) -> Wave) {
        let rows = self.pattern.indices();
        for (place, slot) in into.iter_mut().enumerate() {
            for entry in self.column(place) {
                *slot -= sent(rows[entry], self.first[entry].wide());
            }
        }
    }

    /// Bytes of what couples harmonics.
    pub(super) fn bytes(&self) -> u64 {
        (self.first.len() * size_of::<c32>()) as u64
    }
}
