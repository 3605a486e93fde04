//! What every operation of a formula means on numbers: one definition, shared by constant folding, evaluation at a
//! point and the lanes of a tape, so that all three agree bit for bit.
//!
//! Only +, -, ×, /, √ and integer operations occur, nothing is fused, and no mathematical library of the platform is
//! called: results are the same bits on every machine. `exp`, `log`, `sin`, `cos` and `tanh` are branch-free, so that
//! they run on vector registers; rarer functions come from the crate `libm`.

mod exponential;
mod power;
mod trigonometric;

pub(crate) use exponential::{exponential, hyperbolic_tangent, logarithm};
pub(crate) use power::{power, small_integer};
pub(crate) use trigonometric::{REDUCED, cosine, reduced_cosine, reduced_sine, sine};

/// An operation on one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unary {
    /// -x.
    Negate,
    /// |x|.
    Abs,
    /// 1 for x > 0, -1 for x < 0, x itself for the two zeros and NaN.
    Sign,
    /// 1 for x > 0, 0 for x < 0, ½ at 0: (1 + sign x)/2. NaN stays NaN.
    Step,
    /// The largest integer that is not above x.
    Floor,
    /// √x, NaN below zero.
    Sqrt,
    /// The real cube root, of negative numbers too.
    Cbrt,
    /// eˣ.
    Exp,
    /// The natural logarithm; -∞ at zero, NaN below.
    Log,
    /// The decimal logarithm.
    Log10,
    /// sin x, x in radians.
    Sin,
    /// cos x.
    Cos,
    /// tan x.
    Tan,
    /// The inverse of sin on [-1, 1].
    Asin,
    /// The inverse of cos on [-1, 1].
    Acos,
    /// The inverse of tan.
    Atan,
    /// sinh x.
    Sinh,
    /// cosh x.
    Cosh,
    /// tanh x.
    Tanh,
}

/// An operation on two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Binary {
    /// a + b.
    Add,
    /// a - b.
    Subtract,
    /// a b.
    Multiply,
    /// a / b.
    Divide,
    /// aᵇ: repeated multiplication for integers b, √a for b = ½.
    Power,
    /// The smaller of both, NaN if either is.
    Min,
    /// The larger of both, NaN if either is.
    Max,
    /// √(a² + b²) without overflow on the way.
    Hypot,
    /// The angle of the point (b, a): atan2(y, x).
    Atan2,
    /// 1 if a < b, else 0.
    Less,
    /// 1 if a ≤ b, else 0.
    LessOrEqual,
    /// 1 if a = b, else 0.
    Equal,
    /// 0 if a = b, else 1.
    NotEqual,
}

impl Unary {
    /// The operation's value.
    #[inline(always)]
    pub fn apply(self, x: f64) -> f64 {
        match self {
            Self::Negate => -x,
            Self::Abs => x.abs(),
            Self::Sign => sign(x),
            Self::Step => step(x),
            Self::Floor => libm::floor(x),
            Self::Sqrt => x.sqrt(),
            Self::Cbrt => libm::cbrt(x),
            Self::Exp => exponential(x),
            Self::Log => logarithm(x),
            Self::Log10 => libm::log10(x),
            Self::Sin => sine(x),
            Self::Cos => cosine(x),
            Self::Tan => libm::tan(x),
            Self::Asin => libm::asin(x),
            Self::Acos => libm::acos(x),
            Self::Atan => libm::atan(x),
            Self::Sinh => libm::sinh(x),
            Self::Cosh => libm::cosh(x),
            Self::Tanh => hyperbolic_tangent(x),
        }
    }

    /// Whether f(-x) = -f(x), bit for bit.
    pub(crate) fn is_odd(self) -> bool {
        matches!(
            self,
            Self::Sign
                | Self::Cbrt
                | Self::Sin
                | Self::Tan
                | Self::Asin
                | Self::Atan
                | Self::Sinh
                | Self::Tanh
        )
    }

    /// Whether f(-x) = f(x), bit for bit.
    pub(crate) fn is_even(self) -> bool {
        matches!(self, Self::Abs | Self::Cos | Self::Cosh)
    }
}

impl Binary {
    /// The operation's value.
    #[inline(always)]
    pub fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => power(a, b),
            Self::Min => smaller(a, b),
            Self::Max => larger(a, b),
            Self::Hypot => libm::hypot(a, b),
            Self::Atan2 => libm::atan2(a, b),
            Self::Less => truth(a < b),
            Self::LessOrEqual => truth(a <= b),
            Self::Equal => truth(a == b),
            Self::NotEqual => truth(a != b),
        }
    }

    /// Whether the value is always 0 or 1.
    pub(crate) fn is_comparison(self) -> bool {
        matches!(
            self,
            Self::Less | Self::LessOrEqual | Self::Equal | Self::NotEqual
        )
    }

    /// Whether the operands may be exchanged, bit for bit.
    pub(crate) fn is_commutative(self) -> bool {
        matches!(
            self,
            Self::Add | Self::Multiply | Self::Equal | Self::NotEqual
        )
    }
}

/// `yes` if the condition is not zero, `no` if it is zero, NaN if it is NaN.
#[inline(always)]
pub(crate) fn select(condition: f64, yes: f64, no: f64) -> f64 {
    if condition == 0.0 {
        no
    } else if condition.is_nan() {
        condition
    } else {
        yes
    }
}

#[inline(always)]
fn truth(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

/// Written with one comparison, which vector registers do well.
#[inline(always)]
pub(crate) fn sign(x: f64) -> f64 {
    if x.abs() > 0.0 {
        1.0_f64.copysign(x)
    } else {
        x
    }
}

#[inline(always)]
pub(crate) fn step(x: f64) -> f64 {
    0.5 + 0.5 * sign(x)
}

#[inline(always)]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    let chosen = if b < a { b } else { a };
    if b.is_nan() { b } else { chosen }
}

#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    let chosen = if b > a { b } else { a };
    if b.is_nan() { b } else { chosen }
}

#[cfg(test)]
mod tests;
