//! `pbif curve`: from a located row of a run, the curve of the same P-bifurcation in the plane of the swept and a second parameter.

mod refusals;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::args::{CurveArguments, SweepInput};
use super::output::OutputFolder;
use super::stored::Stored;
use super::{CommandError, Outcome};
use crate::cancellation::Cancellation;
use crate::continuation::curve::{
    CodimensionTwo, CodimensionTwoKind, Curve, CurveError, CurveOptions, CurveOrigin, CurveStart,
    CurveTree, Plane, codimension_two, follow, follow_all,
};
use crate::continuation::{
    BifurcationStatus, LabelledPoint, LocateOptions, SourceError, SweepResult,
};
use crate::figure::{curve_figure, write_figures};
use crate::method::MethodError;
use crate::run::{CurveFolder, RecordedSource, SessionJournal, format_number, format_with_error};
use crate::sweep_file::{Diagnostic, MethodKind, SolveError, Sweep};
use refusals::{check_bounds, chosen_row, held_value, no_indicator, refused, refused_plane};

/// Sections of a run's sweep that may be set anew.
const SECTIONS: [&str; 3] = ["detect", "locate", "figures"];

/// Follows a curve, writes it, and prints what was found.
///
/// # Errors
/// [`CommandError`] when the run or the sweep file cannot be read, the row has no curve, or the results cannot be written.
pub(super) fn run(arguments: &CurveArguments) -> Result<Outcome, CommandError> {
    let (threads, cancellation) = super::interruptible(arguments.work.threads)?;
    threads.install(|| {
        let Some((spec, result)) = swept(arguments, &cancellation)? else {
            super::print("interrupted: nothing was written\n")?;
            return Ok(Outcome::Interrupted);
        };
        let job = Job::new(arguments, &spec, &result)?;
        let output = OutputFolder::prepare(&job.home())?;
        let home = output.path();
        let of = job.described();
        let going_on = arguments.resume && CurveFolder::has_journal(home);
        if arguments.resume && !going_on && CurveFolder::is_complete(home, &of)? {
            let home = home.display();
            let text = format!("the curves in {home} are complete: nothing was solved\n");
            return super::print(&text);
        }
        let folder = CurveFolder::new(home)?;
        let methods = MethodKind::ALL.map(MethodKind::name);
        let journal = match going_on {
            true => folder.go_on(&of, spec.problem.family(), &methods)?,
            false => folder.begin(&of)?,
        };
        let kept = || kept(home);
        let found = job.follow(&journal, &cancellation);
        let found = match journal.failure() {
            Some(error) => Err(error.into()),
            None => found,
        };
        match found.map_err(|error| error.after(kept()))? {
            Some(tree) => {
                let concluded = job.conclude(&tree, (folder, &of), home);
                concluded.map_err(|error| error.after(kept()))
            }
            None => {
                super::print(&format!("interrupted: {}\n", kept()))?;
                Ok(Outcome::Interrupted)
            }
        }
    })
}

/// What there is of curves that did not come to their end.
fn kept(home: &Path) -> String {
    format!(
        "what was solved is kept in {}, and `--resume` goes on from there",
        home.display()
    )
}

/// The sweep with its result: that of a run as it is stored, that of a sweep file solved now; `None` when interrupted.
fn swept(
    arguments: &CurveArguments,
    cancellation: &Cancellation,
) -> Result<Option<(Sweep, SweepResult)>, CommandError> {
    if !super::is_sweep_file(&arguments.target) {
        let overrides = &arguments.overrides;
        let stored = Stored::read(
            &arguments.target,
            overrides,
            &SECTIONS,
            arguments.work.quiet,
        )?;
        return Ok(Some((stored.spec, stored.result)));
    }
    let input = SweepInput {
        file: arguments.target.clone(),
        overrides: arguments.overrides.clone(),
    };
    let spec = super::load(&input, arguments.work.quiet)?.prepare(cancellation)?;
    tell(
        arguments.work.quiet,
        "sweeping; the run of a `pbif sweep` is read instead of solved\n",
    );
    match spec.run(cancellation, &mut ()) {
        Ok(result) if result.interrupted => Ok(None),
        Ok(result) => Ok(Some((spec, result))),
        Err(SolveError::Method(MethodError::Cancelled(_))) => Ok(None),
        Err(SolveError::Method(error)) => Err(error.into()),
        Err(SolveError::Sweep(error)) => Err(error.into()),
    }
}

/// A curve to be followed.
struct Job<'a> {
    arguments: &'a CurveArguments,
    spec: &'a Sweep,
    row: &'a LabelledPoint,
    plane: Plane,
    start: CurveStart,
}

