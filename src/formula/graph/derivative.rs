//! Partial derivatives.
//!
//! A derivative holds away from jumps: `sign`, `step`, `floor` and comparisons have derivative zero there, and
//! [`Derivative::jumps`] says where not. At a kink (`abs`, `min`, `max`) one of the two one-sided values is taken, of
//! |u| their mean.

use super::{Builder, Expression, Graph, Node, PartMap, Symbol, TooLarge};
use crate::formula::arithmetic::{Binary, Unary, small_integer};

/// A partial derivative and where it does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivative {
    /// The derivative away from jumps.
    pub value: Expression,
    /// Expressions at whose zeros (for `floor`: integers) the function may jump, in the order of their parts.
    pub jumps: Vec<Expression>,
}

impl Graph {
    /// The partial derivative of an expression by a symbol. Named definitions are parts like any other; their
    /// derivatives are found once and shared.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub fn derivative(
        &mut self,
        expression: Expression,
        by: Symbol,
    ) -> Result<Derivative, TooLarge> {
        let parts = self.parts(&[expression]);
        let contains = self.containing(&parts, by);
        self.build(|builder| {
            let zero = builder.constant(0.0);
            let mut slopes = KnownDerivatives {
                of: PartMap::new(&parts, zero),
                jumps: Vec::new(),
            };
            for &part in &parts {
                if contains.get(part) == Some(true) {
                    let slope = slopes.of_part(builder, part);
                    slopes.of.set(part, slope);
                }
            }
            let value = slopes.of.get(expression).unwrap_or(zero);
            Derivative {
                value,
                jumps: slopes.jumps,
            }
        })
    }
}

/// Derivatives of the parts so far.
struct KnownDerivatives {
    of: PartMap<Expression>,
    jumps: Vec<Expression>,
}

impl KnownDerivatives {
    fn get(&self, part: Expression) -> Expression {
        self.of.get(part).unwrap_or(part)
    }

    fn jump(&mut self, argument: Expression) {
        if !self.jumps.contains(&argument) {
            self.jumps.push(argument);
        }
    }

    fn of_part(&mut self, builder: &mut Builder<'_>, part: Expression) -> Expression {
        match builder.graph().node(part) {
            Node::Constant(_) => builder.constant(0.0),
            // Only parts that contain the symbol come here.
            Node::Symbol(_) => builder.constant(1.0),
            Node::Unary(operation, a) => self.of_unary(builder, part, operation, a),
            Node::Binary(operation, a, b) => self.of_binary(builder, part, operation, a, b),
            Node::Select(condition, yes, no) => {
                self.condition(builder, condition);
                let (yes, no) = (self.get(yes), self.get(no));
                builder.select(condition, yes, no)
            }
        }
    }

    /// A condition that is not a comparison changes where it is zero.
    fn condition(&mut self, builder: &Builder<'_>, condition: Expression) {
        let node = builder.graph().node(condition);
        let compared = matches!(node, Node::Binary(operation, ..) if operation.is_comparison());
        if !compared && !builder.is_zero(self.get(condition)) {
            self.jump(condition);
        }
    }

    fn of_unary(
        &mut self,
        builder: &mut Builder<'_>,
        value: Expression,
        operation: Unary,
        a: Expression,
    ) -> Expression {
        let slope = self.get(a);
        if builder.is_zero(slope) {
            return slope;
        }
        if operation == Unary::Negate {
            return builder.negate(slope);
        }
        if matches!(operation, Unary::Sign | Unary::Step | Unary::Floor) {
            self.jump(a);
            return builder.constant(0.0);
        }
        outer(builder, value, operation, a, slope)
    }

