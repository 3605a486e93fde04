//! What is asked of a steady state: how it answers to a change of its balance, p' (Σ = 0) from Q p' = -change.

use super::balance::Balance;
use super::newton::linear;
use super::passes::Seat;
use crate::cancellation::{Cancellation, Cancelled};

/// A change of the balance, and how well the answer to it is wanted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Question<'a> {
    /// By how much more mass enters each cell than before, per unit time; what its sum lacks escapes.
    pub(super) change: &'a [f64],
    /// What is expected.
    pub(super) guess: Option<&'a [f64]>,
    /// Relative error in L1.
    pub(super) tolerance: f64,
    /// Whether the iterations that it takes say nothing of how far the factors are from the matrix: what enters beside
    /// the ends of a range takes more of them anyway.
    pub(super) is_aside: bool,
}

/// The answer of the masses `mass` to a question and the iterations used, `None` when it takes more than `limit`.
///
/// # Errors
/// [`Cancelled`].
pub(super) async fn answer(
    seat: &Seat,
    balance: &Balance<'_>,
    mass: &[f64],
    question: &Question<'_>,
    limit: usize,
    cancellation: &Cancellation,
) -> Result<Option<(Vec<f64>, usize)>, Cancelled> {
    let total: f64 = mass.iter().sum();
    let held = balance.held;
    // dF/dθ: rates change, and with them the escape, by minus the column sums.
    let lost: f64 = -question.change.iter().sum::<f64>() / total;
    let pairs = question.change.iter().zip(mass);
    let mut source: Vec<f64> = pairs.map(|(c, p)| -(c + lost * p)).collect();
    source[held] = 0.0;
    // The cell that is held does not answer; p may be added freely.
    let start = question.guess.map(|guess| {
        let share = guess[held] / mass[held];
        let pairs = guess.iter().zip(mass);
        pairs.map(|(x, p)| x - share * p).collect::<Vec<f64>>()
    });
    let start = start.filter(|start| start.iter().all(|value| value.is_finite()));
    let effort = (question.tolerance, limit);
    let jacobian = balance.jacobian(mass);
    let derivative = |vector: &[f64]| jacobian.apply(vector);
    let found = linear(seat, &derivative, (&source, start), effort, cancellation).await?;
    Ok(found.map(|(mut response, used)| {
        let excess: f64 = response.iter().sum::<f64>() / total;
        for (slot, value) in response.iter_mut().zip(mass) {
            *slot -= excess * value;
        }
        (response, used)
    }))
}
