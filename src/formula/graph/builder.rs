//! Makes expressions, simplified where that changes no bit of any value.
//!
//! Signs are pulled out of products and quotients, so that `-(a b)`, `(-a) b` and `a (-b)` are one expression; numbers
//! in products are never negative; `x x` is `x²`. Kept as written are `x + 0` (which turns -0 into 0) and `0 x` (which
//! is NaN where x is infinite). NaN is NaN: neither its sign nor its payload counts.

use super::{Expression, Graph, Node, Number, Symbol, fold};
use crate::formula::arithmetic::{Binary, Unary};

/// Makes new expressions of a graph; see [`Graph::build`].
#[derive(Debug)]
pub(crate) struct Builder<'a> {
    graph: &'a mut Graph,
    full: bool,
}

impl<'a> Builder<'a> {
    pub(super) fn new(graph: &'a mut Graph) -> Self {
        Self { graph, full: false }
    }

    pub(super) fn is_full(&self) -> bool {
        self.full
    }

    /// The graph so far.
    pub(crate) fn graph(&self) -> &Graph {
        self.graph
    }

    fn intern(&mut self, node: Node) -> Expression {
        // When the graph is full, whatever is made is dropped in the end.
        self.graph.intern(node).unwrap_or_else(|| {
            self.full = true;
            Expression(0)
        })
    }

    fn constant_of(&self, expression: Expression) -> Option<f64> {
        self.graph.as_constant(expression)
    }

    fn negated(&self, expression: Expression) -> Option<Expression> {
        match self.graph.node(expression) {
            Node::Unary(Unary::Negate, inner) => Some(inner),
            _ => None,
        }
    }

    /// A number. Infinities and NaN, which no formula can write, become quotients by zero.
    pub(crate) fn constant(&mut self, value: f64) -> Expression {
        if value.is_finite() {
            return self.intern(Node::Constant(Number(value.to_bits())));
        }
        let zero = self.constant(0.0);
        let above = self.constant(if value.is_nan() { 0.0 } else { 1.0 });
        let quotient = self.intern(Node::Binary(Binary::Divide, above, zero));
        if value < 0.0 {
            self.negate(quotient)
        } else {
            quotient
        }
    }

    /// A state, a parameter or time.
    pub(crate) fn symbol(&mut self, symbol: Symbol) -> Expression {
        self.intern(Node::Symbol(symbol))
    }

    /// An operation on one expression.
    pub(crate) fn unary(&mut self, operation: Unary, a: Expression) -> Expression {
        if let Some(value) = self.constant_of(a).and_then(|a| fold::unary(operation, a)) {
            return self.constant(value);
        }
        match operation {
            Unary::Negate => {
                if let Some(inner) = self.negated(a) {
                    return inner;
                }
            }
            _ if operation.is_odd() => {
                if let Some(inner) = self.negated(a) {
                    let value = self.unary(operation, inner);
                    return self.negate(value);
                }
            }
            _ if operation.is_even() => {
                if let Some(inner) = self.negated(a) {
                    return self.unary(operation, inner);
                }
                if operation == Unary::Abs
                    && matches!(self.graph.node(a), Node::Unary(Unary::Abs, _))
                {
                    return a;
                }
            }
            _ => {}
        }
        self.intern(Node::Unary(operation, a))
    }

    /// An operation on two expressions.
    pub(crate) fn binary(&mut self, operation: Binary, a: Expression, b: Expression) -> Expression {
        if let (Some(left), Some(right)) = (self.constant_of(a), self.constant_of(b))
            && let Some(value) = fold::binary(operation, left, right)
        {
            return self.constant(value);
        }
        match operation {
            Binary::Add => self.add(a, b),
            Binary::Subtract => self.subtract(a, b),
            Binary::Multiply => self.multiply(a, b),
            Binary::Divide => self.divide(a, b),
            Binary::Power => self.power(a, b),
            Binary::Min | Binary::Max if a == b => a,
            _ => self.commute(operation, a, b),
        }
    }

    /// The node as it is, with its operands in the order in which it was first written.
    fn commute(&mut self, operation: Binary, a: Expression, b: Expression) -> Expression {
        let exchanged = operation
            .is_commutative()
            .then(|| self.graph.find(Node::Binary(operation, b, a)))
            .flatten();
        exchanged.unwrap_or_else(|| self.intern(Node::Binary(operation, a, b)))
    }

    /// -a.
    pub(crate) fn negate(&mut self, a: Expression) -> Expression {
        self.unary(Unary::Negate, a)
    }

