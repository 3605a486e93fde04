//! `pbif curve`, and `pbif sweep` of a file with `[curve]`: from located rows, the curves of the same P-bifurcations in
//! the plane of the swept and a second parameter.

mod words;

use std::path::{Path, PathBuf};

use super::args::{CurveArguments, Work};
use super::jobs::{self, Printed, files, kept};
use super::stored::{Override, Stored, set};
use super::{CommandError, load, tell};
use crate::cancellation::Cancellation;
use crate::continuation::curve::CurveTree;
use crate::continuation::{SourceError, SweepResult};
use crate::job::{CurveJob, Done, FirstRow, Job as _, JobError, Outcome, Start, curve_rows};
use crate::run::{CURVES, RunError};
use crate::sweep_file::{SolveError, Sweep, SweepFile, list};
pub(super) use words::{codimension_line, level_lines, stability_lines};

/// Sections of a run's sweep that may be set anew.
const SECTIONS: [&str; 4] = ["detect", "locate", "figures", "curve"];

/// What is said where a sweep has no row that can be followed.
const NO_ROW: &str = "no row in the box was located by an indicator: no curve to follow\n";

/// Follows curves, writes them, and prints what was found.
///
/// # Errors
/// [`CommandError`] when the run or the sweep file cannot be read, the row has no curve, or the results cannot be
/// written.
pub(super) fn run(arguments: &CurveArguments) -> Result<Outcome, CommandError> {
    let (threads, cancellation) = super::interruptible(arguments.work.threads)?;
    threads.install(|| {
        let Some((spec, result, only)) = sweep_of(arguments, &cancellation)? else {
            super::print("interrupted: nothing was written\n")?;
            return Ok(Outcome::Interrupted);
        };
        let rows = curve_rows(&spec, &result, only)?;
        if rows.is_empty() {
            super::print(NO_ROW)?;
            return Ok(Outcome::Partial);
        }
        let alone = rows.len() == 1;
        Following {
            spec: &spec,
            result: &result,
            home: &|name| place(arguments, name, alone),
            resume: arguments.resume,
            keeps_others: false,
            work: &arguments.work,
            cancellation: &cancellation,
        }
        .all(&rows)
    })
}

/// Follows the curves that a sweep file asks for, from the run of its sweep in `folder`, which ended with `outcome`.
///
/// # Errors
/// [`CommandError`] as of [`run`].
pub(super) fn after_sweep(
    spec: &Sweep,
    folder: &Path,
    (work, resume): (&Work, bool),
    outcome: Outcome,
) -> Result<Outcome, CommandError> {
    if spec.settings.curve.is_none() || outcome == Outcome::Interrupted {
        return Ok(outcome);
    }
    let (threads, cancellation) = super::interruptible(work.threads)?;
    let done = || format!("the run in {} is complete", folder.display());
    let found = threads.install(|| {
        let Stored {
            spec: swept,
            result,
            ..
        } = Stored::read(folder, &[], &[], true)?;
        // The section is that of the file, which may have changed since.
        let mut followed = swept;
        followed.settings.curve.clone_from(&spec.settings.curve);
        let rows = curve_rows(&followed, &result, false)?;
        if rows.is_empty() {
            return super::print(NO_ROW);
        }
        Following {
            spec: &followed,
            result: &result,
            home: &|name| folder.join(CURVES).join(name),
            resume,
            keeps_others: true,
            work,
            cancellation: &cancellation,
        }
        .all(&rows)
    });
    match found.map_err(|error| error.after(done()))? {
        Outcome::Complete => Ok(outcome),
        curves => Ok(curves),
    }
}

/// Rows that are followed one after the other.
struct Following<'a> {
    spec: &'a Sweep,
    result: &'a SweepResult,
    /// The folder for the results of a row, by the name that it has for itself.
    home: &'a dyn Fn(&str) -> PathBuf,
    /// Whether unfinished curves are gone on with, and complete ones left.
    resume: bool,
    /// Whether those of other settings are then kept below `previous/`, not refused: the sweep file is what is wanted,
    /// and its section may have changed since.
    keeps_others: bool,
    work: &'a Work,
    cancellation: &'a Cancellation,
}

