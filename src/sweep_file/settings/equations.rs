//! The model: a built-in one by its name, or the equations of the file, read with their places so that everything wrong
//! with them is shown where it stands.

use std::sync::Arc;

use crate::MAX_DIMENSION;
use crate::formula::scope::SymbolError;
use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::document::Document;
use crate::sweep_file::draft::{Draft, EquationsDraft};
use crate::sweep_file::formula_place::inside;
use crate::sweep_file::names::{list, nearest_name, quotable};
use crate::sweep_file::reader::Reader;
use crate::sweep_file::value::{Entry, Value};
use crate::system::{
    ColouredNoiseError, FormulaPlace, Model, ParameterDescription, TypedModel, TypedModelError,
};

/// Name of a model made of a file's equations, in messages and in stored runs.
const NAME: &str = "equations";
/// The key of `[system.noise]` that holds for built-in models too.
const KIND: &str = "kind";
/// The tables of equations, without the values of parameters.
const TABLES: [&str; 5] = ["equations", "noise", "define", "bounds", "title"];

/// The model that the file means; `None` where it means none, or something is wrong with it.
pub(super) fn model(reader: &mut Reader<'_>, draft: &Draft) -> Option<Arc<Model>> {
    let has_model = reader.entry(&["system", "model"]);
    let mut tables = TABLES.iter();
    let given = tables.find_map(|table| {
        let entry = reader.entry(&["system", table])?;
        // What the noise is can be said of built-in models too.
        let only_kind = *table == "noise" && {
            let entries = reader.entries(&["system", "noise"]);
            !entries.is_empty() && entries.iter().all(|entry| entry.key == KIND)
        };
        (!only_kind).then_some(entry)
    });
    match (has_model, given) {
        (Some(_), None) => built_in(reader, draft),
        (Some(model), Some(given)) => {
            let title = format!("a built-in model, and `system.{}` too", given.key);
            let diagnostic = Diagnostic::new(title)
                .at(&given.key_place, "equations of your own")
                .allowed("`system.model`, or equations in `system.equations`")
                .remedy(match model.key_place.is_set() {
                    true => "the equations of the file cannot be exchanged for a built-in model: write another file",
                    false => "remove `model`, or the equations",
                });
            reader.report(diagnostic);
            None
        }
        (None, Some(_)) => typed(reader, draft),
        (None, None) => {
            missing(reader);
            None
        }
    }
}

/// The built-in model, with the noise that the file means.
fn built_in(reader: &mut Reader<'_>, draft: &Draft) -> Option<Arc<Model>> {
    let model = draft.model.as_ref()?;
    let kind = draft.noise_kind.unwrap_or_default();
    if !kind.is_coloured() {
        return Some(Arc::clone(model));
    }
    let coloured = Model::with_coloured_noise(model, kind);
    let refused = |error: ColouredNoiseError| {
        let diagnostic = Diagnostic::new(error.to_string());
        let place = reader.place(&["system", "noise", KIND]);
        let diagnostic = match place {
            Some(place) => diagnostic.at(place, "coloured noise"),
            None => diagnostic,
        };
        reader.report(coloured_remedy(diagnostic, &error));
    };
    coloured.map_err(refused).ok()
}

fn coloured_remedy(diagnostic: Diagnostic, error: &ColouredNoiseError) -> Diagnostic {
    match error {
        // A filter of first order needs half of the axes.
        ColouredNoiseError::Axes {
            axes,
            noises,
            each: 2,
        } if axes + noises <= MAX_DIMENSION => diagnostic.remedy(
            "use `kind = \"ornstein-uhlenbeck\"`, which adds one axis a noise, or white noise (leave `kind` out)",
        ),
        ColouredNoiseError::Axes { .. } => {
            diagnostic.remedy("use white noise (leave `kind` out), or a model with fewer axes or noises")
        }
        _ => diagnostic.remedy("use white noise (leave `kind` out), another model, or other names"),
    }
}

/// What messages call a model: one of a file's own equations has no name.
pub(super) fn model_in_words(model: &Model) -> String {
    match model.typed() {
        Some(_) => "the system".to_owned(),
        None => format!("model `{}`", model.name),
    }
}

/// Says that there is neither a model nor an equation.
fn missing(reader: &mut Reader<'_>) {
    if reader.document().cut.is_some() {
        return;
    }
    let table = reader.entry(&["system"]);
    let place = match table {
        Some(entry) => &entry.key_place,
        None => &reader.document().root.place,
    };
    let diagnostic = Diagnostic::new("missing key `system.model`, or equations")
        .at(place, "which system is meant?")
        .allowed("a built-in model (`pbif systems` lists them), or equations of your own")
        .remedy("add `model = \"…\"`, or a table [system.equations] with a line such as `x = \"y\"` an axis");
    reader.report(diagnostic);
}

