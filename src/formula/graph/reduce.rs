//! Operations in which zero counts as zero, whatever it is multiplied with: of derivatives, where a missing term is
//! no term, and of formulas with parameters that are switched off.

use super::{Builder, Expression};
use crate::formula::arithmetic::Binary;

impl Builder<'_> {
    pub(crate) fn is_zero(&self, a: Expression) -> bool {
        self.graph().as_constant(a) == Some(0.0)
    }

    /// As [`Builder::binary`], but 0 x = 0, 0/x = 0 and x + 0 = x.
    pub(crate) fn reduced(
        &mut self,
        operation: Binary,
        a: Expression,
        b: Expression,
    ) -> Expression {
        let (no_a, no_b) = (self.is_zero(a), self.is_zero(b));
        match operation {
            Binary::Multiply if no_a || no_b => self.constant(0.0),
            Binary::Divide if no_a && !no_b => self.constant(0.0),
            Binary::Add if no_a => b,
            Binary::Add | Binary::Subtract if no_b => a,
            Binary::Subtract if no_a => self.negate(b),
            _ => self.binary(operation, a, b),
        }
    }

    pub(crate) fn sum(&mut self, a: Expression, b: Expression) -> Expression {
        self.reduced(Binary::Add, a, b)
    }

    pub(crate) fn difference(&mut self, a: Expression, b: Expression) -> Expression {
        self.reduced(Binary::Subtract, a, b)
    }

    pub(crate) fn product(&mut self, a: Expression, b: Expression) -> Expression {
        self.reduced(Binary::Multiply, a, b)
    }

    pub(crate) fn quotient(&mut self, a: Expression, b: Expression) -> Expression {
        self.reduced(Binary::Divide, a, b)
    }
}
