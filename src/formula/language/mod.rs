//! The language of formulas: spelling of names, tokens, grammar.
//!
//! A text is parsed to a syntax tree that knows nothing of what names mean; [`scope`](crate::formula::scope) does.

mod fault;
mod function;
mod grammar;
mod spelling;
mod suggest;
mod syntax;
mod token;

pub use fault::{Fault, FormulaError};
pub use function::Function;
pub(crate) use spelling::{canonical_name, subscript_digit, typeset_name};

pub(crate) use grammar::parse;
pub(crate) use spelling::check_name;
#[cfg(feature = "store")]
pub(crate) use spelling::{ascii_spelling, foreign_letter, is_invisible, lookalike};
pub(crate) use suggest::{Known, nearest};
pub(crate) use syntax::{Operator, Syntax, SyntaxKind};