impl Following<'_> {
    /// Follows all rows. Of several, one that cannot be followed keeps none of the others from it.
    fn all(&self, rows: &[FirstRow<'_>]) -> Result<Outcome, CommandError> {
        let mut worst = Outcome::Complete;
        for &row in rows {
            match self.follow_row(row) {
                Ok(Outcome::Interrupted) => return Ok(Outcome::Interrupted),
                Ok(Outcome::Partial) => worst = Outcome::Partial,
                Ok(Outcome::Complete) => {}
                Err(error) if rows.len() > 1 && error.is_input() => {
                    let text = super::render(error, super::is_styled());
                    tell(false, &format!("{} is not followed\n{text}", row.label()));
                    worst = Outcome::Partial;
                }
                Err(error) => return Err(error),
            }
        }
        Ok(worst)
    }

    fn follow_row(&self, row: FirstRow<'_>) -> Result<Outcome, CommandError> {
        let mut job = CurveJob::new(self.spec, self.result, row)?;
        let second = &job.plane().sides()[1].parameter;
        let home = (self.home)(&format!("{}-{second}", row.label()));
        let how = (self.work, self.cancellation);
        let start = if self.resume {
            job.start(&home)
        } else {
            Ok(Start::Anew)
        };
        let mut begin = |start| jobs::carry_out(&mut job, &home, start, how);
        match start.map_err(CommandError::from).and_then(&mut begin) {
            Err(CommandError::Run(RunError::OtherSweep { differences, .. }))
                if self.keeps_others =>
            {
                let (home, differences) = (home.display(), list(&differences));
                let text = format!(
                    "the curves in {home} are of other settings ({differences}): they are kept in its folder previous/, and followed anew\n"
                );
                tell(self.work.quiet, &text);
                begin(Start::Anew)
            }
            found => found,
        }
    }
}

impl Printed for CurveJob<'_> {
    fn text(&self, done: &Done<CurveTree>, home: &Path) -> String {
        let mut text = words::summary(self, &done.found);
        if done.outcome == Outcome::Interrupted {
            text += &format!("interrupted: {}\n", kept(self, home));
        }
        text + &files(&done.files)
    }

    fn complete(&self, home: &Path) -> Result<(String, Outcome), CommandError> {
        let home = home.display();
        let text = format!("the curves in {home} are complete: nothing was solved\n");
        Ok((text, Outcome::Complete))
    }
}

/// The folder for the results of the command, of one row or of several.
fn place(arguments: &CurveArguments, name: &str, alone: bool) -> PathBuf {
    let target = &arguments.target;
    match &arguments.out {
        Some(out) if alone => out.clone(),
        Some(out) => out.join(name),
        None if target.is_file() => {
            let stem = target
                .file_stem()
                .map(|stem| stem.to_string_lossy().into_owned());
            let stem = stem.unwrap_or_else(|| "sweep".to_owned());
            Path::new("output").join(format!("{stem}-{name}"))
        }
        None => target.join(CURVES).join(name),
    }
}

/// The options as keys.
fn overrides(arguments: &CurveArguments) -> Vec<Override> {
    let text = |text: &String| format!("{text:?}");
    let number = |number: &f64| format!("{number:?}");
    let options = [
        ("--second", "parameter", arguments.second.as_ref().map(text)),
        ("--from", "from", arguments.from.as_ref().map(number)),
        ("--to", "to", arguments.to.as_ref().map(number)),
        (
            "--first-from",
            "first_from",
            arguments.first_from.as_ref().map(number),
        ),
        (
            "--first-to",
            "first_to",
            arguments.first_to.as_ref().map(number),
        ),
        ("--step", "step", arguments.step.as_ref().map(number)),
        (
            "--row",
            "rows",
            arguments.row.as_ref().map(|row| format!("[{row:?}]")),
        ),
        (
            "--alone",
            "branches",
            arguments.alone.then(|| "\"off\"".to_owned()),
        ),
    ];
    let given = options.into_iter().filter_map(|(option, key, value)| {
        let value = value?;
        Some((option, format!("curve.{key}={value}")))
    });
    set(&arguments.overrides).into_iter().chain(given).collect()
}

/// The sweep with its result, that of a run as it is stored, that of a sweep file solved now, and whether it is to the
/// only row that can be followed that nothing has named; `None` when interrupted.
fn sweep_of(
    arguments: &CurveArguments,
    cancellation: &Cancellation,
) -> Result<Option<(Sweep, SweepResult, bool)>, CommandError> {
    let (target, quiet) = (&arguments.target, arguments.work.quiet);
    let overrides = &overrides(arguments);
    let mut only = true;
    let mut prepare = |file: &mut SweepFile| {
        let written = file.get("curve.parameter");
        let second = arguments.second.as_ref().map(|name| format!("{name:?}"));
        // A section about another parameter says nothing of this one.
        if second.is_some() && second != written {
            file.remove("curve");
        } else {
            only = written.is_none();
        }
    };
    if !super::is_sweep_file(target) {
        let stored = Stored::read_as(target, &mut prepare, overrides, &SECTIONS, quiet)?;
        return Ok(Some((stored.spec, stored.result, only)));
    }
    let mut of_file = |file: &mut SweepFile| prepare(file.without_map());
    let spec = load(target, &mut of_file, overrides, quiet)?.prepare(cancellation)?;
    tell(
        quiet,
        "sweeping; the run of a `pbif sweep` is read instead of solved\n",
    );
    match spec.run(cancellation, &mut ()) {
        Ok(result) if result.interrupted => Ok(None),
        Ok(result) => Ok(Some((spec, result, only))),
        Err(SolveError::Source(SourceError::Interrupted)) => Ok(None),
        Err(SolveError::Source(error)) => Err(JobError::Source(error).into()),
        Err(SolveError::Sweep(error)) => Err(JobError::from(error).into()),
    }
}
