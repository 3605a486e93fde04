//! The model, its parameters, and the values of the swept one.

use std::sync::Arc;

use crate::continuation::evenly_spaced;
use crate::sweep_file::diagnostic::{Diagnostic, Place, nearest_name};
use crate::sweep_file::reader::{Reader, Sited};
use crate::system::{Family, Model, ParameterDescription, Path, System, registry};

/// The part of a specification that says what is swept.
pub(super) struct Swept {
    pub(super) family: Family,
    pub(super) points: usize,
    /// The system at both ends of the sweep.
    pub(super) ends: Vec<Arc<dyn System>>,
}

/// The model, if it is a known one; an unknown one is reported with the kind of its key.
pub(super) fn read_model(reader: &mut Reader) -> Option<Arc<Model>> {
    let name = reader.text(&["system", "model"])?;
    registry::find(&name.value).ok()
}

/// Reads `[system.parameters]` and `[sweep]`.
pub(super) fn read(reader: &mut Reader, model: &Arc<Model>) -> Option<Swept> {
    let name = reader.text(&["sweep", "parameter"]);
    let swept = name
        .as_ref()
        .and_then(|name| known_parameter(reader, model, name));
    // A misspelt name must not make its parameter look missing.
    let meant = swept.map(|swept| swept.name.as_str()).or_else(|| {
        let names = model
            .parameters
            .iter()
            .map(|parameter| parameter.name.as_str());
        nearest_name(&name.as_ref()?.value, names)
    });
    let given = read_parameters(reader, model, meant);
    let (from, to) = read_ends(reader, model, swept);
    let points = reader.integer::<usize>(&["sweep", "points"])?.value;
    let (swept, fixed, from, to) = (swept?, given?, from?, to?);
    if !check_values(reader, &from, &to, points) {
        return None;
    }
    let path = Path::parameter(swept.name.as_str(), from.value, to.value);
    let family = Family::new(model.clone(), &fixed, path);
    let bound = family.and_then(|family| {
        let ends = vec![family.at(from.value)?, family.at(to.value)?];
        Ok(Swept {
            family,
            points,
            ends,
        })
    });
    match bound {
        Ok(swept) => Some(swept),
        Err(error) => {
            reader.report(Diagnostic::new(error.to_string()));
            None
        }
    }
}

fn known_parameter<'a>(
    reader: &mut Reader,
    model: &'a Model,
    name: &Sited<String>,
) -> Option<&'a ParameterDescription> {
    let parameters = &model.parameters;
    let known = parameters
        .iter()
        .find(|parameter| parameter.name == name.value);
    if known.is_none() {
        let title = format!("model `{}` has no parameter `{}`", model.name, name.value);
        let names = parameters.iter().map(|parameter| parameter.name.as_str());
        let diagnostic = Diagnostic::new(title)
            .at(&name.place, "unknown parameter")
            .nearest(&name.value, names);
        reader.report(diagnostic);
    }
    known
}

/// The values that are given, the swept one left out; `None` if anything is wrong with them.
fn read_parameters<'a>(
    reader: &mut Reader,
    model: &'a Model,
    swept: Option<&str>,
) -> Option<Vec<(&'a str, f64)>> {
    let mut values = Vec::new();
    let mut complete = true;
    for name in reader.names(&["system", "parameters"]) {
        let Some(parameter) = known_parameter(reader, model, &name) else {
            complete = false;
            continue;
        };
        if Some(parameter.name.as_str()) == swept {
            let title = format!("parameter `{}` is swept and also given", parameter.name);
            let diagnostic = Diagnostic::new(title)
                .at(&name.place, "given here")
                .remedy("remove it here, or sweep another parameter with `sweep.parameter`");
            reader.report(diagnostic);
            complete = false;
        } else if let Some(value) = reader.number(&["system", "parameters", &parameter.name]) {
            complete &= check_range(reader, model, parameter, &value, "given here");
            values.push((parameter.name.as_str(), value.value));
        } else {
            complete = false;
        }
    }
    complete &= report_missing(reader, model, swept);
    complete.then_some(values)
}

/// Reports parameters without a default that are not given.
fn report_missing(reader: &mut Reader, model: &Model, swept: Option<&str>) -> bool {
    let mut complete = swept.is_some();
    for parameter in &model.parameters {
        let path = ["system", "parameters", &parameter.name];
        let given = reader.entry(&path).is_some() || Some(parameter.name.as_str()) == swept;
        if given || parameter.default.is_some() || swept.is_none() {
            continue;
        }
        complete = false;
        let title = format!(
            "model `{}` needs parameter `{}`",
            model.name, parameter.name
        );
        let mut diagnostic = Diagnostic::new(title)
            .allowed(parameter.range.words())
            .remedy(format!(
                "add `{} = …` to [system.parameters]: {}",
                parameter.name, parameter.meaning
            ));
        let tables = [&path[..2], &path[..1]];
        if let Some(table) = tables.iter().find_map(|path| reader.entry(path)) {
            let label = format!("`{}` is missing here", parameter.name);
            diagnostic = diagnostic.at(&table.key_place.clone(), label);
        }
        reader.report(diagnostic);
    }
    complete
}

fn check_range(
    reader: &mut Reader,
    model: &Model,
    parameter: &ParameterDescription,
    value: &Sited<f64>,
    label: &str,
) -> bool {
    if parameter.range.contains(value.value) {
        return true;
    }
    let title = format!(
        "parameter `{}` of model `{}` cannot be {}",
        parameter.name, model.name, value.value
    );
    let diagnostic = Diagnostic::new(title)
        .at(&value.place, label)
        .allowed(parameter.range.words());
    reader.report(diagnostic);
    false
}

/// Both ends of the sweep. Ranges of parameters are intervals, so that what lies between is allowed too.
fn read_ends(
    reader: &mut Reader,
    model: &Model,
    swept: Option<&ParameterDescription>,
) -> (Option<Sited<f64>>, Option<Sited<f64>>) {
    let mut end = |key: &str| {
        let value = reader.number(&["sweep", key])?;
        let allowed = swept
            .is_none_or(|swept| check_range(reader, model, swept, &value, "the sweep goes here"));
        allowed.then_some(value)
    };
    (end("from"), end("to"))
}

/// Whether the values of the sweep differ from each other.
fn check_values(reader: &mut Reader, from: &Sited<f64>, to: &Sited<f64>, points: usize) -> bool {
    let mut refuse = |title: String, place: &Place, label: &str| {
        let diagnostic = Diagnostic::new(title)
            .at(place, label)
            .allowed("two different ends, in either order, far enough apart for the points");
        reader.report(diagnostic);
        false
    };
    if from.value == to.value {
        let title = format!("the sweep goes from {} to {}", from.value, to.value);
        return refuse(title, &to.place, "the same as `sweep.from`");
    }
    let values = evenly_spaced((from.value, to.value), points);
    let rising = to.value > from.value;
    let apart = values
        .windows(2)
        .all(|pair| pair[1].is_finite() && pair[0] != pair[1] && (pair[1] > pair[0]) == rising);
    if apart {
        return true;
    }
    let title = format!(
        "no {points} different numbers lie between {} and {}",
        from.value, to.value
    );
    refuse(
        title,
        &to.place,
        "too near to, or too far from, `sweep.from`",
    )
}
