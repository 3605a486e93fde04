//! The probability that a process still goes on, for all times, from a small model of the generator.
//!
//! S(t) = 1ᵀ e^{Qt} p₀. Its Laplace transform 1ᵀ (s - Q)⁻¹ p₀ is matched by a model of a few dozen states at real s
//! spread over the times that are asked for, and at s = 0 with the first moments: the space of the columns
//! (s - Q)⁻ʲ p₀ is tested with that of the rows 1ᵀ (s - Q)⁻ʲ, so that at each s twice as many derivatives agree as
//! either has vectors (rational Krylov spaces from both sides; A. Ruhe 1984, E. J. Grimme 1997).

use nalgebra::{DMatrix, DVector, Schur};
use sprs::CsMat;

use super::{PassageError, dot};
use crate::cancellation::Cancellation;
use crate::generator::AbsorbingGenerator;
use crate::numerics::bisected;
use crate::space::CellSpace;
use crate::stationary::generator::{AbsorbingSolver, AbsorbingWork, RateOptions, product};

/// Vectors from either side at each s.
const VECTORS: usize = 3;

/// Ratio of neighbouring s.
const RATIO: f64 = 4.0;

/// Most values of s.
const SHIFTS: usize = 9;

/// Vectors shorter than this beside the others, relative to their length, add nothing.
const NOTHING: f64 = 1e-9;

/// Largest growth rate of a model, over its fastest decay, that is rounding.
const GROWTH: f64 = 1e-9;

/// Most sweeps in which the eigenvalues of a model are looked for.
const MOST_SWEEPS: usize = 10_000;

/// Real numbers at which the transform is matched, for times from one to another.
fn shifts((first, last): (f64, f64)) -> Vec<f64> {
    let (low, high) = (0.5 / last, 10.0 / first);
    let steps = ((high / low).ln() / RATIO.ln())
        .ceil()
        .clamp(1.0, SHIFTS as f64 - 1.0);
    let all = 0..=steps as usize;
    all.map(|step| low * (high / low).powf(step as f64 / steps))
        .collect()
}

/// Small models of two generators on the same cells, for times from one to another. The start is given in two ways, of
/// which the second tells how well the first is known.
pub(super) fn models(
    space: &CellSpace,
    generators: [&AbsorbingGenerator; 2],
    starts: [&[f64]; 2],
    times: (f64, f64),
    (rates, cancellation): (&RateOptions, &Cancellation),
) -> Result<([Survival; 2], AbsorbingWork), PassageError> {
    let [first, _] = generators;
    let (mut columns, mut rows) = (Vec::new(), Vec::new());
    let matrices = generators.map(AbsorbingGenerator::matrix);
    let mut work = AbsorbingWork::default();
    for shift in [0.0].into_iter().chain(shifts(times)) {
        let ends: Vec<f64> = first.ends.iter().map(|rate| rate + shift).collect();
        let mut matrix = matrices[0].clone();
        for cell in 0..ends.len() {
            if let Some(rate) = matrix.get_mut(cell, cell) {
                *rate -= shift;
            }
        }
        let mut solver = AbsorbingSolver::new(space, *rates, cancellation).rough();
        let (stage, mut column) = solver.stage(&matrix, &ends, starts[0])?;
        let mut row = solver.expected(&stage, &first.weights[0])?.values();
        for vector in 0..VECTORS {
            normalise(&mut column);
            normalise(&mut row);
            columns.push(column.clone());
            rows.push(row.clone());
            if vector + 1 < VECTORS {
                column = solver.times(&stage, &column)?;
                row = solver.expected(&stage, &row)?.values();
            }
        }
        work.add(solver.work);
    }
    // The other scheme is projected on the same vectors: what it changes is right to first order.
    let model = |number: usize| {
        let generator = (&matrices[number], generators[number].weights[0].as_slice());
        Survival::new(generator, starts, columns.clone(), rows.clone())
    };
    Ok(([0, 1].map(model), work))
}

fn normalise(vector: &mut [f64]) {
    let length = dot(vector, vector).sqrt();
    if length > 0.0 {
        vector.iter_mut().for_each(|value| *value /= length);
    }
}

/// A model, and one with fewer vectors, by which the first is judged.
pub(super) struct Survival {
    whole: ReducedModel,
    fewer: ReducedModel,
}

