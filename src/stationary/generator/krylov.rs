//! GMRES (Saad and Schultz 1986) on an operator that is close to the identity, no restart.
//!
//! The operator is M⁻¹ A, so residuals are in the units of the unknowns and, divided by the smallest singular
//! value that the Krylov space has seen, estimate the error. All sums run in a fixed order.

use super::passes::Seat;
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::{add_scaled, dot};
use crate::stationary::hessenberg::Triangle;

/// What a run of GMRES gave.
pub(super) struct Outcome {
    /// x with M⁻¹ A x ≈ start.
    pub(super) solution: Vec<f64>,
    /// Applications of the operator.
    pub(super) iterations: usize,
    /// Smallest singular value of the projected operator.
    pub(super) smallest: f64,
    /// Whether the target was reached.
    pub(super) reached: bool,
}

/// When GMRES stops.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Wanted reduction of the 2-norm.
    pub(super) reduction: f64,
    /// Largest number of applications.
    pub(super) iterations: usize,
    /// Whether to stop as soon as the trend says that the limit will not do.
    pub(super) give_up_early: bool,
}

/// A linear operator A.
pub(super) type Operator<'a> = dyn Fn(&[f64]) -> Vec<f64> + Sync + 'a;

/// Solves M⁻¹ A x = start, M⁻¹ by the passes at `seat`.
pub(super) async fn gmres(
    seat: &Seat,
    operator: &Operator<'_>,
    start: Vec<f64>,
    limits: Limits,
    cancellation: &Cancellation,
) -> Result<Outcome, Cancelled> {
    let size = dot(&start, &start).sqrt();
    let mut outcome = Outcome {
        solution: vec![0.0; start.len()],
        iterations: 0,
        smallest: 1.0,
        reached: size == 0.0,
    };
    if !(size > 0.0 && size.is_finite()) {
        return Ok(outcome);
    }
    let mut basis = vec![start];
    basis[0].iter_mut().for_each(|value| *value /= size);
    let mut triangle = Triangle::new(size);
    while !outcome.reached && outcome.iterations < limits.iterations {
        cancellation.check()?;
        let mut next = seat.pass(operator(&basis[outcome.iterations])).await;
        outcome.iterations += 1;
        let mut column = vec![0.0; basis.len()];
        // Twice is enough (Kahan): classical trouble with nearly dependent vectors.
        for _ in 0..2 {
            for (entry, vector) in column.iter_mut().zip(&basis) {
                let overlap = dot(&next, vector);
                *entry += overlap;
                add_scaled(&mut next, -overlap, vector);
            }
        }
        let length = dot(&next, &next).sqrt();
        if !length.is_finite() {
            outcome.iterations = limits.iterations;
            return Ok(outcome);
        }
        let remaining = triangle.push(column, length) / size;
        outcome.reached = remaining <= limits.reduction;
        let hopeless = limits.give_up_early && outcome.iterations >= 5 && {
            let decades = remaining.ln() / outcome.iterations as f64;
            decades * limits.iterations as f64 > limits.reduction.ln()
        };
        if length <= 1e-14 || hopeless {
            break;
        }
        next.iter_mut().for_each(|value| *value /= length);
        basis.push(next);
    }
    let (weights, smallest) = triangle.solve();
    outcome.smallest = smallest;
    for (weight, vector) in weights.iter().zip(&basis) {
        add_scaled(&mut outcome.solution, *weight, vector);
    }
    Ok(outcome)
}
