//! Multilevel aggregation (Horton and Leutenegger, SIGMETRICS 1994; De Sterck et al., SIAM J. Sci. Comput. 30,
//! 2008): Gauss-Seidel smoothing on each level, multiplicative corrections from the lumped chains, W-cycles,
//! elimination on the coarsest level. Anderson's acceleration joins the cycles: on 200² cells with a second
//! eigenvalue of 0.998 it takes 16 cycles where the plain ones take 60.
//!
//! Escaped mass comes back in proportion to the masses: the fixed point of P̃ = P + p eᵀ, e the escape
//! probabilities, is P p = (1 - e·p) p. Lumping preserves it, since lumps inherit e and their share of p.

use rayon::prelude::*;

use super::Options;
use super::acceleration::Acceleration;
use super::chain::{Chain, normalise};
use super::convergence::Contraction;
use super::elimination::Eliminated;
use super::hierarchy::{Level, levels};
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::distance;

/// Masses are kept above this: a zero could never be corrected by a factor.
const SMALLEST_MASS: f64 = 1e-200;

/// Rows of one block of the smoother. Blocks take each other's values from before the sweep, so that they can
/// run side by side with the same result on any number of threads.
const SMOOTHER_BLOCK: usize = 8192;

/// Earlier cycles that the acceleration combines with the latest.
const WINDOW: usize = 8;

/// Result of an iterative solver, states in the order of the chain.
pub(super) struct Iterate {
    pub(super) mass: Vec<f64>,
    pub(super) iterations: usize,
    pub(super) matrix_passes: usize,
    pub(super) error_estimate: f64,
    pub(super) converged: bool,
}

/// Solves for the (quasi-)steady state. `keys` are the Morton keys of the states, ascending.
pub(super) fn solve(
    chain: &Chain,
    keys: Vec<u128>,
    axes: usize,
    guess: Vec<f64>,
    options: &Options,
) -> Result<Iterate, Cancelled> {
    let mut levels = levels(chain.clone(), keys, axes);
    let mut contraction = Contraction::new(1);
    let mut acceleration = Acceleration::new(WINDOW);
    let mut result = Iterate {
        mass: guess,
        iterations: 0,
        matrix_passes: 0,
        error_estimate: 2.0,
        converged: false,
    };
    levels[0].mass.copy_from_slice(&result.mass);
    while result.iterations < options.max_iterations && !result.converged {
        result.matrix_passes += cycle(&mut levels, &options.cancellation)?;
        result.iterations += 1;
        acceleration.step(&result.mass, &mut levels[0].mass);
        normalise(&mut levels[0].mass, SMALLEST_MASS);
        let change = distance(&levels[0].mass, &result.mass);
        result.mass.copy_from_slice(&levels[0].mass);
        result.error_estimate = contraction.observe(change);
        // The first change alone shows no contraction.
        result.converged = result.iterations > 1 && result.error_estimate <= options.tolerance;
    }
    Ok(result)
}

/// One W-cycle; returns the passes over the finest chain.
fn cycle(levels: &mut [Level], cancellation: &Cancellation) -> Result<usize, Cancelled> {
    cancellation.check()?;
    let Some((fine, coarser)) = levels.split_first_mut() else {
        return Ok(0);
    };
    let Some(lumping) = &fine.lumping else {
        eliminate(fine);
        return Ok(1);
    };
    smooth(&fine.chain, &mut fine.mass);
    lumping.project(&fine.chain, &fine.mass, &mut coarser[0]);
    let before = coarser[0].mass.clone();
    cycle(coarser, cancellation)?;
    if coarser.len() > 1 {
        cycle(coarser, cancellation)?;
    }
    for (lump, (new, old)) in coarser[0].mass.iter().zip(&before).enumerate() {
        let states = lumping.members[lump]..lumping.members[lump + 1];
        fine.mass[states]
            .iter_mut()
            .for_each(|mass| *mass *= new / old);
    }
    smooth(&fine.chain, &mut fine.mass);
    Ok(3)
}

/// Solves the coarsest chain.
fn eliminate(level: &mut Level) {
    let chain = &level.chain;
    let n = chain.len();
    let mut rates = vec![0.0; n * n];
    for state in 0..n {
        for entry in chain.starts[state]..chain.starts[state + 1] {
            rates[chain.columns[entry] as usize * n + state] = chain.values[entry];
        }
    }
    level.mass = Eliminated::new(rates, chain.escape.clone()).steady(&level.mass);
    normalise(&mut level.mass, SMALLEST_MASS);
}

/// One sweep of Gauss-Seidel inside blocks, Jacobi between them: p_i ← (Σ_{j≠i} P_ij p_j + (e·p) p_i) / leaving_i.
fn smooth(chain: &Chain, mass: &mut [f64]) {
    let returning = chain.escaping(mass);
    let old = mass.to_vec();
    let sweep = |(block, rows): (usize, &mut [f64])| {
        let first = block * SMOOTHER_BLOCK;
        for row in 0..rows.len() {
            let state = first + row;
            let range = chain.starts[state]..chain.starts[state + 1];
            let mut inflow = returning * rows[row];
            for (&from, value) in chain.columns[range.clone()]
                .iter()
                .zip(&chain.values[range])
            {
                let from = from as usize;
                let source = rows.get(from.wrapping_sub(first)).unwrap_or(&old[from]);
                inflow += value * source;
            }
            // A single state without escape is left for nowhere.
            if chain.leaving[state] > 0.0 {
                rows[row] = inflow / chain.leaving[state];
            }
        }
    };
    mass.par_chunks_mut(SMOOTHER_BLOCK)
        .enumerate()
        .for_each(sweep);
    normalise(mass, SMALLEST_MASS);
}
