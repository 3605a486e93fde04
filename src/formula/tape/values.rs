//! Binds parameters: whatever needs no state becomes a number, integer powers become products.
//!
//! Each rewriting here gives the same bits: signs move into numbers, a division by a power of two is a product.

use std::collections::HashMap;

use crate::formula::arithmetic::{Binary, Unary, select, small_integer};
use crate::formula::graph::{Node, Symbol};

/// What an operation works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Operand {
    /// A coordinate of the state.
    State(u16),
    /// The result of an operation on states, by its number.
    Value(u32),
    /// One number for all lanes, by its number.
    Scalar(u32),
}

/// An operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Operation {
    Unary(Unary, Operand),
    Binary(Binary, Operand, Operand),
    Select(Operand, Operand, Operand),
    /// A polynomial in nested form: its variable and the number of its list of coefficients.
    Polynomial(Operand, u32),
}

impl Operation {
    pub(super) fn operands(&self) -> impl Iterator<Item = Operand> + use<> {
        let operands = match *self {
            Self::Unary(_, a) => [Some(a), None, None],
            Self::Binary(_, a, b) => [Some(a), Some(b), None],
            Self::Select(condition, yes, no) => [Some(condition), Some(yes), Some(no)],
            Self::Polynomial(a, _) => [Some(a), None, None],
        };
        operands.into_iter().flatten()
    }

    /// The same on other operands.
    pub(super) fn map(&self, of: impl Fn(Operand) -> Operand) -> Self {
        match *self {
            Self::Unary(operation, a) => Self::Unary(operation, of(a)),
            Self::Binary(operation, a, b) => Self::Binary(operation, of(a), of(b)),
            Self::Select(condition, yes, no) => Self::Select(of(condition), of(yes), of(no)),
            Self::Polynomial(a, list) => Self::Polynomial(of(a), list),
        }
    }

    /// The result, given the operands', of an operation that is not a polynomial.
    pub(super) fn apply(&self, of: impl Fn(Operand) -> f64) -> f64 {
        match *self {
            Self::Polynomial(..) => f64::NAN,
            Self::Unary(operation, a) => operation.apply(of(a)),
            Self::Binary(operation, a, b) => operation.apply(of(a), of(b)),
            Self::Select(condition, yes, no) => select(of(condition), of(yes), of(no)),
        }
    }
}

/// Numbers that are the same in all lanes: fixed ones, and those that time changes.
#[derive(Debug, Clone, Default)]
pub(super) struct Scalars {
    /// Fixed values, and places for the others.
    pub(super) values: Vec<f64>,
    /// The place of time.
    pub(super) time: Option<u32>,
    /// What is worked out at every time, in this order.
    pub(super) clock: Vec<(u32, Operation)>,
}

/// All operations of a program with bound parameters.
#[derive(Debug, Default)]
pub(super) struct Values {
    pub(super) operations: Vec<Operation>,
    pub(super) scalars: Scalars,
    pub(super) outputs: Vec<Operand>,
    /// Coefficients of polynomials, lowest first, as numbers of scalars.
    pub(super) coefficients: Vec<Vec<u32>>,
    is_fixed: Vec<bool>,
    known: HashMap<Operation, Operand>,
    fixed: HashMap<u64, Operand>,
}

