//! `pbif plot` of a map of regimes, and of curves: their figures from what is stored, nothing is solved.

use std::path::PathBuf;

use super::super::args::PlotArguments;
use super::super::output::OutputFolder;
use super::super::stored::{Override, Stored, check_overrides};
use super::super::{CommandError, Outcome};
use crate::continuation::curve::{Curve, Plane, RowInPlane, SweepInPlane};
use crate::figure::{Figures, write_figures};
use crate::run::{StoredPlane, StoredPlaneContent, format_with_error};
use crate::sweep_file::{Diagnostic, Report, SweepFile};
use crate::system::Family;

/// Draws into the folder's `figures/` or another folder and prints the files; `overrides` are those of keys under
/// `figures`.
///
/// # Errors
/// [`CommandError`] when the file cannot be understood, a figure is not there, or cannot be drawn.
pub(super) fn run(
    stored: &StoredPlane,
    arguments: &PlotArguments,
    overrides: &[Override],
) -> Result<Outcome, CommandError> {
    if !arguments.at.is_empty() {
        let report = Diagnostic::new("`--at` is for the run of a sweep")
            .allowed("of a map and of curves the figures of the whole plane")
            .remedy("leave it out; `--only map_x` draws the map of x alone");
        return Err(report.into());
    }
    check_overrides(overrides, &["figures"])?;
    let mut file = SweepFile::parse("the stored sweep", stored.resolved());
    for (option, setting) in overrides {
        file.set_all(option, [setting]);
    }
    let spec = file.validate()?.fixed()?;
    let (settings, family) = (&spec.settings, spec.problem.family());
    let (title, style) = (&settings.title, &settings.figures.style);
    let content = stored.content(&spec.problem)?;
    let (plane, curves) = match &content {
        StoredPlaneContent::Map(map) => (&map.plane, map.curves.as_slice()),
        StoredPlaneContent::Curves(plane, tree, _) => (&**plane, tree.curves.as_slice()),
    };
    let crossed = crossed(&arguments.with, plane, family)?;
    let sweeps: Vec<SweepInPlane> = crossed.iter().map(|one| one.sweep.clone()).collect();
    let figures = match &content {
        StoredPlaneContent::Map(map) => Figures::of_map(map, &sweeps, title),
        StoredPlaneContent::Curves(plane, tree, origin) => {
            Figures::of_curves((plane, tree), (origin, &sweeps), family, title)
        }
    };
    let figures = figures
        .solved_by(settings.method.kind.name(), spec.problem.watched())
        .carried_by(family, spec.problem.space().axes())
        .with_style(style);
    let words: Vec<&str> = arguments.only.iter().map(|word| word.trim()).collect();
    figures.check(&words)?;
    let figures = match words.as_slice() {
        [] => figures.draw_all(),
        words => figures.draw_named(words),
    };
    let beside = stored.figures();
    let output = OutputFolder::prepare(&arguments.out.clone().map_or(beside, Ok)?)?;
    let files = write_figures(&figures, &settings.figures.formats, output.path())?;
    if files.is_empty() {
        return super::super::print("`figures.formats` is an empty list: nothing to draw\n");
    }
    if arguments.out.is_none() {
        stored.renew_figures(&files)?;
    }
    let summaries = crossed.iter().map(|one| one.summary(plane, curves));
    let text = summaries.collect::<String>() + &super::super::jobs::files(files);
    super::super::conclude(&text, Outcome::Complete, output.path())
}

/// A sweep that is marked, with the folder that it is from.
struct Crossed {
    folder: PathBuf,
    sweep: SweepInPlane,
}

/// The sweeps of some runs as lines of a plane; `family` is the plane's.
fn crossed(
    folders: &[PathBuf],
    plane: &Plane,
    family: &Family,
) -> Result<Vec<Crossed>, CommandError> {
    let read = |folder: &PathBuf| {
        let stored = Stored::read(folder, &[], &[], true)?;
        let sweep = SweepInPlane::new(plane, family, &stored.result).map_err(|error| {
            let [first, second] = plane.sides();
            let title = format!(
                "the sweep in {} does not lie in this plane: {error}",
                folder.display()
            );
            let remedy = format!(
                "`--with` takes a run of `pbif sweep` over {} or {} with the equations and all other parameters of the plane",
                first.parameter, second.parameter
            );
            Report::from(Diagnostic::new(title).remedy(remedy))
        })?;
        let folder = folder.clone();
        Ok(Crossed { folder, sweep })
    };
    folders.iter().map(read).collect()
}

impl Crossed {
    /// What it located, and how far that is from the curves.
    fn summary(&self, plane: &Plane, curves: &[Curve]) -> String {
        let mut text = format!("{}\n", self.folder.display());
        if self.sweep.rows.is_empty() {
            text += "  no P-bifurcation in the box\n";
        }
        for row in &self.sweep.rows {
            text += &format!(
                "  {:<4} {}  {}\n",
                row.label,
                self.place(plane, row),
                self.beside(row, curves)
            );
        }
        text
    }

    /// Both values of a row, to its error.
    fn place(&self, plane: &Plane, row: &RowInPlane) -> String {
        let sides = plane.sides().iter().enumerate();
        let values = sides.map(|(number, side)| {
            let error = if number == self.sweep.side {
                row.error
            } else {
                0.0
            };
            let (value, _) = format_with_error(row.values[number], error);
            format!("{} = {value}", side.parameter)
        });
        values.collect::<Vec<_>>().join("  ")
    }

    /// How far a row is from the curve of its indicator.
    fn beside(&self, row: &RowInPlane, curves: &[Curve]) -> String {
        if row.observable.is_none() {
            return "not marked: the plane does not watch its density".to_owned();
        }
        let Some(gap) = self.sweep.gap(row, curves) else {
            return "no curve of its indicator crosses the sweep".to_owned();
        };
        let words = if gap.gap <= gap.error {
            "within the errors of both"
        } else {
            "beyond the errors of both"
        };
        format!(
            "{:.1e} of the sides of the box from C{}, {words}, {:.1e}",
            gap.gap,
            gap.curve + 1,
            gap.error
        )
    }
}
