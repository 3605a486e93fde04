//! Pairs of axes that may be exchanged: the equations stay the same, and with them the steady-state density.
//!
//! Such axes get the same range and with it the same cells, so that what is computed is symmetric too, and critical
//! points that the symmetry makes change together do so.

use crate::sampling::{mix, unit};
use crate::system::System;

/// States at which the equations are compared.
const TRIALS: usize = 64;
/// Relative difference below which two values are one but for rounding.
const ROUNDING: f64 = 1e-9;

/// The pairs, each with the lower axis first, as random states of a box show them.
pub(super) fn swaps(system: &dyn System, ranges: &[(f64, f64)]) -> Vec<(usize, usize)> {
    let axes = 0..ranges.len();
    let pairs = axes.flat_map(|first| (first + 1..ranges.len()).map(move |second| (first, second)));
    pairs
        .filter(|&pair| is_swap(system, ranges, pair))
        .collect()
}

fn is_swap(system: &dyn System, ranges: &[(f64, f64)], (first, second): (usize, usize)) -> bool {
    let image = |values: &[f64]| {
        let mut values = values.to_vec();
        values.swap(first, second);
        values
    };
    let at = |state: &[f64]| {
        let intensities = (0..state.len()).map(|axis| system.intensity_at(axis, 0.0, state));
        (
            system.drift_at(0.0, state),
            intensities.collect::<Vec<f64>>(),
        )
    };
    (0..TRIALS).all(|trial| {
        let place = |(axis, (from, to)): (usize, &(f64, f64))| {
            let word = mix((trial * ranges.len() + axis) as u64);
            from + unit(word) * (to - from)
        };
        let state: Vec<f64> = ranges.iter().enumerate().map(place).collect();
        let (own, other) = (at(&state), at(&image(&state)));
        is_one(&image(&own.0), &other.0) && is_one(&image(&own.1), &other.1)
    })
}

/// Whether two vectors are one but for rounding.
fn is_one(a: &[f64], b: &[f64]) -> bool {
    let size = a
        .iter()
        .chain(b)
        .fold(0.0_f64, |size, value| size.max(value.abs()));
    a.iter()
        .zip(b)
        .all(|(a, b)| (a - b).abs() <= ROUNDING * size)
}
