//! The curve of one row: what it is made of, following it, and writing it down.

use std::path::Path;

use super::asked::Asked;
use super::refusals::{check_corners, held_value, no_indicator, refused, refused_plane};
use super::{kept, tell};
use crate::cancellation::Cancellation;
use crate::cli::{CommandError, Outcome};
use crate::continuation::curve::{
    Curve, CurveError, CurveOptions, CurveOrigin, CurveStart, CurveTree, Plane, follow_all,
};
use crate::continuation::{LabelledPoint, LocateOptions, SourceError, SweepResult};
use crate::figure::{Figures, write_figures};
use crate::method::MethodError;
use crate::run::{CurveFolder, Journal, JournalledSource, format_number};
use crate::sweep_file::{Diagnostic, Sweep};

/// A curve to be followed.
pub(super) struct Job<'a> {
    pub(super) asked: &'a Asked,
    pub(super) spec: &'a Sweep,
    pub(super) row: &'a LabelledPoint,
    pub(super) plane: Plane,
    start: CurveStart,
    quiet: bool,
}

impl<'a> Job<'a> {
    /// The curve of a row of a result; whatever can be refused before anything is solved is.
    ///
    /// # Errors
    /// [`CommandError::Input`].
    pub(super) fn new(
        asked: &'a Asked,
        spec: &'a Sweep,
        (row, result): (&'a LabelledPoint, &SweepResult),
        quiet: bool,
    ) -> Result<Self, CommandError> {
        let held = held_value(&asked.second, spec)?;
        let plane = asked.plane(spec)?;
        let start = CurveStart::from_row(row, held, spec.problem.subject());
        let start = start.ok_or_else(|| no_indicator(row, result))?;
        let job = Self {
            asked,
            spec,
            row,
            plane,
            start,
            quiet,
        };
        job.check_box()?;
        check_corners(spec, &job.plane)?;
        Ok(job)
    }

    /// Refuses a box that the start is not in, before anything is solved.
    fn check_box(&self) -> Result<(), CommandError> {
        let sides = self.plane.sides().iter().zip(self.start.values).enumerate();
        for (number, (side, value)) in sides {
            if (side.from..=side.to).contains(&value) {
                continue;
            }
            let (parameter, from, to) = (&side.parameter, side.from, side.to);
            let title = format!(
                "{} is not in the box: {parameter} is {} there, and the box goes from {from} to {to}",
                self.row.label,
                format_number(value)
            );
            let (low, high) = match number {
                0 => ("--first-from", "--first-to"),
                _ => ("--from", "--to"),
            };
            let remedy = format!(
                "give `{low}` and `{high}` on either side of {}",
                format_number(value)
            );
            return Err(CommandError::Input(
                Diagnostic::new(title).remedy(remedy).into(),
            ));
        }
        Ok(())
    }

    /// What the curves are made of beside the program, as TOML: the sweep, and where they start and end.
    pub(super) fn described(&self) -> String {
        let sides = self.plane.sides().iter();
        let sides = sides.map(|side| format!("[{:?}, {:?}]", side.from, side.to));
        let sides: Vec<String> = sides.collect();
        format!(
            "{}\n[followed]\nrow = \"{}\"\nstart = {:?}\nsecond = \"{}\"\nbox = [{}]\nstep = {:?}\nbranches = {}\n",
            self.spec.to_toml(),
            self.row.label,
            self.start.values,
            self.asked.second,
            sides.join(", "),
            self.asked.step,
            self.asked.branches,
        )
    }

    /// Follows the curve, and those that start from it; `None` when interrupted before there was one. What is in the
    /// journal is not solved again.
    pub(super) fn follow(
        &self,
        journal: &Journal,
        cancellation: &Cancellation,
    ) -> Result<Option<CurveTree>, CommandError> {
        let options = CurveOptions {
            largest_step: self.asked.step,
            branches: self.asked.branches,
            ..self.spec.curve_options(self.plane.sides()[0].length())
        };
        let source = match self.spec.source_in(&self.plane, cancellation) {
            Ok(source) => JournalledSource::new(Box::new(source), journal),
            Err(MethodError::Cancelled(_)) => return Ok(None),
            Err(error) => return Err(refused_plane(&error)),
        };
        let [first, second] = self
            .plane
            .sides()
            .each_ref()
            .map(|side| side.parameter.as_str());
        let mut met = 0;
        let quiet = self.quiet;
        if journal.solves() > 0 {
            tell(
                quiet,
                &format!("going on after {} solves\n", journal.solves()),
            );
        }
        let mut observer = |values: [f64; 2]| {
            met += 1;
            tell(
                quiet,
                &format!(
                    "{met}: {first} = {:.6e}  {second} = {:.6e}\n",
                    values[0], values[1]
                ),
            );
        };
        let found = follow_all(
            &source,
            &self.plane,
            &self.spec.detector(),
            &self.start,
            &options,
            cancellation,
            &mut observer,
        );
        match found {
            Ok(tree) => Ok(Some(tree)),
            Err(CurveError::Source(SourceError::Interrupted)) => Ok(None),
            Err(error) => Err(refused(error)),
        }
    }

    /// Writes the curves and prints what they are.
    pub(super) fn conclude(
        &self,
        tree: &CurveTree,
        (folder, of): (CurveFolder, &str),
        home: &Path,
    ) -> Result<Outcome, CommandError> {
        let (family, settings) = (self.spec.problem.family(), &self.spec.settings);
        let (origin, sweep) = (CurveOrigin::from(self.row), self.spec.to_toml());
        folder.write(family, &self.plane, tree, (&origin, &sweep, of))?;
        let figures = Figures::of_curves(&tree.curves, (&origin, &[]), family, &settings.title);
        let figures = figures.with_style(&settings.figures.style).draw_all()?;
        write_figures(&figures, &settings.figures.formats, &folder.figures())?;
        let outcome = outcome(tree, &settings.locate);
        let interrupted = outcome == Outcome::Interrupted;
        let files = folder.take_place(interrupted)?;
        let mut text = self.summary(tree);
        if interrupted {
            text += &format!("interrupted: {}\n", kept(home));
        }
        text += "files\n";
        for file in files {
            text += &format!("  {}\n", file.display());
        }
        crate::cli::conclude(&text, outcome, home)
    }
}

/// How a command ends that gives these curves.
fn outcome(tree: &CurveTree, locate: &LocateOptions) -> Outcome {
    let mut points = tree.curves.iter().flat_map(|curve| &curve.points);
    if tree.curves.iter().any(Curve::is_interrupted) {
        Outcome::Interrupted
    } else if tree.missed.is_empty() && points.all(|point| locate.is_met_by(point.status)) {
        Outcome::Complete
    } else {
        Outcome::Partial
    }
}
