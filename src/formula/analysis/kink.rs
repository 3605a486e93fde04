//! Where an expression is not smooth.

use crate::formula::arithmetic::{Binary, Unary, small_integer};
use crate::formula::graph::{Builder, Expression, Graph, Node, Symbol, TooLarge};
use crate::formula::limits;

/// How an expression fails to be smooth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum KinkKind {
    /// Continuous with a jump of the slope: `abs`, `min`, `max`.
    Corner,
    /// A jump: `sign`, `step`, comparisons.
    Jump,
    /// A jump wherever the argument is an integer: `floor`.
    Steps,
}

/// A plane on which a state has one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Surface {
    /// Number of the state.
    pub state: usize,
    /// Its value there, free of states and time. Where it is not a real number (the root of a negative one) there is
    /// no such plane.
    pub at: Expression,
}

/// Where an expression is not smooth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum KinkPlace {
    /// On planes of one state each.
    Surfaces(Vec<Surface>),
    /// On a surface that bends or is oblique: the argument contains several states.
    Oblique,
    /// Where a function of one state is zero that cannot be solved for it.
    Unsolved,
    /// On many planes, one for each integer.
    Everywhere,
    /// On a surface that moves: the argument contains time.
    Moving,
}

/// A place where an expression may fail to be smooth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kink {
    /// The expression whose zeros (for [`KinkKind::Steps`]: integers) are the place.
    pub argument: Expression,
    /// How the expression fails to be smooth there.
    pub kind: KinkKind,
    /// The place.
    pub place: KinkPlace,
}

