//! Slow modes of a lightly damped motion, near the harmonics of its frequency.
//!
//! The slowest modes of such a motion lie in rows beside the imaginary axis, at multiples of its frequency, nearer to
//! each other than to any real number: a model that is made at a real shift would need all of a row before it tells the
//! next. Shifts beside the axis itself, at these multiples, have the slowest modes of each row nearest to them. The
//! first ones are at multiples of the rate of the motion, the next ones where the model then sees the slowest mode of
//! each row.

use nalgebra::Complex;
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::SpectrumError;
use super::grid::Grid;
use super::model::{GridModel, Products, REACH, ReducedModel, in_order, standing};
use crate::cancellation::Cancellation;
use crate::numerics::sort_descending;
use crate::stationary::generator::{
    AbsorbingWork, RateError, RateOptions, Shifted, ShiftedPattern,
};

/// Solves from either side at each shift, round by round: a first look at the rows, then until the modes stand.
const ROUNDS: [usize; 3] = [5, 14, 14];

/// Solves at each shift before the model is looked at.
const FIRST_LOOK: usize = 4;

/// Distance of shifts from the imaginary axis, over the rate of the motion.
const BESIDE: f64 = 1e-3;

/// Inverse iterations at the shift beside zero that leave the steady state alone.
const TO_STEADY: usize = 8;

/// The slowest modes of those that oscillate no faster than almost `REACH` times the rate of the motion, up to the
/// first that does not stand; none where the factors of all shifts together exceed the limit of memory.
pub(super) fn near_harmonics(
    grid: &Grid,
    (wanted, rate): (usize, f64),
    numbers: &mut Xoshiro256PlusPlus,
    (rates, cancellation): (&RateOptions, &Cancellation),
    work: &mut AbsorbingWork,
) -> Result<GridModel, SpectrumError> {
    let mut found = GridModel::default();
    let pattern = ShiftedPattern::new(&grid.space, &grid.full);
    let fastest = fastest(rate);
    let mut places = multiples(rate, fastest);
    // Another grid may have the modes of the rows in another order, and a mode more of each beside those wanted.
    let wanted = wanted + places.len();
    // The grids of a value are solved side by side, and all of them together are less than twice the largest.
    if 2 * places.len() as u64 * pattern.bytes() > rates.memory_limit_bytes {
        return Ok(found);
    }
    let mut steady = Vec::new();
    // What the model had before the last vectors were added.
    let mut seen = Vec::new();
    for solves in ROUNDS {
        let beside = |&place: &f64| {
            let shift = Complex::new(BESIDE * rate, place);
            let solver = Shifted::new(&pattern, &grid.full, shift, cancellation)?;
            Ok(KrylovSpaces::new(solver, numbers))
        };
        let shifts: Result<Vec<KrylovSpaces<'_>>, RateError> = places.iter().map(beside).collect();
        let mut shifts = shifts?;
        work.factorisations += shifts.len();
        if steady.is_empty() {
            steady = shifts[0].steady();
        }
        for solve in 1..=solves {
            for at_shift in &mut shifts {
                at_shift.grow(&steady, &mut found)?;
                cancellation.check().map_err(RateError::from)?;
            }
            if solve < FIRST_LOOK {
                continue;
            }
            (found.products).grow(&found.rows, &found.columns, [&grid.full, &grid.half]);
            let size = found.columns.vectors.len();
            let fewer = std::mem::replace(&mut seen, slowest(&found.products, size, fastest));
            found.modes = standing(&seen, &fewer);
            if found.modes.len() >= wanted {
                break;
            }
        }
        work.passes += shifts.iter().map(|one| one.solver.passes).sum::<usize>();
        if found.modes.len() >= wanted {
            break;
        }
        places = slowest_of_rows(&seen, rate, &multiples(rate, fastest));
    }
    in_order(&mut found.modes, |(value, _)| *value);
    Ok(found)
}

/// The frequency up to which modes are told: that of what lies on the imaginary axis as far from a shift at the rate of
/// the motion as modes are looked for.
fn fastest(rate: f64) -> f64 {
    (REACH * REACH - 1.0).sqrt() * rate
}

/// Multiples of the rate of the motion up to a frequency.
fn multiples(rate: f64, fastest: f64) -> Vec<f64> {
    let all = (0..).map(|k| f64::from(k) * rate);
    all.take_while(|&one| one <= fastest).collect()
}

