//! Quantities with values of all parameters, at states: an angle is taken back to its turn before.

use super::{LANES, Lanes, Model, TypedEquations};
use crate::formula::tape::Tape;

/// A quantity with values of all parameters.
#[derive(Debug, Clone)]
pub struct BoundQuantity {
    pub(super) tape: Tape,
    pub(super) states: Vec<bool>,
    pub(super) turns: Vec<Turn>,
}

/// An angle: its axis, and the ends of its range, which are one place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    axis: usize,
    ends: (f64, f64),
}

impl Turn {
    /// The places in the range that these angles are; those in the range, its ends among them, stay as they are.
    fn in_range(&self, angles: &Lanes) -> Lanes {
        let (from, to) = self.ends;
        angles.map(|angle| match from <= angle && angle <= to {
            true => angle,
            false => from + (angle - from).rem_euclid(to - from),
        })
    }
}

/// The angles of a model among some of its states.
pub(super) fn turns(model: &Model, states: &[bool]) -> Vec<Turn> {
    let known = model.formulas().into_iter().flat_map(TypedEquations::turns);
    let turns = known.filter(|&(axis, _)| states.get(axis).copied().unwrap_or(false));
    turns.map(|(axis, ends)| Turn { axis, ends }).collect()
}

impl BoundQuantity {
    /// Whether it depends on each coordinate of the state.
    pub(crate) fn states(&self) -> &[bool] {
        &self.states
    }

    /// Values at a batch of states, `states[axis][lane]`; NaN or infinite where the formula has no value. An angle that
    /// has gone beyond its range is taken back by whole turns.
    pub fn values(&self, states: &[Lanes]) -> Lanes {
        let mut values = [[f64::NAN; LANES]];
        if self.turns.is_empty() {
            self.tape.run(0.0, states, &mut values);
            return values[0];
        }
        let mut within = states.to_vec();
        for turn in &self.turns {
            within[turn.axis] = turn.in_range(&states[turn.axis]);
        }
        self.tape.run(0.0, &within, &mut values);
        values[0]
    }

    /// The value at one state.
    pub fn at(&self, state: &[f64]) -> f64 {
        let states: Vec<Lanes> = state.iter().map(|&value| [value; LANES]).collect();
        self.values(&states)[0]
    }
}
