//! Two evaluators of trees: one that does each operation as it stands, for equality bit by bit, and one with the
//! functions of the standard library and a bound on what rounding can do, for the functions themselves.

use pbif::formula::arithmetic::{Binary, Unary};

use super::read::Tree;

const FUNCTIONS: [&str; 26] = [
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "ln",
    "log10", "sqrt", "cbrt", "abs", "sign", "sgn", "step", "floor", "min", "max", "hypot", "atan2",
    "pow", "if",
];

pub(crate) fn is_function(name: &str) -> bool {
    FUNCTIONS.contains(&name)
}

/// Each operation as it stands.
pub(crate) fn exact(tree: &Tree, lookup: &dyn Fn(&str) -> Option<f64>) -> Option<f64> {
    Some(match tree {
        Tree::Number(value) => *value,
        Tree::Name(name) if name == "H" => {
            let [x, y, a] = ["x", "y", "a"].map(|name| lookup(name).unwrap_or(f64::NAN));
            y * y / 2.0 + a * (x * x)
        }
        Tree::Name(name) => lookup(name)?,
        Tree::Negate(inner) => -exact(inner, lookup)?,
        Tree::Binary(operator, left, right) => {
            let (a, b) = (exact(left, lookup)?, exact(right, lookup)?);
            match *operator {
                "+" => a + b,
                "-" => a - b,
                "*" => a * b,
                "/" => a / b,
                "^" => Binary::Power.apply(a, b),
                "<" => f64::from(u8::from(a < b)),
                "<=" => f64::from(u8::from(a <= b)),
                ">" => f64::from(u8::from(a > b)),
                ">=" => f64::from(u8::from(a >= b)),
                "==" => f64::from(u8::from(a == b)),
                _ => f64::from(u8::from(a != b)),
            }
        }
        Tree::Call(name, arguments) => {
            let values: Option<Vec<f64>> =
                arguments.iter().map(|tree| exact(tree, lookup)).collect();
            call(name, &values?)?
        }
    })
}

fn call(name: &str, values: &[f64]) -> Option<f64> {
    let folded = |operation: Binary| values.iter().copied().reduce(|a, b| operation.apply(a, b));
    let unary = match name {
        "sin" => Unary::Sin,
        "cos" => Unary::Cos,
        "tan" => Unary::Tan,
        "asin" => Unary::Asin,
        "acos" => Unary::Acos,
        "atan" => Unary::Atan,
        "sinh" => Unary::Sinh,
        "cosh" => Unary::Cosh,
        "tanh" => Unary::Tanh,
        "exp" => Unary::Exp,
        "log" | "ln" => Unary::Log,
        "log10" => Unary::Log10,
        "sqrt" => return Some(values[0].sqrt()),
        "cbrt" => Unary::Cbrt,
        "abs" => return Some(values[0].abs()),
        "sign" | "sgn" => Unary::Sign,
        "step" => Unary::Step,
        "floor" => return Some(values[0].floor()),
        "min" => return folded(Binary::Min),
        "max" => return folded(Binary::Max),
        "hypot" => return folded(Binary::Hypot),
        "atan2" => return folded(Binary::Atan2),
        "pow" => return folded(Binary::Power),
        "if" => {
            let &[condition, yes, no] = values else {
                return None;
            };
            return Some(if condition.is_nan() {
                condition
            } else if condition != 0.0 {
                yes
            } else {
                no
            });
        }
        _ => return None,
    };
    Some(unary.apply(*values.first()?))
}

/// A value and a bound on its error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounded {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

const UNIT: f64 = 4.0 * f64::EPSILON;

fn rounded(value: f64, error: f64) -> Bounded {
    Bounded {
        value,
        error: error + UNIT * value.abs() + f64::MIN_POSITIVE,
    }
}

/// With the standard library's functions and a bound on the error of any evaluation in floating point; `None` where a
/// function is not smooth within the error, or not finite.
pub(crate) fn bounded(tree: &Tree, lookup: &dyn Fn(&str) -> Option<f64>) -> Option<Bounded> {
    let result = match tree {
        Tree::Number(value) => rounded(*value, 0.0),
        Tree::Name(name) if name == "H" => {
            let [x, y, a] = ["x", "y", "a"].map(|name| lookup(name).unwrap_or(f64::NAN));
            rounded(y * y / 2.0 + a * x * x, UNIT * (y * y + (a * x * x).abs()))
        }
        Tree::Name(name) => rounded(lookup(name)?, 0.0),
        Tree::Negate(inner) => {
            let inner = bounded(inner, lookup)?;
            Bounded {
                value: -inner.value,
                error: inner.error,
            }
        }
        Tree::Binary(operator, left, right) => {
            binary(operator, bounded(left, lookup)?, bounded(right, lookup)?)?
        }
        Tree::Call(name, arguments) => {
            let values: Option<Vec<Bounded>> =
                arguments.iter().map(|tree| bounded(tree, lookup)).collect();
            bounded_call(name, &values?)?
        }
    };
    (result.value.is_finite() && result.error.is_finite()).then_some(result)
}

