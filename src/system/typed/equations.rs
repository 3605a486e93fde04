//! What is known of a model because its equations are formulas: they can be written for people, and searched for
//! operations that fail somewhere.

use std::sync::Arc;

use super::read::Reading;
use super::{FormulaPlace, Interpretation, TypedModel};
use crate::formula::analysis::{Domain, HazardKind, Interval};
use crate::formula::graph::{Expression, Symbol};
use crate::formula::language::typeset_name;
use crate::formula::tape::Tape;

/// The typed equations of a model, as they were typed and as they were read.
#[derive(Debug, Clone)]
pub struct TypedEquations {
    model: TypedModel,
    pub(super) reading: Arc<Reading>,
}

/// An operation of a formula that fails somewhere: a division by zero, the root of a negative number, an overflow.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FormulaHazard {
    /// The formula.
    pub place: FormulaPlace,
    /// How the operation fails.
    pub kind: HazardKind,
    /// The operation, typeset.
    pub part: String,
    /// A state at or next to which it fails.
    pub state: Vec<f64>,
    /// Values of the parameters there, in the model's order.
    pub parameters: Vec<f64>,
    /// Whether it surely fails there; otherwise that could not be excluded.
    pub certain: bool,
    /// Numbers of the parameters that it depends on, where it depends on no state.
    pub of_parameters: Option<Vec<usize>>,
}

impl TypedEquations {
    /// Axes that are angles, with the ends of their ranges.
    pub(in crate::system) fn turns(&self) -> impl Iterator<Item = (usize, (f64, f64))> {
        let turns = self.reading.turns.of_axes.iter();
        turns.map(|(&axis, &ends)| (axis, ends))
    }

    pub(super) fn new(model: TypedModel, reading: Arc<Reading>) -> Self {
        Self { model, reading }
    }

    /// Whether a compiled drift stands for the formulas.
    pub(in crate::system) fn is_compiled(&self) -> bool {
        self.model.is_compiled()
    }

    /// The drift by the formulas, with values of the parameters.
    pub(in crate::system) fn drift(&self, values: &[f64]) -> Option<Tape> {
        self.reading.drift.bind(values).ok()
    }

    /// What was typed.
    pub fn source(&self) -> &TypedModel {
        &self.model
    }

    /// Whether drift and noise are smooth everywhere, as polynomials are.
    pub(crate) fn is_smooth(&self) -> bool {
        self.reading.is_smooth
    }

    /// The equations in Unicode for people, one a line, with their noises `ξ₁`, `ξ₂` …; then the definitions, and the
    /// Itô drift where it is not what was typed.
    pub fn typeset(&self) -> Vec<String> {
        let (scope, reading) = (&self.reading.scope, &self.reading);
        let axes = scope.symbols().states();
        let mut lines = Vec::new();
        for (axis, (name, drift)) in axes.iter().zip(&reading.typed_drift).enumerate() {
            let mut line = format!("{}' = ", typeset_name(name));
            line += &scope.typeset(*drift);
            for (process, amplitudes) in reading.noise.iter().enumerate() {
                if reading.noise_axes[process] == axis {
                    let amplitude = factor(&scope.typeset(amplitudes[axis]));
                    line += &format!(" + {amplitude} ξ{}(t)", subscript(process + 1));
                }
            }
            lines.push(line);
        }
        for (name, defined) in scope.definitions() {
            let name = typeset_name(name);
            lines.push(format!("{name} = {}", scope.typeset(defined)));
        }
        let drifts = reading.drift_expressions.iter().zip(&reading.corrected);
        for (name, (ito, _)) in axes.iter().zip(drifts).filter(|(_, (_, is))| **is) {
            let (name, ito) = (typeset_name(name), scope.typeset(*ito));
            lines.push(format!("Itô drift of {name}: {ito}"));
        }
        lines
    }

    /// Noises in words: which axis each drives, and whether its amplitude depends on the state.
    pub(crate) fn noises(&self) -> Vec<String> {
        let (scope, reading) = (&self.reading.scope, &self.reading);
        let axes = scope.symbols().states();
        let channels = reading.noise.iter().zip(&reading.noise_axes).enumerate();
        let words = channels.map(|(process, (amplitudes, &axis))| {
            let amplitude = amplitudes[axis];
            let states = scope.graph().dependence(amplitude).states;
            let kind = if states.is_empty() {
                "additive".to_owned()
            } else {
                let names: Vec<String> = states.iter().map(|&s| typeset_name(&axes[s])).collect();
                format!("multiplicative in {}", names.join(", "))
            };
            let (number, axis) = (subscript(process + 1), typeset_name(&axes[axis]));
            format!(
                "ξ{number} on {axis}, {kind}: amplitude {}",
                scope.typeset(amplitude)
            )
        });
        let mut words: Vec<String> = words.collect();
        if let Some(read) = self.model.interpretation().filter(|_| !words.is_empty()) {
            let name = match read {
                Interpretation::Ito => "Itô",
                Interpretation::Stratonovich => "Stratonovich",
            };
            words.push(format!("read as {name} noise"));
        }
        words
    }

