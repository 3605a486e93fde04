//! Modulus of the second eigenvalue of a transition matrix: how fast the steady state is reached.
//!
//! Arnoldi's method on powers of P - λ₁ p 1ᵀ (Wielandt's deflation: as 1·p = 1, it replaces λ₁ by zero and keeps
//! the other eigenvalues; without escape it is P on vectors of sum zero). In a chain that goes round among m phases
//! the parts of p at each phase are taken from one to the next, which makes m eigenvalues of modulus λ₁: the same
//! is done with each of these parts, and what is left tells how fast the state of any phase is reached. Powers,
//! because the modes of an oscillator lie close to a circle, and their moduli draw apart.

use nalgebra::{Complex, DMatrix, DVector};

use super::chain::{Chain, SoundMatrix};
use super::hierarchy::Curve;
use super::{StationaryError, SteadyState};
use crate::cancellation::{Cancellation, Cancelled};
use crate::sampling::TransitionMatrix;
use crate::space::CellSpace;

/// Applications of P per Krylov vector in the first sweep; each restart doubles them.
const FIRST_POWER: usize = 8;

/// Krylov vectors and sweeps.
const KRYLOV: usize = 24;
const SWEEPS: usize = 4;

/// Sweeps end when the residual is this part of the distance of the eigenvalue to λ₁, which gives the
/// relaxation time to about this accuracy, or when it is rounding.
const TOLERANCE: f64 = 1e-2;
const ROUNDING: f64 = 1e-12;

/// Length below which what is left of a unit vector is rounding.
const NOTHING: f64 = 1e-15;

/// Ritz vectors that are kept in a restart.
const KEPT: usize = 4;

/// The second eigenvalue λ₂ of a transition matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondEigenvalue {
    /// |λ₂|.
    pub modulus: f64,
    /// Residual of the eigenpair in units of the modulus; the error, where the eigenvalue is well conditioned.
    pub residual: f64,
    /// Products with P that it took.
    pub products: usize,
    /// -Δt / ln(|λ₂|/λ₁), the time in which deviations from the steady state shrink by e; zero when nothing
    /// is left after one step, `None` when they do not shrink (a periodic map).
    pub relaxation_time: Option<f64>,
}

/// The second eigenvalue on the cells that carry a steady state found by [`super::solve`].
///
/// # Errors
/// As for [`super::solve`], from the transition matrix; [`StationaryError::Cancelled`].
pub fn second_eigenvalue(
    matrix: &TransitionMatrix,
    space: &CellSpace,
    steady: &SteadyState,
    cancellation: &Cancellation,
) -> Result<SecondEigenvalue, StationaryError> {
    let checked = SoundMatrix::new(matrix, steady.mass.len())?;
    let mass_of = |row: &usize| steady.mass[checked.cells[*row]];
    let rows: Vec<usize> = (0..checked.len())
        .filter(|row| mass_of(row) > 0.0)
        .collect();
    let mass: Vec<f64> = rows.iter().map(mass_of).collect();
    let chain = checked.restriction(&rows);
    let curve = Curve::new(space, matrix.phase);
    let phases = curve.phases(rows.iter().map(|&row| checked.cells[row]));
    let found = of_chain(&chain, (&mass, &phases), cancellation)?;
    let ratio = found.modulus / (1.0 - chain.escaping(&mass));
    let relaxation_time = (ratio < 1.0).then(|| -matrix.map_step / ratio.ln());
    Ok(SecondEigenvalue {
        relaxation_time,
        ..found
    })
}

/// The second eigenvalue of a chain with steady state `mass`, and the phase of each state where it goes round; the
/// relaxation time is left out.
pub(super) fn of_chain(
    chain: &Chain,
    (mass, phases): (&[f64], &[usize]),
    cancellation: &Cancellation,
) -> Result<SecondEigenvalue, Cancelled> {
    let mut krylov = Krylov {
        chain,
        mass,
        phases,
        of_phases: sums(mass, phases),
        cancellation,
        kept: 1.0 - chain.escaping(mass),
        power: FIRST_POWER,
        products: 0,
    };
    let mut start = krylov.first_vector()?;
    let mut best = SecondEigenvalue {
        modulus: 0.0,
        residual: 0.0,
        products: 0,
        relaxation_time: None,
    };
    for _ in 0..SWEEPS {
        let Some((modulus, residual, next)) = krylov.sweep(start)? else {
            break;
        };
        let power = krylov.power as f64;
        best.modulus = modulus.powf(1.0 / power);
        best.residual = residual / power * best.modulus;
        let distance = (krylov.kept - best.modulus).max(0.0);
        if best.residual <= (TOLERANCE * distance).max(ROUNDING) {
            break;
        }
        krylov.power *= 2;
        start = next;
    }
    best.products = krylov.products;
    Ok(best)
}

/// Modulus of the dominant Ritz value, its residual relative to the modulus, and a vector to start again from.
type Swept = (f64, f64, DVector<f64>);

/// Sums over the states of each phase, over all of them without phases.
fn sums(values: &[f64], phases: &[usize]) -> Vec<f64> {
    let mut sums = vec![0.0; phases.iter().max().map_or(1, |last| last + 1)];
    for (state, value) in values.iter().enumerate() {
        sums[phases.get(state).copied().unwrap_or(0)] += value;
    }
    sums
}

