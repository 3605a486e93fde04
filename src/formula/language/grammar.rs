//! The grammar: precedence, implicit products, calls.
//!
//! ```text
//! formula    = sum [ ("<" | "<=" | ">" | ">=" | "==" | "!=") sum ]
//! sum        = product { ("+" | "-") product }
//! product    = signed { ("*" | "/") signed | power }        a product without a sign: see `may_multiply`
//! signed     = ("-" | "+") signed | power
//! power      = atom [ superscript ] [ "^" exponent ]
//! exponent   = ("-" | "+") exponent | power
//! atom       = number | name | function "(" formula { "," formula } ")" | "(" formula ")"
//! ```

mod input;

use winnow::Parser;
use winnow::combinator::opt;
use winnow::stream::{Stateful, TokenSlice};
use winnow::token::any;

use super::fault::{Fault, FormulaError};
use super::function::Function;
use super::syntax::{Operator, Syntax, SyntaxKind};
use super::token::{Refusal, Token, TokenKind, tokens};
use crate::formula::limits;
use input::{
    Input, Operand, Parsed, State, deeper, end, here, last_token, misplacement, next_token, take,
    take_one_of,
};

/// Reads a formula.
pub(crate) fn parse(text: &str) -> Result<Syntax, FormulaError> {
    if text.len() > limits::FORMULA_BYTES {
        let fault = Fault::TooLong { bytes: text.len() };
        return Err(FormulaError::new(0..text.len(), fault));
    }
    let tokens = tokens(text)?;
    if tokens.is_empty() {
        return Err(FormulaError::new(0..text.len(), Fault::Empty));
    }
    let state = State {
        text,
        syntax: Syntax::default(),
        depth: 0,
    };
    let mut input = Stateful {
        input: TokenSlice::new(&tokens),
        state,
    };
    match whole(&mut input) {
        Ok(()) => Ok(input.state.syntax),
        Err(Refusal::Fault(error)) => Err(*error),
        Err(Refusal::Backtrack) => {
            let fault = Fault::Operand {
                found: "something else".to_owned(),
            };
            Err(FormulaError::new(0..text.len(), fault))
        }
    }
}

fn whole(input: &mut Input<'_>) -> Parsed<()> {
    formula(input)?;
    let Some(token) = next_token(input) else {
        return Ok(());
    };
    Err(Refusal::at(token.span(), misplacement(input, token)))
}

const COMPARISONS: [(TokenKind, Operator); 6] = [
    (TokenKind::Less, Operator::Less),
    (TokenKind::LessOrEqual, Operator::LessOrEqual),
    (TokenKind::Greater, Operator::Greater),
    (TokenKind::GreaterOrEqual, Operator::GreaterOrEqual),
    (TokenKind::Equal, Operator::Equal),
    (TokenKind::NotEqual, Operator::NotEqual),
];

fn formula(input: &mut Input<'_>) -> Parsed<u32> {
    let left = sum(input)?;
    let Some(operator) = take_one_of(input, &COMPARISONS) else {
        return Ok(left);
    };
    let right = sum(input)?;
    let node = input.state.binary(operator, left, right, end(input));
    let span = here(input);
    if take_one_of(input, &COMPARISONS).is_some() {
        return Err(Refusal::at(span, Fault::Chained));
    }
    Ok(node)
}

const SIGNS: [(TokenKind, Operator); 2] = [
    (TokenKind::Plus, Operator::Add),
    (TokenKind::Minus, Operator::Subtract),
];

fn sum(input: &mut Input<'_>) -> Parsed<u32> {
    let mut left = product(input)?;
    while let Some(operator) = take_one_of(input, &SIGNS) {
        let right = product(input)?;
        left = input.state.binary(operator, left, right, end(input));
    }
    Ok(left)
}

const FACTORS: [(TokenKind, Operator); 2] = [
    (TokenKind::Times, Operator::Multiply),
    (TokenKind::Over, Operator::Divide),
];

fn product(input: &mut Input<'_>) -> Parsed<u32> {
    let mut left = signed(input)?;
    let mut divided = false;
    loop {
        let (operator, right) = if let Some(operator) = take_one_of(input, &FACTORS) {
            (operator, signed(input)?)
        } else if may_multiply(input, left, divided)? {
            (Operator::Multiply, power(input)?)
        } else {
            return Ok(left.node);
        };
        divided = operator == Operator::Divide;
        let node = input
            .state
            .binary(operator, left.node, right.node, end(input));
        left = Operand { node, ..right };
    }
}

/// Whether the next token begins a factor without a sign before it.
///
/// A name or a parenthesis may follow a number, a closing parenthesis or a superscript directly, and a name after a
/// blank. Refused is whatever can be read in two ways: after a division, after an exponent without a blank, and a
/// parenthesis directly after a name.
fn may_multiply(input: &Input<'_>, left: Operand, divided: bool) -> Parsed<bool> {
    let (Some(next), Some(last)) = (next_token(input), last_token(input)) else {
        return Ok(false);
    };
    if !matches!(next.kind, TokenKind::Name | TokenKind::Open) {
        return Ok(false);
    }
    let refuse = |fault| Err(Refusal::at(next.span(), fault));
    let touching = last.end == next.start;
    if touching && last.kind == TokenKind::Name && next.kind == TokenKind::Open {
        let name = input.state.text[last.span()].to_owned();
        let fault = Fault::NotAFunction {
            name,
            is: None,
            nearest: None,
        };
        return Err(Refusal::at(last.span(), fault));
    }
    if divided {
        return refuse(Fault::ProductAfterDivision);
    }
    if touching && left.ends_in_exponent {
        return refuse(Fault::ProductAfterExponent);
    }
    Ok(true)
}

