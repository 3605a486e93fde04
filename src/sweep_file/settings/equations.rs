//! The model: a built-in one by its name, or the equations of the file, read with their places so that everything wrong
//! with them is shown where it stands.

mod faults;

use std::sync::Arc;

use crate::MAX_DIMENSION;
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::{Draft, EquationsDraft};
use crate::sweep_file::keys;
use crate::sweep_file::names::{list, nearest_name, quotable};
use crate::sweep_file::reader::Reader;
use crate::sweep_file::value::Value;
use crate::system::{ColouredNoiseError, Model, ParameterDescription, TypedModel};

pub(in crate::sweep_file) use faults::value_place;

use faults::{diagnostic, table_place};

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
        (Some(_), None) => built_in_model(reader, draft),
        (Some(model), Some(given)) => {
            let title = format!("a built-in model, and `system.{}` too", given.key);
            let diagnostic = Diagnostic::new(title)
                .at(&given.key_place, "equations of your own")
                .allowed("`system.model`, or equations in `system.equations`")
                .remedy(if model.key_place.is_set() {
"the equations of the file cannot be exchanged for a built-in model: write another file"
                } else {
"remove `model`, or the equations"
                });
            reader.report(diagnostic);
            None
        }
        (None, Some(_)) => typed_model(reader, draft),
        (None, None) => {
            missing(reader);
            None
        }
    }
}

/// The built-in model, with the noise that the file means.
fn built_in_model(reader: &mut Reader<'_>, draft: &Draft) -> Option<Arc<Model>> {
    let model = draft.model.as_ref()?;
    let kind = draft.noise_kind.unwrap_or_default();
    if !kind.is_coloured() {
        return Some(Arc::clone(model));
    }
    let coloured = Model::with_coloured_noise(model, kind);
    let refused = |error: ColouredNoiseError| {
        let diagnostic = Diagnostic::new(error.to_string());
        let place = reader.place(&["system", "noise", KIND]);
        let diagnostic = diagnostic.at(place, "coloured noise");
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
fn typed_model(reader: &mut Reader<'_>, draft: &Draft) -> Option<Arc<Model>> {
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
    check_axis_names(reader);
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

/// Refuses axes whose names are keys in a table that has a key an axis: the file would say two things in one place.
fn check_axis_names(reader: &mut Reader<'_>) {
    let axes = reader.entries(&["system", "equations"]).iter();
    let taken = axes.filter_map(|axis| {
        let key = keys::by_name("<axis>", &axis.key)?;
        let title = format!(
            "an axis cannot be called `{}`: `{}` is a key",
            axis.key,
            key.path()
        );
        let found = Diagnostic::new(title).at(&axis.key_place, "this axis");
        Some(found.remedy("give the axis another name"))
    });
    let taken: Vec<Diagnostic> = taken.collect();
    taken.into_iter().for_each(|found| reader.report(found));
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
    // So is that of a parameter that the map moves, if a formula has it.
    let moved = draft.map.parameter.iter();
    let moved = moved.filter(|name| texts(draft).any(|text| text.contains(name.as_str())));
    for name in draft.parameter.iter().chain(moved) {
        let known = parameters.iter().any(|known| known.name == *name);
        if !known {
            parameters.push(ParameterDescription::from(name.as_str()));
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
    let title = title.map_or("", String::as_str);
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
    for (axis, period) in &equations.angles {
        model = model.with_angle(axis, *period);
    }
    let model = match equations.interpretation {
        Some(interpretation) => model.with_interpretation(interpretation),
        None => model,
    };
    model.with_coloured_noise(draft.noise_kind.unwrap_or_default())
}

/// The formulas of drift, definitions and noise.
fn texts(draft: &Draft) -> impl Iterator<Item = &String> {
    let equations = &draft.equations;
    let drift = equations.drift.iter().chain(&equations.define);
    let noise = equations.noise.iter();
    let noise = noise.flat_map(|(_, amplitudes)| amplitudes);
    drift.map(|(_, text)| text).chain(noise)
}

/// Where other names are unknown, a swept parameter that no formula has is perhaps one of them.
fn check_swept_name(reader: &mut Reader<'_>, draft: &Draft) {
    let Some(swept) = draft.parameter.as_deref() else {
        return;
    };
    let given = draft.parameters.iter().any(|(name, _)| name == swept);
    let of_noise = draft.noise_kind.unwrap_or_default().has_parameter(swept);
    if given || of_noise || texts(draft).any(|text| text.contains(swept)) {
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
            reader.report(diagnostic.at(place, "sweeping it changes nothing"));
        } else if let Some(entry) = reader.entry(&path) {
            let title = format!("parameter `{shown}` is in no equation, noise or bound");
            let near = nearest_name(name, used.iter().copied());
            let near = near.map(|near| format!("did you mean `{near}`?"));
            if entry.key_place.is_set() {
                let diagnostic = Diagnostic::new(title).at(&entry.key_place, "set here");
                reader.report(diagnostic.advice(Some(list(&used)), near));
            } else {
                let diagnostic = Diagnostic::warning(title).at(&entry.key_place, "not used");
                reader.warn(diagnostic.advice(None, near));
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
    reader.report(diagnostic.at(place.as_ref(), "no noise"));
}
