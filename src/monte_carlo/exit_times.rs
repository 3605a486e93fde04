//! What the times of paths say: mean, deviation, rate, probabilities and quantiles, with the errors of sampling and of
//! the time step.
//!
//! Paths that had not ended when they were given up are known to last longer: their times beyond that are taken for
//! exponential, with the rate of those that have lasted long.

use crate::numerics::jackknife;

/// Exits in each of the two parts of a tail, at least.
const FEWEST: usize = 32;

/// Standard errors by which the rates of the two parts may differ.
const LIKE: f64 = 2.0;

/// Times of a block of paths.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block {
    /// Of each path with the step, and with half of it; infinite where it did not end.
    pub(super) times: Vec<[f64; 2]>,
    /// Which part of the region they entered.
    pub(super) exits: Vec<[usize; 2]>,
    pub(super) runaways: usize,
    pub(super) steps: u64,
}

impl Block {
    pub(super) fn new(paths: usize) -> Self {
        Self {
            times: vec![[f64::INFINITY; 2]; paths],
            exits: vec![[0; 2]; paths],
            runaways: 0,
            steps: 0,
        }
    }
}

/// When paths entered a region.
#[derive(Debug, Clone, PartialEq)]
pub struct ExitTimes {
    blocks: Vec<Block>,
    longest: f64,
    /// Parts of the region.
    parts: usize,
}

/// A number that times of paths say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExitNumber {
    /// With half of the time step.
    pub value: f64,
    /// Its standard error by the paths.
    pub sampling: f64,
    /// What the whole step changes, with the standard error of that.
    pub step: (f64, f64),
}

impl ExitNumber {
    /// Standard error: of sampling, and what the whole step changes, as the root of the sum of squares.
    pub fn error(&self) -> f64 {
        self.sampling.hypot(self.step.0)
    }

    /// Whether the time step certainly changes more than half of the error of sampling.
    pub(crate) fn is_biased(&self) -> bool {
        let (shift, error) = self.step;
        shift.abs() - 2.0 * error > 0.5 * self.sampling
    }
}

impl ExitTimes {
    pub(super) fn new(blocks: Vec<Block>, longest: f64, parts: usize) -> Self {
        Self {
            blocks,
            longest,
            parts,
        }
    }

    /// Number of paths.
    pub fn paths(&self) -> usize {
        self.blocks.iter().map(|block| block.times.len()).sum()
    }

    /// Paths that entered the region.
    pub fn exits(&self) -> usize {
        let times = self.blocks.iter().flat_map(|block| &block.times);
        times.filter(|[_, fine]| fine.is_finite()).count()
    }

    /// Paths that ran away without.
    pub fn runaways(&self) -> usize {
        self.blocks.iter().map(|block| block.runaways).sum()
    }

    /// Integrator steps of all paths.
    pub(crate) fn steps(&self) -> u64 {
        self.blocks.iter().map(|block| block.steps).sum()
    }

    /// Time at which paths were given up.
    pub(crate) fn longest(&self) -> f64 {
        self.longest
    }

    /// Times of the paths with the step (0) or half of it (1), all blocks but one, ascending.
    fn sorted(&self, with: usize, without: Option<usize>) -> Vec<f64> {
        let blocks = self.blocks.iter().enumerate();
        let blocks = blocks.filter(|(number, _)| Some(*number) != without);
        let times = blocks.flat_map(|(_, block)| block.times.iter().map(|pair| pair[with]));
        let mut times: Vec<f64> = times.collect();
        times.sort_unstable_by(f64::total_cmp);
        times
    }

    /// How many paths entered each part of the region, with the step (0) or half of it (1), all blocks but one.
    fn entered(&self, with: usize, without: Option<usize>) -> Vec<usize> {
        let mut counts = vec![0; self.parts];
        let blocks = self.blocks.iter().enumerate();
        for (_, block) in blocks.filter(|(number, _)| Some(*number) != without) {
            for (times, exits) in block.times.iter().zip(&block.exits) {
                let part = counts
                    .get_mut(exits[with])
                    .filter(|_| times[with].is_finite());
                part.into_iter().for_each(|count| *count += 1);
            }
        }
        counts
    }

    /// Mean, standard deviation and rate, the shares of those that ended in each part of the region, the
    /// probabilities to go on at some times, and the times by which shares of the paths have ended, in this order.
    /// Not finite where too few paths have ended.
    ///
    /// The error of sampling is that of a delete-a-block jackknife over 32 blocks of paths; of probabilities and
    /// quantiles at least the binomial one.
    pub fn numbers(&self, times: &[f64], shares: &[f64]) -> Vec<ExitNumber> {
        let sample = |with, without| Sample {
            times: self.sorted(with, without),
            entered: self.entered(with, without),
            longest: self.longest,
        };
        let all = sample(1, None);
        let tail = all.tail();
        let of = |sample: &Sample| sample.numbers(tail, times, shares);
        let values = of(&all);
        let shifts = differences(&of(&sample(0, None)), &values);
        let left_out = (0..self.blocks.len()).map(|block| {
            let fine = of(&sample(1, Some(block)));
            let shifts = differences(&of(&sample(0, Some(block))), &fine);
            (fine, shifts)
        });
        let (fine, shifted): (Vec<_>, Vec<_>) = left_out.unzip();
        let least = all.binomial(times, shares);
        let numbers = values.iter().zip(&shifts).zip(least).enumerate();
        let number =
            |(index, ((&value, &shift), least)): (usize, ((&f64, &f64), f64))| ExitNumber {
                value,
                sampling: jackknife(fine.iter().map(|numbers| numbers[index])).max(least),
                step: (
                    shift,
                    jackknife(shifted.iter().map(|numbers| numbers[index])),
                ),
            };
        numbers.map(number).collect()
    }
}

