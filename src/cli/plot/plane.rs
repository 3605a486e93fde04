//! `pbif plot` of a map of regimes, and of curves: their figures from what is stored, nothing is solved.

use super::super::args::PlotArguments;
use super::super::output::OutputFolder;
use super::super::stored::check_overrides;
use super::super::{CommandError, Outcome};
use crate::figure::{
    Figure, FigureError, curve_figure, map_figures, matches_figure, write_figures,
};
use crate::run::{StoredPlane, StoredPlaneContent};
use crate::sweep_file::{Diagnostic, SweepFile};

/// Draws into the folder's `figures/` or another folder and prints the files; `overrides` are those of keys under `figures`.
///
/// # Errors
/// [`CommandError`] when the file cannot be understood, a figure is not there, or cannot be drawn.
pub(super) fn run(
    stored: &StoredPlane,
    arguments: &PlotArguments,
    overrides: &[String],
) -> Result<Outcome, CommandError> {
    if !arguments.at.is_empty() {
        let report = Diagnostic::new("`--at` is for the run of a sweep")
            .allowed("of a map and of curves the figures of the whole plane")
            .remedy("leave it out; `--only map_x` draws the map of x alone");
        return Err(CommandError::Input(report.into()));
    }
    check_overrides(overrides, &["figures"])?;
    let mut file = SweepFile::parse("the stored sweep", stored.resolved());
    let spec = file.set_all("--set", overrides).validate()?.fixed()?;
    let (settings, family) = (&spec.settings, spec.problem.family());
    let (title, style) = (&settings.title, &settings.figure_style);
    let figures = match stored.content(&spec.problem)? {
        StoredPlaneContent::Map(map) => map_figures(&map, title, style)?,
        StoredPlaneContent::Curves(curves, origin) => {
            vec![curve_figure(&curves, &origin, family, title, style)?]
        }
    };
    let figures = chosen(figures, &arguments.only)?;
    let beside = arguments.run.join("figures");
    let output = OutputFolder::prepare(arguments.out.as_deref().unwrap_or(&beside))?;
    let files = write_figures(&figures, &settings.figure_formats, output.path())?;
    if files.is_empty() {
        return super::super::print("`figures.formats` is an empty list: nothing to draw\n");
    }
    if arguments.out.is_none() {
        stored.renew_figures()?;
    }
    let lines = files.iter().map(|file| format!("  {}\n", file.display()));
    let text = format!("files\n{}", lines.collect::<String>());
    super::super::conclude(&text, Outcome::Complete, output.path())
}

/// The figures that some words name; all without any.
fn chosen(figures: Vec<Figure>, words: &[String]) -> Result<Vec<Figure>, FigureError> {
    let words: Vec<&str> = words.iter().map(|word| word.trim()).collect();
    let names = |figure: &Figure, word: &str| word == "all" || matches_figure(word, &figure.name);
    for &word in &words {
        if !figures.iter().any(|figure| names(figure, word)) {
            return Err(FigureError::Unknown {
                name: word.to_owned(),
                known: figures.into_iter().map(|figure| figure.name).collect(),
            });
        }
    }
    let is_chosen =
        |figure: &Figure| words.is_empty() || words.iter().any(|word| names(figure, word));
    Ok(figures.into_iter().filter(is_chosen).collect())
}
