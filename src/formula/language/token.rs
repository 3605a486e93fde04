//! From characters to tokens.

use std::ops::Range;

use winnow::Parser;
use winnow::combinator::{alt, opt};
use winnow::error::ParserError;
use winnow::stream::{LocatingSlice, Location, Stream};
use winnow::token::{any, one_of, take_while};

use super::fault::{Fault, FormulaError};
use super::spelling::{begins_name, continues_name, is_superscript_digit};
use crate::formula::limits;

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TokenKind {
    Number(f64),
    Name,
    /// An integer in superscript digits.
    Superscript(i32),
    Plus,
    Minus,
    Times,
    Over,
    Caret,
    Open,
    Close,
    Comma,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
}

/// A token with its place in the text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Token {
    pub(crate) kind: TokenKind,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl Token {
    pub(crate) fn span(&self) -> Range<usize> {
        self.start..self.end
    }
}

/// Why a parser did not succeed: another may be tried, or the formula is wrong.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Refusal {
    /// Nothing of this kind stands here.
    Backtrack,
    /// The formula is wrong. Boxed, so that results stay small on the stack.
    Fault(Box<FormulaError>),
}

impl Refusal {
    pub(super) fn at(span: Range<usize>, fault: Fault) -> Self {
        Self::Fault(Box::new(FormulaError::new(span, fault)))
    }
}

impl<I: Stream> ParserError<I> for Refusal {
    type Inner = Self;

    fn from_input(_input: &I) -> Self {
        Self::Backtrack
    }

    fn is_backtrack(&self) -> bool {
        matches!(self, Self::Backtrack)
    }

    fn into_inner(self) -> Result<Self::Inner, Self> {
        Ok(self)
    }
}

type Text<'a> = LocatingSlice<&'a str>;
type Parsed<T> = Result<T, Refusal>;

/// All tokens of a text, with blanks and line ends dropped.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, FormulaError> {
    let mut input = LocatingSlice::new(text);
    let mut tokens = Vec::new();
    loop {
        match next(&mut input) {
            Ok(Some(token)) => tokens.push(token),
            Ok(None) => return Ok(tokens),
            Err(Refusal::Fault(error)) => return Err(*error),
            Err(Refusal::Backtrack) => {
                let start = input.current_token_start();
                let character = text[start..].chars().next().unwrap_or(' ');
                let span = start..start + character.len_utf8();
                return Err(FormulaError::new(span, Fault::Character { character }));
            }
        }
    }
}

fn next(input: &mut Text<'_>) -> Parsed<Option<Token>> {
    take_while(0.., is_blank).void().parse_next(input)?;
    if input.is_empty() {
        return Ok(None);
    }
    let start = input.current_token_start();
    let kind = alt((number, name, superscript, comparison, sign)).parse_next(input)?;
    let end = input.previous_token_end();
    Ok(Some(Token { kind, start, end }))
}

/// Blanks that editors and word processors put between symbols.
fn is_blank(character: char) -> bool {
    matches!(
        character,
        ' ' | '\t' | '\n' | '\r' | '\u{a0}' | '\u{2009}' | '\u{200a}' | '\u{202f}'
    )
}

fn digits(input: &mut Text<'_>) -> Parsed<()> {
    take_while(1.., '0'..='9').void().parse_next(input)
}

fn mantissa(input: &mut Text<'_>) -> Parsed<()> {
    alt((
        (digits, opt(('.', opt(digits)))).void(),
        ('.', digits).void(),
    ))
    .parse_next(input)
}

fn exponent(input: &mut Text<'_>) -> Parsed<()> {
    (one_of(['e', 'E']), opt(one_of(['+', '-', '−'])), digits)
        .void()
        .parse_next(input)
}

fn number(input: &mut Text<'_>) -> Parsed<TokenKind> {
    let start = input.current_token_start();
    let written = (mantissa, opt(exponent)).take().parse_next(input)?;
    let rest: &str = input;
    let malformed = |length: usize| {
        let text = format!("{written}{}", &rest[..length]);
        Err(Refusal::at(
            start..start + text.len(),
            Fault::Number { text },
        ))
    };
    // 1.2.3, and an exponent that lacks its digits: `2e` is not told from a product with e.
    if rest.starts_with('.') {
        return malformed(1);
    }
    let word = rest.find(|c| !continues_name(c)).unwrap_or(rest.len());
    if matches!(&rest[..word], "e" | "E") && !written.contains(['e', 'E']) {
        return malformed(1);
    }
    let value: f64 = written
        .replace('−', "-")
        .parse()
        .map_err(|_| Refusal::Backtrack)?;
    let nonzero = written.split(['e', 'E']).next();
    let nonzero = nonzero.is_some_and(|digits| digits.contains(|c| matches!(c, '1'..='9')));
    if !value.is_finite() || (value == 0.0 && nonzero) {
        let text = written.chars().take(40).collect();
        let span = start..start + written.len();
        return Err(Refusal::at(span, Fault::NumberRange { text }));
    }
    Ok(TokenKind::Number(value))
}

