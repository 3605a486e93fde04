//! What state-dependent noise does to the drift.

use crate::formula::graph::{Expression, Graph, Symbol, TooLarge};

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
}
