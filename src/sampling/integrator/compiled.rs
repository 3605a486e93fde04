//! When the compiled steps of an oscillator do what a stepper does.

use super::splitting::Position;
use super::{Integrator, Stepper};
use crate::system::{CompiledSteps, Lanes, StepScheme, VELOCITY};

/// Steps of an oscillator that are compiled in.
pub(super) struct Compiled<'a> {
    steps: &'a dyn CompiledSteps,
    scheme: StepScheme,
    /// Amplitude times √dt of the noise on the velocity.
    increment: f64,
}

impl<'a> Compiled<'a> {
    /// Those that do what a stepper does, if there are any.
    pub(super) fn of(stepper: &Stepper<'a>) -> Option<Self> {
        let steps = stepper.system.compiled_steps()?;
        let scheme = match (stepper.integrator, stepper.positions.as_slice()) {
            (Integrator::EulerMaruyama, _) => return None,
            (_, []) => StepScheme::Heun,
            (_, [Position::DISPLACEMENT]) => StepScheme::Splitting,
            _ => return None,
        };
        let [channel] = stepper.noise.as_slice() else {
            return None;
        };
        let is_free = stepper.mirrors.is_empty() && stepper.turns.is_empty();
        let increment = channel.increment?;
        (is_free && channel.noise.axis == VELOCITY).then_some(Self {
            steps,
            scheme,
            increment,
        })
    }

    /// Steps of a batch, one for each row of normals.
    pub(super) fn advance(&self, time_step: f64, states: &mut [Lanes], normals: &[Lanes]) {
        (self.steps).advance(self.scheme, time_step, self.increment, states, normals);
    }

    /// Adds the postprocessor at `states`, times a sign.
    pub(super) fn shift(&self, time_step: f64, sign: f64, states: &[Lanes], shifted: &mut [Lanes]) {
        self.steps.shift(time_step, sign, states, shifted);
    }
}
