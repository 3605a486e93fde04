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
