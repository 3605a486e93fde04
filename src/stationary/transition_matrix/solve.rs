//! From a transition matrix to its steady state: class, solver, masses on the whole cell space.

use super::chain::{SoundMatrix, normalise};
use super::classes::{self, Carrier};
use super::hierarchy::Curve;
use super::multilevel::{self, Iterate};
use super::{Info, LARGEST_ESCAPE, Options, Outcome, Solver, StationaryError, SteadyState};
use super::{absorption, power};
use crate::cancellation::Cancelled;
use crate::sampling::TransitionMatrix;
use crate::space::CellSpace;

/// Share of the mean mass that a cell without mass in the guess is given. A multiplicative correction cannot
/// lift a zero, and a smoother does so slowly.
const FLOOR: f64 = 1e-10;

/// Finds the (quasi-)steady state of a transition matrix over cells of `space`.
///
/// `guess` has one mass for each cell of the space (not necessarily Σ = 1); without it the start is uniform. The
/// result does not depend on the number of threads.
///
/// # Errors
/// [`StationaryError`] when the input is malformed. Slow convergence, several classes and no class are
/// outcomes, not errors.
pub fn solve(
    matrix: &TransitionMatrix,
    space: &CellSpace,
    guess: Option<&[f64]>,
    options: &Options,
) -> Result<Outcome, StationaryError> {
    if !(options.tolerance > 0.0 && options.tolerance < 1.0) {
        return Err(StationaryError::Tolerance {
            tolerance: options.tolerance,
        });
    }
    let cells = space.n_cells();
    let is_mass = |mass: &f64| mass.is_finite() && *mass >= 0.0;
    if guess.is_some_and(|guess| guess.len() != cells || !guess.iter().all(is_mass)) {
        return Err(StationaryError::Guess { cells });
    }
    let checked = SoundMatrix::new(matrix, cells)?;
    let cancellation = &options.cancellation;
    match classes::carrier(&checked, cancellation)? {
        Carrier::None(escape_per_step) => Ok(Outcome::NoneInside { escape_per_step }),
        Carrier::Several(classes) => {
            let all: Vec<usize> = (0..checked.len()).collect();
            let initial = initial(&checked, &all, guess, 0.0);
            let (classes, escaped) =
                absorption::shares(&checked, space, &classes, &initial, cancellation)?;
            Ok(Outcome::SeveralClasses { classes, escaped })
        }
        Carrier::One(rows) => {
            let curve = Curve::new(space, matrix.phase);
            Ok(solve_on(&checked, &curve, rows, guess, options)?)
        }
    }
}

/// Masses of the given rows to start from, Σ = 1, none below `floor` times the mean.
fn initial(
    matrix: &SoundMatrix<'_>,
    rows: &[usize],
    guess: Option<&[f64]>,
    floor: f64,
) -> Vec<f64> {
    let mean = 1.0 / rows.len() as f64;
    let mut mass = vec![mean; rows.len()];
    if let Some(guess) = guess {
        let total: f64 = rows.iter().map(|&row| guess[matrix.cells[row]]).sum();
        if total > 0.0 {
            for (mass, &row) in mass.iter_mut().zip(rows) {
                *mass = guess[matrix.cells[row]] / total;
            }
        }
    }
    for mass in mass.iter_mut().filter(|mass| **mass == 0.0) {
        *mass = floor * mean;
    }
    normalise(&mut mass, 0.0);
    mass
}

/// Solves on the rows that carry the steady state.
fn solve_on(
    matrix: &SoundMatrix<'_>,
    curve: &Curve<'_>,
    rows: Vec<usize>,
    guess: Option<&[f64]>,
    options: &Options,
) -> Result<Outcome, Cancelled> {
    let mut placed: Vec<(u128, usize)> = rows
        .iter()
        .map(|&row| (curve.place(matrix.cells[row]), row))
        .collect();
    placed.sort_unstable();
    let (keys, rows): (Vec<u128>, Vec<usize>) = placed.into_iter().unzip();
    let chain = matrix.restriction(&rows);
    let start = initial(matrix, &rows, guess, FLOOR);
    let Iterate {
        mass,
        iterations,
        matrix_passes,
        error_estimate,
        converged,
    } = match options.solver {
        Solver::MultilevelAggregation => {
            multilevel::solve(&chain, keys, curve.axes(), start, options)?
        }
        Solver::PowerIteration => {
            let phases = curve.phases(rows.iter().map(|&row| matrix.cells[row]));
            power::solve(&chain, &phases, start, options)?
        }
    };
    let escape_per_step = chain.escaping(&mass);
    if converged && escape_per_step > LARGEST_ESCAPE {
        return Ok(Outcome::NoneInside { escape_per_step });
    }
    let info = Info {
        solver: options.solver,
        iterations,
        matrix_passes: matrix_passes + 1,
        residual: chain.residual(&mass),
        error_estimate,
        converged,
        escape_per_step,
        class_cells: rows.len(),
        transient_cells: matrix.len() - rows.len(),
    };
    let mut all = vec![0.0; curve.cells()];
    for (&row, value) in rows.iter().zip(mass) {
        all[matrix.cells[row]] = value;
    }
    Ok(Outcome::Steady(SteadyState { mass: all, info }))
}
