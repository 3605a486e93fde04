//! From texts to expressions: names, equations, noise with its drift correction, bounds, and what the formulas tell.

use super::{FormulaPlace, Interpretation, TypedModel, TypedModelError};
use crate::MAX_DIMENSION;
use crate::formula::analysis::KinkPlace;
use crate::formula::graph::{Expression, Graph, Symbol, TooLarge};
use crate::formula::scope::{DefinitionFault, Scope, Symbols};
use crate::formula::tape::{BindError, Program};

/// Axes and the coordinates on them that are constant on planes.
type Planes = Vec<(usize, Expression)>;

/// Everything of a typed model but the values of its parameters.
pub(super) struct Reading {
    pub(super) graph: Graph,
    /// Itô drift, one expression an axis.
    pub(super) drift_expressions: Vec<Expression>,
    /// Amplitude of each Wiener process on each axis: `noise[process][axis]`.
    pub(super) noise: Vec<Vec<Expression>>,
    pub(super) drift: Program,
    /// One program of one formula a Wiener process.
    pub(super) amplitudes: Vec<Program>,
    /// The axis that each Wiener process drives.
    pub(super) noise_axes: Vec<usize>,
    /// Axis and coordinate of planes where the drift may not be smooth; not a number where there is no such plane.
    pub(super) surfaces: Planes,
    /// Lower and upper bound of each axis.
    pub(super) bounds: Vec<Option<(Expression, Expression)>>,
    /// `None` where nothing depends on time.
    pub(super) period: Option<Expression>,
}

/// Reads a model; with it, sentences on what was found and cannot be declared.
pub(super) fn read(model: &TypedModel) -> Result<(Reading, Vec<String>), TypedModelError> {
    let scope = scope(model)?;
    let mut reader = Reader { model, scope };
    let typed = reader.drift()?;
    let (noise, noise_axes) = reader.noise()?;
    let bounds = reader.bounds()?;
    let period = reader.period(&typed, &noise)?;
    let drift_expressions = reader.ito_drift(&typed, &noise)?;
    let (surfaces, notes) = reader.surfaces(&drift_expressions)?;
    let scope = reader.scope;
    let own = noise.iter().zip(&noise_axes);
    let amplitudes = own.map(|(process, &axis)| scope.compile(&process[axis..=axis]));
    let amplitudes: Vec<Program> = amplitudes.collect();
    let drift = scope.compile(&drift_expressions);
    for program in amplitudes.iter().chain([&drift]) {
        // Any values will do: more is worked out beforehand only for special ones.
        let values = vec![std::f64::consts::FRAC_1_SQRT_2; program.parameters()];
        if let Err(BindError::TooWide) = program.bind(&values) {
            return Err(TypedModelError::TooWide);
        }
    }
    let reading = Reading {
        graph: scope.graph().clone(),
        drift_expressions,
        noise,
        drift,
        amplitudes,
        noise_axes,
        surfaces,
        bounds,
        period,
    };
    Ok((reading, notes))
}

impl From<TooLarge> for TypedModelError {
    fn from(_: TooLarge) -> Self {
        Self::TooLarge
    }
}

/// The names and the definitions.
fn scope(model: &TypedModel) -> Result<Scope, TypedModelError> {
    let given = model.axes.len();
    if !(1..=MAX_DIMENSION).contains(&given) {
        return Err(TypedModelError::Axes { given });
    }
    let mut symbols = Symbols::default();
    for axis in &model.axes {
        symbols.add_state(&axis.name)?;
    }
    for parameter in &model.parameters {
        symbols.add_parameter(&parameter.name)?;
        let outside = |value: &f64| !parameter.range.contains(*value);
        if let Some(value) = parameter.default.filter(outside) {
            return Err(TypedModelError::Default {
                parameter: parameter.name.clone(),
                value,
                allowed: parameter.range.words(),
            });
        }
    }
    for (name, formula) in &model.definitions {
        symbols.define(name, formula)?;
    }
    Scope::new(symbols).map_err(|errors| definition_error(model, errors))
}

