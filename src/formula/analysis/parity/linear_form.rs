//! Sums of states with factors: what a reflection does to them.

use crate::formula::analysis::reflection::{Parity, Reflection};
use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::graph::{Expression, Node, Symbol};

/// constant + Σ slope_i x_i.
#[derive(Debug, Clone)]
pub(super) struct LinearForm {
    constant: f64,
    slopes: Vec<f64>,
}

impl LinearForm {
    pub(super) fn of(
        node: Node,
        line: &impl Fn(Expression) -> Option<LinearForm>,
        dimension: usize,
    ) -> Option<Self> {
        let constant = |constant| LinearForm {
            constant,
            slopes: vec![0.0; dimension],
        };
        match node {
            Node::Constant(number) => Some(constant(number.value())),
            Node::Symbol(Symbol::State(state)) => {
                let mut own = constant(0.0);
                *own.slopes.get_mut(state)? = 1.0;
                Some(own)
            }
            Node::Unary(Unary::Negate, a) => line(a).map(|a| a.scaled(-1.0)),
            Node::Binary(Binary::Add, a, b) => Some(line(a)?.plus(&line(b)?, 1.0)),
            Node::Binary(Binary::Subtract, a, b) => Some(line(a)?.plus(&line(b)?, -1.0)),
            Node::Binary(Binary::Multiply, a, b) => {
                let (a, b) = (line(a)?, line(b)?);
                match (a.number(), b.number()) {
                    (Some(factor), _) => Some(b.scaled(factor)),
                    (_, Some(factor)) => Some(a.scaled(factor)),
                    _ => None,
                }
            }
            Node::Binary(Binary::Divide, a, b) => {
                let divisor = line(b)?.number()?;
                line(a).map(|a| a.scaled(1.0 / divisor))
            }
            _ => None,
        }
    }

    fn number(&self) -> Option<f64> {
        self.slopes
            .iter()
            .all(|slope| *slope == 0.0)
            .then_some(self.constant)
    }

    fn scaled(mut self, factor: f64) -> Self {
        self.constant *= factor;
        self.slopes.iter_mut().for_each(|slope| *slope *= factor);
        self
    }

    fn plus(mut self, other: &Self, factor: f64) -> Self {
        self.constant += factor * other.constant;
        for (slope, other) in self.slopes.iter_mut().zip(&other.slopes) {
            *slope += factor * other;
        }
        self
    }

    /// Even without slopes along reflected axes, odd if the value at the centre is zero and other slopes are too.
    pub(super) fn parity(&self, reflection: &Reflection) -> Option<Parity> {
        let (mut centre, mut size) = (self.constant, self.constant.abs());
        let (mut even, mut odd) = (true, true);
        for ((slope, reflected), at) in self
            .slopes
            .iter()
            .zip(&reflection.reflected)
            .zip(&reflection.centre)
        {
            if *reflected {
                centre += slope * at;
                size += (slope * at).abs();
                even &= *slope == 0.0;
            } else {
                odd &= *slope == 0.0;
            }
        }
        odd &= centre.abs() <= 4.0 * f64::EPSILON * size;
        match (even, odd) {
            (true, true) => Some(Parity::Zero),
            (true, false) => Some(Parity::Even),
            (false, true) => Some(Parity::Odd),
            (false, false) => None,
        }
    }
}
