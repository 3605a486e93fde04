//! Whether expressions are periodic in a symbol: it stands inside sines and cosines only, each of a straight line in
//! it; and time exchanged for a phase.

use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::graph::{Builder, Expression, Graph, Node, PartMap, Symbol, TooLarge};

/// A sine or cosine of a straight line in a symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Wave {
    /// The sine or cosine.
    pub expression: Expression,
    /// The derivative of its argument by the symbol, which does not contain it.
    pub rate: Expression,
    /// The argument where the symbol is zero.
    pub constant: Expression,
}

/// Why an expression is not periodic in a symbol, or not smoothly so, with the part that says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NotPeriodic {
    /// The symbol stands outside sines and cosines.
    Bare(Expression),
    /// The argument of a sine or cosine is no straight line in the symbol with a rate of parameters alone.
    Bent(Expression),
    /// A jump or kink depends on the symbol.
    Torn(Expression),
}

impl Graph {
    /// The sines and cosines with a symbol in them, if all expressions are periodic in it and smooth.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub(crate) fn waves(
        &mut self,
        expressions: &[Expression],
        symbol: Symbol,
    ) -> Result<Result<Vec<Wave>, NotPeriodic>, TooLarge> {
        let parts = self.parts(expressions);
        let contains = self.containing(&parts, symbol);
        let has = |part: Expression| contains.get(part) == Some(true);
        // Whether a part is periodic though the symbol is in it.
        let mut closed = PartMap::new(&parts, false);
        let mut waves = Vec::new();
        for &part in parts.iter().filter(|&&part| has(part)) {
            let node = self.node(part);
            if let Node::Unary(Unary::Sin | Unary::Cos, argument) = node
                && closed.get(argument) != Some(true)
            {
                let Some(line) = self.affine(argument, symbol)? else {
                    return Ok(Err(NotPeriodic::Bent(part)));
                };
                let reach = self.dependence(line.slope);
                if !reach.states.is_empty() || reach.time {
                    return Ok(Err(NotPeriodic::Bent(part)));
                }
                closed.set(part, true);
                waves.push(Wave {
                    expression: part,
                    rate: line.slope,
                    constant: line.constant,
                });
                continue;
            }
            let is_torn = matches!(
                node,
                Node::Unary(Unary::Abs | Unary::Sign | Unary::Step | Unary::Floor, _)
                    | Node::Binary(
                        Binary::Min
                            | Binary::Max
                            | Binary::Less
                            | Binary::LessOrEqual
                            | Binary::Equal
                            | Binary::NotEqual,
                        ..
                    )
            );
            if is_torn {
                return Ok(Err(NotPeriodic::Torn(part)));
            }
            let mut moved = node.operands().filter(|&operand| has(operand)).peekable();
            let is_closed =
                moved.peek().is_some() && moved.all(|one| closed.get(one) == Some(true));
            closed.set(part, is_closed);
        }
        let bare = expressions.iter().copied();
        let mut bare = bare.filter(|&one| has(one) && closed.get(one) != Some(true));
        Ok(match bare.next() {
            Some(bare) => Err(NotPeriodic::Bare(bare)),
            None => Ok(waves),
        })
    }

    /// The expressions with other arguments for some sines and cosines.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub(crate) fn with_arguments(
        &mut self,
        expressions: &[Expression],
        arguments: &[(Expression, Expression)],
    ) -> Result<Vec<Expression>, TooLarge> {
        let replaced = self.remade(expressions, |builder, part, replaced| {
            let given = arguments.iter().find(|(wave, _)| *wave == part);
            match (builder.graph().node(part), given) {
                (Node::Unary(wave, _), Some((_, argument))) => builder.unary(wave, *argument),
                _ => builder.remade(part, replaced, Builder::binary),
            }
        })?;
        let new = expressions.iter();
        Ok(new.map(|&one| replaced.get(one).unwrap_or(one)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::scope::{Scope, Symbols};

    fn scope() -> Scope {
        Scope::new(Symbols::of(&["x"], &["w"])).unwrap()
    }

    fn waves(text: &str) -> Result<usize, String> {
        let mut scope = scope();
        let read = scope.formula(text).unwrap();
        let found = scope.graph_mut().waves(&[read], Symbol::Time).unwrap();
        found.map(|waves| waves.len()).map_err(|why| match why {
            NotPeriodic::Bare(part) => format!("bare {}", scope.typeset(part)),
            NotPeriodic::Bent(part) => format!("bent {}", scope.typeset(part)),
            NotPeriodic::Torn(part) => format!("torn {}", scope.typeset(part)),
        })
    }

    #[test]
    fn what_is_periodic_in_time_is_told_from_what_is_not() {
        assert_eq!(waves("-x^3 + x"), Ok(0));
        assert_eq!(waves("x cos(w t) + sin(2 w t + 0.3)^2"), Ok(2));
        assert_eq!(waves("exp(0.2 cos(w t)) / (2 + sin(x - w t))"), Ok(2));
        assert_eq!(waves("sgn(x) + cos(w t)"), Ok(1));
        assert_eq!(waves("cos(x + 0.3 cos(w t))"), Ok(1));
        assert!(waves("x + t").unwrap_err().starts_with("bare"));
        assert!(waves("t cos(w t)").unwrap_err().starts_with("bare"));
        assert!(waves("cos(w t^2)").unwrap_err().starts_with("bent"));
        assert!(waves("cos(x t)").unwrap_err().starts_with("bent"));
        assert!(waves("sgn(x - cos(w t))").unwrap_err().starts_with("torn"));
        assert!(waves("max(0, sin(w t))").unwrap_err().starts_with("torn"));
    }

    #[test]
    fn other_arguments_are_put_in() {
        let mut scope = scope();
        let read = scope.formula("2 x cos(w t)").unwrap();
        let new = scope.formula("3 x").unwrap();
        let graph = scope.graph_mut();
        let waves = graph.waves(&[read], Symbol::Time).unwrap().unwrap();
        let made = graph
            .with_arguments(&[read], &[(waves[0].expression, new)])
            .unwrap();
        let expected = scope.formula("2 x cos(3 x)").unwrap();
        assert_eq!(made, [expected]);
    }
}
