//! How much persistence noise alone can make, and the verdicts that follow.
//!
//! Let the true density rise along some path from cell a to a higher peak. If noise makes a a peak of persistence
//! d, that path has a cell c, no lower than a in truth, that is lower than a by d or more in the estimate: the
//! noise at a and c differs by d. For one pair that has a probability of at most the tail of its normal
//! distribution beyond d / √(s_a² + s_c²); the union bound over the cells and over the densities looked at in
//! a sweep gives the limit. (Each cell stands for one pair: pairs of a cell share its noise, and those that
//! matter are few, so a factor for them is left out.)
//!
//! Over two axes many paths lead from a, and *every one* of them must have such a cell. The saddle, on the best
//! path, then hardly adds noise of its own, and d reaches the limit for s_a alone, 1/√2 of that for a pair:
//! in the simulations of `calibration_tests` 5 % of densities have noise beyond 0.6-0.7 of the limit. A thin
//! ridge leaves few paths, hence a share in between.
//!
//! The errors come from few replicates, pooled over a window. A Student quantile allows for that.
//!
//! Where the density is no higher than at open ends of the ranges, what is there may have come from beyond them, and a
//! peak may be made of what is missing: there it has to stand out of the density at the ends. Elsewhere what is missing
//! is a small share, which changes from place to place as the density itself does and makes no peak.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::{DetectOptions, Verdict};

/// Degrees of freedom of a pooled standard error in one and two dimensions: eight replicates (7) times the
/// cells of a window (5, 25), halved because neighbours' noise is not independent after a solve.
const DEGREES_OF_FREEDOM: [f64; 2] = [17.5, 87.5];

/// Share of the limit for a pair of cells that noise reaches, over one and two axes.
const SHARE_OF_PAIR: [f64; 2] = [1.0, 0.8];

/// Persistences below this share of the maximum are rounding.
const ROUNDING: f64 = 1e-12;

/// A height of a density without noise counts from so many times its estimated error.
const SAFETY: f64 = 3.0;

/// Limits on persistence for one density.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Standard errors beyond which noise goes in no more than 1 - confidence of all sweeps.
    certain: f64,
    /// Standard errors that the largest noise of a single density reaches in every second density at most.
    typical: f64,
    /// Least persistence that counts.
    floor: f64,
    /// Least height that counts in a density without noise.
    negligible: f64,
    /// The density at open ends of the ranges.
    at_ends: f64,
}

/// What is said of a persistence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Judgement {
    pub(super) significance: f64,
    pub(super) verdict: Verdict,
}

impl Judgement {
    /// The same of a persistence that may be less than it was judged by.
    pub(super) fn in_doubt(self) -> Self {
        match self.verdict {
            Verdict::Present => Self {
                verdict: Verdict::Unresolved,
                ..self
            },
            _ => self,
        }
    }
}

impl Limits {
    /// For a density of the given number of axes, cells and maximum, one of `looks` in a sweep.
    pub(super) fn new(
        options: &DetectOptions,
        looks: usize,
        dimension: usize,
        cells: usize,
        (maximum, negligible): (f64, f64),
    ) -> Self {
        let index = dimension.clamp(1, 2) - 1;
        let (freedom, of_pair) = (DEGREES_OF_FREEDOM[index], SHARE_OF_PAIR[index]);
        let cells = cells.max(1) as f64;
        // A confidence of 1 would put the limit at infinity, one of 0 at nothing.
        let doubt = (1.0 - options.confidence).clamp(1e-9, 0.5);
        let share = |doubt: f64| -(-doubt).ln_1p() / cells;
        Self {
            certain: of_pair * student_limit(share(doubt) / looks.max(1) as f64, freedom),
            typical: of_pair * student_limit(share(0.5), freedom),
            floor: options.floor.max(ROUNDING) * maximum,
            negligible: negligible * maximum,
            at_ends: 0.0,
        }
    }

    /// The same where the density at open ends of the ranges is this.
    pub(super) fn beside_ends(self, at_ends: f64) -> Self {
        Self { at_ends, ..self }
    }

    /// What open ends of the ranges may have made of the height of one critical point over another, where the density
    /// at the higher one is `highest`: the same share of the height as of the density, and no more than the density at
    /// the ends.
    pub(super) fn error_of_ends(&self, height: f64, highest: f64) -> f64 {
        if highest > 0.0 {
            self.at_ends * (height.abs() / highest).min(1.0)
        } else {
            self.at_ends
        }
    }

