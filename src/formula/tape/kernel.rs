//! Loops over the lanes. Everything here is inlined into the functions of `run` that are compiled for each instruction
//! set, and rounds every operation on its own.

use super::instruction::{Factor, Signs};
use crate::formula::Lanes;
use crate::formula::arithmetic::{self, Binary, Unary};

/// An operand in one lane.
pub(super) trait Lane: Copy {
    /// Its value.
    fn at(self, lane: usize) -> f64;
}

/// A number in each lane.
#[derive(Clone, Copy)]
pub(super) struct Each<'a>(pub(super) &'a Lanes);

impl Lane for Each<'_> {
    #[inline(always)]
    fn at(self, lane: usize) -> f64 {
        self.0[lane]
    }
}

/// One number for all lanes.
#[derive(Clone, Copy)]
pub(super) struct All(pub(super) f64);

impl Lane for All {
    #[inline(always)]
    fn at(self, _lane: usize) -> f64 {
        self.0
    }
}

/// Lanes that are worked on together by [`polynomial`].
const BLOCK: usize = 16;

/// Writes f(lane) to every lane.
#[inline(always)]
pub(super) fn write(target: &mut Lanes, f: impl Fn(usize) -> f64) {
    for (lane, value) in target.iter_mut().enumerate() {
        *value = f(lane);
    }
}

/// An operation on one number in every lane.
#[inline(always)]
pub(super) fn unary(operation: Unary, target: &mut Lanes, a: &Lanes) {
    // Not by a closure: the larger functions would not be inlined into it, and then not vectorised.
    macro_rules! each {
        ($f:expr) => {
            for (value, &x) in target.iter_mut().zip(a) {
                *value = $f(x);
            }
        };
    }
    match operation {
        Unary::Negate => each!(std::ops::Neg::neg),
        Unary::Abs => each!(f64::abs),
        Unary::Sign => each!(arithmetic::sign),
        Unary::Step => each!(arithmetic::step),
        Unary::Sqrt => each!(f64::sqrt),
        Unary::Exp => each!(arithmetic::exponential),
        Unary::Log => each!(arithmetic::logarithm),
        Unary::Tanh => each!(arithmetic::hyperbolic_tangent),
        Unary::Sin => {
            each!(arithmetic::reduced_sine);
            patch(target, a, arithmetic::sine);
        }
        Unary::Cos => {
            each!(arithmetic::reduced_cosine);
            patch(target, a, arithmetic::cosine);
        }
        Unary::Floor
        | Unary::Cbrt
        | Unary::Log10
        | Unary::Tan
        | Unary::Asin
        | Unary::Acos
        | Unary::Atan
        | Unary::Sinh
        | Unary::Cosh => one_by_one(operation, target, a),
    }
}

/// Works out again the lanes whose argument is too large for the fast reduction.
#[inline(always)]
fn patch(target: &mut Lanes, a: &Lanes, f: impl Fn(f64) -> f64) {
    // Counted rather than searched for, which vector registers do well; NaN stays what it is.
    let large = a.iter().filter(|x| x.abs() > arithmetic::REDUCED).count();
    if large == 0 {
        return;
    }
    for (value, &x) in target.iter_mut().zip(a) {
        if x.abs() > arithmetic::REDUCED {
            *value = f(x);
        }
    }
}

#[inline(never)]
fn one_by_one(operation: Unary, target: &mut Lanes, a: &Lanes) {
    for (value, &x) in target.iter_mut().zip(a) {
        *value = operation.apply(x);
    }
}

/// An operation on two numbers in every lane.
#[inline(always)]
pub(super) fn binary(operation: Binary, target: &mut Lanes, a: impl Lane, b: impl Lane) {
    macro_rules! each {
        ($operation:expr) => {
            write(target, |lane| $operation.apply(a.at(lane), b.at(lane)))
        };
    }
    match operation {
        Binary::Add => each!(Binary::Add),
        Binary::Subtract => each!(Binary::Subtract),
        Binary::Multiply => each!(Binary::Multiply),
        Binary::Divide => each!(Binary::Divide),
        Binary::Min => each!(Binary::Min),
        Binary::Max => each!(Binary::Max),
        Binary::Less => each!(Binary::Less),
        Binary::LessOrEqual => each!(Binary::LessOrEqual),
        Binary::Equal => each!(Binary::Equal),
        Binary::NotEqual => each!(Binary::NotEqual),
        Binary::Power | Binary::Hypot | Binary::Atan2 => {
            pair_by_pair(operation, target, &|lane| (a.at(lane), b.at(lane)));
        }
    }
}

