//! Whether an expression is even or odd under a reflection of the state.

mod linear_form;

use linear_form::LinearForm;

use super::reflection::{Parity, Reflection};
use crate::formula::arithmetic::{Binary, Unary, small_integer};
use crate::formula::graph::{Evaluator, Expression, Graph, Node, PartMap, Point, Symbol, TooLarge};

/// The parity of an expression and how it is known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ParityFinding {
    /// What the reflection does.
    pub parity: Parity,
    /// Whether the form of the expression shows it; otherwise trials at many states do.
    pub proven: bool,
    /// A state at which it is not even, where that was found by trial.
    pub not_even: Option<Vec<f64>>,
    /// A state at which it is not odd, where that was found by trial.
    pub not_odd: Option<Vec<f64>>,
}

/// Trial states at each of [`SCALES`].
const TRIALS: usize = 200;
/// Half-widths of the boxes that trial states are drawn from.
const SCALES: [f64; 3] = [0.1, 1.0, 4.0];
/// Largest difference, relative to the largest value among the trials, that counts as rounding.
const ROUNDING: f64 = 1e-11;
/// Trial states at each of [`FAR_SCALES`].
const FAR_TRIALS: usize = 40;
/// The same for systems in other units: an oscillator a micrometre wide has terms that are lost in rounding at states
/// of size one.
const FAR_SCALES: [f64; 6] = [1e-3, 1e3, 1e-6, 1e6, 1e-9, 1e9];
/// Relative difference there that is none of rounding.
const CLEAR: f64 = 1e-6;
/// Product of the shares that sums lose to cancellation, up to which a value has digits enough to be compared so.
const MOST_CANCELLED: f64 = 1e8;

impl Graph {
    /// What a reflection does to an expression with these values of the parameters.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub(crate) fn parity(
        &mut self,
        expression: Expression,
        reflection: &Reflection,
        parameters: &[f64],
    ) -> Result<ParityFinding, TooLarge> {
        let bound = self.bound(expression, parameters)?;
        let parity = self.parity_by_form(bound, reflection);
        if let Some(parity) = parity {
            return Ok(ParityFinding {
                parity,
                proven: true,
                not_even: None,
                not_odd: None,
            });
        }
        Ok(self.parity_by_trial(bound, reflection))
    }

    /// The parity that the form of an expression without parameters shows.
    fn parity_by_form(&self, expression: Expression, reflection: &Reflection) -> Option<Parity> {
        let parts = self.parts(&[expression]);
        let mut lines: Vec<Option<LinearForm>> = Vec::with_capacity(parts.len());
        let mut parities: PartMap<Option<Parity>> = PartMap::new(&parts, None);
        for &part in &parts {
            let line = |operand: Expression| {
                let position = parts.binary_search(&operand).ok()?;
                lines.get(position)?.clone()
            };
            let of = |operand: Expression| parities.get(operand).flatten();
            let own = LinearForm::of(self.node(part), &line, reflection.reflected.len());
            let parity = own
                .as_ref()
                .and_then(|line| line.parity(reflection))
                .or_else(|| parity_of(self, self.node(part), &of));
            parities.set(part, parity);
            lines.push(own);
        }
        parities.get(expression).flatten()
    }

    /// The same, looked for at many states even where the form of the expression shows it.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub(super) fn parity_of_trials(
        &mut self,
        expression: Expression,
        reflection: &Reflection,
        parameters: &[f64],
    ) -> Result<ParityFinding, TooLarge> {
        let bound = self.bound(expression, parameters)?;
        Ok(self.parity_by_trial(bound, reflection))
    }

    /// All sums and differences in an expression, each with its operands.
    fn sums(&self, expression: Expression) -> Vec<[Expression; 3]> {
        let parts = self.parts(&[expression]).into_iter();
        let sums = parts.filter_map(|part| match self.node(part) {
            Node::Binary(Binary::Add | Binary::Subtract, a, b) => Some([part, a, b]),
            _ => None,
        });
        sums.collect()
    }

    fn parity_by_trial(&self, expression: Expression, reflection: &Reflection) -> ParityFinding {
        let mut evaluator = Evaluator::new(self, &[expression]);
        let value = |evaluator: &mut Evaluator, state: &[f64], time: f64| {
            let parameters = &[];
            let states = state;
            evaluator.evaluate(
                self,
                &Point {
                    states,
                    parameters,
                    time,
                },
            );
            evaluator.value(expression)
        };
        let mut random = Random(7);
        let (mut not_even, mut not_odd) = (None, None);
        for scale in SCALES {
            let mut trials = Vec::with_capacity(TRIALS);
            for _ in 0..TRIALS {
                let state = random.state(reflection, scale);
                let (time, mirrored) = (random.symmetric(10.0), reflection.mirrored(&state));
                let here = value(&mut evaluator, &state, time);
                let there = value(&mut evaluator, &mirrored, time);
                if here.is_finite() || there.is_finite() {
                    trials.push((here, there, state));
                }
            }
            let size = trials
                .iter()
                .map(|(here, _, _)| here.abs())
                .filter(|size| size.is_finite());
            let rounding = ROUNDING * size.fold(0.0, f64::max);
            for (here, there, state) in trials {
                // Infinite on one side alone is a difference too.
                let same = (here - there).abs() <= rounding;
                let opposite = (here + there).abs() <= rounding;
                if !same && not_even.is_none() {
                    not_even = Some(state.clone());
                }
                if !opposite && not_odd.is_none() {
                    not_odd = Some(state);
                }
            }
        }
        let sums = self.sums(expression);
        for scale in FAR_SCALES {
            if not_even.is_some() && not_odd.is_some() {
                break;
            }
            for _ in 0..FAR_TRIALS {
                let state = random.state(reflection, scale);
                let (time, mirrored) = (random.symmetric(10.0), reflection.mirrored(&state));
                let mut certain = |state: &[f64]| {
                    let here = value(&mut evaluator, state, time);
                    let lost = sums.iter().map(|[sum, a, b]| {
                        let of = |part: &Expression| evaluator.value(*part).abs();
                        of(a).max(of(b)) / of(sum)
                    });
                    let has_digits = lost.product::<f64>() < MOST_CANCELLED;
                    (has_digits && here.is_finite()).then_some(here)
                };
                let (Some(here), Some(there)) = (certain(&state), certain(&mirrored)) else {
                    continue;
                };
                let clear = CLEAR * here.abs().max(there.abs());
                if (here - there).abs() > clear && not_even.is_none() {
                    not_even = Some(state.clone());
                }
                if (here + there).abs() > clear && not_odd.is_none() {
                    not_odd = Some(state);
                }
            }
        }
        let parity = match (&not_even, &not_odd) {
            (None, None) => Parity::Zero,
            (None, Some(_)) => Parity::Even,
            (Some(_), None) => Parity::Odd,
            (Some(_), Some(_)) => Parity::Neither,
        };
        ParityFinding {
            parity,
            proven: false,
            not_even,
            not_odd,
        }
    }
}