    /// Judges the height of one critical point over another of a density without noise; `error` bounds what cells and
    /// reconstruction make of it.
    pub(super) fn judge_exact(&self, height: f64, error: f64) -> Judgement {
        let limit = SAFETY * error + self.negligible;
        let verdict = if height > limit {
            Verdict::Present
        } else if height > error + self.negligible {
            Verdict::Unresolved
        } else {
            Verdict::Absent
        };
        Judgement {
            significance: height / limit,
            verdict,
        }
    }

    /// Judges a persistence whose standard error is given.
    pub(super) fn judge(&self, persistence: f64, standard_error: f64) -> Judgement {
        let limit = (self.certain * standard_error).max(self.floor);
        let significance = persistence / limit;
        let verdict = if significance > 1.0 {
            Verdict::Present
        } else if persistence > (self.typical * standard_error).max(self.floor) {
            Verdict::Unresolved
        } else {
            Verdict::Absent
        };
        Judgement {
            significance,
            verdict,
        }
    }
}

/// The value that a Student variable exceeds with probability `tail` (at most one half).
fn student_limit(tail: f64, freedom: f64) -> f64 {
    // The lower tail keeps its digits where 1 - tail would round; the arguments are always valid.
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |student| {
        -student.inverse_cdf(tail.clamp(1e-18, 0.5))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::Normal;

    #[test]
    fn limits_are_quantiles_of_the_student_distribution_far_into_the_tail() {
        for freedom in DEGREES_OF_FREEDOM {
            let student = StudentsT::new(0.0, 1.0, freedom).unwrap();
            for tail in [0.3, 1e-3, 1e-6, 1e-9, 1e-12] {
                let limit = student_limit(tail, freedom);
                assert!(
                    (student.cdf(-limit) / tail - 1.0).abs() < 1e-6,
                    "{freedom} {tail} {limit}"
                );
            }
        }
    }

    #[test]
    fn many_degrees_of_freedom_give_the_normal_union_bound() {
        let normal = Normal::new(0.0, 1.0).unwrap();
        let tail = 0.05 / (2500.0 * 61.0);
        assert!((student_limit(tail, 1e6) + normal.inverse_cdf(tail)).abs() < 1e-3);
    }

    #[test]
    fn ends_leave_no_peak_that_is_as_low_as_the_density_there_and_every_one_that_is_far_higher() {
        let limits =
            Limits::new(&DetectOptions::default(), 1, 2, 100, (1.0, 0.0)).beside_ends(1e-6);
        let verdict = |height: f64, highest: f64| {
            let error = 1e-12 + limits.error_of_ends(height, highest);
            limits.judge_exact(height, error).verdict
        };
        // However deep the saddle beside it is.
        for share in [1.0, 0.1, 1e-3] {
            assert_eq!(verdict(share * 0.9e-6, 0.9e-6), Verdict::Absent);
            assert_eq!(verdict(share * 2.9e-6, 2.9e-6), Verdict::Unresolved);
            assert_eq!(verdict(share * 3.1e-6, 3.1e-6), Verdict::Present);
        }
        assert_eq!(verdict(1e-9, 0.5), Verdict::Present);
        assert_eq!(verdict(1e-9, -1e-9), Verdict::Absent);
    }

    #[test]
    fn verdicts_split_at_the_floor_the_typical_and_the_certain_limit() {
        let limits = Limits::new(&DetectOptions::default(), 61, 2, 2500, (10.0, 1e-7));
        assert!(limits.typical > 2.5 && limits.certain > limits.typical + 1.0);
        let verdict = |persistence, error| limits.judge(persistence, error).verdict;
        assert_eq!(verdict(limits.certain * 1.01, 1.0), Verdict::Present);
        assert_eq!(verdict(limits.certain * 0.99, 1.0), Verdict::Unresolved);
        assert_eq!(verdict(limits.typical * 0.99, 1.0), Verdict::Absent);
        // Without sampling only the floor (1e-3 of the maximum 10) is left.
        assert_eq!(verdict(0.0101, 0.0), Verdict::Present);
        assert_eq!(verdict(0.0099, 0.0), Verdict::Absent);
        assert!((limits.judge(0.005, 0.0).significance - 0.5).abs() < 1e-12);
        // More looks ask for more.
        let alone = Limits::new(&DetectOptions::default(), 1, 2, 2500, (10.0, 1e-7));
        assert!(alone.certain < limits.certain && alone.typical == limits.typical);
    }
}