struct Krylov<'a> {
    chain: &'a Chain,
    mass: &'a [f64],
    /// Phase of each state; empty where all have one.
    phases: &'a [usize],
    /// Masses of the phases.
    of_phases: Vec<f64>,
    cancellation: &'a Cancellation,
    /// λ₁.
    kept: f64,
    /// Applications of P per Krylov vector.
    power: usize,
    products: usize,
}

impl Krylov<'_> {
    /// (P - λ₁ p 1ᵀ)^power v, or the same phase by phase.
    fn apply(&mut self, vector: &DVector<f64>) -> Result<DVector<f64>, Cancelled> {
        let mut current = vector.clone();
        let mut next = DVector::zeros(vector.len());
        for _ in 0..self.power {
            self.cancellation.check()?;
            let totals = sums(current.as_slice(), self.phases);
            for (state, (value, mass)) in current.iter_mut().zip(self.mass).enumerate() {
                let phase = self.phases.get(state).copied().unwrap_or(0);
                *value -= totals[phase] / self.of_phases[phase] * mass;
            }
            self.chain.apply(current.as_slice(), next.as_mut_slice());
            std::mem::swap(&mut current, &mut next);
        }
        self.products += self.power;
        Ok(current)
    }

    /// A vector with a part in every mode: the masses with scattered signs, smoothed.
    fn first_vector(&mut self) -> Result<DVector<f64>, Cancelled> {
        let scatter = |state: usize| {
            let hash = (state as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            (hash >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let rough = DVector::from_fn(self.mass.len(), |state, _| {
            self.mass[state] * scatter(state)
        });
        let scale = rough.norm();
        let rough = if scale > 0.0 { rough / scale } else { rough };
        self.apply(&rough)
    }

    /// One Arnoldi factorisation of the power. `None` when the start vanishes: no second eigenvalue.
    fn sweep(&mut self, start: DVector<f64>) -> Result<Option<Swept>, Cancelled> {
        let size = KRYLOV.min(self.mass.len().saturating_sub(1));
        let norm = start.norm();
        if size == 0 || norm.is_nan() || norm <= NOTHING {
            return Ok(None);
        }
        let mut basis = vec![start / norm];
        let mut hessenberg = DMatrix::zeros(size + 1, size);
        let mut used = size;
        for step in 0..size {
            let mut next = self.apply(&basis[step])?;
            let length = next.norm();
            // Twice is enough (Kahan): the second pass removes what rounding left.
            for _ in 0..2 {
                for (row, vector) in basis.iter().enumerate() {
                    let part = vector.dot(&next);
                    hessenberg[(row, step)] += part;
                    next.axpy(-part, vector, 1.0);
                }
            }
            let left = next.norm();
            hessenberg[(step + 1, step)] = left;
            if left <= 1e-14 * length || left == 0.0 {
                hessenberg[(step + 1, step)] = 0.0;
                used = step + 1;
                break;
            }
            basis.push(next / left);
        }
        let coupling = hessenberg[(used, used - 1)];
        let square = hessenberg.view((0, 0), (used, used)).into_owned();
        let Some(ritz) = ritz_pairs(&square) else {
            return Ok(None);
        };
        let Some((value, first)) = ritz.first() else {
            return Ok(None);
        };
        let modulus = value.norm();
        let residual = coupling * first[used - 1].norm() / modulus.max(f64::MIN_POSITIVE);
        let mut next = DVector::zeros(self.mass.len());
        for (_, coefficients) in &ritz {
            for (coefficient, vector) in coefficients.iter().zip(&basis) {
                next.axpy(coefficient.re + coefficient.im, vector, 1.0);
            }
        }
        let residual = if modulus > 0.0 { residual } else { 0.0 };
        Ok(Some((modulus, residual, next)))
    }
}

/// An eigenvalue with its unit eigenvector.
type Pair = (Complex<f64>, DVector<Complex<f64>>);

/// The leading eigenvalues of a small matrix with unit eigenvectors, by falling modulus.
fn ritz_pairs(matrix: &DMatrix<f64>) -> Option<Vec<Pair>> {
    let size = matrix.nrows();
    let schur = nalgebra::Schur::try_new(matrix.clone(), f64::EPSILON, 100 * size)?;
    let mut values: Vec<Complex<f64>> = schur.complex_eigenvalues().iter().copied().collect();
    values.retain(|value| value.re.is_finite() && value.im.is_finite());
    values.sort_by(|a, b| b.norm().total_cmp(&a.norm()).then(b.im.total_cmp(&a.im)));
    let complex = matrix.map(|entry| Complex::new(entry, 0.0));
    let scale = matrix.norm().max(f64::MIN_POSITIVE);
    let pair = |&value: &Complex<f64>| {
        // Inverse iteration a little beside the eigenvalue, so that the matrix can be inverted.
        let shift = value + Complex::new(1e-13 * scale, 0.0);
        let shifted = &complex - DMatrix::from_diagonal_element(size, size, shift);
        let factors = shifted.lu();
        let mut vector = DVector::from_element(size, Complex::new(1.0, 0.0));
        for _ in 0..3 {
            vector = factors.solve(&vector)?;
            let norm = vector.norm();
            vector /= Complex::new(norm, 0.0);
        }
        let sound = vector
            .iter()
            .all(|entry| entry.re.is_finite() && entry.im.is_finite());
        sound.then_some((value, vector))
    };
    values.iter().take(KEPT).map(pair).collect()
}