impl Survival {
    fn new(
        generator: (&CsMat<f64>, &[f64]),
        starts: [&[f64]; 2],
        columns: Vec<Vec<f64>>,
        rows: Vec<Vec<f64>>,
    ) -> Self {
        // All but the last vector of each s: neither the shortest nor the longest times are left out.
        let thinned = |all: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let kept = all
                .iter()
                .enumerate()
                .filter(|(index, _)| index % VECTORS + 1 < VECTORS);
            kept.map(|(_, vector)| vector.clone()).collect()
        };
        let less = [thinned(&columns), thinned(&rows)];
        let [few_columns, few_rows] = less;
        Self {
            whole: ReducedModel::new(generator, starts, columns, rows),
            fewer: ReducedModel::new(generator, starts, few_columns, few_rows),
        }
    }

    /// S at a time, with what fewer vectors and the other start change.
    pub(super) fn at(&self, time: f64) -> (f64, f64) {
        let [value, other] = self.whole.at(time);
        let [by_fewer, _] = self.fewer.at(time);
        (value, (value - by_fewer).abs() + (value - other).abs())
    }

    /// The time at which S has fallen to a share, with what fewer vectors and the other start change.
    pub(super) fn time(&self, share: f64, mean: f64) -> (f64, f64) {
        let [value, other] = [0, 1].map(|start| self.whole.time(start, share, mean));
        let by_fewer = self.fewer.time(0, share, mean);
        (value, (value - by_fewer).abs() + (value - other).abs())
    }
}

/// S(t) = weights · e^{rates t} start.
struct ReducedModel {
    rates: DMatrix<f64>,
    starts: [DVector<f64>; 2],
    weights: DVector<f64>,
}

impl ReducedModel {
    /// The model of these vectors, or of fewer where it would grow.
    fn new(
        generator: (&CsMat<f64>, &[f64]),
        starts: [&[f64]; 2],
        columns: Vec<Vec<f64>>,
        rows: Vec<Vec<f64>>,
    ) -> Self {
        let (mut columns, mut rows) = (orthonormal(columns), orthonormal(rows));
        loop {
            let size = columns.len().min(rows.len());
            columns.truncate(size);
            rows.truncate(size);
            if size > 0
                && let Some(model) = Self::of(generator, starts, &columns, &rows)
                && (model.is_stable() || size <= 2)
            {
                return model;
            }
            if size <= 1 {
                return Self {
                    rates: DMatrix::zeros(1, 1),
                    starts: [
                        DVector::from_element(1, f64::NAN),
                        DVector::from_element(1, f64::NAN),
                    ],
                    weights: DVector::from_element(1, 1.0),
                };
            }
            columns.pop();
            rows.pop();
        }
    }

    fn of(
        (matrix, weights): (&CsMat<f64>, &[f64]),
        starts: [&[f64]; 2],
        columns: &[Vec<f64>],
        rows: &[Vec<f64>],
    ) -> Option<Self> {
        let size = columns.len();
        let images: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| product(matrix, column))
            .collect();
        let overlaps =
            DMatrix::from_fn(size, size, |row, column| dot(&rows[row], &columns[column]));
        let rates = DMatrix::from_fn(size, size, |row, column| dot(&rows[row], &images[column]));
        let tested = starts.map(|start| DVector::from_fn(size, |row, _| dot(&rows[row], start)));
        let inverse = overlaps.full_piv_lu();
        // Eigenvalues of a matrix that is not finite are looked for without end.
        let rates = inverse.solve(&rates)?;
        rates.iter().all(|rate| rate.is_finite()).then_some(())?;
        Some(Self {
            rates,
            starts: [inverse.solve(&tested[0])?, inverse.solve(&tested[1])?],
            weights: DVector::from_fn(size, |column, _| dot(&columns[column], weights)),
        })
    }

    /// Whether nothing grows.
    fn is_stable(&self) -> bool {
        let Some(schur) = Schur::try_new(self.rates.clone(), f64::EPSILON, MOST_SWEEPS) else {
            return false;
        };
        let eigenvalues = schur.complex_eigenvalues();
        let fastest = eigenvalues
            .iter()
            .fold(0.0f64, |most, one| most.max(one.norm()));
        eigenvalues.iter().all(|one| one.re <= GROWTH * fastest)
    }

    /// S at a time, from either start.
    fn at(&self, time: f64) -> [f64; 2] {
        let grown = (self.rates.clone() * time).exp();
        [0, 1].map(|start| self.weights.dot(&(&grown * &self.starts[start])))
    }

    /// The time at which S has fallen to a share.
    fn time(&self, start: usize, share: f64, mean: f64) -> f64 {
        let mut high = mean;
        for _ in 0..60 {
            if self.at(high)[start] <= share {
                break;
            }
            high *= 2.0;
        }
        bisected((0.0, high), 60, |middle| self.at(middle)[start] > share)
    }
}

/// An orthonormal basis of the span of some vectors, in their order.
fn orthonormal(vectors: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut vector in vectors {
        for _ in 0..2 {
            for known in &basis {
                let overlap = dot(known, &vector);
                vector
                    .iter_mut()
                    .zip(known)
                    .for_each(|(x, y)| *x -= overlap * y);
            }
        }
        let length = dot(&vector, &vector).sqrt();
        if length > NOTHING {
            vector.iter_mut().for_each(|value| *value /= length);
            basis.push(vector);
        }
    }
    basis
}
