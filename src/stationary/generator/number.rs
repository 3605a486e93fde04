//! The numbers that a factorisation is made of.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, Sub, SubAssign};

use faer::c32;
use nalgebra::Complex;

/// Numbers a factorisation is made of: `f64`, or `f32` at half the memory and twice the speed; `c32` of complex
/// matrices.
pub(super) trait Number: faer::traits::ComplexField + Copy + Send + Sync + 'static {
    /// What vectors are made of: the same in double precision.
    type Wide: Wide;
    /// Relative distance of neighbouring numbers.
    const SPACING: f64;
    /// Rounds a rate.
    fn from_rate(rate: Self::Wide) -> Self;
    /// Zero in place of a part below a floor, of entries of factors (of a matrix scaled to one): products of two would
    /// be subnormal, which hardware handles a hundred times more slowly.
    fn floored(self) -> Self;
    /// Exact.
    fn wide(self) -> Self::Wide;

    /// Rounds a real number.
    #[inline]
    fn from_real(real: f64) -> Self {
        Self::from_rate(real.into())
    }
}

/// A number of a vector.
pub(super) trait Wide:
    Copy
    + Default
    + Send
    + Sync
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + DivAssign
    + Sum
{
    /// Its larger part, without a sign.
    fn size(self) -> f64;
}

impl Wide for f64 {
    #[inline]
    fn size(self) -> f64 {
        self.abs()
    }
}

impl Wide for Complex<f64> {
    #[inline]
    fn size(self) -> f64 {
        self.re.abs().max(self.im.abs())
    }
}

impl Number for f64 {
    type Wide = Self;
    const SPACING: f64 = Self::EPSILON;

    #[inline]
    fn from_rate(rate: f64) -> Self {
        rate
    }
    #[inline]
    fn floored(self) -> Self {
        const FLOOR: f64 = 1e-150;
        let small = self < FLOOR && self > -FLOOR;
        if small { 0.0 } else { self }
    }
    #[inline]
    fn wide(self) -> f64 {
        self
    }
}

impl Number for f32 {
    type Wide = f64;
    const SPACING: f64 = Self::EPSILON as f64;

    #[inline]
    fn from_rate(rate: f64) -> Self {
        rate as Self
    }
    #[inline]
    fn floored(self) -> Self {
        const FLOOR: f32 = 1e-18;
        let small = self < FLOOR && self > -FLOOR;
        if small { 0.0 } else { self }
    }
    #[inline]
    fn wide(self) -> f64 {
        f64::from(self)
    }
}

impl Number for c32 {
    type Wide = Complex<f64>;
    const SPACING: f64 = f32::EPSILON as f64;

    #[inline]
    fn from_rate(rate: Complex<f64>) -> Self {
        Self::new(rate.re as f32, rate.im as f32)
    }
    #[inline]
    fn floored(self) -> Self {
        Self::new(self.re.floored(), self.im.floored())
    }
    #[inline]
    fn wide(self) -> Complex<f64> {
        Complex::new(f64::from(self.re), f64::from(self.im))
    }
}
