//! How names, numbers, functions and signs are written in each style.

use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::language::{Function, canonical_name, typeset_name};
use crate::formula::scope::Symbols;

/// For whom an expression is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Style {
    /// For the parser.
    Plain,
    /// For people.
    Typeset,
}

impl Style {
    pub(super) fn name(self, name: &str) -> String {
        match self {
            Self::Plain => name.to_owned(),
            Self::Typeset => typeset_name(name),
        }
    }
}

/// A number in the fewest digits that read back to it.
pub(super) fn number(value: f64, style: Style, symbols: &Symbols) -> String {
    if style == Style::Typeset {
        for (letter, name, constant) in [
            ("π", "pi", std::f64::consts::PI),
            ("e", "e", std::f64::consts::E),
        ] {
            if value == constant && !is_taken(symbols, name) {
                return letter.to_owned();
            }
        }
    }
    let size = value.abs();
    if size == 0.0 || (1e-5..1e15).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

fn is_taken(symbols: &Symbols, name: &str) -> bool {
    let definitions = symbols.definitions().iter().map(|(name, _)| name);
    let mut names = symbols
        .states()
        .iter()
        .chain(symbols.parameters())
        .chain(definitions);
    names.any(|own| canonical_name(own) == name)
}

pub(super) fn function_name(operation: Unary, style: Style) -> &'static str {
    let function = match operation {
        Unary::Negate => return "-",
        Unary::Sqrt if style == Style::Typeset => return "√",
        Unary::Abs => Function::Abs,
        Unary::Sign => Function::Sign,
        Unary::Step => Function::Step,
        Unary::Floor => Function::Floor,
        Unary::Sqrt => Function::Sqrt,
        Unary::Cbrt => Function::Cbrt,
        Unary::Exp => Function::Exp,
        Unary::Log => Function::Log,
        Unary::Log10 => Function::Log10,
        Unary::Sin => Function::Sin,
        Unary::Cos => Function::Cos,
        Unary::Tan => Function::Tan,
        Unary::Asin => Function::Asin,
        Unary::Acos => Function::Acos,
        Unary::Atan => Function::Atan,
        Unary::Sinh => Function::Sinh,
        Unary::Cosh => Function::Cosh,
        Unary::Tanh => Function::Tanh,
    };
    function.name()
}

pub(super) fn comparison(operation: Binary, style: Style) -> &'static str {
    match (operation, style) {
        (Binary::Less, _) => " < ",
        (Binary::LessOrEqual, Style::Plain) => " <= ",
        (Binary::LessOrEqual, Style::Typeset) => " ≤ ",
        (Binary::Equal, Style::Plain) => " == ",
        (Binary::Equal, Style::Typeset) => " = ",
        (_, Style::Plain) => " != ",
        (_, Style::Typeset) => " ≠ ",
    }
}

/// Superscripts of the integers from -9 to 12.
const SUPERSCRIPTS: [&str; 22] = [
    "⁻⁹", "⁻⁸", "⁻⁷", "⁻⁶", "⁻⁵", "⁻⁴", "⁻³", "⁻²", "⁻¹", "⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷",
    "⁸", "⁹", "¹⁰", "¹¹", "¹²",
];

pub(super) fn superscript(value: f64) -> Option<&'static str> {
    let integer = value.fract() == 0.0 && (-9.0..=12.0).contains(&value);
    let place = integer.then_some((value + 9.0) as usize)?;
    SUPERSCRIPTS.get(place).copied()
}
