//! Makes expressions anew with something else in the place of some of their parts.

use super::{Builder, Expression, Graph, Node, PartMap, Symbol, TooLarge};
use crate::formula::arithmetic::Binary;

impl Graph {
    /// The expression with numbers for all parameters, and products with a zero among them gone: zero times x counts
    /// as zero, which is what a parameter that is switched off means.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub(crate) fn bound(
        &mut self,
        expression: Expression,
        parameters: &[f64],
    ) -> Result<Expression, TooLarge> {
        let numbers = self.build(|builder| {
            let numbers = parameters.iter().map(|&value| builder.constant(value));
            numbers.collect::<Vec<_>>()
        })?;
        let bound = self.remade(&[expression], |builder, part, replaced| {
            match builder.graph().node(part) {
                Node::Symbol(Symbol::Parameter(number)) => {
                    numbers.get(number).copied().unwrap_or(part)
                }
                _ => builder.remade(part, replaced, Builder::reduced),
            }
        })?;
        Ok(bound.get(expression).unwrap_or(expression))
    }

    /// What stands for each part of expressions, operands before what is made of them: `new` is told the part and what
    /// stands for its operands.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub(crate) fn remade(
        &mut self,
        expressions: &[Expression],
        new: impl Fn(&mut Builder<'_>, Expression, &PartMap<Expression>) -> Expression,
    ) -> Result<PartMap<Expression>, TooLarge> {
        let parts = self.parts(expressions);
        let mut replaced = PartMap::new(&parts, Expression(0));
        self.build(|builder| {
            for &part in &parts {
                let new = new(builder, part, &replaced);
                replaced.set(part, new);
            }
        })?;
        Ok(replaced)
    }
}

impl Builder<'_> {
    /// A part of what stands for its operands, with `binary` for the operations of two.
    pub(crate) fn remade(
        &mut self,
        part: Expression,
        replaced: &PartMap<Expression>,
        binary: impl Fn(&mut Self, Binary, Expression, Expression) -> Expression,
    ) -> Expression {
        let of = |operand: Expression| replaced.get(operand).unwrap_or(operand);
        match self.graph().node(part) {
            Node::Constant(_) | Node::Symbol(_) => part,
            Node::Unary(operation, a) => self.unary(operation, of(a)),
            Node::Binary(operation, a, b) => binary(self, operation, of(a), of(b)),
            Node::Select(condition, yes, no) => self.select(of(condition), of(yes), of(no)),
        }
    }
}
