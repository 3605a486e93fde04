//! Instructions: one pass over the lanes each.

use crate::formula::arithmetic::{Binary, Unary};

/// What is done to the first factor of a product before it is multiplied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Factor {
    Plain,
    /// x².
    Square,
    /// sign x.
    Sign,
    /// |x|.
    Magnitude,
}

/// Signs of the two terms of a sum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Signs {
    PlusPlus,
    PlusMinus,
    MinusPlus,
    MinusMinus,
}

impl Signs {
    /// From whether each is negative.
    pub(super) fn of(first: bool, second: bool) -> Self {
        match (first, second) {
            (false, false) => Self::PlusPlus,
            (false, true) => Self::PlusMinus,
            (true, false) => Self::MinusPlus,
            (true, true) => Self::MinusMinus,
        }
    }
}

/// An instruction on operands of some kind. Each operation in it is rounded on its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Instruction<T> {
    /// a.
    Copy(T),
    Unary(Unary, T),
    Binary(Binary, T, T),
    Select(T, T, T),
    /// f(a) b, a not a scalar.
    Product(Factor, T, T),
    /// ± f(a) b ± c, a not a scalar.
    MultiplyAdd(Signs, Factor, [T; 3]),
    /// ± a b ± c d, a and c not scalars.
    TwoProducts(Signs, [T; 4]),
    /// A polynomial of a, not a scalar, with the number of the list of its coefficients.
    Polynomial(T, u32),
}

impl<T: Copy> Instruction<T> {
    /// The same on other operands.
    pub(super) fn map<U>(self, mut of: impl FnMut(T) -> U) -> Instruction<U> {
        match self {
            Self::Copy(a) => Instruction::Copy(of(a)),
            Self::Unary(operation, a) => Instruction::Unary(operation, of(a)),
            Self::Binary(operation, a, b) => Instruction::Binary(operation, of(a), of(b)),
            Self::Select(a, b, c) => Instruction::Select(of(a), of(b), of(c)),
            Self::Product(factor, a, b) => Instruction::Product(factor, of(a), of(b)),
            Self::MultiplyAdd(signs, factor, operands) => {
                Instruction::MultiplyAdd(signs, factor, operands.map(of))
            }
            Self::TwoProducts(signs, operands) => Instruction::TwoProducts(signs, operands.map(of)),
            Self::Polynomial(a, list) => Instruction::Polynomial(of(a), list),
        }
    }

    /// The operands.
    pub(super) fn operands(self) -> Vec<T> {
        let mut operands = Vec::with_capacity(4);
        self.map(|operand| operands.push(operand));
        operands
    }
}

/// An operand of a finished tape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// A place of [`LANES`](crate::formula::LANES) numbers: states first, then registers.
    Lanes(u16),
    /// One number for all lanes.
    Scalar(u32),
}

/// An instruction with the place of its result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    pub(super) instruction: Instruction<Source>,
    /// Number of a register, or of an output.
    pub(super) target: u16,
    pub(super) is_output: bool,
}
