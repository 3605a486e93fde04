//! Intervals that surely contain all values of an operation, rounded outward.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::formula::arithmetic::{Binary, Unary};

/// All numbers from `low` to `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// Every number.
    pub const ALL: Self = Self {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    /// The interval between two ends in any order; every number if one is NaN.
    pub fn new(one: f64, other: f64) -> Self {
        if one.is_nan() || other.is_nan() {
            return Self::ALL;
        }
        Self {
            low: one.min(other),
            high: one.max(other),
        }
    }

    /// One number.
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// Whether a number is in it.
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// high - low.
    pub(crate) fn width(self) -> f64 {
        self.high - self.low
    }

    /// The middle, and a finite number of it where it is unbounded.
    pub(crate) fn middle(self) -> f64 {
        match (self.low.is_finite(), self.high.is_finite()) {
            (true, true) => self.low + 0.5 * (self.high - self.low),
            (true, false) => self.low.max(0.0),
            (false, true) => self.high.min(0.0),
            (false, false) => 0.0,
        }
    }

    /// Whether both ends are finite.
    pub(crate) fn is_bounded(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// The smallest interval with both.
    pub(super) fn join(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Widened by the rounding of an operation that is accurate to a few units in the last place.
    fn round_outward(self) -> Self {
        let (mut low, mut high) = (self.low, self.high);
        for _ in 0..3 {
            (low, high) = (low.next_down(), high.next_up());
        }
        Self { low, high }
    }

    fn of(ends: &[f64]) -> Self {
        if ends.iter().any(|end| end.is_nan()) {
            return Self::ALL;
        }
        let low = ends.iter().copied().fold(f64::INFINITY, f64::min);
        let high = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { low, high }
    }

    /// The part in which a function is defined; `None` if there is none.
    fn clip(self, low: f64, high: f64) -> Option<Self> {
        let clipped = Self {
            low: self.low.max(low),
            high: self.high.min(high),
        };
        (clipped.low <= clipped.high).then_some(clipped)
    }

    fn abs(self) -> Self {
        if self.contains(0.0) {
            Self {
                low: 0.0,
                high: self.high.max(-self.low),
            }
        } else {
            Self::new(self.low.abs(), self.high.abs())
        }
    }

    /// Values of a function that grows everywhere.
    fn growing(self, f: impl Fn(f64) -> f64) -> Self {
        Self::new(f(self.low), f(self.high)).round_outward()
    }

    /// All values of an operation on one number of this interval where it is defined.
    pub(super) fn unary(self, operation: Unary) -> Self {
        let apply = |x: f64| operation.apply(x);
        match operation {
            Unary::Negate => Self {
                low: -self.high,
                high: -self.low,
            },
            Unary::Abs => self.abs(),
            Unary::Sign | Unary::Step | Unary::Floor => {
                Self::new(apply(self.low), apply(self.high))
            }
            Unary::Cbrt | Unary::Exp | Unary::Atan | Unary::Sinh | Unary::Tanh => {
                let values = self.growing(apply);
                if operation == Unary::Exp {
                    Self {
                        low: values.low.max(0.0),
                        ..values
                    }
                } else {
                    values
                }
            }
            Unary::Cosh => {
                let values = self.abs().growing(apply);
                Self {
                    low: values.low.max(1.0),
                    ..values
                }
            }
            Unary::Sqrt => {
                let defined = self.clip(0.0, f64::INFINITY);
                let values = defined.map_or(Self::ALL, |defined| defined.growing(apply));
                Self {
                    low: values.low.max(0.0),
                    ..values
                }
            }
            Unary::Log | Unary::Log10 => {
                let defined = self.clip(0.0, f64::INFINITY);
                defined.map_or(Self::ALL, |defined| defined.growing(apply))
            }
            Unary::Asin => {
                let defined = self.clip(-1.0, 1.0);
                defined.map_or(Self::ALL, |defined| defined.growing(apply))
            }
            Unary::Acos => {
                let defined = self.clip(-1.0, 1.0);
                let values =
                    defined.map(|defined| Self::new(apply(defined.low), apply(defined.high)));
                values.map_or(Self::ALL, Self::round_outward)
            }
            Unary::Sin => self.periodic(FRAC_PI_2, apply),
            Unary::Cos => self.periodic(0.0, apply),
            Unary::Tan => {
                let branch = |x: f64| ((x + FRAC_PI_2) / PI).floor();
                let one = self.is_bounded()
                    && self.high.abs().max(self.low.abs()) < 1e9
                    && branch(self.low - 1e-9) == branch(self.high + 1e-9);
                if one { self.growing(apply) } else { Self::ALL }
            }
        }
    }

    /// Values of a sine whose maxima are at `peak` + 2πn.
    fn periodic(self, peak: f64, f: impl Fn(f64) -> f64) -> Self {
        let all = Self {
            low: -1.0,
            high: 1.0,
        };
        if !self.is_bounded() || self.low.abs().max(self.high.abs()) > 1e9 || self.width() >= TAU {
            return all;
        }
        // A little wider, so that a peak next to an end is not missed by rounding.
        let has = |at: f64| {
            let turns = |x: f64| (x - at) / TAU;
            turns(self.low - 1e-6).ceil() <= turns(self.high + 1e-6).floor()
        };
        let ends = Self::new(f(self.low), f(self.high)).round_outward();
        let low = if has(peak + PI) {
            -1.0
        } else {
            ends.low.max(-1.0)
        };
        let high = if has(peak) { 1.0 } else { ends.high.min(1.0) };
        Self { low, high }
    }

    /// All values of an operation on two numbers of two intervals where it is defined.
    pub(super) fn binary(self, operation: Binary, other: Self) -> Self {
        let (a, b) = (self, other);
        let apply = |a: f64, b: f64| operation.apply(a, b);
        match operation {
            Binary::Add => Self {
                low: a.low + b.low,
                high: a.high + b.high,
            }
            .round_sum(),
            Binary::Subtract => Self {
                low: a.low - b.high,
                high: a.high - b.low,
            }
            .round_sum(),
            Binary::Multiply => {
                // Zero times an end that is infinite is zero: infinity stands for arbitrarily large numbers.
                let times = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
                let ends = [
                    times(a.low, b.low),
                    times(a.low, b.high),
                    times(a.high, b.low),
                    times(a.high, b.high),
                ];
                Self::of(&ends).round_outward()
            }
            Binary::Divide => {
                if b.contains(0.0) {
                    return Self::ALL;
                }
                let over = |a: f64, b: f64| if b.is_infinite() { 0.0 } else { a / b };
                let ends = [
                    over(a.low, b.low),
                    over(a.low, b.high),
                    over(a.high, b.low),
                    over(a.high, b.high),
                ];
                Self::of(&ends).round_outward()
            }
            Binary::Power => a.power(b),
            Binary::Min | Binary::Max => Self {
                low: apply(a.low, b.low),
                high: apply(a.high, b.high),
            },
            Binary::Hypot => {
                let (a, b) = (a.abs(), b.abs());
                Self {
                    low: apply(a.low, b.low),
                    high: apply(a.high, b.high),
                }
                .round_outward()
            }
            Binary::Atan2 => Self { low: -PI, high: PI }.round_outward(),
            Binary::Less | Binary::LessOrEqual | Binary::Equal | Binary::NotEqual => {
                let (sure, never) = match operation {
                    Binary::Less => (a.high < b.low, a.low >= b.high),
                    Binary::LessOrEqual => (a.high <= b.low, a.low > b.high),
                    _ => {
                        let apart = a.high < b.low || b.high < a.low;
                        let same = a.low == a.high && a == b;
                        if operation == Binary::Equal {
                            (same, apart)
                        } else {
                            (apart, same)
                        }
                    }
                };
                Self {
                    low: if sure { 1.0 } else { 0.0 },
                    high: if never { 0.0 } else { 1.0 },
                }
            }
        }
    }

    fn round_sum(self) -> Self {
        if self.low.is_nan() || self.high.is_nan() {
            return Self::ALL;
        }
        Self {
            low: self.low.next_down(),
            high: self.high.next_up(),
        }
    }

    fn power(self, exponent: Self) -> Self {
        let apply = |a: f64, b: f64| Binary::Power.apply(a, b);
        let fixed = (exponent.low == exponent.high).then_some(exponent.low);
        if let Some(n) = fixed.filter(|n| n.fract() == 0.0) {
            if n < 0.0 {
                let positive = self.power(Self::point(-n));
                return Self::point(1.0).binary(Binary::Divide, positive);
            }
            if n % 2.0 == 0.0 {
                let values = self.abs().wide_growing(|x| apply(x, n));
                return Self {
                    low: values.low.max(0.0),
                    ..values
                };
            }
            return self.wide_growing(|x| apply(x, n));
        }
        // For a positive base the power grows or falls in each of both: its extremes are at the corners.
        let Some(base) = self.clip(0.0, f64::INFINITY) else {
            return Self::ALL;
        };
        let corners = [
            apply(base.low, exponent.low),
            apply(base.low, exponent.high),
            apply(base.high, exponent.low),
            apply(base.high, exponent.high),
        ];
        let values = Self::of(&corners).round_outward();
        // 0⁰ = 1 beside 0ᵇ = 0.
        let values = if base.low == 0.0 {
            values.join(Self::point(0.0))
        } else {
            values
        };
        Self {
            low: values.low.max(0.0),
            ..values
        }
    }

    /// As [`Interval::growing`], for the many roundings of a repeated multiplication.
    fn wide_growing(self, f: impl Fn(f64) -> f64) -> Self {
        let values = Self::new(f(self.low), f(self.high));
        let widen = |x: f64| 64.0 * f64::EPSILON * x.abs();
        Self {
            low: values.low - widen(values.low),
            high: values.high + widen(values.high),
        }
    }
}
