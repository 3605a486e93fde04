//! The model, its parameters, and the values of the swept one.

use std::sync::Arc;

use super::equations::model_in_words;
use crate::continuation::evenly_spaced;
use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::draft::Draft;
use crate::sweep_file::names::{nearest_name, quotable};
use crate::sweep_file::reader::Reader;
use crate::system::{Family, Model, ParameterDescription, Path};

/// What is swept, at how many values.
pub(super) struct Swept {
    pub(super) family: Family,
    pub(super) points: usize,
}

const PARAMETERS: [&str; 2] = ["system", "parameters"];
const PARAMETER: [&str; 2] = ["sweep", "parameter"];

/// Checks `[system.parameters]` and `[sweep]`; `None` if anything is wrong with them.
pub(super) fn read(reader: &mut Reader<'_>, draft: &Draft, model: &Arc<Model>) -> Option<Swept> {
    let name = draft.parameter.as_deref();
    let swept = name.and_then(|name| {
        let place = reader.place(&PARAMETER);
        known_parameter(reader, model, name, place)
    });
    // A misspelt name must not make its parameter look missing.
    let meant = swept.map(|swept| swept.name.as_str()).or_else(|| {
        let names = model.parameters.iter();
        nearest_name(name?, names.map(|parameter| parameter.name.as_str()))
    });
    let moved = (meant, swept.is_some());
    let fixed = read_parameters(reader, draft, model, moved, middle_of_map(draft));
    let (from, to) = (
        read_end(reader, model, swept, "from", draft.from),
        read_end(reader, model, swept, "to", draft.to),
    );
    let points = draft.points?;
    let (swept, fixed, from, to) = (swept?, fixed?, from?, to?);
    if !check_values(reader, from, to, points) {
        return None;
    }
    let path = Path::parameter(swept.name.as_str(), from, to);
    match Family::new(model.clone(), &fixed, path) {
        Ok(family) => Some(Swept { family, points }),
        Err(error) => {
            reader.report(Diagnostic::new(error.to_string()));
            None
        }
    }
}

pub(super) fn known_parameter<'m>(
    reader: &mut Reader<'_>,
    model: &'m Model,
    name: &str,
    place: Option<&Place>,
) -> Option<&'m ParameterDescription> {
    let parameters = &model.parameters;
    let known = parameters.iter().find(|parameter| parameter.name == name);
    if known.is_none() {
        let title = format!(
            "{} has no parameter `{}`",
            model_in_words(model),
            quotable(name)
        );
        let names = parameters.iter().map(|parameter| parameter.name.as_str());
        let diagnostic = Diagnostic::new(title).nearest(name, names);
        reader.report(diagnostic.at(place, "unknown parameter"));
    }
    known
}

/// The values that are given, the swept one left out; `None` if anything is wrong with them. Of the swept one is known
/// whether its name is right, or only the nearest to what is written.
fn read_parameters<'m>(
    reader: &mut Reader<'_>,
    draft: &Draft,
    model: &'m Model,
    (swept, is_named): (Option<&str>, bool),
    mapped: Option<(&str, f64)>,
) -> Option<Vec<(&'m str, f64)>> {
    let mut values = Vec::new();
    let mut complete = true;
    for entry in reader.entries(&PARAMETERS) {
        let known = known_parameter(reader, model, &entry.key, Some(&entry.key_place));
        let Some(parameter) = known else {
            complete = false;
            continue;
        };
        let mut given = draft.parameters.iter();
        if Some(parameter.name.as_str()) == swept && (model.typed().is_some() || !is_named) {
            // Which of the parameters of a file's own equations is swept is changed more easily where all have values;
            // of a name that is misspelt nothing more is to be said.
            continue;
        }
        if Some(parameter.name.as_str()) == swept {
            let title = format!("parameter `{}` is swept and also given", parameter.name);
            let diagnostic = Diagnostic::new(title)
                .at(&entry.key_place, "given here")
                .remedy("remove it here, or sweep another parameter with `sweep.parameter`");
            reader.report(diagnostic);
            complete = false;
        } else if let Some((_, value)) = given.find(|(name, _)| *name == parameter.name) {
            let place = &entry.node.place;
            complete &= check_range(reader, model, parameter, *value, place, "given here");
            values.push((parameter.name.as_str(), *value));
        } else {
            complete = false;
        }
    }
    let is_given = |name: &str| values.iter().any(|(known, _)| *known == name);
    let mapped = mapped.filter(|(name, _)| !is_given(name) && Some(*name) != swept);
    let named = mapped.and_then(|(name, value)| {
        let mut known = model.parameters.iter();
        Some((known.find(|parameter| parameter.name == name)?, value))
    });
    values.extend(named.map(|(parameter, value)| (parameter.name.as_str(), value)));
    complete &= report_missing(reader, model, [swept, mapped.map(|one| one.0)]);
    complete.then_some(values)
}

