//! How low values of a density may be and still have digits.
//!
//! The rates of a generator are known one by one, and so is every mass in proportion to itself, however small it is
//! beside others (C. A. O'Cinneide, Numerische Mathematik 65, 109 (1993)). What limits it is where iterations end. The
//! factors that are at hand tell what they have left of the steady state and of what the second scheme changes, cell by
//! cell: a value that this changes by a share of itself has no digits, nor have lower ones.

use super::session::ROUGH;
use crate::density::EstimatedDensity;
use crate::method::MethodError;
use crate::method::Problem;
use crate::method::problem::Maps;
use crate::stationary::generator::{RateError, RateSolver, RateSteadyState, product};
use sprs::CsMat;

/// What is left, over a mass, from which it has no digits: of the mass itself, and of what the second scheme changes.
const OF_STATE: f64 = 1e-3;
const OF_CHANGE: f64 = 0.03;

/// Part of a value that comes from cells without digits, from which it has none.
const PART: f64 = 0.1;

/// Share of the maximum below which nothing is told: far above the smallest numbers there are, with those of cells that
/// add up to a value.
const LEAST: f64 = 1e-40;

/// What iterations have left of the unknowns of a steady state in each cell, before it was taken off them.
pub(super) struct Left {
    state: Vec<f64>,
}

/// Takes what iterations have left off a steady state; `None` where the factors do not serve.
pub(super) fn finish(
    solver: &mut RateSolver,
    matrix: &CsMat<f64>,
    steady: &mut RateSteadyState,
) -> Result<Option<Left>, MethodError> {
    let (mass, rate) = (&steady.mass, steady.info.escape_rate);
    let mut flow = product(matrix, mass);
    flow.iter_mut()
        .zip(mass)
        .for_each(|(flow, mass)| *flow += rate * mass);
    // What rounding makes of a symmetric state is not symmetric, and would want factors of all cells.
    if mass.iter().eq(mass.iter().rev()) {
        let mirrored: Vec<f64> = flow.iter().rev().copied().collect();
        flow.iter_mut()
            .zip(mirrored)
            .for_each(|(flow, other)| *flow = 0.5 * (*flow + other));
    }
    let left = match solver.response_at_ends(&flow, mass, ROUGH) {
        Ok(left) => left,
        Err(RateError::Sensitivity) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    steady
        .mass
        .iter_mut()
        .zip(&left)
        .for_each(|(mass, left)| *mass += left);
    Ok(Some(Left { state: left }))
}

impl Left {
    /// The masses of cells that have no digits, zero in others.
    fn without_digits(&self, masses: &[f64], change: Option<&[f64]>) -> Vec<f64> {
        let cells = masses.iter().zip(&self.state).enumerate();
        let of_change = |cell: usize| change.map_or(0.0, |change| change[cell].abs());
        cells
            .map(|(cell, (mass, state))| {
                let size = mass.abs();
                let has_digits =
                    state.abs() <= OF_STATE * size && of_change(cell) <= OF_CHANGE * size;
                if has_digits { 0.0 } else { size }
            })
            .collect()
    }

    /// Tells densities of masses below which share of the maximum their values have no digits; `change` is what
    /// iterations have left of what the second scheme changes.
    pub(super) fn tell(
        &self,
        (maps, problem): (&Maps, &Problem),
        (masses, change): (&[f64], Option<&[f64]>),
        densities: &mut [EstimatedDensity],
    ) -> Result<(), MethodError> {
        let without = self.without_digits(masses, change);
        let nothing = vec![0.0; masses.len()];
        let parts = maps.exact(problem, &without, &nothing)?;
        for (one, part) in densities.iter_mut().zip(parts) {
            let values = one.density.values.iter().zip(&part.density.values);
            let lost = values.filter(|(value, part)| **part > PART * value.abs());
            let highest = lost.fold(0.0, |most: f64, (value, _)| most.max(value.abs()));
            let maximum = one.density.maximum().max(f64::MIN_POSITIVE);
            one.negligible = (highest / maximum).max(LEAST);
        }
        Ok(())
    }
}