fn signed(input: &mut Input<'_>) -> Parsed<Operand> {
    let start = here(input).start;
    if take(input, TokenKind::Minus) {
        let operand = deeper(input, signed)?;
        let span = start..end(input);
        let node = input.state.push(SyntaxKind::Negate(operand.node), span);
        return Ok(Operand { node, ..operand });
    }
    if take(input, TokenKind::Plus) {
        return deeper(input, signed);
    }
    power(input)
}

fn power(input: &mut Input<'_>) -> Parsed<Operand> {
    let mut base = atom(input)?;
    let raised = next_token(input);
    if let Some(Token {
        kind: TokenKind::Superscript(value),
        ..
    }) = raised
    {
        let span = here(input);
        take(input, TokenKind::Superscript(value));
        let exponent = input
            .state
            .push(SyntaxKind::Number(f64::from(value)), span.clone());
        base = input
            .state
            .binary(Operator::Power, base, exponent, span.end);
        if matches!(
            next_token(input),
            Some(Token {
                kind: TokenKind::Caret,
                ..
            })
        ) {
            return Err(Refusal::at(here(input), Fault::TwoExponents));
        }
    }
    if !take(input, TokenKind::Caret) {
        return Ok(Operand {
            node: base,
            ends_in_exponent: false,
        });
    }
    let exponent = deeper(input, exponent)?;
    let node = input
        .state
        .binary(Operator::Power, base, exponent, end(input));
    let last = last_token(input).map(|token| token.kind);
    let closed = matches!(last, Some(TokenKind::Close | TokenKind::Superscript(_)));
    Ok(Operand {
        node,
        ends_in_exponent: !closed,
    })
}

fn exponent(input: &mut Input<'_>) -> Parsed<u32> {
    let start = here(input).start;
    if take(input, TokenKind::Minus) {
        let operand = deeper(input, exponent)?;
        let span = start..end(input);
        return Ok(input.state.push(SyntaxKind::Negate(operand), span));
    }
    if take(input, TokenKind::Plus) {
        return deeper(input, exponent);
    }
    Ok(power(input)?.node)
}

fn atom(input: &mut Input<'_>) -> Parsed<u32> {
    let token: Option<&Token> = opt(any).parse_next(input)?;
    let Some(&token) = token else {
        let fault = Fault::Operand {
            found: input.state.words(None),
        };
        return Err(Refusal::at(end(input)..end(input), fault));
    };
    match token.kind {
        TokenKind::Number(value) => Ok(input.state.push(SyntaxKind::Number(value), token.span())),
        TokenKind::Name => match Function::named(&input.state.text[token.span()]) {
            Some(function) => call(input, function, token),
            None => {
                let kind = SyntaxKind::Name(token.start as u32, token.end as u32);
                Ok(input.state.push(kind, token.span()))
            }
        },
        TokenKind::Open => {
            let inner = deeper(input, formula)?;
            close(input, token)?;
            // The parentheses belong to the place of what they hold.
            let end = end(input);
            if let Some(node) = input.state.syntax.nodes.get_mut(inner as usize) {
                (node.start, node.end) = (token.start as u32, end as u32);
            }
            Ok(inner)
        }
        _ => {
            let found = input.state.words(Some(&token));
            Err(Refusal::at(token.span(), Fault::Operand { found }))
        }
    }
}

fn close(input: &mut Input<'_>, open: Token) -> Parsed<()> {
    if take(input, TokenKind::Close) {
        return Ok(());
    }
    match next_token(input) {
        None => Err(Refusal::at(open.span(), Fault::Unclosed)),
        Some(token) => Err(Refusal::at(token.span(), misplacement(input, token))),
    }
}

fn call(input: &mut Input<'_>, function: Function, name: Token) -> Parsed<u32> {
    let Some(open) = next_token(input).filter(|token| token.kind == TokenKind::Open) else {
        let raised = matches!(
            next_token(input),
            Some(Token {
                kind: TokenKind::Caret | TokenKind::Superscript(_),
                ..
            })
        );
        let fault = if raised {
            Fault::PowerOfName { function }
        } else {
            Fault::Parentheses { function }
        };
        return Err(Refusal::at(name.span(), fault));
    };
    take(input, TokenKind::Open);
    let mut arguments = Vec::new();
    if !matches!(
        next_token(input),
        Some(Token {
            kind: TokenKind::Close,
            ..
        })
    ) {
        arguments.push(deeper(input, formula)?);
        while take(input, TokenKind::Comma) {
            arguments.push(deeper(input, formula)?);
        }
    }
    close(input, open)?;
    let span = name.start..end(input);
    let (least, most) = function.arguments();
    let given = arguments.len();
    if given < least || most.is_some_and(|most| given > most) {
        return Err(Refusal::at(span, Fault::Arguments { function, given }));
    }
    let first = input.state.syntax.arguments.len() as u32;
    input.state.syntax.arguments.extend(arguments);
    Ok(input
        .state
        .push(SyntaxKind::Call(function, first, given as u32), span))
}

#[cfg(test)]
mod tests;