/// The first of the errors.
fn definition_error(
    model: &TypedModel,
    errors: Vec<crate::formula::scope::DefinitionError>,
) -> TypedModelError {
    let Some(error) = errors.into_iter().next() else {
        return TypedModelError::TooLarge;
    };
    let place = FormulaPlace::Definition {
        name: error.name.clone(),
    };
    match error.fault {
        DefinitionFault::Formula(fault) => {
            let mut given = model.definitions.iter();
            let given = given.find(|(name, _)| *name == error.name);
            TypedModelError::Formula {
                place,
                text: given.map_or(String::new(), |(_, text)| text.clone()),
                error: Box::new(fault),
            }
        }
        DefinitionFault::Circle { circle, span } => TypedModelError::Circle {
            place,
            circle,
            span,
        },
    }
}

/// A model and the expressions that have been read of it.
struct Reader<'a> {
    model: &'a TypedModel,
    scope: Scope,
}

impl Reader<'_> {
    /// The equation of each axis.
    fn drift(&mut self) -> Result<Vec<Expression>, TypedModelError> {
        let mut drift = vec![None; self.model.axes.len()];
        for (name, text) in &self.model.equations {
            let place = FormulaPlace::Equation { axis: name.clone() };
            let axis = self.axis(name, &place)?;
            let read = self.formula(text, &place)?;
            if drift[axis].replace(read).is_some() {
                return Err(TypedModelError::Doubled { place });
            }
        }
        let equations = drift.into_iter().zip(&self.model.axes);
        let complete = equations.map(|(read, axis)| {
            let axis = axis.name.clone();
            read.ok_or(TypedModelError::MissingEquation { axis })
        });
        complete.collect()
    }

    /// `noise[process][axis]`, and the axis that each process drives.
    fn noise(&mut self) -> Result<(Vec<Vec<Expression>>, Vec<usize>), TypedModelError> {
        let zero = self
            .scope
            .graph_mut()
            .build(|builder| builder.constant(0.0))?;
        let (mut noise, mut driven) = (Vec::new(), Vec::new());
        for (process, amplitudes) in self.model.processes.iter().enumerate() {
            let mut read = vec![None; self.model.axes.len()];
            for (name, text) in amplitudes {
                let place = FormulaPlace::Noise {
                    axis: name.clone(),
                    process,
                };
                let axis = self.axis(name, &place)?;
                let amplitude = self.formula(text, &place)?;
                if read[axis].replace(amplitude).is_some() {
                    return Err(TypedModelError::Doubled { place });
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
                    let name = |&axis: &usize| format!("`{}`", self.model.axes[axis].name);
                    return Err(TypedModelError::SharedNoise {
                        process,
                        axes: axes.iter().map(name).collect(),
                    });
                }
            }
            noise.push(read);
        }
        Ok((noise, driven))
    }

    /// Bounds of each axis.
    fn bounds(&mut self) -> Result<Vec<Option<(Expression, Expression)>>, TypedModelError> {
        let mut bounds = vec![None; self.model.axes.len()];
        for (name, lower, upper) in &self.model.bounds {
            let place = FormulaPlace::Bound { axis: name.clone() };
            let axis = self.axis(name, &place)?;
            let ends = (
                self.of_parameters(lower, &place)?,
                self.of_parameters(upper, &place)?,
            );
            if bounds[axis].replace(ends).is_some() {
                return Err(TypedModelError::Doubled { place });
            }
        }
        Ok(bounds)
    }

    /// The period, where anything depends on time.
    fn period(
        &mut self,
        drift: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<Option<Expression>, TypedModelError> {
        let period = match &self.model.period {
            Some(text) => Some(self.of_parameters(text, &FormulaPlace::Period)?),
            None => None,
        };
        let graph = self.scope.graph();
        let moves = |expression: Expression| graph.contains(expression, Symbol::Time);
        let name = |axis: usize| self.model.axes[axis].name.clone();
        let equation = |axis| FormulaPlace::Equation { axis: name(axis) };
        let mut place = (0..drift.len())
            .find(|&axis| moves(drift[axis]))
            .map(equation);
        for (process, amplitudes) in noise.iter().enumerate() {
            let axis = (0..amplitudes.len()).find(|&axis| moves(amplitudes[axis]));
            let noise = axis.map(|axis| FormulaPlace::Noise {
                axis: name(axis),
                process,
            });
            place = place.or(noise);
        }
        match (place, period) {
            (None, _) => Ok(None),
            (Some(_), Some(period)) => Ok(Some(period)),
            (Some(place), None) => Err(TypedModelError::TimeWithoutPeriod { place }),
        }
    }

    /// The drift of the Itô equation.
    fn ito_drift(
        &mut self,
        typed: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<Vec<Expression>, TypedModelError> {
        if self.model.interpretation == Some(Interpretation::Ito) {
            return Ok(typed.to_vec());
        }
        let (drift, jumps) = self.scope.graph_mut().ito_drift(typed, noise)?;
        let mut axes = (0..typed.len()).filter(|&axis| drift[axis] != typed[axis]);
        if self.model.interpretation.is_none() {
            let differs = axes.next().or_else(|| {
                // An amplitude that is constant but for jumps.
                let jumping = |axis: &usize| {
                    let symbol = Symbol::State(*axis);
                    let mut own = noise.iter().map(|process| process[*axis]);
                    own.any(|amplitude| self.scope.graph().contains(amplitude, symbol))
                };
                (0..typed.len()).find(|axis| !jumps.is_empty() && jumping(axis))
            });
            if let Some(axis) = differs {
                let axis = self.model.axes[axis].name.clone();
                return Err(TypedModelError::Interpretation { axis });
            }
        }
        if let Some(&jump) = jumps.first() {
            let argument = self.scope.typeset(jump);
            return Err(TypedModelError::JumpingNoise { argument });
        }
        Ok(drift)
    }

    /// Planes where the drift may not be smooth, and sentences on places that are no planes of one coordinate.
    fn surfaces(&mut self, drift: &[Expression]) -> Result<(Planes, Vec<String>), TypedModelError> {
        let (mut surfaces, mut notes) = (Vec::new(), Vec::new());
        for &expression in drift {
            for kink in self.scope.graph_mut().kinks(expression)? {
                let why = match kink.place {
                    KinkPlace::Surfaces(planes) => {
                        for plane in planes {
                            let plane = (plane.state, plane.at);
                            if !surfaces.contains(&plane) {
                                surfaces.push(plane);
                            }
                        }
                        continue;
                    }
                    KinkPlace::Oblique => "which contains several coordinates",
                    KinkPlace::Unsolved => "which could not be solved for its coordinate",
                    KinkPlace::Everywhere => "at every whole number",
                    KinkPlace::Moving => "which moves in time",
                };
                let argument = self.scope.typeset(kink.argument);
                let note = format!(
                    "The drift is not smooth where {argument} = 0, {why}: no face of the grid lies there."
                );
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        Ok((surfaces, notes))
    }

    fn axis(&self, name: &str, place: &FormulaPlace) -> Result<usize, TypedModelError> {
        let mut axes = self.model.axes.iter();
        let found = axes.position(|axis| axis.name == name);
        found.ok_or_else(|| TypedModelError::UnknownAxis {
            place: place.clone(),
            known: self.scope.symbols().states().to_vec(),
        })
    }

    fn formula(&mut self, text: &str, place: &FormulaPlace) -> Result<Expression, TypedModelError> {
        let read = self.scope.formula(text);
        read.map_err(|error| TypedModelError::Formula {
            place: place.clone(),
            text: text.to_owned(),
            error: Box::new(error),
        })
    }

    /// A formula without states and time.
    fn of_parameters(
        &mut self,
        text: &str,
        place: &FormulaPlace,
    ) -> Result<Expression, TypedModelError> {
        let read = self.formula(text, place)?;
        let dependence = self.scope.graph().dependence(read);
        let states = dependence.states.iter().map(|&state| Symbol::State(state));
        let time = dependence.time.then_some(Symbol::Time);
        match states.chain(time).next() {
            None => Ok(read),
            Some(symbol) => Err(TypedModelError::NotOfParameters {
                place: place.clone(),
                symbol: self.scope.symbols().name(symbol).to_owned(),
            }),
        }
    }
}
