//! Expressions with their common parts, before parameters have values.

use super::allocate::allocate;
use super::fuse::fuse;
use super::polynomial::nest;
use super::run::Tape;
use super::values::Values;
use crate::formula::graph::{Expression, Graph, Node};
use crate::formula::limits;
use crate::formula::scope::Scope;

/// Some expressions, compiled; they share their common parts. Independent of the scope they come from.
#[derive(Debug, Clone)]
pub struct Program {
    /// Operands before what they are operands of; an expression's number is its position here.
    pub(super) nodes: Vec<Node>,
    pub(super) outputs: Vec<usize>,
    states: usize,
    parameters: usize,
}

/// Why parameters cannot be bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BindError {
    /// Not as many values as parameters.
    #[error("{given} values for {wanted} parameters")]
    Count {
        /// Values given.
        given: usize,
        /// Parameters of the scope.
        wanted: usize,
    },
    /// More intermediate results at one time than `limits::REGISTERS`.
    #[error(
        "the formulas keep more than {} intermediate results at one time",
        limits::REGISTERS
    )]
    TooWide,
}

impl Scope {
    /// Compiles expressions of this scope; a tape made from the program gives their values in this order.
    pub fn compile(&self, expressions: &[Expression]) -> Program {
        let (states, parameters) = (
            self.symbols().states().len(),
            self.symbols().parameters().len(),
        );
        Program::new(self.graph(), expressions, states, parameters)
    }
}

impl Program {
    /// Compiles expressions of a graph with so many states and parameters.
    pub(crate) fn new(
        graph: &Graph,
        expressions: &[Expression],
        states: usize,
        parameters: usize,
    ) -> Self {
        let parts = graph.parts(expressions);
        let position = |expression: Expression| parts.binary_search(&expression).unwrap_or(0);
        let renumbered = |expression: Expression| Expression::from_position(position(expression));
        let renumber = |node: Node| match node {
            Node::Constant(_) | Node::Symbol(_) => node,
            Node::Unary(operation, a) => Node::Unary(operation, renumbered(a)),
            Node::Binary(operation, a, b) => Node::Binary(operation, renumbered(a), renumbered(b)),
            Node::Select(condition, yes, no) => {
                Node::Select(renumbered(condition), renumbered(yes), renumbered(no))
            }
        };
        Self {
            nodes: parts
                .iter()
                .map(|&part| renumber(graph.node(part)))
                .collect(),
            outputs: expressions
                .iter()
                .map(|&expression| position(expression))
                .collect(),
            states,
            parameters,
        }
    }

    /// Number of parameters.
    pub(crate) fn parameters(&self) -> usize {
        self.parameters
    }

    /// A tape for these values of the parameters, in their order. Sums of powers are worked out in nested form
    /// (Horner), which is faster and rounds by a few units in the last place of the largest term otherwise.
    ///
    /// # Errors
    /// [`BindError`].
    pub fn bind(&self, parameters: &[f64]) -> Result<Tape, BindError> {
        let values = self.values(parameters)?;
        self.tape(nest(values))
    }

    /// As [`Program::bind`], every operation as it is written: the bits of
    /// [`Graph::evaluate`](crate::formula::graph::Graph::evaluate).
    ///
    /// # Errors
    /// [`BindError`].
    pub fn bind_as_written(&self, parameters: &[f64]) -> Result<Tape, BindError> {
        let values = self.values(parameters)?;
        self.tape(values)
    }

    fn values(&self, parameters: &[f64]) -> Result<Values, BindError> {
        if parameters.len() != self.parameters {
            return Err(BindError::Count {
                given: parameters.len(),
                wanted: self.parameters,
            });
        }
        Ok(Values::new(&self.nodes, &self.outputs, parameters))
    }

    fn tape(&self, values: Values) -> Result<Tape, BindError> {
        let fused = fuse(&values);
        allocate(values, fused, self.states).ok_or(BindError::TooWide)
    }
}
