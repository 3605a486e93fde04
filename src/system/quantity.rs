//! Quantities: functions of the state given as formulas, such as an amplitude or an energy. Their densities can be
//! watched like those of coordinates.

use std::ops::Range;
use std::sync::Arc;

use super::bound_quantity::{BoundQuantity, Turn, turns};
use super::{Model, PHASE_AXIS, SystemError};
use crate::formula::graph::{Expression, Graph, Symbol};
use crate::formula::language::FormulaError;
use crate::formula::scope::{DefinitionError, DefinitionFault, Scope, SymbolError, Symbols};
use crate::formula::tape::Program;

/// A function of the state, and perhaps of parameters.
#[derive(Debug, Clone)]
pub struct Quantity {
    name: String,
    symbol: String,
    formula: Option<String>,
    program: Program,
    states: Vec<bool>,
    parameters: Vec<String>,
    at_phase: Option<AtPhase>,
    /// The angles that it depends on.
    turns: Vec<Turn>,
}

/// An axis of the state at a phase of the forcing, in place of the whole period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AtPhase {
    /// The axis.
    pub axis: usize,
    /// The phase, in periods, from 0 to below 1.
    pub phase: f64,
}

/// Largest denominator of a phase that is written as a fraction.
const DENOMINATORS: u32 = 24;

impl AtPhase {
    /// The phase as a text: a fraction with a small denominator, or decimals.
    pub(crate) fn fraction(self) -> String {
        let mut denominators = (1..=DENOMINATORS).map(f64::from);
        let whole = |q: &f64| (self.phase * q - (self.phase * q).round()).abs() < 1e-12;
        match denominators.find(whole) {
            Some(1.0) => "0".to_owned(),
            Some(q) => format!("{}/{q}", (self.phase * q).round()),
            None => format!("{}", self.phase),
        }
    }
}

/// What is wrong with a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct QuantityError {
    /// Its number among those that were given.
    pub index: usize,
    /// What is wrong with it.
    pub fault: QuantityFault,
}

/// What is wrong with a quantity.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum QuantityFault {
    /// Its name cannot be given.
    #[error(transparent)]
    Name(#[from] SymbolError),
    /// Its formula is none.
    #[error("{0}")]
    Formula(Box<DefinitionFault>),
    /// A definition of the model that is not right.
    #[error("{0}")]
    Model(Box<DefinitionError>),
    /// A name without a formula that is no definition of the model.
    #[error("`{name}` is not defined")]
    Undefined {
        /// The name.
        name: String,
    },
    /// It depends on time.
    #[error(
        "`{name}` depends on time, which no formula of the steady state may: leave `t` out of it"
    )]
    Time {
        /// Its name.
        name: String,
    },
    /// It depends on no coordinate of the state.
    #[error("`{name}` depends on no coordinate of the state: it has no density")]
    Constant {
        /// Its name.
        name: String,
    },
    /// It keeps too many intermediate results.
    #[error("the formula of `{name}` is too long")]
    TooWide {
        /// Its name.
        name: String,
    },
}

impl QuantityFault {
    /// Bytes of the formula's text at which the fault stands, where it stands in the formula.
    pub fn span(&self) -> Option<Range<usize>> {
        match self {
            Self::Formula(fault) => Some(fault.span()),
            _ => None,
        }
    }

    fn error(&self) -> Option<&FormulaError> {
        match self {
            Self::Formula(fault) => match fault.as_ref() {
                DefinitionFault::Formula(error) => Some(error),
                DefinitionFault::Circle { .. } => None,
            },
            _ => None,
        }
    }

    /// What is allowed there.
    pub(crate) fn allowed(&self) -> Option<String> {
        self.error()?.allowed()
    }

    /// What to write instead.
    pub fn remedy(&self) -> Option<String> {
        match self {
            Self::Name(_) => Some("give it another name".to_owned()),
            _ => self.error()?.remedy(),
        }
    }
}