/// The parity of an operation from those of its operands.
fn parity_of(
    graph: &Graph,
    node: Node,
    of: &impl Fn(Expression) -> Option<Parity>,
) -> Option<Parity> {
    use Parity::{Even, Odd, Zero};
    match node {
        Node::Constant(_) | Node::Symbol(Symbol::Time | Symbol::Parameter(_)) => Some(Even),
        Node::Symbol(Symbol::State(_)) => None,
        Node::Unary(Unary::Negate, a) => of(a),
        Node::Unary(operation, a) => match of(a)? {
            Odd if operation.is_odd() => Some(Odd),
            Odd if operation.is_even() => Some(Even),
            Odd => None,
            Zero if operation.is_odd() => Some(Zero),
            _ => Some(Even),
        },
        Node::Binary(Binary::Add | Binary::Subtract, a, b) => common(of(a)?, of(b)?),
        Node::Binary(Binary::Multiply | Binary::Divide, a, b) => Some(match (of(a)?, of(b)?) {
            (Zero, _) | (_, Zero) => Zero,
            (a, b) if a == b => Even,
            _ => Odd,
        }),
        Node::Binary(Binary::Power, a, b) => {
            let odd_power = graph
                .as_constant(b)
                .and_then(small_integer)
                .map(|n| n % 2 != 0);
            match (of(a)?, of(b)?, odd_power) {
                (Odd, _, Some(true)) => Some(Odd),
                (Odd, _, Some(false)) | (Even | Zero, Even | Zero, _) => Some(Even),
                _ => None,
            }
        }
        Node::Binary(Binary::Hypot, a, b) => of(a).and(of(b)).map(|_| Even),
        Node::Binary(Binary::Atan2, a, b) => match (of(a)?, of(b)?) {
            (Odd, Even) => Some(Odd),
            (Even | Zero, Even | Zero) => Some(Even),
            _ => None,
        },
        Node::Binary(Binary::Equal | Binary::NotEqual, a, b) => {
            common(of(a)?, of(b)?).map(|_| Even)
        }
        Node::Binary(_, a, b) => match common(of(a)?, of(b)?)? {
            Odd => None,
            _ => Some(Even),
        },
        Node::Select(condition, yes, no) => match of(condition)? {
            Odd => None,
            _ => common(of(yes)?, of(no)?),
        },
    }
}

/// The parity of a sum.
fn common(a: Parity, b: Parity) -> Option<Parity> {
    match (a, b) {
        (Parity::Zero, other) | (other, Parity::Zero) => Some(other),
        _ => (a == b).then_some(a),
    }
}

/// Reproducible trial states.
struct Random(u64);

impl Random {
    fn symmetric(&mut self, size: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(0x5851_f42d_4c95_7f2d)
            .wrapping_add(0x1405_7b7e_f767_814f);
        let word = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        size * ((word >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    }

    fn state(&mut self, reflection: &Reflection, scale: f64) -> Vec<f64> {
        reflection
            .centre
            .iter()
            .map(|centre| centre + self.symmetric(scale))
            .collect()
    }
}