fn name(input: &mut Text<'_>) -> Parsed<TokenKind> {
    let start = input.current_token_start();
    let rest = (one_of(begins_name), take_while(0.., continues_name));
    let written = rest.take().parse_next(input)?;
    let length = written.chars().count();
    if length > limits::NAME_LENGTH {
        let span = start..start + written.len();
        return Err(Refusal::at(span, Fault::LongName { length }));
    }
    Ok(TokenKind::Name)
}

fn superscript(input: &mut Text<'_>) -> Parsed<TokenKind> {
    let raised = take_while(1..=3, |c| is_superscript_digit(c).is_some());
    let (minus, digits) = (opt('⁻'), raised).parse_next(input)?;
    let values = digits.chars().filter_map(is_superscript_digit);
    let value = values.fold(0, |value, digit| 10 * value + digit);
    Ok(TokenKind::Superscript(if minus.is_some() {
        -value
    } else {
        value
    }))
}

fn comparison(input: &mut Text<'_>) -> Parsed<TokenKind> {
    alt((
        alt(("<=", "≤")).value(TokenKind::LessOrEqual),
        alt((">=", "≥")).value(TokenKind::GreaterOrEqual),
        "==".value(TokenKind::Equal),
        alt(("!=", "≠")).value(TokenKind::NotEqual),
        '<'.value(TokenKind::Less),
        '>'.value(TokenKind::Greater),
    ))
    .parse_next(input)
}

fn sign(input: &mut Text<'_>) -> Parsed<TokenKind> {
    any.verify_map(|character| {
        Some(match character {
            '+' => TokenKind::Plus,
            '-' | '−' => TokenKind::Minus,
            '*' | '·' | '⋅' | '×' => TokenKind::Times,
            '/' => TokenKind::Over,
            '^' => TokenKind::Caret,
            '(' => TokenKind::Open,
            ')' => TokenKind::Close,
            ',' => TokenKind::Comma,
            _ => return None,
        })
    })
    .parse_next(input)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<TokenKind> {
        let tokens = tokens(text).unwrap();
        tokens.into_iter().map(|token| token.kind).collect()
    }

    fn fault(text: &str) -> (Range<usize>, Fault) {
        let error = tokens(text).unwrap_err();
        (error.span, error.fault)
    }

    #[test]
    fn numbers_of_every_form() {
        use TokenKind::{Name, Number};
        for (text, value) in [
            ("1", 1.0),
            ("1.5", 1.5),
            (".5", 0.5),
            ("2.", 2.0),
            ("1e-3", 1e-3),
            ("1E+3", 1e3),
            ("1.5e−3", 1.5e-3),
        ] {
            assert_eq!(kinds(text), [Number(value)], "{text}");
        }
        assert_eq!(kinds("2x"), [Number(2.0), Name]);
        assert_eq!(kinds("2exp"), [Number(2.0), Name]);
        assert_eq!(kinds("0e5"), [Number(0.0)]);
    }

    #[test]
    fn numbers_that_cannot_be_read_are_pointed_at() {
        let number = |text: &str| Fault::Number {
            text: text.to_owned(),
        };
        assert_eq!(fault("x + 1.2.3"), (4..8, number("1.2.")));
        assert_eq!(fault("2e"), (0..2, number("2e")));
        assert_eq!(fault("2e*x"), (0..2, number("2e")));
        let range = |text: &str| Fault::NumberRange {
            text: text.to_owned(),
        };
        assert_eq!(fault("1e999"), (0..5, range("1e999")));
        assert_eq!(fault("1e-999"), (0..6, range("1e-999")));
    }

    #[test]
    fn characters_that_are_not_known_are_pointed_at() {
        assert_eq!(fault("x = y"), (2..3, Fault::Character { character: '=' }));
        assert_eq!(fault("α é"), (3..5, Fault::Character { character: 'é' }));
        assert_eq!(fault("x\0"), (1..2, Fault::Character { character: '\0' }));
        assert_eq!(fault("x⁻"), (1..4, Fault::Character { character: '⁻' }));
    }

    #[test]
    fn signs_in_print_are_the_signs_of_keyboards() {
        assert_eq!(kinds("a·b×c−d"), kinds("a*b*c-d"));
        assert_eq!(kinds("a≤b≥c≠d"), kinds("a<=b>=c!=d"));
        assert_eq!(kinds("σ²"), [TokenKind::Name, TokenKind::Superscript(2)]);
        assert_eq!(
            kinds("x⁻¹²"),
            [TokenKind::Name, TokenKind::Superscript(-12)]
        );
    }
}
