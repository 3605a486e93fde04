//! What the commands that compute have in common: threads, interrupts, progress, and what is printed of a job.

use std::path::Path;

use super::args::Work;
use super::output::OutputFolder;
use super::progress::Meter;
use super::{CommandError, conclude, fault, interruptible, print};
use crate::cancellation::Cancellation;
use crate::job::{self, Done, Job, JobError, Outcome, Start};
use crate::run::{RunError, clear_after_kill};

/// What is printed of a job.
pub(super) trait Printed: Job {
    /// How many solves are known to be wanted; `None` where nobody knows.
    fn planned(&self) -> Option<usize> {
        None
    }

    /// What was found, and where it is.
    fn text(&self, done: &Done<Self::Found>, home: &Path) -> String;

    /// What is said of a folder in which the job is complete, and how it ended.
    ///
    /// # Errors
    /// [`CommandError`] where the folder cannot be read.
    fn complete(&self, home: &Path) -> Result<(String, Outcome), CommandError>;

    /// What is kept of a job that did not come to its end.
    fn kept_in_words(&self) -> String {
        "what was solved is kept".to_owned()
    }

    /// What must be known of what was found.
    fn warnings(&self, found: &Self::Found) -> Vec<String> {
        let _ = found;
        Vec::new()
    }
}

/// Carries out a job on threads of its own, going on with what is there where that is wanted, and prints what it found.
///
/// # Errors
/// [`CommandError`].
pub(super) fn run<J: Printed + Send>(
    mut job: J,
    home: &Path,
    resume: bool,
    work: &Work,
) -> Result<Outcome, CommandError> {
    let start = if resume {
        job.start(home)?
    } else {
        Start::Anew
    };
    let (threads, cancellation) = interruptible(work.threads)?;
    threads.install(|| carry_out(&mut job, home, start, (work, &cancellation)))
}

/// The same on the threads that there are.
///
/// # Errors
/// As [`run`].
pub(super) fn carry_out<J: Printed>(
    job: &mut J,
    home: &Path,
    start: Start,
    (work, cancellation): (&Work, &Cancellation),
) -> Result<Outcome, CommandError> {
    let output = OutputFolder::prepare(home)?;
    let home = output.path();
    fault::at_work(home, J::LAYOUT);
    if start == Start::Complete {
        clear_after_kill(home);
        let (text, outcome) = job.complete(home)?;
        return conclude(&text, outcome, home);
    }
    let progress = Meter::new(job.planned(), work.quiet);
    let done = job::carry_out(job, home, start, cancellation, &|step| progress.show(step));
    progress.finish();
    let kept = || kept(&*job, home);
    match done {
        Err(error @ JobError::Run(RunError::Gone { .. })) => {
            let written = "what was written is gone with it".to_owned();
            Err(CommandError::from(error).after(written))
        }
        Err(error) if job.kept() > 0 => Err(CommandError::from(error).after(kept())),
        Err(error) => Err(error.into()),
        Ok(Some(done)) => {
            progress.warn(&job.warnings(&done.found));
            conclude(&job.text(&done, home), done.outcome, home)
        }
        Ok(None) => {
            let left = match start {
                _ if job.kept() > 0 => kept(),
                Start::GoOn => "everything is as it was".to_owned(),
                _ => "nothing was written".to_owned(),
            };
            print(&format!("interrupted: {left}\n"))?;
            Ok(Outcome::Interrupted)
        }
    }
}

/// What there is of a job that did not come to its end, and how to go on.
pub(super) fn kept(job: &impl Printed, home: &Path) -> String {
    let (words, home) = (job.kept_in_words(), home.display());
    format!("{words} in {home}, and `--resume` goes on from there")
}

/// Files, one a line, below their heading.
pub(super) fn files<P: AsRef<Path>>(files: impl IntoIterator<Item = P>) -> String {
    let lines = files.into_iter();
    let lines = lines.map(|file| format!("  {}\n", file.as_ref().display()));
    format!("files\n{}", lines.collect::<String>())
}