impl Values {
    pub(super) fn new(nodes: &[Node], outputs: &[usize], parameters: &[f64]) -> Self {
        let mut values = Self::default();
        let mut made: Vec<Operand> = Vec::with_capacity(nodes.len());
        let zero = values.number(0.0);
        for node in nodes {
            let of = |expression: crate::formula::graph::Expression| {
                made.get(expression.position()).copied().unwrap_or(zero)
            };
            let operand = match *node {
                Node::Constant(number) => values.number(number.value()),
                Node::Symbol(Symbol::State(state)) => Operand::State(state as u16),
                Node::Symbol(Symbol::Parameter(number)) => {
                    values.number(parameters.get(number).copied().unwrap_or(f64::NAN))
                }
                Node::Symbol(Symbol::Time) => values.time(),
                Node::Unary(Unary::Negate, a) => values.negate(of(a)),
                Node::Unary(operation, a) => values.push(Operation::Unary(operation, of(a))),
                Node::Binary(Binary::Multiply, a, b) => values.multiply(of(a), of(b)),
                Node::Binary(Binary::Divide, a, b) => values.divide(of(a), of(b)),
                Node::Binary(Binary::Power, a, b) => values.power(of(a), of(b)),
                Node::Binary(operation, a, b) => {
                    values.push(Operation::Binary(operation, of(a), of(b)))
                }
                Node::Select(condition, yes, no) => values.select(of(condition), of(yes), of(no)),
            };
            made.push(operand);
        }
        let output = |&position: &usize| made.get(position).copied().unwrap_or(zero);
        values.outputs = outputs.iter().map(output).collect();
        values
    }

    /// The operation of a value.
    pub(super) fn operation(&self, value: u32) -> Operation {
        let zero = Operation::Unary(Unary::Negate, Operand::Scalar(0));
        self.operations.get(value as usize).copied().unwrap_or(zero)
    }

    /// How often each value is an operand of what the outputs need, or an output.
    pub(super) fn uses(&self) -> Vec<u32> {
        let mut uses = vec![0_u32; self.operations.len()];
        let count = |uses: &mut Vec<u32>, operand: Operand| {
            if let Operand::Value(value) = operand
                && let Some(uses) = uses.get_mut(value as usize)
            {
                *uses = uses.saturating_add(1);
            }
        };
        self.outputs
            .iter()
            .for_each(|&output| count(&mut uses, output));
        for (value, operation) in self.operations.iter().enumerate().rev() {
            if uses[value] > 0 {
                operation
                    .operands()
                    .for_each(|operand| count(&mut uses, operand));
            }
        }
        uses
    }

    /// Takes all operations out, to put others in their place.
    pub(super) fn take_operations(&mut self) -> Vec<Operation> {
        self.known
            .retain(|_, operand| matches!(operand, Operand::Scalar(_)));
        std::mem::take(&mut self.operations)
    }

    /// Adds a polynomial with these scalars as coefficients, lowest first.
    pub(super) fn push_polynomial(&mut self, variable: Operand, list: Vec<Operand>) -> Operand {
        let list: Vec<u32> = list
            .into_iter()
            .filter_map(|operand| match operand {
                Operand::Scalar(place) => Some(place),
                _ => None,
            })
            .collect();
        let known = self.coefficients.iter().rposition(|known| *known == list);
        let number = known.unwrap_or_else(|| {
            self.coefficients.push(list);
            self.coefficients.len() - 1
        });
        self.push(Operation::Polynomial(variable, number as u32))
    }

    pub(super) fn number(&mut self, value: f64) -> Operand {
        if let Some(&found) = self.fixed.get(&value.to_bits()) {
            return found;
        }
        let operand = self.new_scalar(value, true);
        self.fixed.insert(value.to_bits(), operand);
        operand
    }

    fn new_scalar(&mut self, value: f64, fixed: bool) -> Operand {
        self.scalars.values.push(value);
        self.is_fixed.push(fixed);
        Operand::Scalar((self.scalars.values.len() - 1) as u32)
    }

    fn time(&mut self) -> Operand {
        if let Some(place) = self.scalars.time {
            return Operand::Scalar(place);
        }
        let operand = self.new_scalar(f64::NAN, false);
        if let Operand::Scalar(place) = operand {
            self.scalars.time = Some(place);
        }
        operand
    }

    /// The number, if nothing changes it.
    pub(super) fn fixed(&self, operand: Operand) -> Option<f64> {
        let Operand::Scalar(place) = operand else {
            return None;
        };
        let fixed = self.is_fixed.get(place as usize) == Some(&true);
        fixed
            .then(|| self.scalars.values.get(place as usize).copied())
            .flatten()
    }