    fn of_binary(
        &mut self,
        builder: &mut Builder<'_>,
        value: Expression,
        operation: Binary,
        a: Expression,
        b: Expression,
    ) -> Expression {
        let (slope_a, slope_b) = (self.get(a), self.get(b));
        match operation {
            Binary::Add => builder.sum(slope_a, slope_b),
            Binary::Subtract => builder.difference(slope_a, slope_b),
            Binary::Multiply => {
                let left = builder.product(slope_a, b);
                let right = builder.product(a, slope_b);
                builder.sum(left, right)
            }
            Binary::Divide => {
                // (a/b)' = (a' - (a/b) b')/b.
                let less = builder.product(value, slope_b);
                let above = builder.difference(slope_a, less);
                builder.quotient(above, b)
            }
            Binary::Power => power(builder, value, (a, slope_a), (b, slope_b)),
            Binary::Min | Binary::Max => {
                let (first, second) = if operation == Binary::Min {
                    (a, b)
                } else {
                    (b, a)
                };
                let less = builder.binary(Binary::Less, first, second);
                builder.select(less, slope_a, slope_b)
            }
            Binary::Hypot => {
                let left = builder.product(a, slope_a);
                let right = builder.product(b, slope_b);
                let above = builder.sum(left, right);
                builder.quotient(above, value)
            }
            Binary::Atan2 => {
                let left = builder.product(b, slope_a);
                let right = builder.product(a, slope_b);
                let above = builder.difference(left, right);
                let (square_a, square_b) = (builder.multiply(a, a), builder.multiply(b, b));
                let below = builder.add(square_a, square_b);
                builder.quotient(above, below)
            }
            Binary::Less | Binary::LessOrEqual | Binary::Equal | Binary::NotEqual => {
                let argument = builder.difference(a, b);
                if !builder.is_zero(slope_a) || !builder.is_zero(slope_b) {
                    self.jump(argument);
                }
                builder.constant(0.0)
            }
        }
    }
}

/// f'(a) a' of a smooth function or |a|, whose value is `value`.
fn outer(
    builder: &mut Builder<'_>,
    value: Expression,
    operation: Unary,
    a: Expression,
    slope: Expression,
) -> Expression {
    let one = builder.constant(1.0);
    match operation {
        Unary::Abs => {
            let sign = builder.unary(Unary::Sign, a);
            builder.product(sign, slope)
        }
        Unary::Sqrt => {
            let two = builder.constant(2.0);
            let below = builder.multiply(two, value);
            builder.quotient(slope, below)
        }
        Unary::Cbrt => {
            let (three, square) = (builder.constant(3.0), builder.multiply(value, value));
            let below = builder.multiply(three, square);
            builder.quotient(slope, below)
        }
        Unary::Exp => builder.product(value, slope),
        Unary::Log => builder.quotient(slope, a),
        Unary::Log10 => {
            let ten = builder.constant(10.0);
            let log_ten = builder.unary(Unary::Log, ten);
            let below = builder.multiply(a, log_ten);
            builder.quotient(slope, below)
        }
        Unary::Sin => {
            let cosine = builder.unary(Unary::Cos, a);
            builder.product(cosine, slope)
        }
        Unary::Cos => {
            let sine = builder.unary(Unary::Sin, a);
            let product = builder.product(sine, slope);
            builder.negate(product)
        }
        Unary::Tan => {
            let square = builder.multiply(value, value);
            let factor = builder.add(one, square);
            builder.product(factor, slope)
        }
        Unary::Asin | Unary::Acos => {
            let square = builder.multiply(a, a);
            let rest = builder.subtract(one, square);
            let below = builder.unary(Unary::Sqrt, rest);
            let quotient = builder.quotient(slope, below);
            if operation == Unary::Asin {
                quotient
            } else {
                builder.negate(quotient)
            }
        }
        Unary::Atan => {
            let square = builder.multiply(a, a);
            let below = builder.add(one, square);
            builder.quotient(slope, below)
        }
        Unary::Sinh => {
            let cosine = builder.unary(Unary::Cosh, a);
            builder.product(cosine, slope)
        }
        Unary::Cosh => {
            let sine = builder.unary(Unary::Sinh, a);
            builder.product(sine, slope)
        }
        Unary::Tanh => {
            let square = builder.multiply(value, value);
            let factor = builder.subtract(one, square);
            builder.product(factor, slope)
        }
        Unary::Negate | Unary::Sign | Unary::Step | Unary::Floor => slope,
    }
}

/// (uᵛ)' = v uᵛ⁻¹ u' + uᵛ log(u) v'.
fn power(
    builder: &mut Builder<'_>,
    value: Expression,
    (u, slope_u): (Expression, Expression),
    (v, slope_v): (Expression, Expression),
) -> Expression {
    let one = builder.constant(1.0);
    let less = match builder.graph().as_constant(v) {
        // The number itself, so that the exponent stays one that is multiplied out.
        Some(exponent) if small_integer(exponent).is_some() => builder.constant(exponent - 1.0),
        _ => builder.subtract(v, one),
    };
    let by_base = if builder.is_zero(slope_u) {
        slope_u
    } else {
        let power = builder.power(u, less);
        let factor = builder.product(v, power);
        builder.product(factor, slope_u)
    };
    let by_exponent = if builder.is_zero(slope_v) {
        slope_v
    } else {
        let logarithm = builder.unary(Unary::Log, u);
        let factor = builder.product(value, logarithm);
        builder.product(factor, slope_v)
    };
    builder.sum(by_base, by_exponent)
}
