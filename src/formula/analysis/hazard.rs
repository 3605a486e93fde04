//! Where on a box an expression is not a number or overflows.
//!
//! Interval arithmetic finds the operations that may fail; boxes are halved until a state is found at which one does,
//! or none is left in which it might.

mod search;

use super::interval::Interval;
use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::graph::{Expression, Graph, Node, PartMap, Symbol};

/// Where an expression is looked at: an interval for each state, parameter and for time.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    /// One interval a state.
    pub states: Vec<Interval>,
    /// One interval a parameter.
    pub parameters: Vec<Interval>,
    /// Times.
    pub time: Interval,
}

/// How an operation fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HazardKind {
    /// A quotient whose divisor is zero.
    DivisionByZero,
    /// A logarithm of zero or a negative number.
    Logarithm,
    /// A square root of a negative number.
    Root,
    /// A power that is not an integer of a negative number, or a negative power of zero.
    Power,
    /// An inverse sine or cosine of a number beyond ±1.
    Inverse,
    /// A tangent at an odd multiple of π/2.
    Pole,
    /// A finite operation with a result beyond the range of numbers.
    Overflow,
}

impl HazardKind {
    /// The failure in words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::DivisionByZero => "division by zero",
            Self::Logarithm => "logarithm of a number that is not positive",
            Self::Root => "square root of a negative number",
            Self::Power => "power of a negative number or negative power of zero",
            Self::Inverse => "inverse sine or cosine of a number beyond 1",
            Self::Pole => "tangent at a pole",
            Self::Overflow => "overflow",
        }
    }
}

/// An operation that fails somewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Hazard {
    /// How it fails.
    pub kind: HazardKind,
    /// The operation.
    pub part: Expression,
    /// A state at or next to which it fails.
    pub state: Vec<f64>,
    /// Values of the parameters there.
    pub parameters: Vec<f64>,
    /// Time there.
    pub time: f64,
    /// Whether it surely fails there; otherwise that could not be excluded.
    pub certain: bool,
}

/// Most operations that are searched for.
const MOST_HAZARDS: usize = 8;

impl Graph {
    /// Operations of an expression that fail, or may fail, somewhere in a domain; those whose operands may fail are
    /// left to them. Branches of `if` that are not taken do not count.
    pub fn hazards(&self, expression: Expression, domain: &Domain) -> Vec<Hazard> {
        let mut bounds = Bounds::new(self, expression);
        bounds.work_out(domain);
        let candidates: Vec<_> = bounds.hazards.iter().copied().take(MOST_HAZARDS).collect();
        let found = candidates
            .into_iter()
            .filter_map(|(part, kind)| search::search(&mut bounds, domain, part, kind));
        found.collect()
    }

    /// An interval that contains all values of an expression in a domain, where it has one.
    pub(crate) fn range(&self, expression: Expression, domain: &Domain) -> Interval {
        let mut bounds = Bounds::new(self, expression);
        bounds.work_out(domain);
        bounds.of(expression)
    }
}

/// Intervals of all parts of an expression, and the operations that may fail.
struct Bounds<'a> {
    graph: &'a Graph,
    expression: Expression,
    parts: Vec<Expression>,
    values: PartMap<Interval>,
    /// Parts that are not surely defined.
    doubtful: PartMap<bool>,
    /// Parts that the expression needs where it is looked at.
    active: PartMap<bool>,
    hazards: Vec<(Expression, HazardKind)>,
}

impl<'a> Bounds<'a> {
    fn new(graph: &'a Graph, expression: Expression) -> Self {
        let parts = graph.parts(&[expression]);
        Self {
            graph,
            expression,
            values: PartMap::new(&parts, Interval::ALL),
            doubtful: PartMap::new(&parts, false),
            active: PartMap::new(&parts, false),
            parts,
            hazards: Vec::new(),
        }
    }

    fn of(&self, part: Expression) -> Interval {
        self.values.get(part).unwrap_or(Interval::ALL)
    }