pub(super) fn differences(one: &[f64], other: &[f64]) -> Vec<f64> {
    one.iter().zip(other).map(|(a, b)| a - b).collect()
}

/// Times, ascending, those of paths that were given up infinite.
struct Sample {
    times: Vec<f64>,
    /// Of those that ended, by the part of the region.
    entered: Vec<usize>,
    longest: f64,
}

impl Sample {
    fn exits(&self) -> usize {
        self.times.partition_point(|time| time.is_finite())
    }

    /// Time that all paths spent between two times.
    fn at_risk(&self, from: f64, to: f64) -> f64 {
        let spent = |time: &f64| (time.min(to) - from).max(0.0);
        self.times.iter().map(spent).sum()
    }

    /// Exits after a time over the time at risk after it: the most likely rate of an exponential tail.
    fn rate(&self, from: f64) -> f64 {
        let before = self.times.partition_point(|&time| time <= from);
        (self.exits() - before) as f64 / self.at_risk(from, self.longest)
    }

    /// Where the tail begins. Of the exits after a time, the first and the second half have a rate each; where the two
    /// agree within their errors twice in a row, the second half of the first time is the tail, and else the question
    /// is asked of the second half again. What decays faster has decayed more in the second half than in the first,
    /// where it could no longer be seen; a rate that rises first and falls then may agree once by chance.
    fn tail(&self) -> f64 {
        let exits = self.exits();
        let (mut first, mut from) = (0, 0.0);
        let mut agreed: Option<f64> = None;
        while exits - first >= 2 * FEWEST {
            let middle = first + (exits - first) / 2;
            let at = self.times[middle - 1];
            let counts = [(middle - first) as f64, (exits - middle) as f64];
            let early = counts[0] / self.at_risk(from, at);
            let late = counts[1] / self.at_risk(at, self.longest);
            let error = (1.0 / counts[0] + 1.0 / counts[1]).sqrt();
            (first, from) = (middle, at);
            agreed = match ((early / late).ln().abs() <= LIKE * error, agreed) {
                (true, Some(tail)) => return tail,
                (true, None) => Some(at),
                (false, _) => None,
            };
        }
        agreed.unwrap_or(from)
    }

    fn numbers(&self, tail: f64, times: &[f64], shares: &[f64]) -> Vec<f64> {
        let (count, exits, longest) = (self.times.len() as f64, self.exits(), self.longest);
        let rate = self.rate(tail);
        let left = 1.0 - exits as f64 / count;
        let ended = &self.times[..exits];
        let mut mean = ended.iter().sum::<f64>() / count;
        let mut square = ended.iter().map(|time| time * time).sum::<f64>() / count;
        if left > 0.0 {
            mean += left * (longest + 1.0 / rate);
            square += left * ((longest + 1.0 / rate).powi(2) + 1.0 / (rate * rate));
        }
        let survival = times.iter().map(|&time| {
            if time <= longest {
                1.0 - self.times.partition_point(|&end| end <= time) as f64 / count
            } else {
                left * (-rate * (time - longest)).exp()
            }
        });
        let quantile = |&share: &f64| {
            if share * count + 0.5 <= exits as f64 {
                self.ranked(share * count)
            } else {
                longest + (left / (1.0 - share)).ln() / rate
            }
        };
        let moments = [mean, (square - mean * mean).max(0.0).sqrt(), rate];
        let entered = self
            .entered
            .iter()
            .map(|&paths| paths as f64 / exits as f64);
        let numbers = moments.into_iter().chain(entered).chain(survival);
        numbers.chain(shares.iter().map(quantile)).collect()
    }

    /// The time of a rank, between two times by its fraction; ranks begin at half a path.
    fn ranked(&self, rank: f64) -> f64 {
        let last = self.times.len().saturating_sub(1) as f64;
        let rank = (rank - 0.5).clamp(0.0, last);
        let time = |rank: f64| self.times.get(rank as usize).copied();
        let (Some(low), Some(high)) = (time(rank.floor()), time(rank.ceil())) else {
            return f64::NAN;
        };
        if rank.fract() == 0.0 {
            low
        } else {
            low + rank.fract() * (high - low)
        }
    }

    /// The least error of each number: none of moments, of probabilities and quantiles that of independent paths.
    fn binomial(&self, times: &[f64], shares: &[f64]) -> Vec<f64> {
        let count = self.times.len() as f64;
        let survival = times.iter().map(|time| {
            let ended = self.times.partition_point(|end| end <= time) as f64;
            let share = (ended + 0.5) / (count + 1.0);
            (share * (1.0 - share) / count).sqrt()
        });
        let quantile = shares.iter().map(|share| {
            let (rank, spread) = (share * count, (count * share * (1.0 - share)).sqrt());
            let between = self.ranked(rank + spread) - self.ranked(rank - spread);
            if between.is_finite() {
                0.5 * between
            } else {
                0.0
            }
        });
        let exits = self.exits() as f64;
        let entered = self.entered.iter().map(|&paths| {
            let share = (paths as f64 + 0.5) / (exits + 1.0);
            (share * (1.0 - share) / exits).sqrt()
        });
        [0.0; 3]
            .into_iter()
            .chain(entered)
            .chain(survival)
            .chain(quantile)
            .collect()
    }
}
