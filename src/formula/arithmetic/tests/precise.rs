//! Arithmetic on unevaluated sums of two doubles (Dekker 1971), about 32 digits, and slow but sure functions.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// high + low with |low| at most half a unit in the last place of high.
#[derive(Debug, Clone, Copy)]
pub(super) struct Precise {
    pub(super) high: f64,
    low: f64,
}

fn two_sum(a: f64, b: f64) -> Precise {
    let high = a + b;
    let added = high - a;
    Precise {
        high,
        low: (a - (high - added)) + (b - added),
    }
}

impl From<f64> for Precise {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Precise {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let first = two_sum(high.high, high.low + low.high);
        two_sum(first.high, first.low + low.low)
    }
}

impl Neg for Precise {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Precise {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Precise {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let low = self.high.mul_add(other.high, -high);
        two_sum(high, low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Precise {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = Self::from(self.high / other.high);
        let rest = self - first * other;
        let second = Self::from(rest.high / other.high);
        let rest = rest - second * other;
        first + second + Self::from(rest.high / other.high)
    }
}

impl Precise {
    /// The exponential: a power of two times the 2048th power of a Taylor series.
    pub(super) fn exp(x: f64) -> Self {
        Self::exp_of(Self::from(x))
    }

    fn exp_of(x: Self) -> Self {
        let k = (x.high * std::f64::consts::LOG2_E).round();
        let ln2 = Self {
            high: std::f64::consts::LN_2,
            low: 2.319_046_813_846_299_6e-17,
        };
        let scale = (libm::exp2(k * 0.5 - 0.5 * (k % 2.0)), libm::exp2(k % 2.0));
        let power = Self::exp_less_one(x - Self::from(k) * ln2) + Self::from(1.0);
        let once = power * Self::from(scale.0) * Self::from(scale.1);
        once * Self::from(scale.0)
    }

    /// e^x - 1 for a small x. It doubles as (1 + u)² - 1 = u (2 + u), which loses nothing next to x = 0.
    fn exp_less_one(x: Self) -> Self {
        let small = x * Self::from(1.0 / 2048.0);
        let mut less_one = Self::from(0.0);
        for n in (1..=20).rev() {
            less_one = (small * (Self::from(1.0) + less_one)) / Self::from(f64::from(n));
        }
        for _ in 0..11 {
            less_one = less_one * (Self::from(2.0) + less_one);
        }
        less_one
    }

    /// One Newton step from a double is enough: its error is squared.
    pub(super) fn ln(x: f64) -> Self {
        let guess = Self::from(libm::log(x));
        // Large exponents are halved, so that e^-guess neither overflows nor loses bits.
        let half = Self::exp_of(Self::from(-0.5 * guess.high));
        let ratio = (Self::from(x) * half) * half - Self::from(1.0);
        guess + ratio - ratio * ratio * Self::from(0.5)
    }

    pub(super) fn tanh(x: f64) -> Self {
        let less_one = if x.abs() < 1.0 {
            Self::exp_less_one(Self::from(2.0 * x))
        } else {
            Self::exp(2.0 * x) - Self::from(1.0)
        };
        less_one / (less_one + Self::from(2.0))
    }

    /// Sine and cosine by their Taylor series after a reduction with 135 bits of π/2.
    pub(super) fn sine_cosine(x: f64) -> (Self, Self) {
        let quarters = (x * std::f64::consts::FRAC_2_PI).round();
        let n = Self::from(quarters);
        let r = Self::from(x)
            - n * Self::from(1.570_796_326_734_125_6)
            - n * Self::from(6.077_100_506_303_966e-11)
            - n * Self::from(2.022_266_248_711_166_5e-21)
            - n * Self::from(8.478_427_660_368_9e-32);
        let series = |first: u32| {
            let mut sum = Self::from(0.0);
            for n in (0..16).map(|k| first + 2 * k).rev() {
                let next = Self::from(f64::from((n + 1) * (n + 2)));
                sum = Self::from(1.0) - r * r * sum / next;
            }
            sum
        };
        let (sine, cosine) = (r * series(1), series(0));
        match quarters.rem_euclid(4.0) as u8 {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
}
