//! Values of expressions at a point, one number at a time: for trials and messages. Batches run on a tape.

use super::{Expression, Graph, Node, PartMap, Symbol};
use crate::formula::arithmetic::select;

/// Values of all symbols.
#[derive(Debug, Clone, Copy)]
pub struct Point<'a> {
    /// The state, one value a coordinate.
    pub states: &'a [f64],
    /// The parameters in their order.
    pub parameters: &'a [f64],
    /// Time.
    pub time: f64,
}

impl Point<'_> {
    /// The value of a symbol, NaN where the point has none.
    pub(crate) fn value(&self, symbol: Symbol) -> f64 {
        match symbol {
            Symbol::State(state) => self.states.get(state).copied().unwrap_or(f64::NAN),
            Symbol::Parameter(number) => self.parameters.get(number).copied().unwrap_or(f64::NAN),
            Symbol::Time => self.time,
        }
    }
}

/// Evaluates some expressions again and again.
#[derive(Debug, Clone)]
pub(crate) struct Evaluator {
    parts: Vec<Expression>,
    values: PartMap<f64>,
}

impl Evaluator {
    /// For these expressions and all their parts.
    pub(crate) fn new(graph: &Graph, expressions: &[Expression]) -> Self {
        let parts = graph.parts(expressions);
        let values = PartMap::new(&parts, f64::NAN);
        Self { parts, values }
    }

    /// Works out all values at a point.
    pub(crate) fn evaluate(&mut self, graph: &Graph, point: &Point<'_>) {
        for &part in &self.parts {
            let of = |operand: Expression| self.values.get(operand).unwrap_or(f64::NAN);
            let value = match graph.node(part) {
                Node::Constant(number) => number.value(),
                Node::Symbol(symbol) => point.value(symbol),
                Node::Unary(operation, a) => operation.apply(of(a)),
                Node::Binary(operation, a, b) => operation.apply(of(a), of(b)),
                Node::Select(condition, yes, no) => select(of(condition), of(yes), of(no)),
            };
            self.values.set(part, value);
        }
    }

    /// The value of one of the expressions, or of a part of one, as last worked out.
    pub(crate) fn value(&self, expression: Expression) -> f64 {
        self.values.get(expression).unwrap_or(f64::NAN)
    }
}

impl Graph {
    /// The value of an expression at a point.
    pub fn evaluate(&self, expression: Expression, point: &Point<'_>) -> f64 {
        let mut evaluator = Evaluator::new(self, &[expression]);
        evaluator.evaluate(self, point);
        evaluator.value(expression)
    }
}