    /// Parameters that no equation, noise or bound contains, by name; coloured noise uses those of its filter.
    pub(crate) fn unused_parameters(&self) -> Vec<&str> {
        let reading = &self.reading;
        let mut all: Vec<Expression> = reading.typed_drift.clone();
        all.extend(reading.noise.iter().flatten());
        let bounds = reading.bounds.iter().flatten();
        all.extend(bounds.flat_map(|&(lower, upper)| [lower, upper]));
        let graph = reading.scope.graph();
        let names = reading.scope.symbols().parameters().iter().enumerate();
        let noise = self.model.noise_kind;
        let unused = names.filter(|(number, name)| {
            if noise.has_parameter(name) {
                return false;
            }
            let symbol = Symbol::Parameter(*number);
            !all.iter().any(|&one| graph.contains(one, symbol))
        });
        unused.map(|(_, name)| name.as_str()).collect()
    }

    /// Operations of drift and noise that fail, or may fail, somewhere in a box of states and of parameters: one range
    /// each.
    pub(crate) fn hazards(
        &self,
        states: &[(f64, f64)],
        parameters: &[(f64, f64)],
    ) -> Vec<FormulaHazard> {
        let reading = &self.reading;
        let domain = domain(states, parameters);
        let mut found = Vec::new();
        for (place, expression) in self.formulas() {
            for hazard in reading.scope.graph().hazards(expression, &domain) {
                let needs = reading.scope.graph().dependence(hazard.part);
                let is_of_states = needs.time || !needs.states.is_empty();
                found.push(FormulaHazard {
                    of_parameters: (!is_of_states).then_some(needs.parameters),
                    place: place.clone(),
                    kind: hazard.kind,
                    part: reading.scope.typeset(hazard.part),
                    state: hazard.state,
                    parameters: hazard.parameters,
                    certain: hazard.certain,
                });
            }
        }
        found
    }

    /// Amplitudes that depend on the state and may be zero somewhere in a box of states and of parameters, typeset;
    /// those beside an additive noise on the same axis do no harm and are left out.
    pub(crate) fn vanishing_noises(
        &self,
        states: &[(f64, f64)],
        parameters: &[(f64, f64)],
    ) -> Vec<String> {
        let (scope, reading) = (&self.reading.scope, &self.reading);
        let domain = domain(states, parameters);
        let channels = || reading.noise.iter().zip(&reading.noise_axes);
        let is_additive =
            |expression: Expression| scope.graph().dependence(expression).states.is_empty();
        let additive: Vec<usize> = channels()
            .filter(|(amplitudes, axis)| is_additive(amplitudes[**axis]))
            .map(|(_, &axis)| axis)
            .collect();
        let own = channels().filter(|(_, axis)| !additive.contains(axis));
        let own = own.map(|(amplitudes, &axis)| amplitudes[axis]);
        let vanishing =
            own.filter(|&amplitude| scope.graph().range(amplitude, &domain).contains(0.0));
        vanishing
            .map(|amplitude| scope.typeset(amplitude))
            .collect()
    }

    /// Drift of the Itô equation and amplitudes, with their places.
    fn formulas(&self) -> Vec<(FormulaPlace, Expression)> {
        let reading = &self.reading;
        let name = |axis: usize| reading.scope.symbols().states()[axis].clone();
        let drift = reading.drift_expressions.iter().enumerate();
        let drift = drift.map(|(axis, &drift)| {
            let place = FormulaPlace::Equation { axis: name(axis) };
            (place, drift)
        });
        let processes = reading.noise.iter().zip(&reading.typed_processes);
        let noise = processes.zip(&reading.noise_axes);
        let noise = noise.map(|((amplitudes, &process), &axis)| {
            let axis_name = name(axis);
            let place = FormulaPlace::Noise {
                axis: axis_name,
                process,
            };
            (place, amplitudes[axis])
        });
        drift.chain(noise).collect()
    }
}

/// A box of states and of parameters.
fn domain(states: &[(f64, f64)], parameters: &[(f64, f64)]) -> Domain {
    let interval = |&(low, high): &(f64, f64)| Interval::new(low, high);
    Domain {
        states: states.iter().map(interval).collect(),
        parameters: parameters.iter().map(interval).collect(),
        time: Interval::point(0.0),
    }
}

/// A typeset formula as a factor: in parentheses where it is a sum or begins with a sign.
fn factor(text: &str) -> String {
    let mut depth = 0_usize;
    let mut before = ' ';
    let mut is_sum = text.starts_with(['-', '−']);
    for c in text.chars() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            '+' | '-' | '−' | '<' | '>' | '=' => is_sum |= depth == 0 && before == ' ',
            _ => {}
        }
        before = c;
    }
    if is_sum {
        format!("({text})")
    } else {
        text.to_owned()
    }
}

/// A number in lowered digits.
fn subscript(number: usize) -> String {
    let digits = number.to_string();
    let lowered = digits.chars().filter_map(|c| {
        let digit = c.to_digit(10)?;
        char::from_u32('₀' as u32 + digit)
    });
    lowered.collect()
}
