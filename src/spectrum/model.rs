//! A small model of a generator: its action between a space of columns and a space of rows.

use nalgebra::{Complex, DMatrix, DVector};
use sprs::CsMat;

use super::transfer::Transfer;
use crate::numerics::{dot, sort_ascending, sort_descending};
use crate::stationary::generator::product;

/// Overlaps of the two spaces smaller than this beside the largest are rounding.
const NOTHING: f64 = 1e-11;

/// A new vector this small, relative to what it was before the others were taken out of it, adds nothing.
const SPANNED: f64 = 1e-12;

/// Cells of a grid so small that a model of all of its vectors costs nothing.
const SMALL: usize = 64;

/// Modes are looked for that oscillate no faster than this many times the rate of the motion.
pub(super) const REACH: f64 = 3.0;

/// Relative change by more vectors at which an eigenvalue stands.
const TOLERANCE: f64 = 1e-7;

/// Decay rates that differ by less, relatively, are in the order of their frequencies.
const SAME: f64 = 1e-2;

/// Distance of the shift of inverse iteration from an eigenvalue that is known, as a share.
const BESIDE: f64 = 1e-9;

/// Steps of inverse iteration.
const INVERSE_STEPS: usize = 3;

/// Orthonormal vectors.
#[derive(Default)]
pub(super) struct Basis {
    pub(super) vectors: Vec<Vec<f64>>,
}

impl Basis {
    /// Adds what spans all vectors with Σ = 0, where these are few; whether they are.
    pub(super) fn fill(&mut self, cells: usize) -> bool {
        let is_small = cells <= SMALL;
        for one in (0..cells).filter(|_| is_small) {
            let mut unit = vec![0.0; cells];
            unit[one] = 1.0;
            self.add(balanced(unit));
        }
        is_small
    }

    /// Adds a direction; whether it was a new one.
    pub(super) fn add(&mut self, mut vector: Vec<f64>) -> bool {
        let size = dot(&vector, &vector).sqrt();
        for _ in 0..2 {
            for known in &self.vectors {
                let overlap = dot(known, &vector);
                let pairs = vector.iter_mut().zip(known);
                pairs.for_each(|(x, y)| *x -= overlap * y);
            }
        }
        let left = dot(&vector, &vector).sqrt();
        if !(left > SPANNED * size && left.is_finite()) {
            return false;
        }
        vector.iter_mut().for_each(|value| *value /= left);
        self.vectors.push(vector);
        true
    }

    /// The vectors with these weights.
    pub(super) fn combined(&self, weights: &DVector<Complex<f64>>) -> Vec<Complex<f64>> {
        let length = self.vectors.first().map_or(0, Vec::len);
        let mut sum = vec![Complex::new(0.0, 0.0); length];
        for (weight, vector) in weights.iter().zip(&self.vectors) {
            let pairs = sum.iter_mut().zip(vector);
            pairs.for_each(|(total, value)| *total += weight * *value);
        }
        sum
    }
}

/// With Σ = 0: the steady state is left out.
pub(super) fn balanced(mut vector: Vec<f64>) -> Vec<f64> {
    let mean = vector.iter().sum::<f64>() / vector.len() as f64;
    vector.iter_mut().for_each(|value| *value -= mean);
    vector
}

/// What one generator, and another beside it, do between the first vectors of two spaces.
pub(super) struct ReducedModel {
    /// From weights of the model to those of rows and columns.
    rows: DMatrix<f64>,
    columns: DMatrix<f64>,
    /// The two generators on the model's states.
    pub(super) first: DMatrix<f64>,
    pub(super) second: DMatrix<f64>,
}

/// Products with the vectors of two spaces, which grow with them.
#[derive(Default)]
pub(super) struct Products {
    overlaps: Vec<Vec<f64>>,
    first: Vec<Vec<f64>>,
    second: Vec<Vec<f64>>,
    images: [Vec<Vec<f64>>; 2],
}

