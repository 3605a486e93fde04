//! The names of a typed model and its definitions.

use crate::MAX_DIMENSION;
use crate::formula::scope::{DefinitionError, DefinitionFault, Scope, SymbolError, Symbols};
use crate::system::typed::{FormulaPlace, TypedModel, TypedModelError};

/// The names and the definitions; `None` where the names alone are wrong. A definition that is wrong counts as zero
/// after that, so that the formulas with it can be read.
pub(super) fn scope(model: &TypedModel, errors: &mut Vec<TypedModelError>) -> Option<Scope> {
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
