//! `pbif plot`: the figures of a stored run, drawn again: which, where, how.

mod plane;

use super::args::PlotArguments;
use super::output::OutputFolder;
use super::stored::{Override, Stored, set};
use super::{CommandError, Outcome};
use crate::continuation::{Point, SweepResult};
use crate::figure::{
    ColourMap, ColourScale, FigureWidth, Figures, Ground, Typeface, write_figures,
};
use crate::job::draw_sweep;
use crate::run::{StoredPlane, format_number};
use crate::sweep_file::{Diagnostic, list};

/// Share of the swept range within which a value is one of the run's.
const SAME: f64 = 1e-6;
/// Computed values that are offered for one that is not there.
const OFFERED: usize = 3;

/// Draws into the run's `figures/` or another folder and prints the files.
///
/// # Errors
/// [`CommandError`] when the run cannot be read or a figure not be drawn.
pub(super) fn run(arguments: &PlotArguments) -> Result<Outcome, CommandError> {
    let mut overrides = overrides(arguments)?;
    overrides.extend(set(&arguments.overrides));
    if let Some(stored) = StoredPlane::open(&arguments.run)? {
        // Names of its figures are not those of a sweep.
        overrides.retain(|(_, one)| !one.starts_with("figures.draw="));
        return plane::run(&stored, arguments, &overrides);
    }
    if !arguments.with.is_empty() {
        let report = Diagnostic::new("`--with` marks sweeps in the figure of a plane, and this is the run of a sweep")
            .remedy("give the folder of a map or of curves first: `pbif plot output/coulomb_plane --with output/coulomb_fc`");
        return Err(report.into());
    }
    let stored = Stored::read(&arguments.run, &overrides, &["figures"], arguments.quiet)?;
    if !arguments.at.is_empty() {
        check_values(&stored.result, &stored.spec.settings.figures.at)?;
    }
    check_names(&stored)?;
    let figures = stored.run.figures();
    let output = OutputFolder::prepare(&arguments.out.clone().map_or(figures, Ok)?)?;
    let drawn = draw_sweep(&stored.spec, &stored.result);
    let formats = &stored.spec.settings.figures.formats;
    let files = write_figures(&drawn, formats, output.path())?;
    if files.is_empty() {
        return super::print(nothing_drawn(&stored));
    }
    if arguments.out.is_none() {
        stored.run.renew_figures(&files)?;
    }
    super::conclude(&super::jobs::files(files), Outcome::Complete, output.path())
}

/// Why there is no figure.
fn nothing_drawn(stored: &Stored) -> &'static str {
    let settings = &stored.spec.settings;
    if settings.figures.names().is_empty() {
        return "`figures.draw` is an empty list: nothing to draw\n";
    }
    if settings.figures.formats.is_empty() {
        return "`figures.formats` is an empty list: nothing to draw\n";
    }
    let has_density = |point: &Point| !point.densities.is_empty();
    if stored.result.points.iter().any(has_density) {
        "the run has no figures of these names: nothing to draw\n"
    } else {
        super::sweep::summary::nothing_to_draw(&stored.result)
    }
}

/// Refuses names that no figure of this run has, such as one at a value that was not computed.
fn check_names(stored: &Stored) -> Result<(), CommandError> {
    let settings = &stored.spec.settings;
    let figures = Figures::of_sweep(&stored.result, &settings.title, &settings.figures.at);
    Ok(figures.check(settings.figures.names())?)
}

/// The short options as keys.
fn overrides(arguments: &PlotArguments) -> Result<Vec<Override>, CommandError> {
    let mut keys = Vec::new();
    let texts = |words: &[String]| {
        let quoted = words.iter().map(|word| format!("{:?}", word.trim()));
        quoted.collect::<Vec<_>>().join(", ")
    };
    if !arguments.only.is_empty() {
        let names = texts(&arguments.only);
        keys.push(("--only", format!("figures.draw=[{names}]")));
    }
    if !arguments.format.is_empty() {
        let names = texts(&arguments.format);
        keys.push(("--format", format!("figures.formats=[{names}]")));
    }
    if !arguments.at.is_empty() {
        let values = arguments.at.join(", ");
        keys.push(("--at", format!("figures.at=[{values}]")));
    }
    for word in &arguments.style {
        keys.push(("--style", style_key(word.trim())?));
    }
    Ok(keys)
}

/// The key that a word of `--style` sets.
pub(super) fn style_key(word: &str) -> Result<String, CommandError> {
    let is_name = |names: &[&str]| names.contains(&word);
    let widths: Vec<&str> = FigureWidth::NAMED
        .into_iter()
        .filter_map(FigureWidth::name)
        .collect();
    let fonts = Typeface::ALL.map(Typeface::name);
    let colours = ColourMap::ALL.map(ColourMap::name);
    let scales = ColourScale::ALL.map(ColourScale::name);
    let grounds = Ground::ALL.map(Ground::name);
    let switches = ["no-title", "no-letters"];
    if word.parse::<f64>().is_ok() {
        return Ok(format!("figures.style.width={word}"));
    }
    let of = |key: &str| Ok(format!("figures.style.{key}={word:?}"));
    match () {
        () if is_name(&widths) => of("width"),
        () if is_name(&fonts) => of("font"),
        () if is_name(&colours) => of("colours"),
        () if is_name(&scales) => of("scale"),
        () if is_name(&grounds) => of("ground"),
        () if is_name(&switches) => Ok(format!(
            "figures.style.{}=\"off\"",
            word.trim_start_matches("no-")
        )),
        () => {
            let known: Vec<&str> = widths
                .into_iter()
                .chain(fonts)
                .chain(colours)
                .chain(scales)
                .chain(grounds)
                .chain(switches)
                .collect();
            let report = Diagnostic::new(format!("`--style` knows no word {word:?}"))
                .allowed(format!("a number of millimetres, {}", list(&known)))
                .remedy("finer settings are keys: `--set figures.style.text=7`")
                .nearest(word, known.iter().copied());
            Err(report.into())
        }
    }
}

/// Refuses values at which the run has no densities; offers the nearest.
fn check_values(result: &SweepResult, values: &[f64]) -> Result<(), CommandError> {
    let parameter = result.subject.family.parameter();
    let (low, high) = result.subject.family.range();
    let solved: Vec<f64> = result
        .points
        .iter()
        .filter(|point| !point.densities.is_empty())
        .map(|point| point.value)
        .collect();
    for &wanted in values {
        let mut nearest = solved.clone();
        nearest.sort_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs()));
        let is_there = |value: &f64| (value - wanted).abs() <= SAME * (high - low);
        if nearest.first().is_some_and(is_there) {
            continue;
        }
        nearest.truncate(OFFERED);
        nearest.sort_by(f64::total_cmp);
        let offered: Vec<String> = nearest.into_iter().map(format_number).collect();
        let title = format!("the run has no densities at {parameter} = {wanted}");
        let report = Diagnostic::new(title)
            .allowed(format!("the nearest that it has: {}", offered.join(", ")))
            .remedy("`--set figures.at=[…]` takes the nearest value by itself");
        return Err(report.into());
    }
    Ok(())
}