/// The model made of the file's equations.
fn typed(reader: &mut Reader<'_>, draft: &Draft) -> Option<Arc<Model>> {
    let equations = &draft.equations;
    if reader.entry(&["system", "equations"]).is_none() {
        let entry = reader.entry(&["system"])?;
        let diagnostic = Diagnostic::new("missing table `system.equations`")
            .at(&entry.key_place, "a system without equations")
            .remedy("add a table [system.equations] with a line such as `x = \"y\"` for each axis");
        reader.report(diagnostic);
        return None;
    }
    // Formulas that are no formulas are reported already; what is left would look incomplete.
    let table = reader.entry(&["system", "equations"]);
    if table.is_some_and(|table| !matches!(table.node.value, Value::Table(_))) {
        return None;
    }
    let complete = reader.is_clean();
    if !complete && equations.drift.len() < reader.entries(&["system", "equations"]).len() {
        return None;
    }
    let parameters = parameters(reader, draft);
    let source = source(draft, equations, parameters);
    match source.build_or_all_errors() {
        Ok(model) => {
            check_use(reader, draft, &model);
            check_noise(reader, &model);
            Some(model)
        }
        Err(errors) => {
            let mut found: Vec<Diagnostic> = Vec::new();
            for error in errors {
                let diagnostic = diagnostic(reader, equations, error);
                // Several noises on an axis without equation are one mistake.
                if !found.contains(&diagnostic) {
                    found.push(diagnostic);
                }
            }
            found
                .into_iter()
                .for_each(|diagnostic| reader.report(diagnostic));
            check_swept_name(reader, draft);
            None
        }
    }
}

/// The parameters that are given, and the swept one. What is given is the default, so that any of them can be swept.
fn parameters(reader: &Reader<'_>, draft: &Draft) -> Vec<ParameterDescription> {
    let given = draft.parameters.iter();
    let given =
        given.map(|(name, value)| ParameterDescription::from(name.as_str()).with_default(*value));
    let mut parameters: Vec<ParameterDescription> = given.collect();
    // A value that is none is reported already; its name is known all the same.
    for entry in reader.entries(&["system", "parameters"]) {
        if !parameters.iter().any(|known| known.name == entry.key) {
            parameters.push(ParameterDescription::from(entry.key.as_str()));
        }
    }
    if let Some(swept) = &draft.parameter {
        let known = parameters.iter().any(|known| known.name == *swept);
        if !known {
            parameters.push(ParameterDescription::from(swept.as_str()));
        }
    }
    parameters
}

fn source(
    draft: &Draft,
    equations: &EquationsDraft,
    parameters: Vec<ParameterDescription>,
) -> TypedModel {
    let title = equations.title.as_ref().or(draft.title.as_ref());
    let title = title.map_or("equations of a sweep file", String::as_str);
    let axes = equations.drift.iter().map(|(axis, _)| axis.as_str());
    let mut model = TypedModel::new(NAME, title, axes).with_parameters(parameters);
    for (axis, drift) in &equations.drift {
        model = model.with_equation(axis, drift);
    }
    for (axis, amplitudes) in &equations.noise {
        model = model.with_noise(axis, amplitudes.iter());
    }
    for (name, formula) in &equations.define {
        model = model.with_definition(name, formula);
    }
    for (axis, [lower, upper]) in &equations.bounds {
        model = model.with_bounds(axis, lower, upper);
    }
    let model = match equations.interpretation {
        Some(interpretation) => model.with_interpretation(interpretation),
        None => model,
    };
    model.with_coloured_noise(draft.noise_kind.unwrap_or_default())
}

/// Where other names are unknown, a swept parameter that no formula has is perhaps one of them.
fn check_swept_name(reader: &mut Reader<'_>, draft: &Draft) {
    let Some(swept) = draft.parameter.as_deref() else {
        return;
    };
    let equations = &draft.equations;
    let drift = equations.drift.iter().chain(&equations.define);
    let noise = equations
        .noise
        .iter()
        .flat_map(|(_, amplitudes)| amplitudes);
    let mut texts = drift.map(|(_, text)| text).chain(noise);
    let given = draft.parameters.iter().any(|(name, _)| name == swept);
    let of_noise = draft.noise_kind.unwrap_or_default().has_parameter(swept);
    if given || of_noise || texts.any(|text| text.contains(swept)) {
        return;
    }
    let title = format!(
        "the swept parameter `{}` is in no equation or noise",
        quotable(swept)
    );
    if let Some(place) = reader.place(&["sweep", "parameter"]) {
        let diagnostic = Diagnostic::new(title).at(place, "sweeping it changes nothing");
        reader.report(diagnostic);
    }
}

