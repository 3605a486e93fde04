//! `pbif curve`, and `pbif sweep` of a file with `[curve]`: from located rows, the curves of the same P-bifurcations in
//! the plane of the swept and a second parameter.

mod asked;
mod job;
mod refusals;
mod told;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::args::{CurveArguments, SweepInput, Work};
use super::output::OutputFolder;
use super::stored::{Stored, set};
use super::{CommandError, Outcome};
use crate::cancellation::Cancellation;
use crate::continuation::{LabelledPoint, SweepResult};
use crate::method::MethodError;
use crate::run::{CURVES, CurveFolder, RunError};
use crate::sweep_file::{SolveError, Sweep, list};
use asked::Asked;
use job::Job;
use refusals::check_corners;
pub(super) use told::codimension_line;

/// Sections of a run's sweep that may be set anew.
const SECTIONS: [&str; 4] = ["detect", "locate", "figures", "curve"];

/// Follows curves, writes them, and prints what was found.
///
/// # Errors
/// [`CommandError`] when the run or the sweep file cannot be read, the row has no curve, or the results cannot be
/// written.
pub(super) fn run(arguments: &CurveArguments) -> Result<Outcome, CommandError> {
    let (threads, cancellation) = super::interruptible(arguments.work.threads)?;
    threads.install(|| {
        let Some((spec, result)) = swept(arguments, &cancellation)? else {
            super::print("interrupted: nothing was written\n")?;
            return Ok(Outcome::Interrupted);
        };
        let asked = Asked::by(arguments, &spec)?;
        let rows = asked.rows(&spec, &result)?;
        let alone = rows.len() == 1;
        let home = |name: &str| place(arguments, name, alone);
        Following {
            asked: &asked,
            spec: &spec,
            result: &result,
            home: &home,
            begin: match arguments.resume {
                true => Begin::GoOn,
                false => Begin::Anew,
            },
            quiet: arguments.work.quiet,
            cancellation: &cancellation,
        }
        .all(&rows)
    })
}

/// Refuses curves that a sweep file asks for before its sweep is run.
///
/// # Errors
/// [`CommandError::Input`] where the box has a corner that is not allowed.
pub(super) fn check(spec: &Sweep) -> Result<(), CommandError> {
    match &spec.settings.curve {
        Some(curve) => check_corners(spec, &Asked::of(curve).plane(spec)?),
        None => Ok(()),
    }
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
    let Some(curve) = &spec.settings.curve else {
        return Ok(outcome);
    };
    if outcome == Outcome::Interrupted {
        return Ok(outcome);
    }
    let (threads, cancellation) = super::interruptible(work.threads)?;
    let done = || format!("the run in {} is complete", folder.display());
    let found = threads.install(|| {
        let stored = Stored::read(folder, &[], &[], true)?;
        let asked = Asked::of(curve);
        let rows = asked.rows(&stored.spec, &stored.result)?;
        if rows.is_empty() {
            return super::print(
                "no row in the box was located by an indicator: no curve to follow\n",
            );
        }
        Following {
            asked: &asked,
            spec: &stored.spec,
            result: &stored.result,
            home: &|name| folder.join(CURVES).join(name),
            begin: match resume {
                true => Begin::GoOnWhereTheSame,
                false => Begin::Anew,
            },
            quiet: work.quiet,
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
    asked: &'a Asked,
    spec: &'a Sweep,
    result: &'a SweepResult,
    /// The folder for the results of a row, by the name that it has for itself.
    home: &'a dyn Fn(&str) -> PathBuf,
    begin: Begin,
    quiet: bool,
    cancellation: &'a Cancellation,
}

/// What is done with curves that are there.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Begin {
    /// They are kept below `previous/`, and followed anew.
    Anew,
    /// Unfinished ones are gone on with, complete ones are left; those of other settings are refused.
    GoOn,
    /// The same, but those of other settings are kept and followed anew: the sweep file is what is wanted, and its
    /// section may have changed since.
    GoOnWhereTheSame,
}

impl Following<'_> {
    /// Follows all rows. Of several, one that cannot be followed keeps none of the others from it.
    fn all(&self, rows: &[&LabelledPoint]) -> Result<Outcome, CommandError> {
        let mut worst = Outcome::Complete;
        for row in rows {
            match self.one(row) {
                Ok(Outcome::Interrupted) => return Ok(Outcome::Interrupted),
                Ok(Outcome::Partial) => worst = Outcome::Partial,
                Ok(Outcome::Complete) => {}
                Err(error) if rows.len() > 1 && error.is_input() => {
                    let text = super::render(error, super::is_styled());
                    tell(false, &format!("{} is not followed\n{text}", row.label));
                    worst = Outcome::Partial;
                }
                Err(error) => return Err(error),
            }
        }
        Ok(worst)
    }

    fn one(&self, row: &LabelledPoint) -> Result<Outcome, CommandError> {
        let job = Job::new(self.asked, self.spec, (row, self.result), self.quiet)?;
        let output = OutputFolder::prepare(&(self.home)(&format!(
            "{}-{}",
            row.label, self.asked.second
        )))?;
        let home = output.path();
        let of = job.described();
        let goes_on = self.begin != Begin::Anew;
        let has_journal = CurveFolder::has_journal(home);
        if goes_on && !has_journal {
            let complete = CurveFolder::is_complete(home, &of).map(|is| is.then_some(()));
            if self.or_other(complete, home)?.is_some() {
                let home = home.display();
                let text = format!("the curves in {home} are complete: nothing was solved\n");
                return super::print(&text);
            }
        }
        let folder = CurveFolder::new(home)?;
        let mut journal = None;
        if goes_on && has_journal {
            journal = self.or_other(folder.go_on(&of).map(Some), home)?;
        }
        let journal = match journal {
            Some(journal) => journal,
            None => folder.begin(&of)?,
        };
        let kept = || kept(home);
        let found = job.follow(&journal, self.cancellation);
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
    }
}

impl Following<'_> {
    /// What was found in a folder; `None` where curves of other settings are there that do not keep new ones away.
    fn or_other<T>(
        &self,
        found: Result<Option<T>, RunError>,
        home: &Path,
    ) -> Result<Option<T>, RunError> {
        match found {
            Err(RunError::OtherSweep { differences, .. })
                if self.begin == Begin::GoOnWhereTheSame =>
            {
                let (home, differences) = (home.display(), list(&differences));
                let text = format!(
                    "the curves in {home} are of other settings ({differences}): they are kept in its folder previous/, and followed anew\n"
                );
                tell(self.quiet, &text);
                Ok(None)
            }
            found => found,
        }
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
        let overrides = &set(&arguments.overrides);
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

/// Says how it goes.
fn tell(quiet: bool, text: &str) {
    if !quiet {
        // Without a reader of stderr there is nobody to tell.
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
    }
}
