//! Derivatives of drift and noise at every state, from the formulas: what small deviations from a path obey.

use super::TypedEquations;
use crate::formula::graph::{Expression, Symbol};
use crate::formula::tape::{Program, Tape};
use crate::system::tangent::{Tangent, TangentFault};
use crate::system::{ExponentMethod, Facts, System};

impl TypedEquations {
    /// The equations of a system and of the direction of small deviations from its paths, with values of the
    /// parameters in their order; `scales` are lengths that count as equal along the axes.
    ///
    /// # Errors
    /// [`TangentFault`].
    pub(in crate::system) fn tangent(
        &self,
        system: std::sync::Arc<dyn System>,
        parameters: &[f64],
        (scales, by): (&[f64], ExponentMethod),
    ) -> Result<Tangent, TangentFault> {
        let reading = &self.reading;
        let axes = reading.drift_expressions.len();
        fit(axes, reading.is_smooth, system.facts(), by)?;
        let mut graph = reading.scope.graph().clone();
        let mut outputs: Vec<Expression> = Vec::new();
        let own = reading.noise.iter().zip(&reading.noise_axes);
        let amplitudes = own.map(|(process, &axis)| process[axis]);
        for of in reading.drift_expressions.iter().copied().chain(amplitudes) {
            for by in 0..axes {
                let slope = graph.derivative(of, Symbol::State(by));
                outputs.push(slope.map_err(|_| TangentFault::TooLarge)?.value);
            }
        }
        let program = Program::new(&graph, &outputs, axes, parameters.len());
        let tape: Tape = program
            .bind(parameters)
            .map_err(|_| TangentFault::TooLarge)?;
        Ok(Tangent::new(system, tape, &reading.noise_axes, scales))
    }

    /// Why small deviations from paths have no linear equation, whatever the parameters; `None` where they have one.
    pub(in crate::system) fn tangent_fault(
        &self,
        facts: &Facts,
        by: ExponentMethod,
    ) -> Option<TangentFault> {
        let (reading, axes) = (&self.reading, self.reading.drift_expressions.len());
        fit(axes, reading.is_smooth, facts, by).err()
    }
}

/// Nothing, if deviations on so many axes are worked out.
fn fit(
    axes: usize,
    is_smooth: bool,
    facts: &Facts,
    by: ExponentMethod,
) -> Result<(), TangentFault> {
    let by_modes = by == ExponentMethod::Modes;
    let refused = [
        (
            facts.phase.is_some() || facts.period.is_some(),
            TangentFault::Forced,
        ),
        (!is_smooth, TangentFault::Rough),
        (
            by_modes && axes > 1 && !facts.turns.is_empty(),
            TangentFault::Turns,
        ),
        (by_modes && axes > 2, TangentFault::Axes { axes }),
        (
            !by_modes && !facts.reflecting.is_empty(),
            TangentFault::Walls,
        ),
    ];
    let mut refused = refused.into_iter();
    refused
        .find(|(is_so, _)| *is_so)
        .map_or(Ok(()), |(_, fault)| Err(fault))
}