/// A swept parameter that is in no formula is a mistake, and so is one that is set there; others are perhaps left over.
fn check_use(reader: &mut Reader<'_>, draft: &Draft, model: &Model) {
    let Some(typed) = model.typed() else {
        return;
    };
    let unused = typed.unused_parameters();
    let used: Vec<&str> = model
        .parameters
        .iter()
        .map(|one| one.name.as_str())
        .collect();
    let used: Vec<&str> = used
        .into_iter()
        .filter(|name| !unused.contains(name))
        .collect();
    for name in unused {
        let path = ["system", "parameters", name];
        let shown = quotable(name);
        if draft.parameter.as_deref() == Some(name) {
            let title = format!("the swept parameter `{shown}` is in no equation, noise or bound");
            let diagnostic = Diagnostic::new(title).nearest(name, used.iter().copied());
            let place = reader.place(&["sweep", "parameter"]);
            reader.report(match place {
                Some(place) => diagnostic.at(place, "sweeping it changes nothing"),
                None => diagnostic,
            });
        } else if let Some(entry) = reader.entry(&path) {
            let title = format!("parameter `{shown}` is in no equation, noise or bound");
            let near = nearest_name(name, used.iter().copied());
            let advise = |diagnostic: Diagnostic| match near {
                Some(near) => diagnostic.remedy(format!("did you mean `{near}`?")),
                None => diagnostic,
            };
            if entry.key_place.is_set() {
                let diagnostic = Diagnostic::new(title).at(&entry.key_place, "set here");
                reader.report(advise(diagnostic.allowed(list(&used))));
            } else {
                let diagnostic = Diagnostic::warning(title).at(&entry.key_place, "not used");
                reader.warn(advise(diagnostic));
            }
        }
    }
}

/// Without noise there is no density to speak of.
fn check_noise(reader: &mut Reader<'_>, model: &Model) {
    if model.typed().is_none_or(|typed| !typed.noises().is_empty()) {
        return;
    }
    // Amplitudes that are no formulas are reported already.
    let mut entries = reader.entries(&["system", "noise"]).iter();
    if !reader.is_clean() && entries.any(|entry| entry.key != KIND) {
        return;
    }
    let diagnostic = Diagnostic::new("no equation has noise, so that there is no stationary density")
        .remedy("add a table [system.noise] with the amplitudes of white noises, such as `y = \"sqrt(2 D)\"`");
    let place = table_place(reader, "noise").or_else(|| table_place(reader, "equations"));
    reader.report(match place {
        Some(place) => diagnostic.at(&place, "no noise"),
        None => diagnostic,
    });
}

/// Where a name that nothing defines can be given a meaning.
fn defined(name: &str) -> Option<String> {
    let name = quotable(name);
    Some(format!(
        "give `{name}` a value in [system.parameters] or a formula in [system.define]; if it is a state, a line `{name} = …` in \
         [system.equations]"
    ))
}

/// What the model says, at its place in the file.
fn diagnostic(
    reader: &Reader<'_>,
    equations: &EquationsDraft,
    error: TypedModelError,
) -> Diagnostic {
    let value = |place: &FormulaPlace| value_place(reader.document(), equations, place);
    let words = error.to_string();
    let plain = |label: &str, place: Option<Place>| {
        let diagnostic = Diagnostic::new(words.clone());
        match place.or_else(|| table_place(reader, "equations")) {
            Some(place) => diagnostic.at(&place, label),
            None => diagnostic,
        }
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
            if let Some(allowed) = fault.allowed() {
                diagnostic = diagnostic.allowed(allowed);
            }
            match fault.remedy().or_else(|| defined(fault.unknown_symbol()?)) {
                Some(remedy) => diagnostic.remedy(remedy),
                None => diagnostic,
            }
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
            let diagnostic = Diagnostic::new(title)
                .remedy(format!(
                    "add a line `{} = …` to [system.equations]",
                    quotable(axis)
                ))
                .nearest(axis, known.iter().map(String::as_str));
            match key {
                Some(key) => diagnostic.at(&key, "unknown axis"),
                None => diagnostic,
            }
        }
        TypedModelError::Name(error) => {
            let place = name_entry(reader, error).map(|entry| entry.key_place.clone());
            plain("this name", place).remedy("give it another name")
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
        TypedModelError::TimeWithoutPeriod { place } => {
            let title = format!("{place} contains the time `t`");
            let diagnostic = Diagnostic::new(title).remedy(
                "stationary densities are of systems that do not change with time: a forcing can be made an axis of its own, a phase",
            );
            match value(place) {
                Some(place) => diagnostic.at(&place, "depends on time"),
                None => diagnostic,
            }
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

fn table_place(reader: &Reader<'_>, table: &str) -> Option<Place> {
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

/// The key that a name that is refused was given by: the last of those that have it.
fn name_entry<'d>(reader: &Reader<'d>, error: &SymbolError) -> Option<&'d Entry> {
    let (SymbolError::Malformed { name }
    | SymbolError::Reserved { name, .. }
    | SymbolError::Taken { name, .. }) = error
    else {
        return None;
    };
    let tables = ["define", "parameters", "equations"];
    tables
        .iter()
        .find_map(|table| reader.entry(&["system", table, name]))
}