impl Products {
    /// Takes up the vectors that are new.
    pub(super) fn grow(&mut self, rows: &Basis, columns: &Basis, matrices: [&CsMat<f64>; 2]) {
        let before = self.images[0].len();
        for column in columns.vectors.iter().skip(before) {
            for (images, matrix) in self.images.iter_mut().zip(matrices) {
                images.push(product(matrix, column));
            }
        }
        let grow = |table: &mut Vec<Vec<f64>>, vectors: &[Vec<f64>]| {
            for (row, tested) in rows.vectors.iter().enumerate() {
                if table.len() == row {
                    table.push(Vec::new());
                }
                let known = table[row].len();
                table[row].extend(vectors.iter().skip(known).map(|vector| dot(tested, vector)));
            }
        };
        grow(&mut self.overlaps, &columns.vectors);
        grow(&mut self.first, &self.images[0]);
        grow(&mut self.second, &self.images[1]);
    }

    /// So many vectors less of either space, but for those that span all there is: they leave nothing out.
    pub(super) fn fewer(&self, size: usize, less: usize) -> usize {
        let cells = self.images[0].first().map_or(0, Vec::len);
        if size + 1 >= cells {
            return size;
        }
        size.saturating_sub(less).max(1)
    }

    /// The model of so many vectors of either space; `None` where the two have nothing in common.
    pub(super) fn model(&self, size: usize) -> Option<ReducedModel> {
        let size = size.min(self.overlaps.len()).min(self.images[0].len());
        // Where no vector was found there is none of which values could be looked for.
        (size > 0).then_some(())?;
        let table =
            |rows: &[Vec<f64>]| DMatrix::from_fn(size, size, |row, column| rows[row][column]);
        let overlaps = table(&self.overlaps);
        overlaps
            .iter()
            .all(|value| value.is_finite())
            .then_some(())?;
        let parts = overlaps.try_svd(true, true, f64::EPSILON, 0)?;
        let (left, right) = (parts.u?, parts.v_t?);
        let largest = parts.singular_values.max();
        let kept: Vec<usize> = (0..size)
            .filter(|&one| parts.singular_values[one] > NOTHING * largest)
            .collect();
        let root = |one: usize| parts.singular_values[kept[one]].sqrt();
        let rows = DMatrix::from_fn(kept.len(), size, |one, row| {
            left[(row, kept[one])] / root(one)
        });
        let columns = DMatrix::from_fn(size, kept.len(), |column, one| {
            right[(kept[one], column)] / root(one)
        });
        let of = |rates: &[Vec<f64>]| &rows * table(rates) * &columns;
        let (first, second) = (of(&self.first), of(&self.second));
        let is_finite = first.iter().chain(&second).all(|rate| rate.is_finite());
        (is_finite && !kept.is_empty()).then_some(ReducedModel {
            rows,
            columns,
            first,
            second,
        })
    }
}

/// Spaces of either side, what a generator and another one do between them, and the modes that are told by it, each
/// with what fewer vectors change.
#[derive(Default)]
pub(super) struct GridModel {
    pub(super) columns: Basis,
    pub(super) rows: Basis,
    pub(super) products: Products,
    pub(super) modes: Vec<(Complex<f64>, f64)>,
    /// How many of them stand, the first ones; of the rest it is known that they are there.
    pub(super) standing: usize,
    /// Whether rounding hides the rate of the slowest mode.
    pub(super) hides: bool,
}

/// Eigenvalues up to the first that fewer vectors do not give as well, each with what they change.
pub(super) fn standing(all: &[Complex<f64>], fewer: &[Complex<f64>]) -> Vec<(Complex<f64>, f64)> {
    let change = |value: &Complex<f64>| {
        let distances = fewer.iter().map(|other| (value - other).norm());
        (*value, distances.fold(f64::INFINITY, f64::min))
    };
    all.iter().map(change).take_while(stands).collect()
}

/// Whether fewer vectors give an eigenvalue as well.
pub(super) fn stands((value, change): &(Complex<f64>, f64)) -> bool {
    *change <= TOLERANCE * value.norm()
}

