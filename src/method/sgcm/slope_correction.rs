//! The steady state of a cell map whose densities are linear inside the cells instead of flat.
//!
//! The plain cell map forgets where in a cell a sample ends, and starts the next step evenly spread: a diffusion of
//! h²/(12Δt). Most of it is the slope: where the density falls across a cell, more of its mass sits at the higher side.
//! So the samples, which know where they started, are weighted by the density at their starts. The weights depend on
//! the density that is sought; the equation is solved by turns, slopes from the last masses, masses from the matrix
//! with these slopes, until nothing changes.

use super::Correction;
use crate::MAX_DIMENSION;
use crate::method::MethodError;
use crate::numerics::distance;
use crate::sampling::{SampledTransitions, TransitionMatrix};
use crate::space::CellSpace;
use crate::stationary::{Options, Outcome, SteadyState, solve};

/// Most turns.
const MOST_ROUNDS: usize = 100;

/// A solved cell map.
#[derive(Debug, Clone)]
pub struct Corrected {
    /// What was found.
    pub outcome: Outcome,
    /// The transition matrix of the last turn.
    pub matrix: TransitionMatrix,
    /// Slopes of the density in every sampled cell, see `SampledTransitions::slopes`; all zero without correction.
    pub slopes: Vec<[f64; MAX_DIMENSION]>,
    /// Turns that were made.
    pub rounds: usize,
    /// L1 change of the masses in the last turn.
    pub change: f64,
}

/// Solves the cell map with slope-corrected transitions, all samples or without one group of them. `guess` has one mass
/// a cell of the space. Turns end when the masses change by less than `largest_change` in L1; a steady state that still
/// changes by more after a hundred of them is marked as not converged. Without kept starts, or where there is no single
/// steady state, the plain cell map's outcome is given: which cells communicate does not depend on weights.
///
/// # Errors
/// [`MethodError::Stationary`] when the transitions cannot be solved.
pub fn solve_corrected(
    transitions: &SampledTransitions,
    space: &CellSpace,
    guess: Option<&[f64]>,
    left_out: Option<usize>,
    options: &Options,
    largest_change: f64,
) -> Result<Corrected, MethodError> {
    let flat = vec![[0.0; MAX_DIMENSION]; transitions.cells().len()];
    let slopes_of = |mass: &[f64]| transitions.slopes(space, mass);
    let mut slopes = match guess {
        Some(mass) if transitions.keeps_starts() => slopes_of(mass),
        _ => flat,
    };
    let mut last: Option<SteadyState> = None;
    let (mut rounds, mut work) = (0, (0, 0));
    loop {
        let matrix = transitions.corrected_matrix(&slopes, left_out);
        let start = last.as_ref().map(|steady| steady.mass.as_slice()).or(guess);
        let mut outcome = solve(&matrix, space, start, options)?;
        rounds += 1;
        let mut change = 0.0;
        if let Outcome::Steady(steady) = &mut outcome {
            work.0 += steady.info.iterations;
            work.1 += steady.info.matrix_passes;
            (steady.info.iterations, steady.info.matrix_passes) = work;
            change = distance(start.unwrap_or(&[]), &steady.mass);
            let settled = last.is_some() && change < largest_change;
            if transitions.keeps_starts() && !settled {
                if rounds < MOST_ROUNDS {
                    slopes = slopes_of(&steady.mass);
                    last = Some(steady.clone());
                    continue;
                }
                steady.info.converged = false;
                steady.info.error_estimate = steady.info.error_estimate.max(change);
            }
        }
        return Ok(Corrected {
            outcome,
            matrix,
            slopes,
            rounds,
            change,
        });
    }
}

/// Solves the cell map with the correction that is asked for; without any, as if starts had not been kept.
pub(super) fn solve_by(
    correction: Correction,
    transitions: &SampledTransitions,
    space: &CellSpace,
    guess: Option<&[f64]>,
    left_out: Option<usize>,
    (options, largest_change): (&Options, f64),
) -> Result<Corrected, MethodError> {
    if correction == Correction::Slope {
        return solve_corrected(transitions, space, guess, left_out, options, largest_change);
    }
    let matrix = match left_out {
        Some(group) => transitions.matrix_without_group(group),
        None => transitions.matrix(),
    };
    Ok(Corrected {
        outcome: solve(&matrix, space, guess, options)?,
        matrix,
        slopes: vec![[0.0; MAX_DIMENSION]; transitions.cells().len()],
        rounds: 1,
        change: 0.0,
    })
}

#[cfg(test)]
mod tests;