    fn work_out(&mut self, domain: &Domain) {
        let mut hazards = Vec::new();
        for index in 0..self.parts.len() {
            let part = self.parts[index];
            let node = self.graph.node(part);
            let (value, hazard) = self.value_of(node, domain);
            let mut doubtful = match node {
                Node::Select(condition, yes, no) => {
                    let (takes_yes, takes_no) = self.branches(condition);
                    self.is_doubtful(condition)
                        || takes_yes && self.is_doubtful(yes)
                        || takes_no && self.is_doubtful(no)
                }
                _ => node.operands().any(|operand| self.is_doubtful(operand)),
            };
            if let Some(kind) = hazard
                && !doubtful
            {
                hazards.push((part, kind));
                doubtful = true;
            }
            self.values
                .set(part, if doubtful { Interval::ALL } else { value });
            self.doubtful.set(part, doubtful);
        }
        self.find_active();
        hazards.retain(|(part, _)| self.active.get(*part) == Some(true));
        self.hazards = hazards;
    }

    fn is_doubtful(&self, part: Expression) -> bool {
        self.doubtful.get(part) == Some(true)
    }

    /// Whether a condition may hold and whether it may not.
    fn branches(&self, condition: Expression) -> (bool, bool) {
        let value = self.of(condition);
        (value.low != 0.0 || value.high != 0.0, value.contains(0.0))
    }

    fn find_active(&mut self) {
        for &part in &self.parts {
            self.active.set(part, false);
        }
        self.active.set(self.expression, true);
        for index in (0..self.parts.len()).rev() {
            let part = self.parts[index];
            if self.active.get(part) != Some(true) {
                continue;
            }
            match self.graph.node(part) {
                Node::Select(condition, yes, no) => {
                    let (takes_yes, takes_no) = self.branches(condition);
                    self.active.set(condition, true);
                    for (operand, taken) in [(yes, takes_yes), (no, takes_no)] {
                        if taken {
                            self.active.set(operand, true);
                        }
                    }
                }
                node => node
                    .operands()
                    .for_each(|operand| self.active.set(operand, true)),
            }
        }
    }

    /// The interval of an operation, and how it may fail.
    fn value_of(&self, node: Node, domain: &Domain) -> (Interval, Option<HazardKind>) {
        let interval = |intervals: &[Interval], number: usize| {
            intervals.get(number).copied().unwrap_or(Interval::ALL)
        };
        match node {
            Node::Constant(number) => (Interval::point(number.value()), None),
            Node::Symbol(Symbol::State(state)) => (interval(&domain.states, state), None),
            Node::Symbol(Symbol::Parameter(number)) => (interval(&domain.parameters, number), None),
            Node::Symbol(Symbol::Time) => (domain.time, None),
            Node::Unary(operation, a) => {
                let a = self.of(a);
                let value = a.unary(operation);
                (
                    value,
                    unary_hazard(operation, a).or(overflow(value, a.is_bounded())),
                )
            }
            Node::Binary(operation, a, b) => {
                let (a, b) = (self.of(a), self.of(b));
                let value = a.binary(operation, b);
                let hazard = binary_hazard(operation, a, b);
                (
                    value,
                    hazard.or(overflow(value, a.is_bounded() && b.is_bounded())),
                )
            }
            Node::Select(condition, yes, no) => {
                let value = match self.branches(condition) {
                    (true, false) => self.of(yes),
                    (false, true) => self.of(no),
                    _ => self.of(yes).join(self.of(no)),
                };
                (value, None)
            }
        }
    }
}

fn overflow(value: Interval, from_bounded: bool) -> Option<HazardKind> {
    (from_bounded && !value.is_bounded()).then_some(HazardKind::Overflow)
}

fn unary_hazard(operation: Unary, a: Interval) -> Option<HazardKind> {
    match operation {
        Unary::Log | Unary::Log10 => (a.low <= 0.0).then_some(HazardKind::Logarithm),
        Unary::Sqrt => (a.low < 0.0).then_some(HazardKind::Root),
        Unary::Asin | Unary::Acos => (a.low < -1.0 || a.high > 1.0).then_some(HazardKind::Inverse),
        Unary::Tan => (!a.unary(operation).is_bounded()).then_some(HazardKind::Pole),
        _ => None,
    }
}

fn binary_hazard(operation: Binary, a: Interval, b: Interval) -> Option<HazardKind> {
    match operation {
        Binary::Divide => b.contains(0.0).then_some(HazardKind::DivisionByZero),
        Binary::Power => {
            let fails = match (b.low == b.high && b.low.fract() == 0.0).then_some(b.low) {
                Some(n) => n < 0.0 && a.contains(0.0),
                None => a.low < 0.0 || (a.contains(0.0) && b.low < 0.0),
            };
            fails.then_some(HazardKind::Power)
        }
        _ => None,
    }
}
