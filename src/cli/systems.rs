//! `pbif systems`: the list of models, and everything that is known of one.

use std::fmt::Write as _;
use std::sync::Arc;

use comfy_table::{Table, presets};

use crate::sweep_file::{Diagnostic, Report, starting_files};
use crate::system::friction::pulled::{has_friction, shown_values};
use crate::system::{Model, System, in_letters, registry};

/// The table of models.
pub(super) fn list() -> String {
    let mut table = table(&["model", "axes", "parameters", "description"]);
    for model in registry::models() {
        let axes: Vec<&str> = model.axes.iter().map(|axis| axis.name.as_str()).collect();
        let parameters = model
            .parameters
            .iter()
            .map(|parameter| parameter.name.as_str());
        let parameters: Vec<&str> = parameters.collect();
        table.add_row([
            model.name.clone(),
            axes.join(" "),
            parameters.join(" "),
            model.title.clone(),
        ]);
    }
    format!("{table}\n\nOne model in full: pbif systems NAME\n")
}

/// A plain table, as wide as its content.
fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(header.iter().copied());
    table
}

/// The model of that name.
///
/// # Errors
/// A report when there is no such model.
pub(super) fn find(name: &str) -> Result<Arc<Model>, Report> {
    let found = registry::find(name).map_err(|error| {
        let names = registry::models().iter().map(|model| model.name.as_str());
        Diagnostic::new(error.to_string()).nearest(name, names)
    });
    Ok(found?)
}

/// Everything about one model.
///
/// # Errors
/// As [`find`].
pub(super) fn describe(name: &str) -> Result<String, Report> {
    let model = find(name)?;
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_model(&mut text, &model);
    Ok(text)
}

fn write_model(text: &mut String, model: &Model) -> std::fmt::Result {
    writeln!(text, "{}: {}\n\nEquations", model.name, model.title)?;
    for equation in &model.equations {
        writeln!(text, "  {equation}")?;
    }
    writeln!(text, "\nAxes")?;
    for axis in &model.axes {
        let (name, symbol, meaning) = (&axis.name, in_letters(&axis.symbol), &axis.meaning);
        writeln!(text, "  {name}  {meaning} ({symbol} in figures)")?;
    }
    let mut parameters = table(&["parameter", "symbol", "meaning", "allowed", "default"]);
    for parameter in &model.parameters {
        let default = parameter.default;
        parameters.add_row([
            parameter.name.clone(),
            in_letters(&parameter.symbol),
            parameter.meaning.clone(),
            parameter.range.words().to_owned(),
            default.map_or("must be given".to_owned(), |value| value.to_string()),
        ]);
    }
    writeln!(text, "\n{parameters}\n")?;
    write_facts(text, model)?;
    writeln!(text, "\nSource\n  {}", model.source)?;
    if !model.notes.is_empty() {
        writeln!(text, "\nNotes")?;
    }
    for note in &model.notes {
        writeln!(text, "  - {note}")?;
    }
    let mut files = starting_files().iter();
    if let Some(file) = files.find(|file| file.is_of_model(&model.name)) {
        let name = file.name;
        writeln!(
            text,
            "\nA sweep to start from\n  pbif new mine.toml --like {name}"
        )?;
    }
    let shown = shown_values(model, &[]);
    if shown.is_ok_and(|values| has_friction(model.system(&values).as_ref())) {
        writeln!(
            text,
            "\nA picture of its force\n  pbif systems {} --plot",
            model.name
        )?;
    }
    Ok(())
}

/// Domain, switching surfaces and symmetry, which belong to a system with bound parameters: defaults, and 1
/// for parameters without one (every range allows it).
fn write_facts(text: &mut String, model: &Model) -> std::fmt::Result {
    let values = |default: f64| {
        let parameters = model.parameters.iter();
        parameters.map(move |parameter| {
            (
                parameter.name.as_str(),
                parameter.default.unwrap_or(default),
            )
        })
    };
    let given: Vec<(&str, f64)> = values(1.0).collect();
    let Ok(system) = model.system_with(&given) else {
        return Ok(());
    };
    let shown: Vec<String> = given
        .iter()
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    writeln!(text, "Domain")?;
    for (index, axis) in model.axes.iter().enumerate() {
        match system.facts().bounds(index) {
            Some((low, high)) => writeln!(
                text,
                "  {}  from {low} to {high} at {}; a sweep takes it from its parameters{}",
                axis.name,
                shown.join(", "),
                if axis.by_modes {
                    ", and modes carry it unless `cells` cuts it"
                } else {
                    ""
                }
            )?,
            None => writeln!(
                text,
                "  {}  unbounded: a sweep must give a range",
                axis.name
            )?,
        }
    }
    writeln!(
        text,
        "\nSwitching surfaces\n  {}",
        surfaces(model, system.as_ref())
    )?;
    writeln!(text, "\nSymmetry\n  {}", symmetry(model, system.as_ref()))
}

fn surfaces(model: &Model, system: &dyn System) -> String {
    let surfaces = &system.facts().switching_surfaces;
    let planes: Vec<String> = surfaces
        .iter()
        .filter_map(|surface| {
            Some(format!(
                "{} = {}",
                &model.axes.get(surface.axis)?.name,
                surface.at
            ))
        })
        .collect();
    if planes.is_empty() {
        return "none: the drift is smooth".to_owned();
    }
    planes.join(", ")
}

fn symmetry(model: &Model, system: &dyn System) -> String {
    let Some(symmetry) = &system.facts().symmetry else {
        return "none declared".to_owned();
    };
    let names: Vec<&str> = model.axes.iter().map(|axis| axis.name.as_str()).collect();
    let image = names.iter().enumerate().map(|(index, name)| {
        let reflected = symmetry.reflected.get(index).copied().unwrap_or(false);
        match symmetry.centre.get(index) {
            Some(&centre) if reflected && centre != 0.0 => format!("{} - {name}", 2.0 * centre),
            _ if reflected => format!("-{name}"),
            _ => (*name).to_owned(),
        }
    });
    let image: Vec<String> = image.collect();
    format!("({}) -> ({})", names.join(", "), image.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_is_listed_and_described() {
        let list = list();
        for model in registry::models() {
            assert!(list.contains(&model.name));
            let text = describe(&model.name).unwrap();
            let stated = [&model.source, &model.title].into_iter();
            for words in stated.chain(&model.equations).chain(&model.notes) {
                assert!(text.contains(words), "{words} not in\n{text}");
            }
            for parameter in &model.parameters {
                assert!(text.contains(&parameter.meaning));
            }
        }
    }

    #[test]
    fn a_law_with_a_starting_file_says_so() {
        let text = describe("lugre").unwrap();
        for words in ["pbif new mine.toml --like lugre", "modes carry it"] {
            assert!(text.contains(words), "{words} not in\n{text}");
        }
        assert!(!describe("coulomb").unwrap().contains("--like"));
    }

    #[test]
    fn coulomb_switches_at_rest_and_is_symmetric() {
        let text = describe("coulomb").unwrap();
        assert!(text.contains("Switching surfaces\n  y = 0\n"), "{text}");
        assert!(text.contains("(x, y) -> (-x, -y)"), "{text}");
    }
}
