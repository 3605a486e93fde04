//! The times at which a process is asked whether it still goes on, and the times by which shares have ended: which
//! small models of the generator tell them.

use super::Passage;
use super::moments::Numbers;
use super::survival::Survival;

/// Times this much shorter than the mean are no longer told apart, and products of the rate and a time from which on
/// the probability that a process goes on is zero in double precision.
const EARLY: f64 = 1e-6;
const LATE: f64 = 750.0;

/// Ratio of times that one model tells.
const WIDE: f64 = 1e3;

impl Passage {
    /// The time at which about a share of the processes has ended, as if times were exponential.
    fn time_of(share: f64, mean: f64) -> f64 {
        -mean * (-share).ln_1p()
    }

    /// The times that numbers beyond the moments are of, as far as they can differ from one and from zero, in groups of
    /// neighbours: the shortest and the longest of each.
    pub(super) fn groups_of_times(&self, numbers: &Numbers) -> Vec<(f64, f64)> {
        let (mean, rate) = (numbers.values[0], numbers.values[2]);
        let quantiles = self.quantiles.iter().copied();
        let least = quantiles.clone().reduce(f64::min).into_iter();
        let of_ends = least.chain(quantiles.reduce(f64::max));
        let of_quantiles = of_ends.map(|share| Self::time_of(share, mean));
        let all = self.times.iter().copied().chain(of_quantiles);
        let inside = |time: f64| time.max(EARLY * mean).min(LATE / rate);
        let asked = all.map(inside);
        let mut asked: Vec<f64> = asked.filter(|time| *time > 0.0).collect();
        asked.sort_unstable_by(f64::total_cmp);
        let mut groups: Vec<(f64, f64)> = Vec::new();
        for time in asked {
            match groups.last_mut() {
                Some((first, last)) if time <= WIDE * *first => *last = time,
                _ => groups.push((time, time)),
            }
        }
        groups
    }

    /// Adds the probabilities and the quantiles that are asked for, by the models of groups of times.
    pub(super) fn add(&self, numbers: &mut Numbers, groups: &[(f64, f64)], models: &[Survival]) {
        let (mean, rate) = (numbers.values[0], numbers.values[2]);
        let model_for = |time: f64| {
            let after = groups.partition_point(|(first, _)| *first <= time);
            &models[after.saturating_sub(1)]
        };
        // What start and border do to the mean, as a change of the unit of time.
        let stretch = numbers.stretch;
        let probabilities = self.times.iter().map(|&time| {
            let is_over = time * rate > LATE;
            let (value, error) = match is_over {
                true => (0.0, 0.0),
                false => model_for(time).at(time),
            };
            let slope = -value * value.max(f64::MIN_POSITIVE).ln();
            (value, error + stretch * slope.max(0.0))
        });
        let quantiles = self.quantiles.iter().map(|&share| {
            let model = model_for(Self::time_of(share, mean));
            let (value, error) = model.time(1.0 - share, mean);
            (value, error + stretch * value)
        });
        for (value, error) in probabilities.chain(quantiles) {
            numbers.values.push(value);
            numbers.errors.push(error);
        }
    }
}