/// Reads quantities of a model: names with their formulas in the model's coordinates and parameters, in the names of
/// its definitions, and in each other's names. A name without a formula is that of a definition of the model.
///
/// # Errors
/// Everything that is wrong with them.
///
/// ```
/// use pbif::system::{quantities, registry};
///
/// let model = registry::find("rayleigh")?;
/// let read = quantities(&model, &[("H", Some("(x^2 + y^2)/2")), ("scaled", Some("2 b H"))]).unwrap();
/// let scaled = read[1].bind(&model.values(&[("a", 0.1), ("b", 0.5), ("sigma2", 1.0)])?).unwrap();
/// assert_eq!(scaled.at(&[3.0, 4.0]), 12.5);
/// let errors = quantities(&model, &[("H", Some("(x^2 + v^2)/2"))]).unwrap_err();
/// assert_eq!(errors[0].fault.span(), Some(7..8));
/// # Ok::<(), pbif::system::SystemError>(())
/// ```
pub fn quantities(
    model: &Model,
    given: &[(&str, Option<&str>)],
) -> Result<Vec<Arc<Quantity>>, Vec<QuantityError>> {
    let mut errors = Vec::new();
    let at = |index: usize| move |fault: QuantityFault| QuantityError { index, fault };
    let mut symbols = Symbols::default();
    let mut whole = |taken: Result<(), SymbolError>| {
        errors.extend(taken.map_err(|error| at(0)(error.into())).err());
    };
    for axis in &model.axes {
        match axis.name == PHASE_AXIS {
            // No formula can name it: there `t` is time.
            true => drop(symbols.add_unnamed_state(PHASE_AXIS)),
            false => whole(symbols.add_state(&axis.name).map(drop)),
        }
    }
    for parameter in &model.parameters {
        whole(symbols.add_parameter(&parameter.name).map(drop));
    }
    for (name, formula) in model.definitions() {
        whole(symbols.define(name, formula));
    }
    for (index, (name, formula)) in given.iter().enumerate() {
        if let Some(formula) = formula {
            let taken = symbols.define(name, formula);
            errors.extend(taken.map_err(|error| at(index)(error.into())).err());
        }
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let scope = Scope::new(symbols).map_err(|wrong| {
        let located = wrong.into_iter().map(|error| {
            let known = given.iter().position(|(name, _)| *name == error.name);
            match known {
                Some(index) => at(index)(QuantityFault::Formula(Box::new(error.fault))),
                None => at(0)(QuantityFault::Model(Box::new(error))),
            }
        });
        located.collect::<Vec<_>>()
    })?;
    let mut read = Vec::new();
    for (index, (name, formula)) in given.iter().enumerate() {
        match Quantity::new(&scope, model, name, *formula) {
            Ok(quantity) => read.push(Arc::new(quantity)),
            Err(fault) => errors.push(at(index)(fault)),
        }
    }
    if errors.is_empty() {
        Ok(read)
    } else {
        Err(errors)
    }
}

impl Quantity {
    fn new(
        scope: &Scope,
        model: &Model,
        name: &str,
        formula: Option<&str>,
    ) -> Result<Self, QuantityFault> {
        let named = || name.to_owned();
        let found = scope.definition(name);
        let expression: Expression =
            found.ok_or_else(|| QuantityFault::Undefined { name: named() })?;
        let graph = scope.graph();
        if graph.contains(expression, Symbol::Time) {
            return Err(QuantityFault::Time { name: named() });
        }
        let state = |state: usize| graph.contains(expression, Symbol::State(state));
        let states: Vec<bool> = (0..model.axes.len()).map(state).collect();
        if model.phase_axis().is_some_and(|phase| states[phase]) {
            return Err(QuantityFault::Time { name: named() });
        }
        if !states.contains(&true) {
            return Err(QuantityFault::Constant { name: named() });
        }
        let program = scope.compile(&[expression]);
        // Any values will do to see whether it fits.
        let probe = vec![std::f64::consts::FRAC_1_SQRT_2; program.parameters()];
        if program.bind_as_written(&probe).is_err() {
            return Err(QuantityFault::TooWide { name: named() });
        }
        let parameters = model.parameters.iter().enumerate();
        let parameters = parameters
            .filter(|(number, _)| graph.contains(expression, Symbol::Parameter(*number)))
            .map(|(_, parameter)| parameter.name.clone());
        Ok(Self {
            name: named(),
            symbol: match name.split_once('_') {
                Some((name, index)) => format!("{name}_{{{}}}", index.replace('_', " ")),
                None => named(),
            },
            formula: formula.map(str::to_owned),
            program,
            turns: turns(model, &states),
            states,
            parameters: parameters.collect(),
            at_phase: None,
        })
    }

    /// An axis of a model at a phase of its forcing; `None` where the model has no such axis or no phase.
    pub(crate) fn at_phase(model: &Model, at: AtPhase) -> Option<Self> {
        let phase = model.phase_axis()?;
        let own = model.axes.get(at.axis).filter(|_| at.axis != phase)?;
        let mut graph = Graph::default();
        let state = Symbol::State(at.axis);
        let expression = graph.build(|builder| builder.symbol(state)).ok()?;
        let (states, parameters) = (model.axes.len(), model.parameters.len());
        let fraction = at.fraction();
        let letters = fraction.replace(['/', '.'], "_");
        Some(Self {
            name: format!("{}_phase_{letters}", own.name),
            symbol: match fraction.as_str() {
                "0" => format!("{}(0)", own.symbol),
                fraction => format!("{}({fraction} T)", own.symbol),
            },
            formula: None,
            program: Program::new(&graph, &[expression], states, parameters),
            states: (0..states).map(|axis| axis == at.axis).collect(),
            parameters: Vec::new(),
            at_phase: Some(at),
            turns: Vec::new(),
        })
    }

    /// The axis and the phase, of an axis at a phase of the forcing.
    pub(crate) fn phase(&self) -> Option<AtPhase> {
        self.at_phase
    }

    /// How a sweep file says an axis at a phase.
    pub(crate) fn phase_text(&self, model: &Model) -> Option<String> {
        let at = self.at_phase?;
        let axis = &model.axes.get(at.axis)?.name;
        Some(format!("{axis} @ phase {}", at.fraction()))
    }

    /// Its name, as given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its name as a symbol with `_{}`: what follows the first `_` is lowered.
    pub(crate) fn symbol(&self) -> &str {
        &self.symbol
    }

    /// The formula as given; `None` where it is a definition of the model.
    pub fn formula(&self) -> Option<&str> {
        self.formula.as_deref()
    }

    /// Whether it depends on each coordinate of the state.
    pub(crate) fn states(&self) -> &[bool] {
        &self.states
    }

    /// Whether it contains one of these parameters or definitions.
    pub(super) fn depends_on(&self, names: &[String]) -> bool {
        self.parameters.iter().any(|name| names.contains(name))
    }

    /// With values of all parameters of the model.
    ///
    /// # Errors
    /// [`SystemError::QuantityNotBound`] for values of another model.
    pub fn bind(&self, values: &super::ParameterValues) -> Result<BoundQuantity, SystemError> {
        let tape = self.program.bind_as_written(values.as_slice());
        let tape = tape.map_err(|_| SystemError::QuantityNotBound {
            quantity: self.name.clone(),
        })?;
        Ok(BoundQuantity {
            tape,
            states: self.states.clone(),
            turns: self.turns.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Family, registry};

    fn faults(given: &[(&str, Option<&str>)]) -> Vec<String> {
        let model = registry::find("coulomb").unwrap();
        let errors = quantities(&model, given).unwrap_err();
        errors.iter().map(|error| error.fault.to_string()).collect()
    }

    #[test]
    fn what_is_no_quantity_is_refused_by_name() {
        assert!(faults(&[("x", Some("y"))])[0].contains("already a state"));
        assert!(faults(&[("v", Some("kappa"))])[0].contains("no coordinate"));
        assert!(faults(&[("v", Some("t x"))])[0].contains("depends on time"));
        assert!(faults(&[("v", None)])[0].contains("not defined"));
        assert!(faults(&[("v", Some("w")), ("w", Some("v x"))])[0].contains("needs itself"));
        assert!(faults(&[("sin", Some("x"))])[0].contains("a function"));
    }

    #[test]
    fn it_knows_what_it_depends_on() {
        let model = registry::find("coulomb").unwrap();
        let read = quantities(&model, &[("V_s", Some("alpha x^2/2"))]).unwrap();
        assert_eq!(read[0].states(), [true, false]);
        assert_eq!(read[0].symbol(), "V_{s}");
        let fixed = [("kappa", 0.1), ("sigma2", 0.1), ("f_c", 0.0)];
        let path = crate::system::Path::parameter("alpha", 0.5, 1.0);
        let family = Family::new(model, &fixed, path).unwrap();
        assert!(family.moves(&read[0]));
    }
}
