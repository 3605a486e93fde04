//! What can be wrong with a formula, where, and what to write instead.

use std::ops::Range;

use super::function::Function;
use super::spelling::{foreign_letter, is_invisible, is_superscript_digit};
use crate::formula::limits;

/// A fault of a formula and its place in the text.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{fault}")]
pub struct FormulaError {
    /// Bytes of the formula's text.
    pub span: Range<usize>,
    /// What is wrong there.
    pub fault: Fault,
}

/// What is wrong with a formula.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Fault {
    /// Nothing but blanks.
    #[error("the formula is empty")]
    Empty,
    /// Longer than `limits::FORMULA_BYTES`.
    #[error("the formula has {bytes} bytes")]
    TooLong {
        /// Its length.
        bytes: usize,
    },
    /// Deeper than [`limits::NESTING`].
    #[error("the formula is nested too deeply")]
    TooDeep,
    /// More distinct subexpressions than [`limits::NODES`].
    #[error("the formulas have too many different subexpressions")]
    TooLarge,
    /// A character that the language does not have.
    #[error("unexpected character {}", in_words(*.character))]
    Character {
        /// The character.
        character: char,
    },
    /// A number that cannot be read.
    #[error("`{text}` is not a number")]
    Number {
        /// What was written.
        text: String,
    },
    /// A number that no 64-bit floating point number comes near.
    #[error("`{text}` is outside the range of numbers")]
    NumberRange {
        /// What was written.
        text: String,
    },
    /// A name longer than `limits::NAME_LENGTH`.
    #[error("a name of {length} characters")]
    LongName {
        /// Its length in characters.
        length: usize,
    },
    /// Something else stands where an operand should.
    #[error("expected a number, a name or `(`, found {found}")]
    Operand {
        /// What stands there, in words.
        found: String,
    },
    /// Something else stands where an operator or the end should.
    #[error("expected an operator or the end, found {found}")]
    Operator {
        /// What stands there, in words.
        found: String,
    },
    /// A parenthesis that is never closed.
    #[error("this parenthesis is not closed")]
    Unclosed,
    /// A comma outside the arguments of a function.
    #[error("a comma separates the arguments of a function and stands nowhere else")]
    Comma {
        /// Whether it looks like a decimal comma.
        decimal: bool,
    },
    /// A number directly after an operand.
    #[error("a number directly after another factor")]
    NumberAfterFactor,
    /// A product without a sign after a division, as in `1/2 x`.
    #[error("this can be read in two ways")]
    ProductAfterDivision,
    /// A product without a sign or blank after an exponent, as in `x^2y`.
    #[error("it is not clear whether this belongs to the exponent")]
    ProductAfterExponent,
    /// A superscript followed by `^`.
    #[error("two exponents follow each other")]
    TwoExponents,
    /// A symbol directly followed by a parenthesis.
    #[error("`{name}` is not a function")]
    NotAFunction {
        /// The name.
        name: String,
        /// What it is, for example `a parameter`; `None` if it is unknown.
        is: Option<&'static str>,
        /// The function with the nearest name.
        nearest: Option<String>,
    },
    /// A function without its parentheses.
    #[error("the function `{}` needs its argument in parentheses", .function.name())]
    Parentheses {
        /// The function.
        function: Function,
    },
    /// A power on a function's name, as in `sin^2(x)`.
    #[error("a power cannot stand between a function and its argument")]
    PowerOfName {
        /// The function.
        function: Function,
    },
    /// A wrong number of arguments.
    #[error("`{}` is given {given} argument{}", .function.name(), plural(*.given))]
    Arguments {
        /// The function.
        function: Function,
        /// How many are given.
        given: usize,
    },
    /// `a < b < c`.
    #[error("comparisons cannot be chained")]
    Chained,
    /// A name that nothing defines.
    #[error("unknown symbol `{name}`")]
    Symbol {
        /// The name as written, shortened if it is long.
        name: String,
        /// The nearest known symbol.
        nearest: Option<String>,
        /// The same as a product of known symbols, as in `c1 x` for `c1x`.
        product: Option<String>,
        /// Everything that is known, in words.
        known: String,
    },
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