    pub(super) fn push(&mut self, operation: Operation) -> Operand {
        if operation
            .operands()
            .all(|operand| self.fixed(operand).is_some())
        {
            let value = operation.apply(|operand| self.fixed(operand).unwrap_or(f64::NAN));
            return self.number(value);
        }
        if let Some(&found) = self.known.get(&operation) {
            return found;
        }
        let of_scalars = operation
            .operands()
            .all(|operand| matches!(operand, Operand::Scalar(_)));
        let operand = if of_scalars {
            let operand = self.new_scalar(f64::NAN, false);
            if let Operand::Scalar(place) = operand {
                self.scalars.clock.push((place, operation));
            }
            operand
        } else {
            self.operations.push(operation);
            Operand::Value((self.operations.len() - 1) as u32)
        };
        self.known.insert(operation, operand);
        operand
    }

    /// -a; into the number of a product or a quotient where there is one.
    pub(super) fn negate(&mut self, a: Operand) -> Operand {
        if let Operand::Value(value) = a
            && let Operation::Binary(operation @ (Binary::Multiply | Binary::Divide), left, right) =
                self.operation(value)
        {
            if matches!(left, Operand::Scalar(_)) {
                let left = self.push(Operation::Unary(Unary::Negate, left));
                return self.push(Operation::Binary(operation, left, right));
            }
            if matches!(right, Operand::Scalar(_)) {
                let right = self.push(Operation::Unary(Unary::Negate, right));
                return self.push(Operation::Binary(operation, left, right));
            }
        }
        self.push(Operation::Unary(Unary::Negate, a))
    }

    /// a b, a number second.
    fn multiply(&mut self, a: Operand, b: Operand) -> Operand {
        let (a, b) = if matches!(a, Operand::Scalar(_)) {
            (b, a)
        } else {
            (a, b)
        };
        match self.fixed(b) {
            Some(1.0) => a,
            Some(-1.0) => self.negate(a),
            _ => self.push(Operation::Binary(Binary::Multiply, a, b)),
        }
    }

    fn divide(&mut self, a: Operand, b: Operand) -> Operand {
        if let Some(divisor) = self.fixed(b)
            && is_power_of_two(divisor)
        {
            let reciprocal = self.number(1.0 / divisor);
            return self.multiply(a, reciprocal);
        }
        self.push(Operation::Binary(Binary::Divide, a, b))
    }

    fn power(&mut self, a: Operand, b: Operand) -> Operand {
        let exponent = self.fixed(b);
        if exponent == Some(0.5) {
            return self.push(Operation::Unary(Unary::Sqrt, a));
        }
        let Some(n) = exponent.and_then(small_integer) else {
            return self.push(Operation::Binary(Binary::Power, a, b));
        };
        let product = self.integer_power(a, n.unsigned_abs());
        let one = self.number(1.0);
        if n < 0 {
            self.divide(one, product)
        } else {
            product
        }
    }

    /// aⁿ as the products of [`crate::formula::arithmetic::integer_power`].
    pub(super) fn integer_power(&mut self, a: Operand, n: u32) -> Operand {
        let (mut square, mut left, mut product) = (a, n, None);
        while left > 0 {
            if left & 1 == 1 {
                product = Some(match product {
                    Some(product) => {
                        self.push(Operation::Binary(Binary::Multiply, product, square))
                    }
                    None => square,
                });
            }
            left >>= 1;
            if left > 0 {
                square = self.push(Operation::Binary(Binary::Multiply, square, square));
            }
        }
        product.unwrap_or_else(|| self.number(1.0))
    }

    fn select(&mut self, condition: Operand, yes: Operand, no: Operand) -> Operand {
        match self.fixed(condition) {
            Some(0.0) => no,
            Some(value) if value.is_nan() => condition,
            Some(_) => yes,
            None => self.push(Operation::Select(condition, yes, no)),
        }
    }
}

/// Whether the reciprocal is exact and both are normal numbers.
fn is_power_of_two(value: f64) -> bool {
    let mantissa = value.to_bits() & ((1 << 52) - 1);
    mantissa == 0 && value.is_normal() && (1.0 / value).is_normal()
}