impl Graph {
    /// All places where an expression may fail to be smooth, each once, the first `limits::KINKS` of them. What
    /// depends on parameters alone has none.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub fn kinks(&mut self, expression: Expression) -> Result<Vec<Kink>, TooLarge> {
        let mut found: Vec<(Expression, KinkKind)> = Vec::new();
        for part in self.parts(&[expression]) {
            let Some((argument, kind)) = self.kink_of(part)? else {
                continue;
            };
            let reach = self.reach(argument);
            if reach.states == 0 && !reach.time {
                continue;
            }
            let argument = self.without_sign(argument);
            let opposite = self.opposite(argument);
            let same = |known: Expression| known == argument || Some(self.node(known)) == opposite;
            if found.len() == limits::KINKS {
                break;
            }
            match found.iter_mut().find(|(known, _)| same(*known)) {
                Some((_, known)) => *known = kind.max(*known),
                None => found.push((argument, kind)),
            }
        }
        let mut kinks = Vec::with_capacity(found.len());
        for (argument, kind) in found {
            let place = self.place(argument, kind)?;
            kinks.push(Kink {
                argument,
                kind,
                place,
            });
        }
        Ok(kinks)
    }

    fn kink_of(&mut self, part: Expression) -> Result<Option<(Expression, KinkKind)>, TooLarge> {
        Ok(match self.node(part) {
            Node::Unary(Unary::Sign | Unary::Step, a) => Some((a, KinkKind::Jump)),
            Node::Unary(Unary::Abs, a) => Some((a, KinkKind::Corner)),
            Node::Unary(Unary::Floor, a) => Some((a, KinkKind::Steps)),
            Node::Binary(Binary::Min | Binary::Max, a, b) => Some((
                self.build(|builder| builder.difference(a, b))?,
                KinkKind::Corner,
            )),
            Node::Binary(operation, a, b) if operation.is_comparison() => Some((
                self.build(|builder| builder.difference(a, b))?,
                KinkKind::Jump,
            )),
            Node::Select(condition, ..) => {
                let node = self.node(condition);
                let compared = matches!(node, Node::Binary(own, ..) if own.is_comparison());
                (!compared).then_some((condition, KinkKind::Jump))
            }
            _ => None,
        })
    }

    fn without_sign(&self, expression: Expression) -> Expression {
        match self.node(expression) {
            Node::Unary(Unary::Negate, inner) => inner,
            _ => expression,
        }
    }

    /// b - a for a - b.
    fn opposite(&self, expression: Expression) -> Option<Node> {
        match self.node(expression) {
            Node::Binary(Binary::Subtract, a, b) => Some(Node::Binary(Binary::Subtract, b, a)),
            _ => None,
        }
    }

    fn place(&mut self, argument: Expression, kind: KinkKind) -> Result<KinkPlace, TooLarge> {
        let reach = self.reach(argument);
        if reach.time {
            return Ok(KinkPlace::Moving);
        }
        if kind == KinkKind::Steps {
            return Ok(KinkPlace::Everywhere);
        }
        if reach.states.count_ones() != 1 {
            return Ok(KinkPlace::Oblique);
        }
        let state = reach.states.trailing_zeros() as usize;
        let zeros = self.zeros(argument, Symbol::State(state))?;
        Ok(match zeros {
            Some(zeros) => {
                let surfaces = zeros.into_iter().map(|at| Surface { state, at });
                KinkPlace::Surfaces(surfaces.collect())
            }
            None => KinkPlace::Unsolved,
        })
    }

    /// Where an expression is zero as a function of one symbol: products, powers, straight lines, and distances
    /// |v| = r or v² = r of straight lines v.
    fn zeros(
        &mut self,
        expression: Expression,
        symbol: Symbol,
    ) -> Result<Option<Vec<Expression>>, TooLarge> {
        let mut zeros = Vec::new();
        let mut ahead = vec![expression];
        while let Some(next) = ahead.pop() {
            if !self.contains(next, symbol) {
                continue;
            }
            if let Some(line) = self.affine(next, symbol)? {
                let zero = self.build(|builder| {
                    let constant = builder.negate(line.constant);
                    builder.quotient(constant, line.slope)
                })?;
                if !zeros.contains(&zero) {
                    zeros.push(zero);
                }
                continue;
            }
            match self.node(next) {
                Node::Unary(Unary::Negate | Unary::Abs | Unary::Sign, a) => ahead.push(a),
                Node::Binary(Binary::Multiply, a, b) => ahead.extend([b, a]),
                Node::Binary(Binary::Divide, a, b) if !self.contains(b, symbol) => ahead.push(a),
                Node::Binary(Binary::Power, a, b)
                    if self.as_constant(b).is_some_and(|exponent| exponent > 0.0) =>
                {
                    ahead.push(a);
                }
                Node::Binary(Binary::Add | Binary::Subtract, ..) => {
                    let Some((inner, distance)) = self.distance(next, symbol)? else {
                        return Ok(None);
                    };
                    let sides = self.build(|builder| {
                        [
                            builder.difference(inner, distance),
                            builder.sum(inner, distance),
                        ]
                    })?;
                    for side in sides {
                        if self.affine(side, symbol)?.is_none() {
                            return Ok(None);
                        }
                    }
                    ahead.extend([sides[0], sides[1]]);
                }
                _ => return Ok(None),
            }
        }
        Ok(Some(zeros))
    }

    /// v and r where the expression is zero exactly for |v| = r: of a|v| + b and a v² + b with a, b free of the symbol.
    fn distance(
        &mut self,
        expression: Expression,
        symbol: Symbol,
    ) -> Result<Option<(Expression, Expression)>, TooLarge> {
        // The one part that is |v| or v² takes the place of the symbol in a straight line.
        let parts = self.parts(&[expression]);
        let mut measures = parts.iter().filter_map(|&part| match self.node(part) {
            Node::Unary(Unary::Abs, inner) => Some((part, inner, false)),
            Node::Binary(Binary::Power, inner, exponent) => {
                let square = self.as_constant(exponent).and_then(small_integer) == Some(2);
                square.then_some((part, inner, true))
            }
            _ => None,
        });
        let Some((measure, inner, is_square)) =
            measures.find(|(part, ..)| self.contains(*part, symbol))
        else {
            return Ok(None);
        };
        // Time cannot occur in these expressions and stands for the part.
        let replaced = self.replace(expression, measure, Symbol::Time)?;
        if self.contains(replaced, symbol) {
            return Ok(None);
        }
        let Some(line) = self.affine(replaced, Symbol::Time)? else {
            return Ok(None);
        };
        let distance = self.build(|builder| {
            let constant = builder.negate(line.constant);
            let distance = builder.quotient(constant, line.slope);
            if is_square {
                builder.unary(Unary::Sqrt, distance)
            } else {
                distance
            }
        })?;
        Ok(Some((inner, distance)))
    }

    /// The expression with one part replaced by a symbol.
    fn replace(
        &mut self,
        expression: Expression,
        part: Expression,
        by: Symbol,
    ) -> Result<Expression, TooLarge> {
        let symbol = self.build(|builder| builder.symbol(by))?;
        let replaced = self.remade(&[expression], |builder, own, replaced| {
            if own == part {
                return symbol;
            }
            builder.remade(own, replaced, Builder::binary)
        })?;
        Ok(replaced.get(expression).unwrap_or(expression))
    }
}