/// Eigenvalues of the model of so many vectors that oscillate no faster than this, in the order of their decay rates.
fn slowest(products: &Products, size: usize, fastest: f64) -> Vec<Complex<f64>> {
    let all = products.model(size).as_ref().map(ReducedModel::eigenvalues);
    let is_asked = |one: &Complex<f64>| one.re < 0.0 && one.im <= fastest;
    let mut all: Vec<Complex<f64>> = all.into_iter().flatten().filter(is_asked).collect();
    sort_descending(&mut all, |one| one.re);
    all
}

/// The frequency of the slowest mode near each multiple of the rate of the motion.
fn slowest_of_rows(all: &[Complex<f64>], rate: f64, multiples: &[f64]) -> Vec<f64> {
    let of_row = |&multiple: &f64| {
        let mut near = all
            .iter()
            .filter(|one| (one.im - multiple).abs() <= 0.5 * rate);
        near.next().map_or(multiple, |one| one.im)
    };
    multiples.iter().map(of_row).collect()
}

/// A shift, and the last vectors of Krylov's spaces of both sides there.
struct KrylovSpaces<'a> {
    solver: Shifted<'a>,
    column: Vec<Complex<f64>>,
    row: Vec<Complex<f64>>,
    /// The columns and rows of this shift, orthonormal.
    known: [Vec<Vec<Complex<f64>>>; 2],
}

impl<'a> KrylovSpaces<'a> {
    /// Which begins with vectors at random.
    fn new(solver: Shifted<'a>, numbers: &mut Xoshiro256PlusPlus) -> Self {
        let cells = solver.cells();
        let mut random = || -> Vec<Complex<f64>> {
            let one = |_| Complex::new(numbers.random_range(-1.0..1.0), 0.0);
            (0..cells).map(one).collect()
        };
        Self {
            column: random(),
            row: random(),
            known: [Vec::new(), Vec::new()],
            solver,
        }
    }

    /// Masses of the steady state, Σ = 1, by inverse iteration: the shift is beside zero.
    fn steady(&mut self) -> Vec<f64> {
        let cells = self.solver.cells();
        let mut masses = vec![Complex::new(1.0 / cells as f64, 0.0); cells];
        for _ in 0..TO_STEADY {
            masses = self.solver.solve(&[masses], false).swap_remove(0);
            let sum: Complex<f64> = masses.iter().sum();
            masses.iter_mut().for_each(|mass| *mass /= sum);
        }
        masses.iter().map(|mass| mass.re).collect()
    }

    /// One more vector of either side, their real and imaginary parts.
    fn grow(&mut self, steady: &[f64], found: &mut GridModel) -> Result<(), SpectrumError> {
        let without_steady = |mut vector: Vec<Complex<f64>>| {
            let sum: Complex<f64> = vector.iter().sum();
            let pairs = vector.iter_mut().zip(steady);
            pairs.for_each(|(value, mass)| *value -= sum * mass);
            vector
        };
        let without_constant = |mut vector: Vec<Complex<f64>>| {
            let pairs = vector.iter().zip(steady);
            let mean: Complex<f64> = pairs.map(|(value, mass)| value * mass).sum();
            vector.iter_mut().for_each(|value| *value -= mean);
            vector
        };
        let [known_columns, known_rows] = &mut self.known;
        let column = without_steady(self.column.clone());
        self.column = apart(
            without_steady(self.solver.solve(&[column], false).swap_remove(0)),
            known_columns,
        );
        let row = without_constant(self.row.clone());
        self.row = apart(
            without_constant(self.solver.solve(&[row], true).swap_remove(0)),
            known_rows,
        );
        for part in [|one: &Complex<f64>| one.re, |one: &Complex<f64>| one.im] {
            let of = |vector: &[Complex<f64>]| vector.iter().map(part).collect::<Vec<f64>>();
            // A direction that adds nothing to one side is left out of both.
            if found.columns.add(of(&self.column)) && !found.rows.add(of(&self.row)) {
                found.columns.vectors.pop();
            }
        }
        Ok(())
    }
}

/// Without the vectors that are known, and of length one; it is known then.
fn apart(mut vector: Vec<Complex<f64>>, known: &mut Vec<Vec<Complex<f64>>>) -> Vec<Complex<f64>> {
    for other in known.iter() {
        let pairs = other.iter().zip(&vector);
        let overlap: Complex<f64> = pairs.map(|(one, other)| one.conj() * other).sum();
        let pairs = vector.iter_mut().zip(other);
        pairs.for_each(|(value, one)| *value -= overlap * one);
    }
    let length = vector.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|value| *value /= length);
    known.push(vector.clone());
    vector
}