/// Reports parameters without a default that are not given.
fn report_missing(reader: &mut Reader<'_>, model: &Model, moved: [Option<&str>; 2]) -> bool {
    let swept = moved[0];
    let mut complete = swept.is_some();
    for parameter in &model.parameters {
        let path = [PARAMETERS[0], PARAMETERS[1], &parameter.name];
        let given = reader.entry(&path).is_some() || moved.contains(&Some(parameter.name.as_str()));
        if given || parameter.default.is_some() || swept.is_none() {
            continue;
        }
        complete = false;
        let title = format!(
            "{} needs parameter `{}`",
            model_in_words(model),
            parameter.name
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
            diagnostic = diagnostic.at(&table.key_place, label);
        }
        reader.report(diagnostic);
    }
    complete
}

pub(super) fn check_range(
    reader: &mut Reader<'_>,
    model: &Model,
    parameter: &ParameterDescription,
    value: f64,
    place: &Place,
    label: &str,
) -> bool {
    if parameter.range.contains(value) {
        return true;
    }
    let title = format!(
        "parameter `{}` of model `{}` cannot be {value}",
        parameter.name, model.name
    );
    let diagnostic = Diagnostic::new(title)
        .at(place, label)
        .allowed(parameter.range.words());
    reader.report(diagnostic);
    false
}

/// One end of the sweep. Ranges of parameters are intervals, so that what lies between is allowed too.
fn read_end(
    reader: &mut Reader<'_>,
    model: &Model,
    swept: Option<&ParameterDescription>,
    key: &str,
    value: Option<f64>,
) -> Option<f64> {
    let value = value?;
    let (Some(swept), Some(place)) = (swept, reader.place(&["sweep", key])) else {
        return Some(value);
    };
    let allowed = check_range(reader, model, swept, value, place, "the sweep goes here");
    allowed.then_some(value)
}

/// Whether the values of the sweep differ from each other.
fn check_values(reader: &mut Reader<'_>, from: f64, to: f64, points: usize) -> bool {
    let (title, label) = if from == to {
        let title = format!("the sweep goes from {from} to {to}");
        (title, "the same as `sweep.from`")
    } else {
        let values = evenly_spaced((from, to), points);
        let rising = to > from;
        let apart = values
            .windows(2)
            .all(|pair| pair[1].is_finite() && pair[0] != pair[1] && (pair[1] > pair[0]) == rising);
        if apart {
            return true;
        }
        let [from, to] = [from, to].map(in_few_digits);
        let title = format!("no {points} different numbers lie between {from} and {to}");
        (title, "too near to, or too far from, `sweep.from`")
    };
    let diagnostic = Diagnostic::new(title)
        .allowed("two different ends, in either order, far enough apart for the points");
    reader.report(diagnostic.at(reader.place(&["sweep", "to"]), label));
    false
}

/// The second parameter with a value in the middle of its range, for a file that does not say at which value a sweep of
/// the first alone holds it.
pub(super) fn middle_of_map(draft: &Draft) -> Option<(&str, f64)> {
    let (from, to) = (draft.map.from?, draft.map.to?);
    Some((draft.map.parameter.as_deref()?, 0.5 * (from + to)))
}

/// A number as it may stand in a sentence: with an exponent where it has more digits than a number can have.
fn in_few_digits(value: f64) -> String {
    match value.abs() {
        1e-6..1e17 | 0.0 => value.to_string(),
        _ => format!("{value:e}"),
    }
}
