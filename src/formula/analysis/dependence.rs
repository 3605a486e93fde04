//! Which symbols an expression contains.

use crate::formula::graph::{Expression, Graph, Node, Symbol};

/// The symbols of an expression, each kind in ascending order.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Dependence {
    /// Numbers of the states.
    pub states: Vec<usize>,
    /// Numbers of the parameters.
    pub parameters: Vec<usize>,
    /// Whether time occurs.
    pub time: bool,
}

impl Graph {
    /// Which symbols occur in an expression, whether or not its value changes with them.
    pub(crate) fn dependence(&self, expression: Expression) -> Dependence {
        let mut dependence = Dependence::default();
        for part in self.parts(&[expression]) {
            match self.node(part) {
                Node::Symbol(Symbol::State(state)) => dependence.states.push(state),
                Node::Symbol(Symbol::Parameter(number)) => dependence.parameters.push(number),
                Node::Symbol(Symbol::Time) => dependence.time = true,
                _ => {}
            }
        }
        dependence.states.sort_unstable();
        dependence.parameters.sort_unstable();
        dependence
    }
}
