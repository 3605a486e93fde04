//! How an expression depends on one symbol: as a straight line.

use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::graph::{Builder, Expression, Graph, Node, PartMap, Symbol, TooLarge};

/// constant + slope·symbol; neither contains the symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Affine {
    /// The value where the symbol is zero.
    pub constant: Expression,
    /// The derivative by the symbol.
    pub slope: Expression,
}

impl Graph {
    /// The expression as constant + slope·symbol, equal up to rounding, if its form shows that it is one. `None` does
    /// not prove that it is not: terms that cancel are not looked for.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub(crate) fn affine(
        &mut self,
        expression: Expression,
        symbol: Symbol,
    ) -> Result<Option<Affine>, TooLarge> {
        let parts = self.parts(&[expression]);
        let contains = self.containing(&parts, symbol);
        self.build(|builder| {
            let (zero, one) = (builder.constant(0.0), builder.constant(1.0));
            let mut forms: PartMap<Option<Affine>> = PartMap::new(&parts, None);
            for &part in &parts {
                let form = if contains.get(part) != Some(true) {
                    Some(Affine {
                        constant: part,
                        slope: zero,
                    })
                } else if builder.graph().node(part) == Node::Symbol(symbol) {
                    Some(Affine {
                        constant: zero,
                        slope: one,
                    })
                } else {
                    combine(builder, part, &forms)
                };
                forms.set(part, form);
            }
            forms.get(expression).flatten()
        })
    }
}

/// The form of an operation from those of its operands.
fn combine(
    builder: &mut Builder<'_>,
    part: Expression,
    forms: &PartMap<Option<Affine>>,
) -> Option<Affine> {
    let of = |operand: Expression| forms.get(operand).flatten();
    match builder.graph().node(part) {
        Node::Unary(Unary::Negate, a) => {
            let a = of(a)?;
            let (constant, slope) = (builder.negate(a.constant), builder.negate(a.slope));
            Some(Affine { constant, slope })
        }
        Node::Binary(operation @ (Binary::Add | Binary::Subtract), a, b) => {
            let (a, b) = (of(a)?, of(b)?);
            Some(Affine {
                constant: builder.reduced(operation, a.constant, b.constant),
                slope: builder.reduced(operation, a.slope, b.slope),
            })
        }
        Node::Binary(operation @ (Binary::Multiply | Binary::Divide), a, b) => {
            let (a, b) = (of(a)?, of(b)?);
            let (line, factor) = if builder.is_zero(b.slope) {
                (a, b.constant)
            } else if operation == Binary::Multiply && builder.is_zero(a.slope) {
                (b, a.constant)
            } else {
                return None;
            };
            Some(Affine {
                constant: builder.reduced(operation, line.constant, factor),
                slope: builder.reduced(operation, line.slope, factor),
            })
        }
        Node::Select(condition, yes, no) => {
            let (free, yes, no) = (of(condition)?, of(yes)?, of(no)?);
            builder.is_zero(free.slope).then(|| Affine {
                constant: builder.select(condition, yes.constant, no.constant),
                slope: builder.select(condition, yes.slope, no.slope),
            })
        }
        _ => None,
    }
}
