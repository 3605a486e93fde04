//! `pbif systems NAME --plot`: the friction law of a model, as a test bench shows it.

use std::path::Path;

use super::args::FrictionPlotArguments;
use super::output::OutputFolder;
use super::plot::style_key;
use super::{CommandError, Outcome};
use crate::figure::{FigureStyle, Figures, Format, write_figures};
use crate::sweep_file::{Diagnostic, Report, SweepFile, list, starting_files};
use crate::system::friction::pulled::{has_friction, shown_values};
use crate::system::{Model, SystemError, registry};

/// Where figures go that belong to no run.
const FOLDER: &str = "output/systems";

/// Draws the law and prints the files.
///
/// # Errors
/// [`CommandError`] when the model has no friction law, a value or an option cannot be understood, or a file cannot be
/// written.
pub(super) fn run(
    model: &Model,
    arguments: &FrictionPlotArguments,
) -> Result<Outcome, CommandError> {
    let (figure_keys, values): (Vec<&String>, Vec<&String>) = arguments
        .overrides
        .iter()
        .partition(|one| one.starts_with("figures."));
    let (style, formats) = style(arguments, &figure_keys)?;
    let given = values.into_iter().map(|one| value(model, one));
    let given = given.collect::<Result<Vec<_>, _>>()?;
    let given: Vec<(&str, f64)> = given
        .iter()
        .map(|(name, value)| (&name[..], *value))
        .collect();
    let values = shown_values(model, &given).map_err(|error| refusal(model, &error))?;
    let figures = Figures::of_friction(model, &values, &model.title).with_style(&style);
    let figures = figures.draw_all();
    if figures.is_empty() {
        return Err(without_friction(model).into());
    }
    if formats.is_empty() {
        return super::print("`figures.formats` is an empty list: nothing to draw\n");
    }
    let folder = arguments.out.as_deref().unwrap_or(Path::new(FOLDER));
    let output = OutputFolder::prepare(folder)?;
    let files = write_figures(&figures, &formats, output.path())?;
    let lines = files.iter().map(|file| format!("  {}\n", file.display()));
    let text = format!("files\n{}", lines.collect::<String>());
    super::conclude(&text, Outcome::Complete, output.path())
}

/// Style and formats, by the keys that they have in a sweep file.
fn style(
    arguments: &FrictionPlotArguments,
    keys: &[&String],
) -> Result<(FigureStyle, Vec<Format>), CommandError> {
    let mut overrides = Vec::new();
    if !arguments.format.is_empty() {
        let quoted = arguments
            .format
            .iter()
            .map(|word| format!("{:?}", word.trim()));
        let quoted: Vec<String> = quoted.collect();
        overrides.push(format!("figures.formats=[{}]", quoted.join(", ")));
    }
    for word in &arguments.style {
        overrides.push(style_key(word.trim())?);
    }
    overrides.extend(keys.iter().map(|key| (*key).clone()));
    // Any sweep knows the keys of figures.
    let text = starting_files().first().map_or("", |file| file.text);
    let settings = SweepFile::parse("a sweep", text)
        .set_all("--set", &overrides)
        .validate()?;
    Ok((settings.figures.style, settings.figures.formats))
}

/// `lambda=2` as a name and a number.
fn value(model: &Model, given: &str) -> Result<(String, f64), Report> {
    let (name, number) = given.split_once('=').unwrap_or((given, ""));
    let name = name.trim().trim_start_matches("system.parameters.");
    let names: Vec<&str> = model
        .parameters
        .iter()
        .map(|one| one.name.as_str())
        .collect();
    if !names.contains(&name) {
        return Err(
            Diagnostic::new(format!("`{}` has no parameter `{name}`", model.name))
                .allowed(list(&names))
                .nearest(name, names.iter().copied())
                .into(),
        );
    }
    match number.trim().parse() {
        Ok(value) => Ok((name.to_owned(), value)),
        Err(_) => Err(Diagnostic::new(format!("`--set {given}` gives no number"))
            .allowed(format!("a parameter and its value, such as {name}=0.5"))
            .into()),
    }
}

fn refusal(model: &Model, error: &SystemError) -> Report {
    let report = Diagnostic::new(error.to_string());
    report
        .remedy(format!(
            "`pbif systems {}` lists what each parameter may be",
            model.name
        ))
        .into()
}

fn without_friction(model: &Model) -> Report {
    let models = registry::models().iter();
    let with = models.filter(|model| {
        let values = shown_values(model, &[]);
        values.is_ok_and(|values| has_friction(model.system(&values).as_ref()))
    });
    let with: Vec<&str> = with.map(|model| model.name.as_str()).collect();
    let title = if with.contains(&model.name.as_str()) {
        format!(
            "the friction of `{}` is zero with these values: nothing to draw",
            model.name
        )
    } else {
        format!("`{}` has no friction law: nothing to draw", model.name)
    };
    let report = Diagnostic::new(title).allowed(format!("models with one: {}", list(&with)));
    let remedy = format!("`pbif systems {}` tells in words what it is", model.name);
    report.remedy(remedy).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(report: &Report) -> String {
        report.render(false)
    }

    #[test]
    fn what_cannot_be_drawn_is_told_with_what_can() {
        let text = words(&without_friction(&registry::find("bistable").unwrap()));
        for words in ["`bistable` has no friction law", "coulomb", "bliman_sorine"] {
            assert!(text.contains(words), "{words} not in {text}");
        }
        assert!(!text.contains("rayleigh"), "{text}");
        let text = words(&without_friction(&registry::find("coulomb").unwrap()));
        assert!(text.contains("is zero with these values"), "{text}");
    }

    #[test]
    fn a_value_is_a_parameter_of_the_model_and_a_number() {
        let lugre = registry::find("lugre").unwrap();
        assert_eq!(value(&lugre, "f_s=2").unwrap(), ("f_s".to_owned(), 2.0));
        let long = value(&lugre, "system.parameters.f_s = 2").unwrap();
        assert_eq!(long, ("f_s".to_owned(), 2.0));
        let text = words(&value(&lugre, "lamda=2").unwrap_err());
        assert!(
            text.contains("has no parameter `lamda`") && text.contains("lambda"),
            "{text}"
        );
        let text = words(&value(&lugre, "f_s=high").unwrap_err());
        assert!(text.contains("gives no number"), "{text}");
        let text = words(&value(&lugre, "f_s").unwrap_err());
        assert!(text.contains("gives no number"), "{text}");
    }
}