#[inline(never)]
fn pair_by_pair(operation: Binary, target: &mut Lanes, pair: &dyn Fn(usize) -> (f64, f64)) {
    for (lane, value) in target.iter_mut().enumerate() {
        let (a, b) = pair(lane);
        *value = operation.apply(a, b);
    }
}

/// f(a) b.
#[inline(always)]
pub(super) fn product(factor: Factor, target: &mut Lanes, a: &Lanes, b: impl Lane) {
    match factor {
        Factor::Plain => write(target, |lane| a[lane] * b.at(lane)),
        Factor::Square => write(target, |lane| a[lane] * a[lane] * b.at(lane)),
        Factor::Sign => write(target, |lane| arithmetic::sign(a[lane]) * b.at(lane)),
        Factor::Magnitude => write(target, |lane| a[lane].abs() * b.at(lane)),
    }
}

/// ± f(a) b ± c.
#[inline(always)]
pub(super) fn multiply_add(
    signs: Signs,
    factor: Factor,
    target: &mut Lanes,
    (a, b): (&Lanes, impl Lane),
    c: impl Lane,
) {
    macro_rules! with_function {
        ($f:expr) => {
            match signs {
                Signs::PlusPlus => write(target, |lane| $f(a[lane]) * b.at(lane) + c.at(lane)),
                Signs::PlusMinus => write(target, |lane| $f(a[lane]) * b.at(lane) - c.at(lane)),
                Signs::MinusPlus => write(target, |lane| c.at(lane) - $f(a[lane]) * b.at(lane)),
                Signs::MinusMinus => write(target, |lane| -($f(a[lane]) * b.at(lane)) - c.at(lane)),
            }
        };
    }
    match factor {
        Factor::Plain => with_function!(|x: f64| x),
        Factor::Square => with_function!(|x: f64| x * x),
        Factor::Sign => with_function!(arithmetic::sign),
        Factor::Magnitude => with_function!(f64::abs),
    }
}

/// ± a b ± c d.
#[inline(always)]
pub(super) fn two_products(
    signs: Signs,
    target: &mut Lanes,
    (a, b): (&Lanes, impl Lane),
    (c, d): (&Lanes, impl Lane),
) {
    macro_rules! terms {
        (|$left:ident, $right:ident| $sum:expr) => {
            write(target, |lane| {
                let ($left, $right) = (a[lane] * b.at(lane), c[lane] * d.at(lane));
                $sum
            })
        };
    }
    match signs {
        Signs::PlusPlus => terms!(|left, right| left + right),
        Signs::PlusMinus => terms!(|left, right| left - right),
        Signs::MinusPlus => terms!(|left, right| right - left),
        Signs::MinusMinus => terms!(|left, right| -left - right),
    }
}

/// A polynomial in nested form, with the list of its coefficients, lowest first.
#[inline(always)]
pub(super) fn polynomial(
    target: &mut Lanes,
    x: &Lanes,
    coefficients: &[u32],
    value: impl Fn(u32) -> f64,
) {
    let Some((&highest, rest)) = coefficients.split_last() else {
        return;
    };
    let (targets, _) = target.as_chunks_mut::<BLOCK>();
    let (arguments, _) = x.as_chunks::<BLOCK>();
    for (target, x) in targets.iter_mut().zip(arguments) {
        let mut sum = [value(highest); BLOCK];
        for &coefficient in rest.iter().rev() {
            let coefficient = value(coefficient);
            for lane in 0..BLOCK {
                sum[lane] = sum[lane] * x[lane] + coefficient;
            }
        }
        *target = sum;
    }
}
