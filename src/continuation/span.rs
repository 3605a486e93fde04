//! The part of a path that a sweep goes along, and how finely.

use super::Subject;

/// Evenly spaced values (at least 2), both ends exact. Weights are whole numbers and values are rounded to 15 digits,
/// so that round values between (0, or -0.01, between -0.02 and 0.01) come out as people write them.
pub fn evenly_spaced((from, to): (f64, f64), points: usize) -> Vec<f64> {
    let steps = points.max(2) - 1;
    let value = |index: usize| match index {
        0 => from,
        index if index == steps => to,
        index => {
            let value = (from * (steps - index) as f64 + to * index as f64) / steps as f64;
            format!("{value:.14e}").parse().unwrap_or(value)
        }
    };
    (0..=steps).map(value).collect()
}

/// Parts of a step into which a short stretch is cut at most.
const MOST_FINER: usize = 16;

/// Share of a step from the end of a stretch within which no further value is solved.
const NEAREST: f64 = 0.25;

/// Between the ends of a path, in steps of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    lower: f64,
    upper: f64,
    /// Distance between neighbouring given values.
    pub(super) step: f64,
}

impl Span {
    /// Of a sweep with that many given values.
    pub(super) fn new(subject: &Subject, points: usize) -> Self {
        let (lower, upper) = subject.family.range();
        Self::over([lower, upper], points)
    }

    /// Of a stretch with that many given values.
    pub(super) fn over([lower, upper]: [f64; 2], points: usize) -> Self {
        Self {
            lower,
            upper,
            step: (upper - lower) / (points.max(2) - 1) as f64,
        }
    }

    /// The ends of a stretch and the given values inside it, with so many values between them that there are as many as
    /// wanted at least. Values of stretches that overlap are the same.
    pub(super) fn values_within(&self, stretch: [f64; 2], least: usize) -> Vec<f64> {
        let [from, to] = stretch;
        let steps = (self.length() / self.step).round().max(1.0) as usize;
        let mut finer = 1;
        while (to - from) / self.step * (finer as f64) < (least as f64) - 1.5 && finer < MOST_FINER
        {
            finer *= 2;
        }
        let step = self.step / finer as f64;
        let values = evenly_spaced((self.lower, self.upper), steps * finer + 1);
        let apart = |value: f64| (value - from).min(to - value) >= NEAREST * step;
        let inside = values.into_iter().filter(|value| apart(*value));
        [from].into_iter().chain(inside).chain([to]).collect()
    }

    /// Distance between the ends.
    pub(super) fn length(&self) -> f64 {
        self.upper - self.lower
    }

    /// The value between the ends, or the end, that is nearest to a value.
    pub(super) fn nearest(&self, value: f64) -> f64 {
        value.clamp(self.lower, self.upper)
    }

    /// Whether a value lies between the ends or is one of them.
    pub(super) fn contains(&self, value: f64) -> bool {
        (self.lower..=self.upper).contains(&value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_that_overlap_have_their_values_in_common() {
        let span = Span::over([0.0, 2.0], 21);
        let long = span.values_within([0.2, 1.7], 5);
        assert_eq!((long.len(), long[0], long[15]), (16, 0.2, 1.7));
        let short = span.values_within([0.5, 1.1], 5);
        assert!(short.iter().all(|value| long.contains(value)), "{short:?}");
        // A stretch of two steps is cut into four.
        let finer = span.values_within([0.5, 0.7], 5);
        assert_eq!(finer, [0.5, 0.55, 0.6, 0.65, 0.7]);
        // Its ends may be values between.
        let between = span.values_within([0.46, 1.0], 5);
        assert_eq!((between[0], between[1]), (0.46, 0.5));
    }
}
