//! The numbers of a passage from an operator: mean, deviation, rate, shares of exits, probabilities and quantiles.

use super::krylov::solve;
use super::moments::{EXITS, SPENT, SQUARE};
use super::operator::{Operator, StartVector};
use super::survival::{Survival, Times};
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::dot;

/// What was solved for with an operator; it serves every start.
pub(super) struct Functions {
    map_step: f64,
    /// Mean time that is left.
    time: Vec<f64>,
    /// Mean square of that, less what the step itself has of it.
    square: Vec<f64>,
    /// Probability of each exit.
    exits: Vec<Vec<f64>>,
    /// Probability per unit time that a process ends which has lasted long.
    rate: f64,
    /// Largest residual of an equation over its right side.
    pub(super) residual: f64,
}

impl Functions {
    pub(super) fn new(
        operator: &Operator,
        (map_step, exits): (f64, usize),
        cancellation: &Cancellation,
    ) -> Result<Self, Cancelled> {
        let time = solve(operator, &operator.told[SPENT], cancellation)?;
        // A path that goes on has spent Δt, and (Δt + T)² = Δt² + 2 Δt T + T².
        let cross = operator.apply(&time.function);
        let own = operator.told[SQUARE].iter().zip(&cross);
        let right: Vec<f64> = own
            .map(|(own, cross)| own + 2.0 * map_step * cross)
            .collect();
        let square = solve(operator, &right, cancellation)?;
        let mut residual = time.residual.max(square.residual);
        let mut shares = Vec::new();
        // The last of them is what the others leave.
        for part in 0..exits {
            let solved = solve(operator, &operator.told[EXITS + part], cancellation)?;
            residual = residual.max(solved.residual);
            shares.push(solved.function);
        }
        let after = square.function.iter().zip(&time.function);
        let after = after.map(|(square, time)| square + 2.0 * map_step * time);
        Ok(Self {
            map_step,
            square: after.collect(),
            rate: -(-time.loss).ln_1p() / map_step,
            time: time.function,
            exits: shares,
            residual,
        })
    }

    /// All numbers of a start, in the order of their columns; and what the places between which quantiles are
    /// interpolated change of each.
    pub(super) fn numbers(
        &self,
        operator: &Operator,
        start: &StartVector,
        times: &Times,
    ) -> (Vec<f64>, Vec<f64>) {
        let mean = start.told[SPENT] + dot(&start.weights, &self.time);
        let square = start.told[SQUARE] + dot(&start.weights, &self.square);
        let deviation = (square - mean * mean).max(0.0).sqrt();
        let mut numbers = vec![mean, deviation, self.rate];
        let shares = self.exits.iter().enumerate();
        let shares =
            shares.map(|(part, share)| start.told[EXITS + part] + dot(&start.weights, share));
        let shares: Vec<f64> = shares.collect();
        let sum: f64 = shares.iter().sum();
        numbers.extend(shares.iter().map(|share| share / sum));
        let mut doubts = vec![0.0; numbers.len()];
        let survival = Survival {
            operator,
            start,
            map_step: self.map_step,
            rate: self.rate,
            exits: self.exits.len(),
        };
        let (survived, unsure) = survival.at(times);
        numbers.extend(survived);
        doubts.extend(unsure);
        (numbers, doubts)
    }
}
