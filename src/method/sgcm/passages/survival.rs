//! Probabilities that a process still goes on, and quantiles: the start is taken on by one map step after another.
//!
//! A time that is no multiple of the map step needs no interpolation: it is known of every path whether it goes on a
//! part of a step after its start, so that the last step is that part.

use super::moments::{ENDED, EXITS};
use super::operator::{Operator, StartVector};
use crate::numerics::dot;

/// Parts of a map step at whose ends probabilities are known for quantiles.
const PARTS: usize = 8;

/// The tail has begun where the rate of a step agrees with that of processes that have lasted long to this share, in so
/// many steps in a row.
const AGREEMENT: f64 = 1e-3;
const AGREEING: usize = 20;

/// Most steps; what is left then decays at the last rate.
const MOST_STEPS: usize = 20_000;

/// Times and shares that are asked for, and looks within a map step that answer them.
#[derive(Debug, Clone)]
pub(super) struct Times {
    times: Vec<f64>,
    shares: Vec<f64>,
    /// Of each time: whole map steps before it, and the look that has the rest.
    at: Vec<(usize, usize)>,
    /// Looks within a map step, ascending.
    pub(super) looks: Vec<f64>,
}

impl Times {
    pub(super) fn new(times: &[f64], shares: &[f64], map_step: f64) -> Self {
        let split = |time: &f64| {
            let whole = (time / map_step).floor();
            (whole as usize, (time - whole * map_step).max(0.0))
        };
        let split: Vec<(usize, f64)> = times.iter().map(split).collect();
        let parts = (0..PARTS).map(|part| map_step * part as f64 / PARTS as f64);
        let parts = parts.filter(|_| !shares.is_empty());
        let mut looks: Vec<f64> = split.iter().map(|(_, rest)| *rest).chain(parts).collect();
        looks.sort_unstable_by(f64::total_cmp);
        looks.dedup();
        let look = |rest: f64| looks.partition_point(|&look| look < rest);
        Self {
            times: times.to_vec(),
            shares: shares.to_vec(),
            at: split
                .iter()
                .map(|&(whole, rest)| (whole, look(rest)))
                .collect(),
            looks,
        }
    }

    /// How many probabilities are asked for.
    pub(super) fn count(&self) -> usize {
        self.times.len()
    }

    /// Looks at parts of a map step.
    fn parts(&self, map_step: f64) -> Vec<(f64, usize)> {
        let parts = (0..PARTS).map(|part| map_step * part as f64 / PARTS as f64);
        let look = |time: f64| self.looks.partition_point(|&look| look < time);
        parts.map(|time| (time, look(time))).collect()
    }
}

/// A process that is taken on step by step.
pub(super) struct Survival<'a> {
    pub(super) operator: &'a Operator,
    pub(super) start: &'a StartVector,
    pub(super) map_step: f64,
    pub(super) rate: f64,
    pub(super) exits: usize,
}

impl Survival<'_> {
    /// Probabilities at the times and quantiles of the shares; of each what twice as wide parts change.
    pub(super) fn at(&self, times: &Times) -> (Vec<f64>, Vec<f64>) {
        if times.looks.is_empty() {
            return (Vec::new(), Vec::new());
        }
        let parts = match times.shares.is_empty() {
            true => Vec::new(),
            false => times.parts(self.map_step),
        };
        let least = times.shares.iter().fold(0.0_f64, |a, &b| a.max(b));
        let last_time = times.at.iter().map(|at| at.0).max().unwrap_or(0);
        let mut found = vec![f64::NAN; times.times.len()];
        let mut curve = Vec::new();
        let mut weights = self.start.weights.clone();
        // After the first map step; `step` counts those behind the weights from there on.
        let (mut agreeing, mut step) = (0, 0);
        loop {
            let survival = |look: usize| -> f64 {
                let place = EXITS + self.exits + look;
                let share = match step {
                    0 => self.start.told[place],
                    _ => dot(&weights, &self.operator.told[place]),
                };
                share.clamp(0.0, 1.0)
            };
            for (found, &(whole, look)) in found.iter_mut().zip(&times.at) {
                if whole == step {
                    *found = survival(look);
                }
            }
            let before = self.map_step * step as f64;
            curve.extend(
                parts
                    .iter()
                    .map(|&(part, look)| (before + part, survival(look))),
            );
            let now = curve.last().map_or(0.0, |last: &(f64, f64)| last.1);
            let is_known = step >= last_time && (parts.is_empty() || now <= 1.0 - least);
            agreeing = if self.is_in_tail(&weights, step) {
                agreeing + 1
            } else {
                0
            };
            if is_known || agreeing >= AGREEING || step >= MOST_STEPS {
                break;
            }
            if step > 0 {
                weights = self.operator.applied_to_weights(&weights);
            }
            step += 1;
        }
        self.add_tail(&weights, step, times, &mut found);
        let tail = self.tail(&weights, step);
        let quantile = |share: &f64, stride: usize| {
            let points: Vec<(f64, f64)> = curve.iter().copied().step_by(stride).collect();
            self.quantile(&points, 1.0 - share, tail)
        };
        let quantiles = times
            .shares
            .iter()
            .map(|share| (quantile(share, 1), quantile(share, 2)));
        let (fine, coarse): (Vec<f64>, Vec<f64>) = quantiles.unzip();
        let mut doubts = vec![0.0; found.len()];
        doubts.extend(fine.iter().zip(&coarse).map(|(a, b)| (a - b).abs()));
        found.extend(fine);
        (found, doubts)
    }

    /// Whether processes end at the rate of those that have lasted long.
    fn is_in_tail(&self, weights: &[f64], step: usize) -> bool {
        if step == 0 {
            return false;
        }
        let ending = dot(weights, &self.operator.told[ENDED]);
        let lasting = self.lasting(weights);
        let rate = -(-ending / lasting).ln_1p() / self.map_step;
        (rate - self.rate).abs() <= AGREEMENT * self.rate
    }

    /// Probability that a process still goes on.
    fn lasting(&self, weights: &[f64]) -> f64 {
        let width = weights.len() / self.operator.rows();
        weights.iter().step_by(width).sum()
    }

    /// Time and probability from which on everything decays at one rate.
    fn tail(&self, weights: &[f64], step: usize) -> (f64, f64) {
        (self.map_step * step.max(1) as f64, self.lasting(weights))
    }

    fn add_tail(&self, weights: &[f64], step: usize, times: &Times, found: &mut [f64]) {
        let (from, share) = self.tail(weights, step);
        for ((found, at), time) in found.iter_mut().zip(&times.at).zip(&times.times) {
            if at.0 > step {
                *found = share * (-self.rate * (time - from)).exp();
            }
        }
    }

    /// When a probability falls below a share, between points by its logarithm.
    fn quantile(&self, points: &[(f64, f64)], share: f64, (from, left): (f64, f64)) -> f64 {
        let behind = points.iter().position(|point| point.1 <= share);
        let Some(behind) = behind else {
            let (from, left) = match points.last() {
                Some(&(time, left)) if time > from => (time, left),
                _ => (from, left),
            };
            return from + (left / share).ln() / self.rate;
        };
        let (time, after) = points[behind];
        let Some(&(start, before)) = behind.checked_sub(1).map(|place| &points[place]) else {
            return time;
        };
        let log = |value: f64| value.max(f64::MIN_POSITIVE).ln();
        let part = match after > 0.0 {
            true => (log(before) - log(share)) / (log(before) - log(after)),
            false => (before - share) / (before - after),
        };
        start + part * (time - start)
    }
}
