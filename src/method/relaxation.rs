//! How fast a generator forgets its start: the slowest decay rate beside the steady state, by inverse iteration with
//! the factorisation of the steady state.
//!
//! The time is compared with the time in which mass escapes, to say whether there is a steady state. Far from such a limit
//! a neighbour's time will do, and close to it the iteration starts from the neighbour's mode.

use std::sync::Arc;

use crate::stationary::rates::RateSolver;

/// Inverse iterations from an arbitrary start, and from a neighbour's mode; the last half of them counts.
const ITERATIONS: [usize; 2] = [16, 8];

/// Relative error of each of them.
const ROUGH: f64 = 1e-2;

/// Factor by which a time may change from one point of a sweep to the next, as far as we dare to trust it.
const TRUST: f64 = 3.0;

/// How fast deviations from a steady state die out.
#[derive(Debug, PartialEq)]
pub(super) struct Relaxation {
    /// Time in which they shrink by e.
    pub(super) time: f64,
    /// The deviation that lives longest, Σ = 0.
    mode: Arc<Vec<f64>>,
    /// Points of the sweep since it was computed.
    age: i32,
}

impl Relaxation {
    /// The neighbour's time where it answers for sure on which side of `limit` the share of mass is that leaves, at
    /// this escape rate, within it.
    pub(super) fn carried(neighbour: &Self, escape_rate: f64, limit: f64) -> Option<Self> {
        let age = neighbour.age + 1;
        let share = escape_rate * neighbour.time;
        // A share that is reported must be that of this point.
        (share * TRUST.powi(age) < limit).then(|| Self {
            time: neighbour.time,
            mode: neighbour.mode.clone(),
            age,
        })
    }

    /// From x ← Q⁻¹ x on vectors of sum zero: the mean growth over the last iterations is 1/|λ₂|. Rough (a few per cent,
    /// more for oscillating modes), which is enough to compare with the time in which mass escapes. `None` when a
    /// solve fails.
    pub(super) fn compute(
        solver: &mut RateSolver,
        mass: &[f64],
        neighbour: Option<&Self>,
    ) -> Option<Self> {
        let iterations = ITERATIONS[usize::from(neighbour.is_some())];
        let mut mode = neighbour.map_or_else(|| uneven(mass), |known| known.mode.to_vec());
        let mut growth = 0.0;
        for iteration in 0..iterations {
            let size: f64 = mode.iter().map(|value| value.abs()).sum();
            if size == 0.0 || !size.is_finite() {
                return None;
            }
            mode.iter_mut().for_each(|value| *value /= size);
            let next = solver.response(&mode, mass, None, ROUGH).ok()?;
            let grown: f64 = next.iter().map(|value| value.abs()).sum();
            if 2 * iteration >= iterations {
                growth += grown.ln();
            }
            mode = next;
        }
        let time = (growth / (iterations / 2) as f64).exp();
        (time > 0.0 && time.is_finite()).then(|| Self {
            time,
            mode: Arc::new(mode),
            age: 0,
        })
    }
}

/// A start that excites every mode: mass times an uneven, deterministic weight, made to sum to zero.
fn uneven(mass: &[f64]) -> Vec<f64> {
    let cells = mass.len() as f64;
    let weight = |cell: usize| ((cell as f64 * 0.754_877_666).fract() - 0.5) + cell as f64 / cells;
    let entries = mass.iter().enumerate();
    let mut vector: Vec<f64> = entries.map(|(cell, mass)| mass * weight(cell)).collect();
    let excess: f64 = vector.iter().sum();
    let pairs = vector.iter_mut().zip(mass);
    pairs.for_each(|(value, mass)| *value -= excess * mass);
    vector
}