/// Puts modes in the order of their decay rates, of those with the same one in the order of their frequencies.
pub(super) fn in_order<T>(modes: &mut [T], value: impl Fn(&T) -> Complex<f64>) {
    sort_descending(modes, |one| value(one).re);
    let mut first = 0;
    for end in 1..=modes.len() {
        let is_same =
            end < modes.len() && value(&modes[end]).re >= (1.0 + SAME) * value(&modes[first]).re;
        if !is_same {
            sort_ascending(&mut modes[first..end], |one| value(one).im);
            first = end;
        }
    }
}

/// What belongs to an eigenvalue of a model.
pub(super) struct Eigen {
    /// By how much the second generator changes it, to first order.
    pub(super) change: Complex<f64>,
    /// Weights of the columns and of the rows; lᵀ r = 1.
    pub(super) columns: DVector<Complex<f64>>,
    pub(super) rows: DVector<Complex<f64>>,
}

impl ReducedModel {
    /// How one of the two generators passes on what observables do: `rows` is what they give of each column, an
    /// observable a row, and `columns` what each row gives of their deviations, a deviation a column.
    pub(super) fn transfer(
        &self,
        generator: &DMatrix<f64>,
        rows: &DMatrix<f64>,
        columns: &DMatrix<f64>,
    ) -> Option<Transfer> {
        Transfer::new(generator, &(rows * &self.columns), &(&self.rows * columns))
    }

    /// Vectors of either side with these weights of the model's states, at some places: the vectors of the columns
    /// with weights of states, and those of the rows.
    pub(super) fn at_places(
        &self,
        places: &[usize],
        (rows, columns): (&Basis, &Basis),
    ) -> [DMatrix<f64>; 2] {
        let of = |basis: &Basis, size: usize| {
            DMatrix::from_fn(places.len(), size, |place, vector| {
                basis.vectors[vector][places[place]]
            })
        };
        let size = self.columns.nrows();
        [
            of(columns, size) * &self.columns,
            of(rows, size) * self.rows.transpose(),
        ]
    }

    /// All eigenvalues, of a pair the one with the positive imaginary part.
    pub(super) fn eigenvalues(&self) -> Vec<Complex<f64>> {
        let Some(schur) = self.first.clone().try_schur(f64::EPSILON, 10_000) else {
            return Vec::new();
        };
        let all = schur.complex_eigenvalues();
        all.iter().copied().filter(|one| one.im >= 0.0).collect()
    }

    /// What belongs to an eigenvalue of the model.
    pub(super) fn eigen(&self, value: Complex<f64>) -> Option<Eigen> {
        let size = self.first.nrows();
        let shift = value * (1.0 + BESIDE) + Complex::new(f64::MIN_POSITIVE, 0.0);
        let shifted = self.first.map(|rate| Complex::new(rate, 0.0))
            - DMatrix::from_diagonal_element(size, size, shift);
        let iterate = |matrix: DMatrix<Complex<f64>>| {
            let factors = matrix.full_piv_lu();
            let mut vector = DVector::from_fn(size, |one, _| Complex::new(1.0, 0.1 * one as f64));
            for _ in 0..INVERSE_STEPS {
                vector = factors.solve(&vector)?;
                let length = vector.norm();
                vector /= Complex::new(length, 0.0);
            }
            vector
                .iter()
                .all(|one| one.re.is_finite() && one.im.is_finite())
                .then_some(vector)
        };
        let right = iterate(shifted.clone())?;
        let mut left = iterate(shifted.transpose())?;
        let scale = left.dot(&right);
        left /= scale;
        let change = (&self.second - &self.first).map(|rate| Complex::new(rate, 0.0));
        Some(Eigen {
            change: left.dot(&(change * &right)),
            columns: self.columns.map(|one| Complex::new(one, 0.0)) * right,
            rows: self.rows.transpose().map(|one| Complex::new(one, 0.0)) * left,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Products;

    #[test]
    fn of_no_vectors_there_is_no_model() {
        assert!(Products::default().model(8).is_none());
    }
}
