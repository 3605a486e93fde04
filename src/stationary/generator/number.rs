//! The numbers that a factorisation is made of.

/// Numbers a factorisation is made of: `f64`, or `f32` at half the memory and twice the speed.
pub(super) trait Number: faer::traits::RealField + Copy + Send + Sync + 'static {
    /// Rounds a rate.
    fn from_rate(rate: f64) -> Self;
    /// Relative distance of neighbouring numbers.
    const SPACING: f64;
    /// Entries below are dropped from factors (of a matrix scaled to one): products of two would be subnormal,
    /// which hardware handles a hundred times more slowly.
    const FLOOR: Self;
    /// Exact.
    fn wide(self) -> f64;
}

impl Number for f64 {
    const SPACING: f64 = Self::EPSILON;
    const FLOOR: Self = 1e-150;

    fn from_rate(rate: f64) -> Self {
        rate
    }
    fn wide(self) -> f64 {
        self
    }
}

impl Number for f32 {
    const SPACING: f64 = Self::EPSILON as f64;
    const FLOOR: Self = 1e-18;

    fn from_rate(rate: f64) -> Self {
        rate as Self
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
}