impl<'a> Job<'a> {
    fn new(
        arguments: &'a CurveArguments,
        spec: &'a Sweep,
        result: &'a SweepResult,
    ) -> Result<Self, CommandError> {
        let row = chosen_row(arguments.row.as_deref(), result)?;
        let held = held_value(&arguments.second, spec)?;
        let swept = spec.problem.family();
        let (low, high) = swept.range();
        let first = (
            swept.parameter(),
            arguments.first_from.unwrap_or(low),
            arguments.first_to.unwrap_or(high),
        );
        let (from, to) = (
            arguments.from.min(arguments.to),
            arguments.from.max(arguments.to),
        );
        let plane = Plane::new(first, (&arguments.second, from, to)).map_err(refused)?;
        let start = CurveStart::from_row(row, held, spec.problem.subject());
        let start = start.ok_or_else(|| no_indicator(row, result))?;
        let job = Self {
            arguments,
            spec,
            row,
            plane,
            start,
        };
        job.check_box()?;
        check_bounds(spec, &job.plane)?;
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

    /// The folder for the results.
    fn home(&self) -> PathBuf {
        let name = format!("{}-{}", self.row.label, self.arguments.second);
        let target = &self.arguments.target;
        match &self.arguments.out {
            Some(out) => out.clone(),
            None if target.is_file() => {
                let stem = target
                    .file_stem()
                    .map(|stem| stem.to_string_lossy().into_owned());
                let stem = stem.unwrap_or_else(|| "sweep".to_owned());
                Path::new("output").join(format!("{stem}-{name}"))
            }
            None => target.join("curves").join(name),
        }
    }

    /// What the curves are made of beside the program, as TOML: the sweep, and where they start and end.
    fn described(&self) -> String {
        let sides = self.plane.sides().iter();
        let sides = sides.map(|side| format!("[{:?}, {:?}]", side.from, side.to));
        let sides: Vec<String> = sides.collect();
        format!(
            "{}\n[curve]\nrow = \"{}\"\nstart = {:?}\nsecond = \"{}\"\nbox = [{}]\nstep = {:?}\nalone = {}\n",
            self.spec.to_toml(),
            self.row.label,
            self.start.values,
            self.arguments.second,
            sides.join(", "),
            self.arguments.step,
            self.arguments.alone,
        )
    }

    /// Follows the curve, and those that start from it; `None` when interrupted before there was one. What is in the journal is not solved again.
    fn follow(
        &self,
        journal: &SessionJournal,
        cancellation: &Cancellation,
    ) -> Result<Option<CurveTree>, CommandError> {
        let options = CurveOptions {
            largest_step: self.arguments.step,
            ..self.spec.curve_options(self.plane.sides()[0].length())
        };
        let source = match self.spec.source_in(&self.plane, cancellation) {
            Ok(source) => RecordedSource::new(Box::new(source), journal.clone()),
            Err(MethodError::Cancelled(_)) => return Ok(None),
            Err(error) => return Err(refused_plane(&error)),
        };
        let [first, second] = self
            .plane
            .sides()
            .each_ref()
            .map(|side| side.parameter.as_str());
        let mut met = 0;
        let quiet = self.arguments.work.quiet;
        if journal.waiting() > 0 {
            tell(
                quiet,
                &format!("going on after {} solves\n", journal.waiting()),
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
        let detector = self.spec.detector();
        let (source, plane, start) = (&source, &self.plane, &self.start);
        let observer = &mut observer;
        let found = match self.arguments.alone {
            false => follow_all(
                source,
                plane,
                &detector,
                start,
                &options,
                cancellation,
                observer,
            ),
            true => follow(
                source,
                plane,
                &detector,
                start,
                &options,
                cancellation,
                observer,
            )
            .map(CurveTree::from),
        };
        match found {
            Ok(tree) => Ok(Some(tree)),
            Err(CurveError::Source(SourceError::Interrupted)) => Ok(None),
            Err(error) => Err(refused(error)),
        }
    }

    /// Writes the curves and prints what they are.
    fn conclude(
        &self,
        tree: &CurveTree,
        (folder, of): (CurveFolder, &str),
        home: &Path,
    ) -> Result<Outcome, CommandError> {
        let (family, settings) = (self.spec.problem.family(), &self.spec.settings);
        let (origin, sweep) = (CurveOrigin::from(self.row), self.spec.to_toml());
        folder.write(family, &self.plane, tree, (&origin, &sweep, of))?;
        let style = &settings.figure_style;
        let figure = curve_figure(&tree.curves, (&origin, &[]), family, &settings.title, style)?;
        write_figures(&[figure], &settings.figure_formats, &folder.figures())?;
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
        super::conclude(&text, outcome, home)
    }

    fn summary(&self, tree: &CurveTree) -> String {
        let mut text = String::new();
        for (index, curve) in tree.curves.iter().enumerate() {
            text += &self.told(tree, index, curve);
        }
        for point in codimension_two(&tree.curves) {
            text += &codimension_line(&point, &self.plane);
        }
        for missed in &tree.missed {
            text += &format!(
                "not followed: {} is zero near {}: {}\n",
                missed.start.kind.name(),
                place(&self.plane, missed.start.values, 1e-3),
                missed.reason
            );
        }
        text
    }

    /// A curve with its ends.
    fn told(&self, tree: &CurveTree, index: usize, curve: &Curve) -> String {
        let family = self.spec.problem.family();
        let [first, second] = curve.plane.sides();
        let what = format!(
            "{} of {} is zero",
            curve.kind.name(),
            curve.observable.name(family)
        );
        let number = match tree.curves.len() {
            1 => String::new(),
            _ => format!("C{}  ", index + 1),
        };
        let mut text = match index {
            0 => format!(
                "{number}{what}, followed from {} in the plane of {} and {}\n",
                self.row.label, first.parameter, second.parameter
            ),
            _ => format!("{number}{what}\n"),
        };
        let mut line = |label: &str, index: usize, words: &str| {
            if let Some(point) = curve.points.get(index) {
                let values = place(&curve.plane, point.values, point.error);
                text += &format!("  {label:<4} {values}  {words}\n");
            }
        };
        let first_end = curve.ends.first().filter(|_| curve.ends.len() > 1);
        if let Some(end) = first_end {
            line(&end.label, end.point, &end.reason.words(&curve.plane));
        }
        if index == 0 {
            line(&self.row.label, curve.start, "start");
        }
        for split in &curve.degenerate {
            let words = "degenerate split: from here on peaks are born away from the centre";
            line(&split.label, split.point, words);
        }
        if let Some(end) = curve.ends.last() {
            line(&end.label, end.point, &end.reason.words(&curve.plane));
        }
        let errors = curve.points.iter().map(|point| point.error);
        let largest = errors.fold(0.0, f64::max);
        let checked = curve.points.iter().filter(|point| point.checked).count();
        let located = curve.points.iter();
        let located = located.filter(|point| is_located(point.status)).count();
        text += &format!(
            "  {} points, {located} of them located, {checked} checked; largest error {largest:.1e} of the sides of the box\n",
            curve.points.len()
        );
        let tolerance = self.spec.curve_options(first.length()).tolerance;
        text + &sampling_in_words(curve, tolerance)
    }
}

/// What sampling leaves open, where it is more than the tolerance; nothing for densities that are not sampled.
fn sampling_in_words(curve: &Curve, tolerance: f64) -> String {
    let sampling = curve.points.iter().map(|point| point.parts.sampling);
    let largest = sampling.fold(0.0, f64::max);
    if largest <= tolerance {
        return String::new();
    }
    let times = (largest / tolerance).powi(2).ceil();
    format!(
        "  sampling alone is up to {largest:.1e} of the sides of the box, and the tolerance is {tolerance:.1e}: {times:.0} times the samples would meet it, or a larger `locate.relative_tolerance`\n"
    )
}

/// Values of both parameters to the digits that an error, a share of the sides of the box, leaves.
fn place(plane: &Plane, values: [f64; 2], error: f64) -> String {
    let sides = plane.sides().iter().zip(values);
    let values = sides.map(|(side, value)| {
        let (value, _) = format_with_error(value, error * side.length());
        format!("{} = {value}", side.parameter)
    });
    values.collect::<Vec<_>>().join("  ")
}

/// A point of codimension two in a line.
pub(super) fn codimension_line(point: &CodimensionTwo, plane: &Plane) -> String {
    let curves = point.curves.iter().map(|index| format!("C{}", index + 1));
    let curves = curves.collect::<Vec<_>>().join(" and ");
    let words = match point.kind {
        CodimensionTwoKind::Cusp => format!("cusp of {curves}"),
        CodimensionTwoKind::DegenerateSplit => format!(
            "degenerate split of {curves}: births at the centre turn into births away from it"
        ),
        CodimensionTwoKind::Crossing => format!("crossing of {curves}"),
    };
    format!(
        "{}  {}  {words}; known to {:.1e} of the sides of the box\n",
        point.label,
        place(plane, point.values, point.error),
        point.error
    )
}

fn is_located(status: BifurcationStatus) -> bool {
    status == BifurcationStatus::Located
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

/// Says how it goes.
fn tell(quiet: bool, text: &str) {
    if !quiet {
        // Without a reader of stderr there is nobody to tell.
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
    }
}
