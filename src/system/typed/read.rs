//! From texts to expressions: names, equations, noise with its drift correction, bounds, and what the formulas tell.

use super::{FormulaPlace, Interpretation, TypedModel, TypedModelError};
use crate::MAX_DIMENSION;
use crate::formula::analysis::KinkPlace;
use crate::formula::graph::{Expression, Symbol, TooLarge};
use crate::formula::scope::{DefinitionError, DefinitionFault, Scope, SymbolError, Symbols};
use crate::formula::tape::{BindError, Program};

/// Axes and the coordinates on them that are constant on planes.
type Planes = Vec<(usize, Expression)>;

/// Everything of a typed model but the values of its parameters.
#[derive(Debug)]
pub(super) struct Reading {
    /// All names and expressions.
    pub(super) scope: Scope,
    /// Drift as it was typed, one expression an axis.
    pub(super) typed_drift: Vec<Expression>,
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
    /// Lower and upper bound of each axis.
    pub(super) bounds: Vec<Option<(Expression, Expression)>>,
    /// `None` where nothing depends on time.
    pub(super) period: Option<Expression>,
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

/// The names and the definitions; `None` where the names alone are wrong. A definition that is wrong counts as zero
/// after that, so that the formulas with it can be read.
fn scope(model: &TypedModel, errors: &mut Vec<TypedModelError>) -> Option<Scope> {
    let given = model.axes.len();
    if !(1..=MAX_DIMENSION).contains(&given) {
        errors.push(TypedModelError::Axes { given });
    }
    let mut symbols = Symbols::default();
    let mut refused: Vec<SymbolError> = Vec::new();
    // Far more axes than a model has would only be complained about one by one.
    for axis in model.axes.iter().take(2 * MAX_DIMENSION) {
        refused.extend(symbols.add_state(&axis.name).err());
    }
    for parameter in &model.parameters {
        refused.extend(symbols.add_parameter(&parameter.name).err());
        let outside = |value: &f64| !parameter.range.contains(*value);
        if let Some(value) = parameter.default.filter(outside) {
            errors.push(TypedModelError::Default {
                parameter: parameter.name.clone(),
                value,
                allowed: parameter.range.words(),
            });
        }
    }
    let names = symbols.clone();
    for (name, formula) in &model.definitions {
        refused.extend(symbols.define(name, formula).err());
    }
    errors.extend(refused.into_iter().map(TypedModelError::Name));
    if !errors.is_empty() {
        return None;
    }
    let wrong = match Scope::new(symbols) {
        Ok(scope) => return Some(scope),
        Err(wrong) => wrong,
    };
    let mut symbols = names;
    for (name, formula) in &model.definitions {
        let is_wrong = wrong.iter().any(|error| error.name == *name);
        let formula = if is_wrong { "0" } else { formula };
        symbols.define(name, formula).ok()?;
    }
    let found = wrong.into_iter();
    errors.extend(found.map(|error| definition_error(model, error)));
    Scope::new(symbols).ok()
}

fn definition_error(model: &TypedModel, error: DefinitionError) -> TypedModelError {
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

/// A model, the expressions that have been read of it, and what was found wrong.
struct Reader<'a> {
    model: &'a TypedModel,
    scope: Scope,
    errors: Vec<TypedModelError>,
}

/// Amplitudes of each Wiener process on each axis, the axis that it drives, and its number among those that were typed.
type Noise = (Vec<Vec<Expression>>, Vec<usize>, Vec<usize>);

impl Reader<'_> {
    /// What follows from expressions that are all there.
    fn join(
        mut self,
        typed_drift: Vec<Expression>,
        (noise, noise_axes, typed_processes): Noise,
        bounds: Vec<Option<(Expression, Expression)>>,
    ) -> Result<(Reading, Vec<String>), TypedModelError> {
        let period = self.period(&typed_drift, &noise)?;
        let drift_expressions = self.ito_drift(&typed_drift, &noise)?;
        // Where an amplitude bends, so does the density; and an amplitude of coloured noise is a part of the drift.
        let mut rough = drift_expressions.clone();
        rough.extend(noise.iter().flatten());
        let (surfaces, notes) = self.surfaces(&rough)?;
        let scope = self.scope;
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
            scope,
            typed_drift,
            drift_expressions,
            noise,
            typed_processes,
            drift,
            amplitudes,
            noise_axes,
            surfaces,
            bounds,
            period,
        };
        Ok((reading, notes))
    }

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
        Some(bounds)
    }

    /// The period, where anything depends on time.
    fn period(
        &mut self,
        drift: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<Option<Expression>, TypedModelError> {
        let model = self.model;
        let mut period = None;
        if let Some(text) = &model.period {
            period = self.of_parameters(text, &FormulaPlace::Period);
            if let Some(error) = self.errors.pop() {
                return Err(error);
            }
        }
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
        let read = self.model.interpretation;
        let coloured = self.model.noise_kind.is_coloured();
        // What comes through a filter is smooth: its drift is the one that was typed.
        if coloured && read != Some(Interpretation::Ito) {
            return Ok(typed.to_vec());
        }
        if read == Some(Interpretation::Ito) && !coloured {
            return Ok(typed.to_vec());
        }
        let (drift, jumps) = self.scope.graph_mut().ito_drift(typed, noise)?;
        let mut axes = (0..typed.len()).filter(|&axis| drift[axis] != typed[axis]);
        if coloured {
            return match axes.next() {
                Some(axis) => Err(TypedModelError::ColouredIto {
                    axis: self.model.axes[axis].name.clone(),
                }),
                None => Ok(typed.to_vec()),
            };
        }
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

    /// Planes where drift or noise may not be smooth, and sentences on places that are no planes of one coordinate.
    fn surfaces(&mut self, rough: &[Expression]) -> Result<(Planes, Vec<String>), TypedModelError> {
        let (mut surfaces, mut notes) = (Vec::new(), Vec::new());
        for &expression in rough {
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
                    "Drift or noise is not smooth where {argument} = 0, {why}: no face of the grid lies there."
                );
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        Ok((surfaces, notes))
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
