//! How fast a generator forgets its start: the slowest decay rate beside the steady state, by inverse iteration with
//! the factorisation of the steady state.
//!
//! The time is compared with the time in which mass escapes, to say whether there is a steady state. Far from such a
//! limit a neighbour's time will do, and close to it the iteration starts from the neighbour's mode.

use crate::stationary::generator::RateSolver;

/// Most inverse iterations.
const ITERATIONS: usize = 24;

/// The growth of an iteration is averaged over so many, because that of an oscillating mode oscillates.
const AVERAGED: usize = 4;

/// Change of that average, relative, at which it is taken.
const SETTLED: f64 = 0.03;

/// Relative error of each of them.
const ROUGH: f64 = 1e-2;

/// Factor by which a time may change from one point of a sweep to the next while nothing is known of it.
const UNKNOWN_CHANGE: f64 = 3.0;

/// The same on top of twice the change that was seen before.
const LEAST_CHANGE: f64 = 1.05;

/// How fast deviations from a steady state die out.
#[derive(Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Relaxation {
    /// Time in which they shrink by e.
    pub(super) time: f64,
    /// The deviation that lives longest, Σ = 0; nothing where the time is that of fewer cells.
    mode: Vec<f64>,
    /// Factor by which the time may change from point to point.
    change: f64,
    /// Points of the sweep since it was computed.
    age: i32,
    /// Factor by which the time may be off: fewer cells change it.
    pub(super) off: f64,
}

impl Relaxation {
    /// The neighbour's time where it tells for sure that less than `limit` of the mass leaves, at this escape rate,
    /// within it. (A share that is reported must be that of the point itself.)
    pub(super) fn carry_over(neighbour: &Self, escape_rate: f64, limit: f64) -> Option<Self> {
        let age = neighbour.age + 1;
        let largest_time = neighbour.time * neighbour.off * neighbour.change.powi(age);
        (escape_rate * largest_time < limit).then(|| Self {
            time: neighbour.time,
            mode: neighbour.mode.clone(),
            change: neighbour.change,
            age,
            off: neighbour.off,
        })
    }

    /// A time that fewer cells gave, which may be off by a factor.
    pub(super) fn rough(time: f64, off: f64, neighbour: Option<&Self>) -> Self {
        let change = neighbour.map_or(UNKNOWN_CHANGE, |known| LEAST_CHANGE * known.change_to(time));
        Self {
            time,
            mode: Vec::new(),
            change,
            age: 0,
            off,
        }
    }

    /// Whether less than `limit` of the mass leaves within it for sure, at this escape rate, at the point that it is
    /// of.
    pub(super) fn is_quiet(&self, escape_rate: f64, limit: f64) -> bool {
        escape_rate * self.time * self.off < limit
    }

    /// Twice the change a point, as a factor, that has led from here to a time.
    fn change_to(&self, time: f64) -> f64 {
        let seen = (time / self.time).ln().abs() / f64::from(self.age + 1);
        (2.0 * seen).exp()
    }

    /// Number of cells that it is on; `None` where it knows of none.
    pub(super) fn cells(&self) -> Option<usize> {
        Some(self.mode.len()).filter(|&cells| cells > 0)
    }

    /// From x ← Q⁻¹ x on vectors of sum zero: the mean growth over the last iterations is 1/|λ₂|. Rough (a few per
    /// cent, more for oscillating modes), which is enough to compare with the time in which mass escapes. `None` when a
    /// solve fails.
    pub(super) fn compute(
        solver: &mut RateSolver,
        mass: &[f64],
        neighbour: Option<&Self>,
    ) -> Option<Self> {
        let known = neighbour.filter(|known| !known.mode.is_empty());
        let mut mode = known.map_or_else(|| uneven(mass), |known| known.mode.clone());
        let mut growth: Vec<f64> = Vec::with_capacity(ITERATIONS);
        while growth.len() < ITERATIONS && !is_settled(&growth) {
            let size: f64 = mode.iter().map(|value| value.abs()).sum();
            if size == 0.0 || !size.is_finite() {
                return None;
            }
            mode.iter_mut().for_each(|value| *value /= size);
            mode = solver.response(&mode, mass, None, ROUGH).ok()?;
            growth.push(mode.iter().map(|value| value.abs()).sum::<f64>().ln());
        }
        let time = mean(growth.rchunks(AVERAGED).next()?).exp();
        let change = neighbour.map_or(UNKNOWN_CHANGE, |known| LEAST_CHANGE * known.change_to(time));
        (time > 0.0 && time.is_finite()).then_some(Self {
            time,
            mode,
            change,
            age: 0,
            off: 1.0,
        })
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Whether the average over the last iterations is that of those before.
fn is_settled(growth: &[f64]) -> bool {
    let mut averages = growth.rchunks_exact(AVERAGED).map(mean);
    match (averages.next(), averages.next()) {
        (Some(last), Some(before)) => (last - before).abs() <= SETTLED,
        _ => false,
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
