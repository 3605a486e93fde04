//! Power iteration p ← P p / Σ P p, the cell map run until it stands.

use std::f64::consts::PI;

use super::chain::{Chain, normalise};
use super::convergence::Contraction;
use super::multilevel::Iterate;
use super::{Options, second_eigenvalue};
use crate::cancellation::Cancelled;
use crate::numerics::distance;

/// Steps over which the contraction is observed.
const WINDOW: usize = 20;

/// Steps after which an iteration that has not come closer is given up: it oscillates, or has reached rounding.
const PATIENCE: usize = 2000;

/// Solves for the (quasi-)steady state from `mass`, Σ = 1.
///
/// Fast modes may hide a slow one of small amplitude, so the first claim of convergence is checked against
/// |λ₂|/λ₁ before it is believed.
///
/// Where states have `phases`, the chain goes round among them for ever. Then only half of the mass takes each step,
/// which leaves the steady state as it is: modes that go round in m phases shrink by cos(π/m).
pub(super) fn solve(
    chain: &Chain,
    phases: &[usize],
    mass: Vec<f64>,
    options: &Options,
) -> Result<Iterate, Cancelled> {
    let tolerance = options.tolerance;
    let mut contraction = Contraction::new(WINDOW);
    let mut result = Iterate {
        mass,
        iterations: 0,
        matrix_passes: 0,
        error_estimate: 2.0,
        converged: false,
    };
    let mut next = vec![0.0; chain.len()];
    let mut verified = false;
    let round = phases.iter().max().map(|last| last + 1);
    let mut milestone = f64::INFINITY;
    while result.iterations < options.max_iterations && !result.converged {
        options.cancellation.check()?;
        chain.apply(&result.mass, &mut next);
        if round.is_some() {
            let pairs = next.iter_mut().zip(&result.mass);
            pairs.for_each(|(next, mass)| *next = 0.5 * (*next + mass));
        }
        normalise(&mut next, 0.0);
        result.iterations += 1;
        result.matrix_passes += 1;
        let change = distance(&next, &result.mass);
        std::mem::swap(&mut next, &mut result.mass);
        result.error_estimate = contraction.observe(change);
        if result.error_estimate <= tolerance && !verified {
            let states = (result.mass.as_slice(), phases);
            let second = second_eigenvalue::of_chain(chain, states, &options.cancellation)?;
            result.matrix_passes += second.products;
            let ratio = second.modulus / (1.0 - chain.escaping(&result.mass));
            contraction.set_known(match round {
                Some(count) => (0.5 + 0.5 * ratio).max((PI / count as f64).cos()),
                None => ratio,
            });
            result.error_estimate = contraction.estimate(change);
            verified = true;
        }
        result.converged = result.error_estimate <= tolerance;
        if result.iterations.is_multiple_of(PATIENCE) {
            if change > 0.999 * milestone {
                break;
            }
            milestone = change;
        }
    }
    Ok(result)
}