fn in_words(character: char) -> String {
    if character.is_control() || is_invisible(character) {
        format!("U+{:04X}", character as u32)
    } else {
        format!("`{character}`")
    }
}

/// What stands for a function that other languages, or papers, have.
fn instead_of(name: &str) -> Option<&'static str> {
    Some(match name.to_lowercase().as_str() {
        "h" | "u" | "heaviside" | "unitstep" => "`step(x)` for the unit step",
        "signum" => "`sign(x)`",
        "fabs" => "`abs(x)`",
        "power" => "`x^2` or `pow(x, 2)`",
        "tg" => "`tan(x)`",
        "arcsin" => "`asin(x)`",
        "arccos" => "`acos(x)`",
        "arctan" | "arctg" => "`atan(x)`",
        "sec" => "`1/cos(x)`",
        "csc" => "`1/sin(x)`",
        "cot" => "`1/tan(x)`",
        "sech" => "`1/cosh(x)`",
        "csch" => "`1/sinh(x)`",
        "coth" => "`1/tanh(x)`",
        "asinh" | "arcsinh" | "arsinh" => "`log(x + sqrt(x^2 + 1))`",
        "acosh" | "arccosh" | "arcosh" => "`log(x + sqrt(x^2 - 1))`",
        "atanh" | "arctanh" | "artanh" => "`log((1 + x)/(1 - x))/2`",
        _ => return None,
    })
}

impl FormulaError {
    pub(crate) fn new(span: Range<usize>, fault: Fault) -> Self {
        Self { span, fault }
    }

    /// What is allowed at this place.
    pub fn allowed(&self) -> Option<String> {
        match &self.fault {
            Fault::TooLong { .. } => Some(format!("at most {} bytes", limits::FORMULA_BYTES)),
            Fault::TooDeep => Some(format!("at most {} levels", limits::NESTING)),
            Fault::TooLarge => Some(format!("at most {} of them", limits::NODES)),
            Fault::LongName { .. } => Some(format!("at most {} characters", limits::NAME_LENGTH)),
            Fault::Arguments { function, .. } => Some(function.example()),
            Fault::Symbol { known, .. } => Some(known.clone()),
            Fault::NotAFunction { is: None, .. } => {
                Some(Function::names().collect::<Vec<_>>().join(", "))
            }
            Fault::Character { .. } => Some(
                "numbers, names, `+ - * / ^ ( ) ,`, the comparisons `< <= > >= == !=`".to_owned(),
            ),
            _ => None,
        }
    }

    /// The name that nothing defines, if that is the fault.
    pub(crate) fn unknown_symbol(&self) -> Option<&str> {
        match &self.fault {
            Fault::Symbol { name, .. } if !is_no_number(name) => Some(name),
            _ => None,
        }
    }