fn binary(operator: &str, a: Bounded, b: Bounded) -> Option<Bounded> {
    let (x, y) = (a.value, b.value);
    let apart = (x - y).abs() > a.error + b.error;
    let compared = |holds: bool| apart.then(|| rounded(f64::from(u8::from(holds)), 0.0));
    match operator {
        "+" => Some(rounded(x + y, a.error + b.error)),
        "-" => Some(rounded(x - y, a.error + b.error)),
        "*" => Some(rounded(
            x * y,
            x.abs() * b.error + y.abs() * a.error + a.error * b.error,
        )),
        "/" => {
            let least = y.abs() - b.error;
            (least > 0.0).then(|| rounded(x / y, (a.error + (x / y).abs() * b.error) / least))
        }
        "^" => power(a, b),
        "<" | "<=" => compared(x < y),
        ">" | ">=" => compared(x > y),
        "==" => compared(false),
        _ => compared(true),
    }
}

fn power(a: Bounded, b: Bounded) -> Option<Bounded> {
    let (x, y) = (a.value, b.value);
    if y.fract() == 0.0 && y.abs() <= 64.0 && b.error <= UNIT * y.abs() + 1e-300 {
        // The relative error of the base counts |y| times, as do the roundings of the products.
        let relative = y.abs() * (a.error / x.abs() + UNIT);
        let value = x.powi(y as i32);
        return (relative < 0.1).then(|| rounded(value, 2.0 * value.abs() * relative));
    }
    if x <= a.error {
        return None;
    }
    let value = x.powf(y);
    let relative = y.abs() * a.error / (x - a.error)
        + x.ln().abs() * b.error
        + UNIT * (1.0 + (y * x.ln()).abs());
    (relative < 0.1).then(|| rounded(value, 2.0 * value * relative))
}

fn bounded_call(name: &str, values: &[Bounded]) -> Option<Bounded> {
    let first = *values.first()?;
    let (x, error) = (first.value, first.error);
    let small = error < 1e-3 * (1.0 + x.abs()).min(1.0);
    match name {
        "min" | "max" => {
            let smaller = name == "min";
            let chosen = values
                .iter()
                .copied()
                .reduce(|a, b| if (a.value < b.value) == smaller { a } else { b })?;
            let error = values
                .iter()
                .fold(0.0, |most: f64, value| most.max(value.error));
            return Some(Bounded {
                value: chosen.value,
                error,
            });
        }
        "hypot" => {
            let b = values.get(1)?;
            return Some(rounded(x.hypot(b.value), error + b.error));
        }
        "atan2" => {
            let b = values.get(1)?;
            let distance = x.hypot(b.value) - error - b.error;
            let cut = x.abs() <= error && b.value <= b.error;
            return (distance > 0.0 && !cut)
                .then(|| rounded(x.atan2(b.value), (error + b.error) / distance));
        }
        "pow" => return power(first, *values.get(1)?),
        "if" => {
            let certain = x.abs() > error || (x == 0.0 && error <= f64::MIN_POSITIVE);
            return certain.then(|| if x != 0.0 { values[1] } else { values[2] });
        }
        "abs" => {
            return Some(Bounded {
                value: x.abs(),
                error,
            });
        }
        "sign" | "sgn" => return (x.abs() > error).then(|| rounded(x.signum(), 0.0)),
        "step" => return (x.abs() > error).then(|| rounded(if x > 0.0 { 1.0 } else { 0.0 }, 0.0)),
        "floor" => {
            let near = (x - x.round()).abs() <= error;
            return (!near && x.abs() < 1e15).then(|| rounded(x.floor(), 0.0));
        }
        _ if !small => return None,
        _ => {}
    }
    // What is smooth only in a part of the axis, and the value and slope there.
    let (is_smooth, value, slope) = match name {
        "sin" => (x.abs() < 1e5, x.sin(), 1.0),
        "cos" => (x.abs() < 1e5, x.cos(), 1.0),
        "tan" => {
            let slope = 1.0 + x.tan().powi(2);
            (x.abs() < 1e5 && slope * error < 1e-3, x.tan(), slope)
        }
        "asin" | "acos" => {
            let rest = 1.0 - x * x - 3.0 * error;
            let value = if name == "asin" { x.asin() } else { x.acos() };
            (rest > 1e-6, value, 1.0 / rest.sqrt())
        }
        "atan" => (true, x.atan(), 1.0),
        "sinh" => (true, x.sinh(), x.cosh()),
        "cosh" => (true, x.cosh(), x.cosh()),
        "tanh" => (true, x.tanh(), 1.0),
        "exp" => (true, x.exp(), x.exp()),
        "log" | "ln" => (x > 2.0 * error, x.ln(), 1.0 / (x - error)),
        "log10" => (x > 2.0 * error, x.log10(), 1.0 / (x - error)),
        "sqrt" => (x > 2.0 * error, x.sqrt(), 1.0 / (x - error).sqrt()),
        "cbrt" => {
            let slope = (x.abs() - error).powf(-2.0 / 3.0);
            (x.abs() > 2.0 * error, x.cbrt(), slope)
        }
        _ => return None,
    };
    is_smooth.then(|| rounded(value, 2.0 * slope.abs() * error))
}
