//! Puts numbers for parameters.

use super::{Expression, Graph, Node, PartMap, Symbol, TooLarge};

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
        let parts = self.parts(&[expression]);
        let mut replaced = PartMap::new(&parts, expression);
        self.build(|builder| {
            for &part in &parts {
                let of = |operand: Expression| replaced.get(operand).unwrap_or(operand);
                let new = match builder.graph().node(part) {
                    Node::Symbol(Symbol::Parameter(number)) => {
                        numbers.get(number).copied().unwrap_or(part)
                    }
                    Node::Constant(_) | Node::Symbol(_) => part,
                    Node::Unary(operation, a) => builder.unary(operation, of(a)),
                    Node::Binary(operation, a, b) => builder.reduced(operation, of(a), of(b)),
                    Node::Select(condition, yes, no) => {
                        builder.select(of(condition), of(yes), of(no))
                    }
                };
                replaced.set(part, new);
            }
            replaced.get(expression).unwrap_or(expression)
        })
    }
}