    /// What to write instead.
    pub fn remedy(&self) -> Option<String> {
        let words = match &self.fault {
            Fault::Empty => "write 0 for a formula that is zero",
            Fault::Character { character } => return character_remedy(*character),
            Fault::Number { .. } => "write numbers as 1, 0.5, .5 or 1e-3, and a product as `2 e`",
            Fault::Comma { decimal: true } => "write a decimal point, as in 1.5",
            Fault::NumberAfterFactor => "write `*` between them, or the number first",
            Fault::ProductAfterDivision => "write a/b*c or a/(b c), whichever is meant",
            Fault::ProductAfterExponent => "write a blank or `*` before it, or parentheses",
            Fault::TwoExponents => "write parentheses",
            Fault::NotAFunction {
                name, is: Some(_), ..
            } => {
                return Some(format!("write `{name} (…)` or `{name}*(…)` for a product"));
            }
            Fault::NotAFunction { name, nearest, .. } => {
                let nearest = || Some(format!("did you mean `{}`?", nearest.as_ref()?));
                return instead_of(name)
                    .map(|words| format!("write {words}"))
                    .or_else(nearest);
            }
            Fault::Parentheses { function } => {
                return Some(format!("write {}", function.example()));
            }
            Fault::PowerOfName { function } => {
                return Some(format!("write {}^2", function.example()));
            }
            Fault::Arguments {
                function: Function::Log,
                ..
            } => "log is the natural logarithm; write log(x)/log(b) for another base",
            Fault::Arguments { function, given: 2 } if function.arguments().1 == Some(1) => {
                "write a decimal point, not a comma, inside a number"
            }
            Fault::Operand { found } if found == "`*`" => "write ^ for a power, as in x^2",
            Fault::Symbol { name, .. } if is_no_number(name) => {
                "formulas have finite numbers only, and may not become infinite"
            }
            Fault::Chained => "write if(a < b, b < c, 0)",
            Fault::Symbol {
                product: Some(product),
                ..
            } => {
                return Some(format!("did you mean the product `{product}`?"));
            }
            Fault::Symbol { nearest, .. } => {
                return nearest
                    .as_ref()
                    .map(|name| format!("did you mean `{name}`?"));
            }
            _ => return None,
        };
        Some(words.to_owned())
    }

    /// The line of `text` with the fault, carets below it, and the message; for a reader without a better way.
    pub fn drawn(&self, text: &str) -> String {
        let start = floor_boundary(text, self.span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let end = floor_boundary(text, self.span.end.clamp(start, line_end));
        // A window around the fault, so that a long line stays readable.
        let before: Vec<char> = text[line_start..start].chars().rev().take(50).collect();
        let before: String = before.into_iter().rev().map(visible).collect();
        let marked: String = text[start..end].chars().take(40).map(visible).collect();
        let after: String = text[end..line_end].chars().take(30).map(visible).collect();
        let carets = "^".repeat(marked.chars().count().max(1));
        let indent = " ".repeat(before.chars().count());
        let mut drawn = format!("  {before}{marked}{after}\n  {indent}{carets} {self}");
        if let Some(remedy) = self.remedy() {
            drawn.push_str(&format!("\n  {indent}{remedy}"));
        }
        drawn
    }
}

fn visible(character: char) -> char {
    if character.is_control() {
        '·'
    } else {
        character
    }
}

fn floor_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// Whether a name is what other languages call a number that is none.
fn is_no_number(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    ["nan", "inf", "infinity"].contains(&name.as_str())
}

fn character_remedy(character: char) -> Option<String> {
    if let Some((words, remedy)) = foreign_letter(&character.to_string()) {
        return Some(format!("{words}: {remedy}"));
    }
    let words = match character {
        '=' => "write `==` to compare; an equation's left side is its key",
        '|' => "write abs(x) for |x|",
        '&' => "write (a < b)*(c < d): comparisons are 1 or 0",
        '!' => "write != to compare; factorials are not known",
        '√' => "write sqrt(x)",
        '÷' | '∕' => "write /",
        '–' | '—' => "write - for minus",
        '²'..='³' => "an exponent follows what it belongs to",
        '[' | ']' | '{' | '}' => "write ( ) for all parentheses",
        '\'' | '′' => "derivatives are states of their own; give them a name",
        '\\' => "write names without a backslash, as in alpha or α",
        _ if is_invisible(character) => "the character takes no room: delete it",
        '%' => "write the remainder as x - n floor(x/n)",
        ';' => "write , between arguments",
        '.' => "write numbers as 1, 0.5, .5 or 1e-3",
        _ if is_superscript_digit(character).is_some() => "an exponent follows what it belongs to",
        _ if character.is_alphabetic() => "names have Latin and Greek letters, digits and `_`",
        _ => return None,
    };
    Some(words.to_owned())
}
