//! From texts to expressions: equations, noise, bounds; what follows from them together is in `joined`.

mod joined;
mod names;
mod turns;

use std::collections::BTreeMap;

use super::{Extras, FormulaPlace, PeriodFault, TypedModel, TypedModelError};
use crate::formula::graph::{Expression, Symbol, TooLarge};
use crate::formula::scope::Scope;
use crate::formula::tape::Program;
use names::scope;

/// Axes and the coordinates on them that are constant on planes.
type Planes = Vec<(usize, Expression)>;

/// Axes that close on themselves, with the ends of one turn, and the phase of the forcing among them.
#[derive(Debug, Clone, Default)]
pub(super) struct Turns {
    pub(super) of_axes: BTreeMap<usize, (f64, f64)>,
    pub(super) phase: Option<usize>,
}

/// Everything of a typed model but the values of its parameters.
#[derive(Debug)]
pub(super) struct Reading {
    /// All names and expressions.
    pub(super) scope: Scope,
    /// Drift as it was typed, one expression an axis that was typed.
    pub(super) typed_drift: Vec<Expression>,
    /// Itô drift where it is not what was typed, one entry an axis.
    pub(super) corrected: Vec<bool>,
    /// Axes that close on themselves.
    pub(super) turns: Turns,
    /// Itô drift, one expression an axis.
    pub(super) drift_expressions: Vec<Expression>,
    /// Amplitude of each Wiener process on each axis: `noise[process][axis]`.
    pub(super) noise: Vec<Vec<Expression>>,
    /// Number of each of these processes among all that were typed, those without effect included.
    pub(super) typed_processes: Vec<usize>,
    pub(super) drift: Program,
    /// One program of one formula a Wiener process.
    pub(super) amplitudes: Vec<Program>,
    /// The axis that each Wiener process drives.
    pub(super) noise_axes: Vec<usize>,
    /// Axis and coordinate of planes where the drift may not be smooth; not a number where there is no such plane.
    pub(super) surfaces: Planes,
    /// Whether drift and noise are smooth everywhere.
    pub(super) is_smooth: bool,
    /// Lower and upper bound of each axis.
    pub(super) bounds: Vec<Option<(Expression, Expression)>>,
    /// `None` where nothing depends on time.
    pub(super) period: Option<Expression>,
    /// Rates, of parameters alone, at which axes without noise and bounds relax.
    pub(super) relaxation: Vec<Option<Expression>>,
    /// Of an axis without noise that may have hysteresis, the axis along whose path.
    pub(super) paths: Vec<Option<usize>>,
    pub(super) friction: Option<Expression>,
    pub(super) extras: Extras,
}

/// Reads a model; with it, sentences on what was found and cannot be declared.
///
/// # Errors
/// All that is wrong with its names and formulas; what does not fit together is looked for where these are right.
pub(super) fn read(model: &TypedModel) -> Result<(Reading, Vec<String>), Vec<TypedModelError>> {
    let mut errors = Vec::new();
    let Some(scope) = scope(model, &mut errors) else {
        return Err(errors);
    };
    let mut reader = Reader {
        model,
        scope,
        errors,
    };
    let (drift, noise, bounds) = (reader.drift(), reader.noise(), reader.bounds());
    match (drift, noise, bounds) {
        (Some(drift), Some(noise), Some(bounds)) if reader.errors.is_empty() => {
            let found = reader.join(drift, noise, bounds);
            found.map_err(|error| vec![error])
        }
        _ => Err(reader.errors),
    }
}

impl From<TooLarge> for TypedModelError {
    fn from(_: TooLarge) -> Self {
        Self::TooLarge
    }
}

/// A model, the expressions that have been read of it, and what was found wrong.
struct Reader<'a> {
    model: &'a TypedModel,
    scope: Scope,
    errors: Vec<TypedModelError>,
}

/// Amplitudes of each Wiener process on each axis, the axis that it drives, and its number among those that were typed.
type Noise = (Vec<Vec<Expression>>, Vec<usize>, Vec<usize>);

