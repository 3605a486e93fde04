//! How fast and how far states move in a steady state, and what the ends of the range do to an eigenvalue.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::Steady;
use super::grid::Grid;
use crate::space::CellSpace;
use crate::system::System;

/// What the ends do is an estimate: it is taken so many times.
const SAFETY: f64 = 2.0;

/// Densities below this share of the largest are rounding.
const NOTHING: f64 = 1e-16;

/// Masses below this are rounding.
const NO_MASS: f64 = 1e-12;

/// A product whose logarithm falls by less than this share of that of the density does not fall because states are
/// held: left vectors grow like p^(-1/2) in a spectrum that is continuous without the ends of the range.
const GROWING: f64 = 0.25;

/// Such eigenvalues change with the distance b of the ends like 1/b², which is as if the product fell over this share
/// of b.
const CONTINUOUS: f64 = 0.375;

/// What the ends of the range do to an eigenvalue of a size, at most; `product` is |l r| at a cell, of vectors whose
/// product sums to one. With w(b) the product's density at a wall at the distance b from the mean, the wall changes the
/// eigenvalue λ by λ w(b) for each unit of length by which it is moved (J. Hadamard, 1908), so that a wall in place of
/// none does it by λ w(b) ℓ, where w falls over the length ℓ. Of a density like a Gaussian one it falls like exp(-x²)
/// from its largest value on, so that ℓ = b/(2 ln(w_max/w(b))); of dry friction's, whose modes are spread evenly, it
/// does not.
pub(super) fn of_ends(
    grid: &Grid,
    size: f64,
    product: impl Fn(usize) -> f64,
    motion: &Motion,
) -> f64 {
    let mut share = 0.0;
    for (index, (axis, reaches)) in grid.space.axes().iter().zip(&motion.reaches).enumerate() {
        if *reaches == [0.0; 2] {
            continue;
        }
        let mut densities = vec![0.0; axis.count()];
        for cell in 0..grid.space.n_cells() {
            densities[grid.space.position(cell, index)] += product(cell);
        }
        for (position, density) in densities.iter_mut().enumerate() {
            *density /= axis.width(position);
        }
        let ends = [0, 1].map(|end| (fall(&densities, end), motion.falls[index][end]));
        for (((density, falls), of_density), reach) in ends.into_iter().zip(reaches) {
            let length = match falls > GROWING * of_density {
                true => reach * (0.5 / falls).min(CONTINUOUS),
                false => reach * CONTINUOUS,
            };
            share += SAFETY * density * length;
        }
    }
    share * size
}

/// The value at an end of a row, and by how much the logarithm falls from the largest of all to there.
fn fall(row: &[f64], end: usize) -> (f64, f64) {
    let largest = row.iter().copied().fold(0.0, f64::max);
    let value = row[end * (row.len() - 1)];
    let falls = (largest / value.max(NOTHING * largest)).ln();
    (value, if falls.is_finite() { falls } else { 0.0 })
}

/// How fast and how far states move in a steady state.
pub(super) struct Motion {
    /// Rate at which states change: the largest, over the axes, of the root mean square of the drift over the standard
    /// deviation; of an angle, the rate at which drift or noise moves it by a radian.
    pub(super) rate: f64,
    /// Per axis and end that is no wall of the system, the square of the standard deviation over the distance from the
    /// mean to the end; zero at walls, and along series.
    ends: Vec<[f64; 2]>,
    /// Per axis and end that is no wall of the system, the distance from the mean to the end; zero at walls, and along
    /// series.
    reaches: Vec<[f64; 2]>,
    /// Per axis and end, by how much the logarithm of the density along the axis falls from its largest value.
    falls: Vec<[f64; 2]>,
    /// Shares of the cells in the steady state.
    shares: Vec<f64>,
}

