//! How a small model passes fluctuations of one observable on to another: functions of the frequency and of the lag.
//!
//! With A the generator between the model's states, c the rows of observables g and b the columns of their deviations
//! p (h - ⟨h⟩), the half-sided spectrum is H(ω) = c (iω - A)⁻¹ b, and the correlation function c e^{Aτ} b. A is brought
//! to triangular form once, so that a frequency costs one back substitution.

use nalgebra::{Complex, DMatrix, DVector};

/// A model between observables.
pub(super) struct Transfer {
    /// A = U T Uᴴ, with T upper triangular.
    unitary: DMatrix<Complex<f64>>,
    triangle: DMatrix<Complex<f64>>,
    /// An observable a row.
    rows: DMatrix<Complex<f64>>,
    /// A deviation a column.
    columns: DMatrix<Complex<f64>>,
}

impl Transfer {
    /// From the generator of a model, the rows of its observables and the columns of their deviations; `None` where
    /// its triangular form is not found.
    pub(super) fn new(
        generator: &DMatrix<f64>,
        rows: &DMatrix<f64>,
        columns: &DMatrix<f64>,
    ) -> Option<Self> {
        let complex = |matrix: &DMatrix<f64>| matrix.map(|value| Complex::new(value, 0.0));
        let schur = complex(generator).try_schur(f64::EPSILON, 10_000)?;
        let (unitary, triangle) = schur.unpack();
        Some(Self {
            rows: complex(rows) * &unitary,
            columns: unitary.adjoint() * complex(columns),
            unitary,
            triangle,
        })
    }

    /// Eigenvalues of A, in no order.
    pub(super) fn poles(&self) -> impl Iterator<Item = Complex<f64>> {
        self.triangle
            .diagonal()
            .into_iter()
            .copied()
            .collect::<Vec<_>>()
            .into_iter()
    }

    /// (iω - A)⁻¹ x.
    fn resolved(&self, frequency: f64, mut x: DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let shift = Complex::new(0.0, frequency);
        for row in (0..x.len()).rev() {
            x[row] /= shift - self.triangle[(row, row)];
            let value = x[row];
            let column = self.triangle.column(row);
            let above = x.iter_mut().zip(column.iter()).take(row);
            above.for_each(|(x, rate)| *x += rate * value);
        }
        x
    }

    /// (iω - A)⁻ᵀ y, the same from the other side.
    fn resolved_transposed(
        &self,
        frequency: f64,
        mut y: DVector<Complex<f64>>,
    ) -> DVector<Complex<f64>> {
        let shift = Complex::new(0.0, frequency);
        for row in 0..y.len() {
            let column = self.triangle.column(row);
            let above = y.iter().zip(column.iter()).take(row);
            let sum: Complex<f64> = above.map(|(known, rate)| known * rate).sum();
            y[row] += sum;
            y[row] /= shift - self.triangle[(row, row)];
        }
        y
    }

    /// Vectors at some places, one a column, times weights of the model's states as [`Transfer::responses`] gives them;
    /// for columns, and for rows.
    pub(super) fn at_places(
        &self,
        columns: &DMatrix<f64>,
        rows: &DMatrix<f64>,
    ) -> [DMatrix<Complex<f64>>; 2] {
        let complex = |matrix: &DMatrix<f64>| matrix.map(Complex::from);
        let conjugate = self.unitary.map(|value| value.conj());
        [complex(columns) * &self.unitary, complex(rows) * conjugate]
    }

    /// Weights of the states of the triangular form in (iω - A)⁻¹ b of a deviation, and in c (iω - A)⁻¹ of an
    /// observable.
    pub(super) fn responses(
        &self,
        frequency: f64,
        (observable, deviation): (usize, usize),
    ) -> [DVector<Complex<f64>>; 2] {
        let column = self.columns.column(deviation).into_owned();
        let row = self.rows.row(observable).transpose();
        [
            self.resolved(frequency, column),
            self.resolved_transposed(frequency, row),
        ]
    }

    /// H(ω) of an observable's row with a deviation's column.
    fn half_sided_alone(
        &self,
        frequency: f64,
        (observable, deviation): (usize, usize),
    ) -> Complex<f64> {
        let x = self.resolved(frequency, self.columns.column(deviation).into_owned());
        (self.rows.row(observable) * x)[(0, 0)]
    }

    /// H(ω) and its first two derivatives by the frequency, of an observable's row with a deviation's column.
    fn half_sided(
        &self,
        frequency: f64,
        (observable, deviation): (usize, usize),
    ) -> [Complex<f64>; 3] {
        let row = self.rows.row(observable);
        let mut x = self.columns.column(deviation).into_owned();
        let factors = [
            Complex::new(1.0, 0.0),
            Complex::new(0.0, -1.0),
            Complex::new(-2.0, 0.0),
        ];
        factors.map(|factor| {
            x = self.resolved(frequency, x.clone());
            (row * &x)[(0, 0)] * factor
        })
    }

    /// The two-sided cross spectrum ∫ C(τ) e^{-iωτ} dτ with C(τ) = E[g(t + τ) h(t)] less the means: real where both
    /// are the same.
    pub(super) fn cross(&self, frequency: f64, (one, other): (usize, usize)) -> Complex<f64> {
        let half = |pair| self.half_sided_alone(frequency, pair);
        if one == other {
            return Complex::new(2.0 * half((one, one)).re, 0.0);
        }
        half((one, other)) + half((other, one)).conj()
    }

    /// The two-sided power spectrum of an observable.
    pub(super) fn power(&self, frequency: f64, observable: usize) -> f64 {
        let pair = (observable, observable);
        2.0 * self.half_sided_alone(frequency, pair).re
    }