impl Reader<'_> {
    /// The equation of each axis.
    fn drift(&mut self) -> Option<Vec<Expression>> {
        let model = self.model;
        let mut drift = vec![None; model.axes.len()];
        let mut given = vec![false; model.axes.len()];
        for (name, text) in &model.equations {
            let place = FormulaPlace::Equation { axis: name.clone() };
            let read = self.formula(text, &place);
            let Some(axis) = self.axis(name, &place) else {
                continue;
            };
            if std::mem::replace(&mut given[axis], true) {
                self.errors.push(TypedModelError::Doubled { place });
            } else {
                drift[axis] = read;
            }
        }
        for (axis, _) in model.axes.iter().zip(given).filter(|(_, given)| !given) {
            let axis = axis.name.clone();
            self.errors.push(TypedModelError::MissingEquation { axis });
        }
        drift.into_iter().collect()
    }

    /// The Wiener processes that act somewhere.
    fn noise(&mut self) -> Option<Noise> {
        let zero = self
            .scope
            .graph_mut()
            .build(|builder| builder.constant(0.0))
            .ok()?;
        let model = self.model;
        let (mut noise, mut driven, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
        for (process, amplitudes) in model.processes.iter().enumerate() {
            let mut read = vec![None; model.axes.len()];
            for (name, text) in amplitudes {
                let place = FormulaPlace::Noise {
                    axis: name.clone(),
                    process,
                };
                let amplitude = self.formula(text, &place);
                let Some(axis) = self.axis(name, &place) else {
                    continue;
                };
                if read[axis].is_some() {
                    self.errors.push(TypedModelError::Doubled { place });
                } else {
                    read[axis] = amplitude;
                }
            }
            let read: Vec<Expression> = read.into_iter().map(|one| one.unwrap_or(zero)).collect();
            let graph = self.scope.graph();
            let acts = |axis: &usize| graph.as_constant(read[*axis]) != Some(0.0);
            let axes: Vec<usize> = (0..read.len()).filter(acts).collect();
            match axes[..] {
                [] => continue,
                [axis] => driven.push(axis),
                _ => {
                    let name = |&axis: &usize| format!("`{}`", model.axes[axis].name);
                    self.errors.push(TypedModelError::SharedNoise {
                        process,
                        axes: axes.iter().map(name).collect(),
                    });
                    continue;
                }
            }
            noise.push(read);
            numbers.push(process);
        }
        Some((noise, driven, numbers))
    }

    /// Bounds of each axis.
    fn bounds(&mut self) -> Option<Vec<Option<(Expression, Expression)>>> {
        let model = self.model;
        let mut bounds = vec![None; model.axes.len()];
        for (name, lower, upper) in &model.bounds {
            let place = FormulaPlace::Bound { axis: name.clone() };
            let ends = [lower, upper].map(|end| self.of_parameters(end, &place));
            let Some(axis) = self.axis(name, &place) else {
                continue;
            };
            if let [Some(lower), Some(upper)] = ends
                && bounds[axis].replace((lower, upper)).is_some()
            {
                self.errors.push(TypedModelError::Doubled { place });
            }
        }
        for (name, period) in &model.turns {
            let place = FormulaPlace::Bound { axis: name.clone() };
            let axis = self.axis(name, &place);
            if axis.is_some_and(|axis| bounds[axis].is_some()) {
                self.errors.push(TypedModelError::Doubled { place });
            } else if !(period.is_finite() && *period > 0.0) {
                let (symbol, period) = (name.clone(), *period);
                let fault = PeriodFault::NotPositive { symbol, period };
                self.errors.push(TypedModelError::Periodic { place, fault });
            }
        }
        Some(bounds)
    }

    /// The friction force, where one is given.
    fn friction(&mut self) -> Result<Option<Expression>, TypedModelError> {
        let place = FormulaPlace::Definition {
            name: "friction".to_owned(),
        };
        let force = self.model.extras.friction.as_deref();
        let read = force.and_then(|force| self.formula(force, &place));
        self.errors.pop().map_or(Ok(read), Err)
    }

    fn axis(&mut self, name: &str, place: &FormulaPlace) -> Option<usize> {
        let mut axes = self.model.axes.iter();
        let found = axes.position(|axis| axis.name == name);
        if found.is_none() {
            self.errors.push(TypedModelError::UnknownAxis {
                place: place.clone(),
                known: self.scope.symbols().states().to_vec(),
            });
        }
        found
    }

    fn formula(&mut self, text: &str, place: &FormulaPlace) -> Option<Expression> {
        let read = self.scope.formula(text);
        let refused = |error| TypedModelError::Formula {
            place: place.clone(),
            text: text.to_owned(),
            error: Box::new(error),
        };
        read.map_err(|error| self.errors.push(refused(error))).ok()
    }

    /// A formula without states and time.
    fn of_parameters(&mut self, text: &str, place: &FormulaPlace) -> Option<Expression> {
        let read = self.formula(text, place)?;
        let dependence = self.scope.graph().dependence(read);
        let states = dependence.states.iter().map(|&state| Symbol::State(state));
        let time = dependence.time.then_some(Symbol::Time);
        let Some(symbol) = states.chain(time).next() else {
            return Some(read);
        };
        self.errors.push(TypedModelError::NotOfParameters {
            place: place.clone(),
            symbol: self.scope.symbols().name(symbol).to_owned(),
        });
        None
    }
}
