//! Expressions as nodes of one graph: every subexpression is kept once, however often it is written.
//!
//! A node's operands always stand before it, so that every pass over a graph is a loop and never a recursion. New
//! nodes are made by a `Builder`, which simplifies where that does not change a single bit of any value.

mod builder;
mod derivative;
mod evaluate;
mod fold;
mod part_map;
mod reduce;
mod substitute;

use std::collections::HashMap;

use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::limits;

pub(crate) use builder::Builder;
pub use derivative::Derivative;
pub(crate) use evaluate::Evaluator;
pub use evaluate::Point;

pub(crate) use part_map::PartMap;

/// What a name in a formula stands for, with its number among its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Symbol {
    /// A coordinate of the state.
    State(usize),
    /// A parameter.
    Parameter(usize),
    /// Time.
    Time,
}

/// An expression of a [`Graph`]: the number of its node. Two are equal exactly when they are the same expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Expression(u32);

impl Expression {
    pub(crate) fn from_position(position: usize) -> Self {
        Self(position as u32)
    }

    pub(crate) fn position(self) -> usize {
        self.0 as usize
    }
}

/// A finite number that is compared by its bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Number(u64);

impl Number {
    /// The number.
    pub(crate) fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// What an expression is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    /// A number.
    Constant(Number),
    /// A state, a parameter or time.
    Symbol(Symbol),
    /// An operation on one expression.
    Unary(Unary, Expression),
    /// An operation on two expressions.
    Binary(Binary, Expression, Expression),
    /// The second expression where the first is not zero, else the third.
    Select(Expression, Expression, Expression),
}

impl Node {
    /// The operands.
    pub(crate) fn operands(&self) -> impl Iterator<Item = Expression> + use<> {
        let operands = match *self {
            Self::Constant(_) | Self::Symbol(_) => [None; 3],
            Self::Unary(_, a) => [Some(a), None, None],
            Self::Binary(_, a, b) => [Some(a), Some(b), None],
            Self::Select(condition, yes, no) => [Some(condition), Some(yes), Some(no)],
        };
        operands.into_iter().flatten()
    }
}

/// Which symbols an expression contains: states as bits, parameters and time as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Reach {
    pub(crate) states: u64,
    pub(crate) parameters: bool,
    pub(crate) time: bool,
}

impl Reach {
    fn join(self, other: Self) -> Self {
        Self {
            states: self.states | other.states,
            parameters: self.parameters || other.parameters,
            time: self.time || other.time,
        }
    }
}

/// There are more than [`limits::NODES`] different subexpressions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("more than {} different subexpressions", limits::NODES)]
pub struct TooLarge;

/// All expressions of a scope.
#[derive(Debug, Clone)]
pub struct Graph {
    nodes: Vec<Node>,
    reach: Vec<Reach>,
    known: HashMap<Node, Expression>,
}

impl Default for Graph {
    fn default() -> Self {
        let zero = Node::Constant(Number(0));
        Self {
            nodes: vec![zero],
            reach: vec![Reach::default()],
            known: HashMap::from([(zero, Expression(0))]),
        }
    }
}

impl Graph {
    /// What an expression is. An expression of another graph is taken for zero where this one is smaller.
    pub(crate) fn node(&self, expression: Expression) -> Node {
        let zero = Node::Constant(Number(0));
        self.nodes
            .get(expression.0 as usize)
            .copied()
            .unwrap_or(zero)
    }

    /// Number of different expressions.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Never: zero is always there.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Makes new expressions.
    ///
    /// # Errors
    /// [`TooLarge`] when the graph would outgrow its bound; it is then as it was before.
    pub(crate) fn build<T>(
        &mut self,
        make: impl FnOnce(&mut Builder<'_>) -> T,
    ) -> Result<T, TooLarge> {
        let before = self.nodes.len();
        let mut builder = Builder::new(self);
        let made = make(&mut builder);
        if !builder.is_full() {
            return Ok(made);
        }
        for node in self.nodes.drain(before..) {
            self.known.remove(&node);
        }
        self.reach.truncate(before);
        Err(TooLarge)
    }

    /// The value of an expression that is a number as it stands.
    pub(crate) fn as_constant(&self, expression: Expression) -> Option<f64> {
        match self.node(expression) {
            Node::Constant(number) => Some(number.value()),
            _ => None,
        }
    }

    pub(crate) fn reach(&self, expression: Expression) -> Reach {
        self.reach
            .get(expression.0 as usize)
            .copied()
            .unwrap_or_default()
    }

    /// Whether a symbol occurs in an expression.
    pub fn contains(&self, expression: Expression, symbol: Symbol) -> bool {
        let reach = self.reach(expression);
        match symbol {
            Symbol::State(state) => state < limits::STATES && reach.states >> state & 1 == 1,
            Symbol::Time => reach.time,
            Symbol::Parameter(_) => {
                let is_symbol = |&part: &Expression| self.node(part) == Node::Symbol(symbol);
                reach.parameters && self.parts(&[expression]).iter().any(is_symbol)
            }
        }
    }

    /// All subexpressions of some expressions and themselves, operands before what they are operands of.
    pub(crate) fn parts(&self, expressions: &[Expression]) -> Vec<Expression> {
        let last = expressions
            .iter()
            .map(|expression| expression.0 as usize)
            .max();
        let length = last.map_or(0, |last| last + 1).min(self.nodes.len());
        let mut wanted = vec![false; length];
        for expression in expressions {
            if let Some(mark) = wanted.get_mut(expression.0 as usize) {
                *mark = true;
            }
        }
        for index in (0..length).rev() {
            if wanted[index] {
                for operand in self.nodes[index].operands() {
                    if let Some(mark) = wanted.get_mut(operand.0 as usize) {
                        *mark = true;
                    }
                }
            }
        }
        let parts = wanted.iter().enumerate().filter(|(_, wanted)| **wanted);
        parts.map(|(index, _)| Expression(index as u32)).collect()
    }

    /// Which of the expressions in `parts`, as [`Graph::parts`] gives them, contain a symbol.
    pub(crate) fn containing(&self, parts: &[Expression], symbol: Symbol) -> PartMap<bool> {
        let mut contained = PartMap::new(parts, false);
        for &part in parts {
            let node = self.node(part);
            let here = node == Node::Symbol(symbol)
                || node
                    .operands()
                    .any(|operand| contained.get(operand) == Some(true));
            contained.set(part, here);
        }
        contained
    }

    /// Adds a node as it is, or finds it.
    fn intern(&mut self, node: Node) -> Option<Expression> {
        if let Some(&found) = self.known.get(&node) {
            return Some(found);
        }
        if self.nodes.len() >= limits::NODES {
            return None;
        }
        let reach = match node {
            Node::Symbol(Symbol::State(state)) => Reach {
                states: 1 << (state % limits::STATES),
                ..Reach::default()
            },
            Node::Symbol(Symbol::Parameter(_)) => Reach {
                parameters: true,
                ..Reach::default()
            },
            Node::Symbol(Symbol::Time) => Reach {
                time: true,
                ..Reach::default()
            },
            _ => node.operands().fold(Reach::default(), |reach, operand| {
                reach.join(self.reach(operand))
            }),
        };
        let expression = Expression(self.nodes.len() as u32);
        self.nodes.push(node);
        self.reach.push(reach);
        self.known.insert(node, expression);
        Some(expression)
    }

    fn find(&self, node: Node) -> Option<Expression> {
        self.known.get(&node).copied()
    }
}

#[cfg(test)]
mod tests;
