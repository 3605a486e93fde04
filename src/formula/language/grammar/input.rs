//! What the grammar reads from and builds: tokens, the tree so far, the depth.

use std::ops::Range;

use winnow::Parser;
use winnow::combinator::opt;
use winnow::stream::{Stateful, TokenSlice};
use winnow::token::any;

use crate::formula::language::fault::Fault;
use crate::formula::language::syntax::{Operator, Syntax, SyntaxKind, SyntaxNode};
use crate::formula::language::token::{Refusal, Token, TokenKind};
use crate::formula::limits;

/// What is built while reading.
#[derive(Debug)]
pub(super) struct State<'a> {
    pub(super) text: &'a str,
    pub(super) syntax: Syntax,
    pub(super) depth: usize,
}

pub(super) type Input<'a> = Stateful<TokenSlice<'a, Token>, State<'a>>;
pub(super) type Parsed<T> = Result<T, Refusal>;

/// An operand that has been read: its node and how it ended.
#[derive(Clone, Copy)]
pub(super) struct Operand {
    pub(super) node: u32,
    /// Whether its last token belongs to an exponent after `^` and is not a parenthesis.
    pub(super) ends_in_exponent: bool,
}

impl State<'_> {
    pub(super) fn push(&mut self, kind: SyntaxKind, span: Range<usize>) -> u32 {
        let (start, end) = (span.start as u32, span.end as u32);
        self.syntax.nodes.push(SyntaxNode { kind, start, end });
        (self.syntax.nodes.len() - 1) as u32
    }

    pub(super) fn start(&self, node: u32) -> usize {
        self.syntax
            .nodes
            .get(node as usize)
            .map_or(0, |node| node.start as usize)
    }

    pub(super) fn binary(&mut self, operator: Operator, left: u32, right: u32, end: usize) -> u32 {
        let start = self.start(left);
        self.push(SyntaxKind::Binary(operator, left, right), start..end)
    }

    pub(super) fn words(&self, token: Option<&Token>) -> String {
        match token {
            None => "the end".to_owned(),
            Some(token) => {
                let text: String = self.text[token.span()].chars().take(40).collect();
                format!("`{text}`")
            }
        }
    }
}

pub(super) fn next_token(input: &Input<'_>) -> Option<Token> {
    input.input.first().copied()
}

pub(super) fn last_token(input: &Input<'_>) -> Option<Token> {
    input.input.previous_tokens().next().copied()
}

/// Where the last token ended.
pub(super) fn end(input: &Input<'_>) -> usize {
    last_token(input).map_or(0, |token| token.end)
}

pub(super) fn take(input: &mut Input<'_>, kind: TokenKind) -> bool {
    let token = any.verify(|token: &&Token| token.kind == kind);
    let taken: Parsed<Option<&Token>> = opt(token).parse_next(input);
    matches!(taken, Ok(Some(_)))
}

pub(super) fn take_one_of(
    input: &mut Input<'_>,
    table: &[(TokenKind, Operator)],
) -> Option<Operator> {
    let found = |token: &Token| table.iter().find(|(kind, _)| *kind == token.kind);
    let operator = any.verify_map(|token: &Token| found(token).map(|(_, operator)| *operator));
    let taken: Parsed<Option<Operator>> = opt(operator).parse_next(input);
    taken.ok().flatten()
}

/// Where the next token is, or the place after the last.
pub(super) fn here(input: &Input<'_>) -> Range<usize> {
    next_token(input).map_or(end(input)..end(input), |token| token.span())
}

pub(super) fn deeper<'a, T>(
    input: &mut Input<'a>,
    parser: impl FnOnce(&mut Input<'a>) -> Parsed<T>,
) -> Parsed<T> {
    if input.state.depth == limits::NESTING {
        return Err(Refusal::at(here(input), Fault::TooDeep));
    }
    input.state.depth += 1;
    let parsed = parser(input);
    input.state.depth -= 1;
    parsed
}

/// The fault of a token where an operator or the end should be.
pub(super) fn misplacement(input: &Input<'_>, token: Token) -> Fault {
    match token.kind {
        TokenKind::Comma => {
            let before = matches!(
                last_token(input),
                Some(Token {
                    kind: TokenKind::Number(_),
                    ..
                })
            );
            let after = input.state.text[token.end..].starts_with(|c: char| c.is_ascii_digit());
            Fault::Comma {
                decimal: before && after,
            }
        }
        TokenKind::Number(_) => Fault::NumberAfterFactor,
        TokenKind::Superscript(_) => Fault::TwoExponents,
        _ => Fault::Operator {
            found: input.state.words(Some(&token)),
        },
    }
}
