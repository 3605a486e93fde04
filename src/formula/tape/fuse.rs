//! Joins operations into instructions: a product that only one sum needs is worked out where it is added.

use super::instruction::{Factor, Instruction, Signs};
use super::values::{Operand, Operation, Values};
use crate::formula::arithmetic::{Binary, Unary};

/// The instruction of each value, `None` for those that became part of another's.
pub(super) type Fused = Vec<Option<Instruction<Operand>>>;

/// Finds the instructions of all values that the outputs need.
pub(super) fn fuse(values: &Values) -> Fused {
    let fuser = Fuser {
        values,
        uses: values.uses(),
    };
    let count = values.operations.len();
    let mut fused: Fused = vec![None; count];
    let mut wanted = vec![false; count];
    for &output in &values.outputs {
        mark(&mut wanted, output);
    }
    for value in (0..count).rev() {
        if wanted[value] {
            let instruction = fuser.instruction(values.operations[value]);
            for operand in instruction.operands() {
                mark(&mut wanted, operand);
            }
            fused[value] = Some(instruction);
        }
    }
    fused
}

fn mark(marks: &mut [bool], operand: Operand) {
    if let Operand::Value(value) = operand
        && let Some(mark) = marks.get_mut(value as usize)
    {
        *mark = true;
    }
}

struct Fuser<'a> {
    values: &'a Values,
    uses: Vec<u32>,
}

/// A product, with the function of its first factor and its sign.
#[derive(Clone, Copy)]
struct Product {
    negative: bool,
    factor: Factor,
    a: Operand,
    b: Operand,
}

impl Fuser<'_> {
    /// The operation of a value that nothing else needs.
    fn sole(&self, operand: Operand) -> Option<Operation> {
        let Operand::Value(value) = operand else {
            return None;
        };
        (self.uses.get(value as usize) == Some(&1)).then(|| self.values.operation(value))
    }

    fn instruction(&self, operation: Operation) -> Instruction<Operand> {
        match operation {
            Operation::Binary(Binary::Multiply, a, b) => {
                let product = self.factor(a, b);
                Instruction::Product(product.factor, product.a, product.b)
            }
            Operation::Binary(Binary::Add, a, b) => self.sum(a, b, false),
            Operation::Binary(Binary::Subtract, a, b) => self.sum(a, b, true),
            Operation::Unary(operation, a) => Instruction::Unary(operation, a),
            Operation::Binary(operation, a, b) => Instruction::Binary(operation, a, b),
            Operation::Select(condition, yes, no) => Instruction::Select(condition, yes, no),
            Operation::Polynomial(a, list) => Instruction::Polynomial(a, list),
        }
    }

    /// a ± b.
    fn sum(&self, a: Operand, b: Operand, minus: bool) -> Instruction<Operand> {
        match (self.product(a), self.product(b)) {
            (Some(left), Some(right)) => {
                if left.factor == Factor::Plain && right.factor == Factor::Plain {
                    let signs = Signs::of(left.negative, right.negative != minus);
                    Instruction::TwoProducts(signs, [left.a, left.b, right.a, right.b])
                } else if right.factor == Factor::Plain {
                    // The product with a function in it is worked out here, the other with its sign on its own.
                    let signs = Signs::of(left.negative, minus);
                    Instruction::MultiplyAdd(signs, left.factor, [left.a, left.b, b])
                } else {
                    let signs = Signs::of(right.negative != minus, false);
                    Instruction::MultiplyAdd(signs, right.factor, [right.a, right.b, a])
                }
            }
            (Some(left), None) => {
                let (c, negative) = self.unsigned(b);
                let signs = Signs::of(left.negative, negative != minus);
                Instruction::MultiplyAdd(signs, left.factor, [left.a, left.b, c])
            }
            (None, Some(right)) => {
                let (c, negative) = self.unsigned(a);
                let signs = Signs::of(right.negative != minus, negative);
                Instruction::MultiplyAdd(signs, right.factor, [right.a, right.b, c])
            }
            (None, None) => {
                let operation = if minus { Binary::Subtract } else { Binary::Add };
                Instruction::Binary(operation, a, b)
            }
        }
    }

    /// A term without its sign.
    fn unsigned(&self, operand: Operand) -> (Operand, bool) {
        match self.sole(operand) {
            Some(Operation::Unary(Unary::Negate, inner)) => (inner, true),
            _ => (operand, false),
        }
    }

    /// A product that nothing but one sum needs.
    fn product(&self, operand: Operand) -> Option<Product> {
        let (operand, negative) = self.unsigned(operand);
        match self.sole(operand)? {
            Operation::Binary(Binary::Multiply, a, b) => Some(Product {
                negative,
                ..self.factor(a, b)
            }),
            _ => None,
        }
    }

    fn factor(&self, a: Operand, b: Operand) -> Product {
        for (first, second) in [(a, b), (b, a)] {
            if a != b
                && let Some((factor, inner)) = self.function(first)
            {
                return Product {
                    negative: false,
                    factor,
                    a: inner,
                    b: second,
                };
            }
        }
        Product {
            negative: false,
            factor: Factor::Plain,
            a,
            b,
        }
    }

    /// A function that can be worked out inside a product.
    fn function(&self, operand: Operand) -> Option<(Factor, Operand)> {
        match self.sole(operand)? {
            Operation::Binary(Binary::Multiply, a, b) if a == b => Some((Factor::Square, a)),
            Operation::Unary(Unary::Sign, a) => Some((Factor::Sign, a)),
            Operation::Unary(Unary::Abs, a) => Some((Factor::Magnitude, a)),
            _ => None,
        }
    }
}
