//! A parsed formula before its names have a meaning: nodes in an arena, children before parents.

use super::function::Function;

/// A binary operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
}

/// What a node is. Numbers are positions of other nodes, all smaller than the node's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SyntaxKind {
    Number(f64),
    /// A name: the bytes of the text where it stands, without parentheses around it.
    Name(u32, u32),
    Negate(u32),
    Binary(Operator, u32, u32),
    /// A call: the range of its arguments in [`Syntax::arguments`].
    Call(Function, u32, u32),
}

/// A node with its place in the text, parentheses around it included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SyntaxNode {
    pub(crate) kind: SyntaxKind,
    pub(crate) start: u32,
    pub(crate) end: u32,
}

/// A parsed formula: the last node is the whole.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Syntax {
    pub(crate) nodes: Vec<SyntaxNode>,
    pub(crate) arguments: Vec<u32>,
}

impl Syntax {
    /// Arguments of a call.
    pub(crate) fn arguments_of(&self, first: u32, count: u32) -> &[u32] {
        let range = first as usize..(first + count) as usize;
        self.arguments.get(range).unwrap_or(&[])
    }
}
