//! What is wrong with the equations of a file, shown where it stands: the model says what, and here is found where.

use super::{KIND, coloured_remedy};
use crate::formula::language::foreign_letter;
use crate::formula::scope::{Role, SymbolError};
use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::document::Document;
use crate::sweep_file::draft::EquationsDraft;
use crate::sweep_file::formula_place::inside;
use crate::sweep_file::names::quotable;
use crate::sweep_file::reader::Reader;
use crate::sweep_file::value::{Entry, Value};
use crate::system::{FormulaPlace, TypedModelError};

/// Where a name that nothing defines can be given a meaning.
fn defined(name: &str) -> Option<String> {
    let name = quotable(name);
    Some(format!(
        "give `{name}` a value in [system.parameters] or a formula in [system.define]; if it is a state, a line `{name} = …` in \
         [system.equations]"
    ))
}

/// What the model says, at its place in the file.
pub(super) fn diagnostic(
    reader: &Reader<'_>,
    equations: &EquationsDraft,
    error: TypedModelError,
) -> Diagnostic {
    let value = |place: &FormulaPlace| value_place(reader.document(), equations, place);
    let words = error.to_string();
    let plain = |label: &str, place: Option<Place>| {
        let diagnostic = Diagnostic::new(words.clone());
        diagnostic.at(
            place.or_else(|| table_place(reader, "equations")).as_ref(),
            label,
        )
    };
    match &error {
        TypedModelError::Formula {
            place,
            error: fault,
            ..
        } => {
            let mut diagnostic = Diagnostic::new(format!("{place}: {fault}"));
            if let Some(value) = value(place) {
                let part = inside(&reader.document().sources, &value, &fault.span);
                diagnostic = diagnostic.at(&part, "here");
            }
            let remedy = fault.remedy().or_else(|| defined(fault.unknown_symbol()?));
            diagnostic.advice(fault.allowed(), remedy)
        }
        TypedModelError::Circle { place, span, .. } => {
            let value = value(place);
            let part = value.map(|value| inside(&reader.document().sources, &value, span));
            plain("needed here", part).remedy("write one of them without the others")
        }
        TypedModelError::UnknownAxis { place, known } => {
            let (table, axis) = table_and_name(place);
            let entry = reader.entry(&["system", table, axis]);
            let key = entry.map(|entry| entry.key_place.clone());
            let title = format!(
                "`system.{table}.{}`: no equation is of that name",
                quotable(axis)
            );
            let remedy = match table {
                "noise" => "a line of [system.noise] is the amplitude of the noise on an axis; numbers that formulas use \
                            stand in [system.parameters]"
                    .to_owned(),
                _ => format!("add a line `{} = …` to [system.equations]", quotable(axis)),
            };
            let diagnostic = Diagnostic::new(title)
                .remedy(remedy)
                .nearest(axis, known.iter().map(String::as_str));
            diagnostic.at(key.as_ref(), "unknown axis")
        }
        TypedModelError::Name(error) => {
            let diagnostic = plain("this name", name_place(reader, error));
            match error {
                SymbolError::Malformed { name } => match foreign_letter(name) {
                    Some((words, remedy)) => diagnostic.remedy(format!("{words}: {remedy}")),
                    None => diagnostic.remedy("give it another name"),
                },
                SymbolError::TooMany { .. } | SymbolError::LongDefinitions => plain("these", name_place(reader, error))
                    .remedy("write some of them out in the formulas that use them, or leave out what none uses"),
                _ => diagnostic.remedy("give it another name"),
            }
        }
        TypedModelError::Doubled { place } => plain("a second time", value(place)),
        TypedModelError::Interpretation { axis } => {
            let entry = reader.entry(&["system", "noise", axis]);
            let place = entry.map(|entry| entry.node.place.clone());
            plain("this noise", place)
                .allowed("`interpretation = \"ito\"` or `interpretation = \"stratonovich\"`")
                .remedy("add one of them to [system.noise]; noise of a physical system is mostly meant as Stratonovich")
        }
        TypedModelError::ColouredIto { .. } => {
            let place = reader.place(&["system", "noise", "interpretation"]);
            plain("not of coloured noise", place.cloned())
                .remedy("leave `interpretation` out, or use white noise (leave `kind` out)")
        }
        TypedModelError::Coloured(error) => {
            let place = reader.place(&["system", "noise", KIND]);
            coloured_remedy(plain("coloured noise", place.cloned()), error)
        }
        TypedModelError::JumpingNoise { .. } => plain("these noises", table_place(reader, "noise")),
        TypedModelError::Periodic { place, fault } => {
            plain("not periodic", value(place)).remedy(fault.remedy())
        }
        TypedModelError::NotOfParameters { place, .. } => plain("a bound", value(place)),
        TypedModelError::Axes { .. } => plain("these equations", None)
            .remedy("leave out what the others do not need, or write two equations as one"),
        TypedModelError::MissingEquation { .. }
        | TypedModelError::SharedNoise { .. }
        | TypedModelError::Default { .. }
        | TypedModelError::TooLarge
        | TypedModelError::TooWide => plain("these equations", None),
    }
}

pub(super) fn table_place(reader: &Reader<'_>, table: &str) -> Option<Place> {
    let entry = reader.entry(&["system", table])?;
    Some(entry.key_place.clone())
}

/// The table that a formula stands in, and its key there.
fn table_and_name(place: &FormulaPlace) -> (&'static str, &str) {
    match place {
        FormulaPlace::Equation { axis } => ("equations", axis),
        FormulaPlace::Noise { axis, .. } => ("noise", axis),
        FormulaPlace::Definition { name } => ("define", name),
        FormulaPlace::Bound { axis } => ("bounds", axis),
        FormulaPlace::Period => ("equations", ""),
    }
}

/// Where the value of a formula stands.
pub(in crate::sweep_file) fn value_place(
    document: &Document,
    equations: &EquationsDraft,
    place: &FormulaPlace,
) -> Option<Place> {
    let (table, name) = table_and_name(place);
    let node = &document.root.find(&["system", table, name])?.node;
    let node = match (place, &node.value) {
        (FormulaPlace::Noise { process, .. }, Value::Array(items)) => {
            let mut first = 0;
            for (axis, amplitudes) in &equations.noise {
                if axis == name {
                    break;
                }
                first += amplitudes.len();
            }
            items.get(process.checked_sub(first)?)?
        }
        _ => node,
    };
    Some(node.place.clone())
}

/// Where a name that is refused was given, the last of its places; the table of those that are too many.
fn name_place(reader: &Reader<'_>, error: &SymbolError) -> Option<Place> {
    let is_meant = |entry: &&Entry| match error {
        SymbolError::Malformed { name }
        | SymbolError::Reserved { name, .. }
        | SymbolError::Taken { name, .. } => entry.key == *name,
        SymbolError::Long { length } => entry.key.chars().count() == *length,
        SymbolError::TooMany { .. } | SymbolError::LongDefinitions => false,
    };
    let table = match error {
        SymbolError::TooMany {
            role: Role::State, ..
        } => "equations",
        SymbolError::TooMany {
            role: Role::Parameter,
            ..
        } => "parameters",
        SymbolError::TooMany { .. } | SymbolError::LongDefinitions => "define",
        _ => {
            let tables = ["define", "parameters", "equations"].into_iter();
            let mut entries = tables.filter_map(|table| reader.entry(&["system", table]));
            let key = entries.find_map(|table| table.node.entries().iter().find(is_meant));
            let swept = || reader.place(&["sweep", "parameter"]).cloned();
            return key.map(|entry| entry.key_place.clone()).or_else(swept);
        }
    };
    table_place(reader, table)
}
