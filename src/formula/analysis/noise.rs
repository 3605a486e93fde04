//! What state-dependent noise does to the drift.

use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::graph::{Expression, Graph, Node, Symbol, TooLarge};

impl Graph {
    /// The drift of the Itô equation that is the same process as the Stratonovich equation
    /// dX = drift dt + Σ_k b_k ∘ dW_k: drift_i + ½ Σ_k Σ_j b_jk ∂b_ik/∂x_j, for `noise[k][j]` the amplitude b_jk of
    /// process k on axis j. The second part lists what the amplitudes' derivatives do not hold at (see
    /// [`Derivative::jumps`](crate::formula::graph::Derivative::jumps)): there the two readings of the equation differ
    /// by more.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub(crate) fn ito_drift(
        &mut self,
        drift: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<(Vec<Expression>, Vec<Expression>), TooLarge> {
        let mut jumps: Vec<Expression> = Vec::new();
        let mut corrected = drift.to_vec();
        for process in noise {
            for (axis, drift) in corrected.iter_mut().enumerate() {
                let Some(&amplitude) = process.get(axis) else {
                    continue;
                };
                for (other, &strength) in process.iter().enumerate() {
                    let derivative = self.derivative(amplitude, Symbol::State(other))?;
                    if self.as_constant(strength) == Some(0.0) {
                        continue;
                    }
                    for jump in derivative.jumps {
                        if !jumps.contains(&jump) {
                            jumps.push(jump);
                        }
                    }
                    let square = match other == axis {
                        true => self.square_of_root(amplitude, axis)?,
                        false => None,
                    };
                    if let Some(square) = square {
                        // ½ b b' = ¼ (b²)', which has a value where b² is zero and b' has none.
                        let slope = self.derivative(square, Symbol::State(axis))?.value;
                        *drift = self.build(|builder| {
                            let quarter = builder.constant(0.25);
                            let term = builder.product(quarter, slope);
                            builder.sum(*drift, term)
                        })?;
                        continue;
                    }
                    *drift = self.build(|builder| {
                        let half = builder.constant(0.5);
                        let product = builder.product(strength, derivative.value);
                        let term = builder.product(half, product);
                        builder.sum(*drift, term)
                    })?;
                }
            }
        }
        Ok((corrected, jumps))
    }

    /// The square of an amplitude in which the root of what depends on its axis is a factor.
    fn square_of_root(
        &mut self,
        amplitude: Expression,
        axis: usize,
    ) -> Result<Option<Expression>, TooLarge> {
        let Some(parts) = self.parts_of_root(amplitude) else {
            return Ok(None);
        };
        let slope = self.derivative(parts.radicand, Symbol::State(axis))?.value;
        if self.as_constant(slope) == Some(0.0) {
            return Ok(None);
        }
        let square = self.build(|builder| {
            let mut square = parts.radicand;
            for &factor in &parts.factors {
                let twice = builder.product(factor, factor);
                square = builder.product(twice, square);
            }
            for &divisor in &parts.divisors {
                let twice = builder.product(divisor, divisor);
                square = builder.quotient(square, twice);
            }
            square
        })?;
        Ok(Some(square))
    }

    /// The first root that is a factor of an expression, and the others; their signs do not matter.
    fn parts_of_root(&self, expression: Expression) -> Option<PartsOfRoot> {
        let with = |of: Expression, factor: Option<Expression>, divisor: Option<Expression>| {
            let mut parts = self.parts_of_root(of)?;
            parts.factors.extend(factor);
            parts.divisors.extend(divisor);
            Some(parts)
        };
        match self.node(expression) {
            Node::Unary(Unary::Sqrt, radicand) => Some(PartsOfRoot {
                radicand,
                factors: Vec::new(),
                divisors: Vec::new(),
            }),
            Node::Unary(Unary::Negate, of) => self.parts_of_root(of),
            Node::Binary(Binary::Divide, above, below) => with(above, None, Some(below)),
            Node::Binary(Binary::Multiply, a, b) => {
                with(a, Some(b), None).or_else(|| with(b, Some(a), None))
            }
            _ => None,
        }
    }
}

/// An expression as a root times factors over divisors.
struct PartsOfRoot {
    radicand: Expression,
    factors: Vec<Expression>,
    divisors: Vec<Expression>,
}