impl Motion {
    /// Of a steady state with these masses; `None` where nothing moves, or nothing is spread.
    pub(super) fn new(grid: &Grid, system: &dyn System, steady: Steady<'_>) -> Option<Self> {
        let whole: f64 = steady.masses.iter().map(|mass| mass.abs()).sum();
        let axes = grid.space.axes();
        let zeros = || vec![0.0; axes.len()];
        let (mut drifts, mut intensities) = (zeros(), zeros());
        let (mut means, mut squares) = (zeros(), zeros());
        for (cell, mass) in steady.masses.iter().enumerate() {
            let share = mass.abs() / whole;
            if share < NO_MASS {
                continue;
            }
            let state = grid.space.place(cell);
            for (axis, drift) in system.drift_at(0.0, &state).into_iter().enumerate() {
                drifts[axis] += share * drift * drift;
                intensities[axis] += share * system.intensity_at(axis, 0.0, &state);
                means[axis] += share * state[axis];
                squares[axis] += share * state[axis] * state[axis];
            }
        }
        let variance = |axis: usize| squares[axis] - means[axis] * means[axis];
        let of_axis = |axis: usize| {
            let radian = (axes[axis].to() - axes[axis].from()) / TAU;
            let along = match (axes[axis].is_closed(), axes[axis].is_modes()) {
                (true, _) => drifts[axis].sqrt().max(intensities[axis] / radian) / radian,
                (false, false) => (drifts[axis] / variance(axis)).sqrt(),
                (false, true) => return None,
            };
            Some(along)
        };
        let rates = (0..axes.len()).filter_map(of_axis);
        let rate = rates.filter(|rate| rate.is_finite()).reduce(f64::max)?;
        let reach = |axis: usize, end: usize| {
            let is_wall = steady.closed.get(axis).is_none_or(|closed| closed[end]);
            let at = [axes[axis].from(), axes[axis].to()][end];
            if is_wall || axes[axis].is_modes() {
                0.0
            } else {
                (at - means[axis]).abs()
            }
        };
        let reaches = (0..axes.len()).map(|axis| [0, 1].map(|end| reach(axis, end)));
        let reaches: Vec<[f64; 2]> = reaches.collect();
        let ratio = |axis: usize, reach: f64| match reach > 0.0 {
            true => variance(axis) / reach.powi(2),
            false => 0.0,
        };
        let ends = reaches.iter().enumerate();
        let ends = ends.map(|(axis, reaches)| reaches.map(|reach| ratio(axis, reach)));
        let ends: Vec<[f64; 2]> = ends.collect();
        let falls = axes.iter().enumerate().map(|(index, axis)| {
            let mut row = vec![0.0; axis.count()];
            for (cell, mass) in steady.masses.iter().enumerate() {
                let position = grid.space.position(cell, index);
                row[position] += mass.abs() / axis.width(position);
            }
            [0, 1].map(|end| fall(&row, end).1)
        });
        let falls: Vec<[f64; 2]> = falls.collect();
        (rate > 0.0).then(|| Self {
            rate,
            ends,
            reaches,
            falls,
            shares: steady.masses.iter().map(|mass| mass / whole).collect(),
        })
    }

    /// A left vector of a mode without the constant that the steady state's has, of whatever size it is; the same where
    /// the cells are others than those of the steady state.
    pub(super) fn centred(&self, mut left: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
        if left.len() == self.shares.len() {
            let pairs = left.iter().zip(&self.shares);
            let mean: Complex<f64> = pairs.map(|(value, share)| value * share).sum();
            left.iter_mut().for_each(|value| *value -= mean);
        }
        left
    }

    /// Cells at ends that are no walls, with what the product of a row and a column there counts in a number: a rate.
    pub(super) fn at_ends(&self, space: &CellSpace) -> (Vec<usize>, Vec<f64>) {
        let mut found = (Vec::new(), Vec::new());
        for (index, (axis, ends)) in space.axes().iter().zip(&self.ends).enumerate() {
            for (position, &ratio) in [0, axis.count() - 1].into_iter().zip(ends) {
                if ratio == 0.0 {
                    continue;
                }
                let weight = SAFETY * 0.5 * axis.count() as f64 * ratio * self.rate;
                for cell in
                    (0..space.n_cells()).filter(|&cell| space.position(cell, index) == position)
                {
                    found.0.push(cell);
                    found.1.push(weight);
                }
            }
        }
        found
    }
}
