//! Operations on numbers, carried out where the result is exact.
//!
//! `2 + 3` and `1/2` become numbers, `1/3` and `sqrt(2)` stay as they are written: a tape works them out once, with
//! the same bits, and a printed formula still says what was meant; for the same reason `2 pi` stays as it is.
//! Infinities and NaN never become numbers.

use crate::formula::arithmetic::{Binary, Unary, small_integer};

/// Largest integer below which every integer is a double.
const INTEGERS: f64 = 9_007_199_254_740_992.0;

/// Whether a number has a name of its own.
fn is_named(value: f64) -> bool {
    value == std::f64::consts::PI || value == std::f64::consts::E
}

/// The value of an operation on one number, if it is exact.
pub(super) fn unary(operation: Unary, x: f64) -> Option<f64> {
    if is_named(x) {
        return None;
    }
    let value = operation.apply(x);
    let exact = match operation {
        Unary::Negate | Unary::Abs | Unary::Sign | Unary::Step | Unary::Floor => true,
        Unary::Sqrt => value.mul_add(value, -x) == 0.0,
        Unary::Cbrt => value.abs() < 1e5 && value.fract() == 0.0 && value * value * value == x,
        Unary::Log | Unary::Log10 | Unary::Acos => x == 1.0 && value == 0.0,
        Unary::Exp | Unary::Cos | Unary::Cosh => x == 0.0 && value == 1.0,
        Unary::Sin | Unary::Tan | Unary::Asin | Unary::Atan | Unary::Sinh | Unary::Tanh => {
            x == 0.0 && value == 0.0
        }
    };
    (exact && value.is_finite()).then_some(value)
}

/// The value of an operation on two numbers, if it is exact.
pub(super) fn binary(operation: Binary, a: f64, b: f64) -> Option<f64> {
    if is_named(a) || is_named(b) {
        return None;
    }
    let value = operation.apply(a, b);
    let exact = match operation {
        Binary::Add => sum_is_exact(a, b),
        Binary::Subtract => sum_is_exact(a, -b),
        Binary::Multiply => {
            (value.is_normal() && a.mul_add(b, -value) == 0.0) || a == 0.0 || b == 0.0
        }
        Binary::Divide => (value.is_normal() && value.mul_add(b, -a) == 0.0) || a == 0.0,
        Binary::Power => power_is_exact(a, b, value),
        Binary::Min | Binary::Max => true,
        Binary::Hypot | Binary::Atan2 => false,
        _ => true,
    };
    (exact && value.is_finite()).then_some(value)
}

fn sum_is_exact(a: f64, b: f64) -> bool {
    let sum = a + b;
    let added = sum - a;
    (a - (sum - added)) + (b - added) == 0.0
}

/// Integers to the power of natural numbers, as long as all products on the way are exact.
fn power_is_exact(a: f64, b: f64, value: f64) -> bool {
    let natural = small_integer(b).is_some_and(|n| n >= 0);
    natural && a.fract() == 0.0 && value.abs() < INTEGERS
}
