//! Coordinates without noise that relax linearly, found in the formulas: v' = g - λ v, where g does not depend on v,
//! and λ on parameters only. Hermite modes can carry them.

use crate::formula::graph::{Expression, Graph, Symbol, TooLarge};

/// Rates λ of the axes that are `free` of noise and bounds, one an axis; `None` where the form of the drift does not
/// show one. Its sign depends on the parameters.
///
/// # Errors
/// [`TooLarge`].
pub(super) fn rates(
    graph: &mut Graph,
    drift: &[Expression],
    free: &dyn Fn(usize) -> bool,
) -> Result<Vec<Option<Expression>>, TooLarge> {
    let axes = drift.iter().enumerate();
    axes.map(|(axis, &drift)| match free(axis) {
        true => rate(graph, drift, axis),
        false => Ok(None),
    })
    .collect()
}

fn rate(graph: &mut Graph, drift: Expression, axis: usize) -> Result<Option<Expression>, TooLarge> {
    let Some(line) = graph.affine(drift, Symbol::State(axis))? else {
        return Ok(None);
    };
    let dependence = graph.dependence(line.slope);
    if dependence.time
        || !dependence.states.is_empty()
        || graph.as_constant(line.slope) == Some(0.0)
    {
        return Ok(None);
    }
    graph.build(|builder| builder.negate(line.slope)).map(Some)
}