    /// a + b.
    pub(crate) fn add(&mut self, a: Expression, b: Expression) -> Expression {
        if let Some(inner) = self.negated(b) {
            return self.subtract(a, inner);
        }
        match (self.constant_of(a), self.constant_of(b)) {
            (Some(left), Some(right)) if fold::binary(Binary::Add, left, right).is_some() => {
                self.binary(Binary::Add, a, b)
            }
            (None, Some(right)) if is_negative_zero(right) => a,
            (Some(left), None) if is_negative_zero(left) => b,
            (_, Some(right)) if right < 0.0 => {
                let positive = self.constant(-right);
                self.commute(Binary::Subtract, a, positive)
            }
            _ => self.commute(Binary::Add, a, b),
        }
    }

    /// a - b.
    pub(crate) fn subtract(&mut self, a: Expression, b: Expression) -> Expression {
        if let Some(inner) = self.negated(b) {
            return self.add(a, inner);
        }
        match (self.constant_of(a), self.constant_of(b)) {
            (Some(left), Some(right)) if fold::binary(Binary::Subtract, left, right).is_some() => {
                self.binary(Binary::Subtract, a, b)
            }
            (None, Some(right)) if right == 0.0 && !is_negative_zero(right) => a,
            (_, Some(right)) if right < 0.0 => {
                let positive = self.constant(-right);
                self.commute(Binary::Add, a, positive)
            }
            _ => self.commute(Binary::Subtract, a, b),
        }
    }

    /// a b.
    pub(crate) fn multiply(&mut self, a: Expression, b: Expression) -> Expression {
        if let Some((a, b)) = self.without_sign(a, b) {
            let product = self.multiply(a, b);
            return self.negate(product);
        }
        match (self.constant_of(a), self.constant_of(b)) {
            (Some(left), Some(right)) if fold::binary(Binary::Multiply, left, right).is_some() => {
                return self.binary(Binary::Multiply, a, b);
            }
            (Some(1.0), None) => return b,
            (None, Some(1.0)) => return a,
            _ => {}
        }
        if a == b {
            let two = self.constant(2.0);
            return self.power(a, two);
        }
        // x² x = x³: the same products in the same order.
        for (square, factor) in [(a, b), (b, a)] {
            if let Node::Binary(Binary::Power, base, exponent) = self.graph.node(square)
                && base == factor
                && self.constant_of(exponent) == Some(2.0)
            {
                let three = self.constant(3.0);
                return self.power(base, three);
            }
        }
        self.commute(Binary::Multiply, a, b)
    }

    /// a/b.
    pub(crate) fn divide(&mut self, a: Expression, b: Expression) -> Expression {
        if let Some((a, b)) = self.without_sign(a, b) {
            let quotient = self.divide(a, b);
            return self.negate(quotient);
        }
        match (self.constant_of(a), self.constant_of(b)) {
            (Some(left), Some(right)) if fold::binary(Binary::Divide, left, right).is_some() => {
                self.binary(Binary::Divide, a, b)
            }
            (None, Some(1.0)) => a,
            _ => self.commute(Binary::Divide, a, b),
        }
    }

    /// Two factors with one sign taken off, if one has it.
    fn without_sign(&mut self, a: Expression, b: Expression) -> Option<(Expression, Expression)> {
        if let Some(inner) = self.positive(a) {
            return Some((inner, b));
        }
        self.positive(b).map(|inner| (a, inner))
    }

    /// The same without its sign, if it is a negation or a negative number.
    fn positive(&mut self, a: Expression) -> Option<Expression> {
        match self.constant_of(a) {
            Some(value) if value.is_sign_negative() => Some(self.constant(-value)),
            Some(_) => None,
            None => self.negated(a),
        }
    }

    /// aᵇ.
    pub(crate) fn power(&mut self, a: Expression, b: Expression) -> Expression {
        let Some(exponent) = self.constant_of(b) else {
            return self.intern(Node::Binary(Binary::Power, a, b));
        };
        if exponent == 0.0 {
            return self.constant(1.0);
        }
        if exponent == 1.0 {
            return a;
        }
        if let Some(base) = self.constant_of(a)
            && let Some(value) = fold::binary(Binary::Power, base, exponent)
        {
            return self.constant(value);
        }
        if let Some(integer) = crate::formula::arithmetic::small_integer(exponent)
            && let Some(inner) = self.positive(a)
        {
            let power = self.power(inner, b);
            return if integer % 2 == 0 {
                power
            } else {
                self.negate(power)
            };
        }
        self.intern(Node::Binary(Binary::Power, a, b))
    }

    /// `yes` where the condition is not zero, else `no`.
    pub(crate) fn select(
        &mut self,
        condition: Expression,
        yes: Expression,
        no: Expression,
    ) -> Expression {
        if let Some(value) = self.constant_of(condition) {
            return if value == 0.0 { no } else { yes };
        }
        // Any other condition may be NaN, and then the value is.
        let compared = matches!(self.graph.node(condition), Node::Binary(operation, ..) if operation.is_comparison());
        if yes == no && compared {
            return yes;
        }
        self.intern(Node::Select(condition, yes, no))
    }
}

fn is_negative_zero(value: f64) -> bool {
    value == 0.0 && value.is_sign_negative()
}