    /// The two-sided power spectrum of an observable, and its first two derivatives by the frequency.
    pub(super) fn power_and_slopes(&self, frequency: f64, observable: usize) -> [f64; 3] {
        self.half_sided(frequency, (observable, observable))
            .map(|value| 2.0 * value.re)
    }

    /// E[g h] less the means.
    pub(super) fn covariance(&self, one: usize, other: usize) -> f64 {
        (self.rows.row(one) * self.columns.column(other))[(0, 0)].re
    }

    /// E[g(t + τ) h(t)] less the means, at so many lags `step` apart from zero on, and the size of what was left out:
    /// modes that grow are none of the equation.
    pub(super) fn correlations(
        &self,
        (one, other): (usize, usize),
        step: f64,
        count: usize,
    ) -> (Vec<f64>, f64) {
        let (mut values, mut left_out) = (vec![0.0; count], 0.0);
        for (number, pole) in self.poles().enumerate() {
            let [right, left] = self.vectors(number);
            let row = (self.rows.row(one) * &right)[(0, 0)];
            let residue = row * left.dot(&self.columns.column(other)) / left.dot(&right);
            if pole.re >= 0.0 {
                left_out += residue.norm();
                continue;
            }
            for (lag, value) in values.iter_mut().enumerate() {
                *value += (residue * (pole * (step * lag as f64)).exp()).re;
            }
        }
        (values, left_out)
    }

    /// Right and left eigenvectors of T for one of its diagonal values.
    fn vectors(&self, number: usize) -> [DVector<Complex<f64>>; 2] {
        let size = self.triangle.nrows();
        let pole = self.triangle[(number, number)];
        // Values that coincide are told apart by rounding.
        let least = f64::EPSILON * self.triangle.norm();
        let apart = |other: usize| {
            let distance = pole - self.triangle[(other, other)];
            if distance.norm() > least {
                distance
            } else {
                Complex::new(least, 0.0)
            }
        };
        let mut right = DVector::zeros(size);
        let mut left = DVector::zeros(size);
        right[number] = Complex::new(1.0, 0.0);
        left[number] = Complex::new(1.0, 0.0);
        for row in (0..number).rev() {
            let sum: Complex<f64> = (row + 1..=number)
                .map(|k| self.triangle[(row, k)] * right[k])
                .sum();
            right[row] = sum / apart(row);
        }
        for column in number + 1..size {
            let sum: Complex<f64> = (number..column)
                .map(|k| left[k] * self.triangle[(k, column)])
                .sum();
            left[column] = sum / apart(column);
        }
        [right, left]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x' = y, y' = -x - 0.2 y + 0.4 ξ: moments of first order close, so that the model is exact with two states.
    fn oscillator() -> Transfer {
        let generator = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, -0.2]);
        let rows = DMatrix::identity(2, 2);
        // Stationary covariance: 0.16 / 0.4 of either.
        let columns = DMatrix::from_diagonal_element(2, 2, 0.4);
        Transfer::new(&generator, &rows, &columns).unwrap()
    }

    fn exact(frequency: f64) -> f64 {
        let w = frequency * frequency;
        0.16 / ((1.0 - w).powi(2) + 0.04 * w)
    }

    #[test]
    fn an_oscillator_has_its_spectra() {
        let transfer = oscillator();
        for frequency in [0.0, 0.3, 0.99, 1.0, 2.5] {
            let [power, slope, curvature] = transfer.power_and_slopes(frequency, 0);
            // Differences of second order, whose errors are h² times derivatives of some thousands.
            let beside = |h: f64| [frequency - h, frequency + h].map(exact);
            let [below, above] = beside(1e-5);
            assert!((slope - (above - below) / 2e-5).abs() < 1e-5);
            let [below, above] = beside(1e-4);
            let second = (above - 2.0 * exact(frequency) + below) / 1e-8;
            assert!((curvature - second).abs() < 1e-4 * second.abs().max(10.0));
            // The velocity is the derivative: S_yx = iω S_xx.
            let cross = transfer.cross(frequency, (1, 0));
            let expected = Complex::new(0.0, frequency) * power;
            assert!((cross - expected).norm() < 1e-11, "{cross} {expected}");
        }
    }

    #[test]
    fn a_correlation_function_is_that_of_the_oscillator() {
        let (values, left_out) = oscillator().correlations((0, 0), 0.25, 80);
        assert_eq!(left_out, 0.0);
        let fast = 0.99f64.sqrt();
        for (number, value) in values.into_iter().enumerate() {
            let lag = 0.25 * number as f64;
            let turns = (fast * lag).cos() + 0.1 / fast * (fast * lag).sin();
            assert!((value - 0.4 * (-0.1 * lag).exp() * turns).abs() < 1e-12);
        }
    }

    #[test]
    fn both_sides_give_the_same() {
        let transfer = oscillator();
        let [column, row] = transfer.responses(0.7, (0, 1));
        let [column, row] = [
            &transfer.unitary * column,
            transfer.unitary.map(|value| value.conj()) * row,
        ];
        let shift = Complex::new(0.0, 0.7);
        let size = column.len();
        let generator = &transfer.unitary * &transfer.triangle * transfer.unitary.adjoint();
        let matrix = DMatrix::from_diagonal_element(size, size, shift) - generator;
        let b = &transfer.unitary * transfer.columns.column(1);
        let c = transfer.rows.row(0) * transfer.unitary.adjoint();
        let expected = transfer.half_sided(0.7, (0, 1))[0];
        assert!(((&c * &column)[(0, 0)] - expected).norm() < 1e-13);
        assert!(((row.transpose() * &b)[(0, 0)] - expected).norm() < 1e-13);
        assert!((matrix * column - b).norm() < 1e-13);
    }
}
