//! What a sweep file asks for, carried out: a sweep, a map of regimes, the curves from located rows, a comparison of
//! methods.
//!
//! A [`Job`] says what it solves, and which files and figures are made of what it finds. [`carry_out`] does the rest,
//! alike for all: it keeps what is solved, goes on with what was interrupted, and puts files into their folder.
//!
//! ```
//! use pbif::cancellation::Cancellation;
//! use pbif::job::{Job, Start, SweepJob, carry_out};
//! use pbif::sweep_file::SweepFile;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let home = tempfile::tempdir()?;
//! # let home = home.path();
//! let mut file = SweepFile::parse("bistable.toml", include_str!("../../sweeps/bistable.toml"));
//! file.set("sweep.points", "11").set("cells.x.count", "60");
//! let never = Cancellation::new();
//! let sweep = file.validate()?.prepare(&never)?;
//! let done = carry_out(&mut SweepJob::new(&sweep), home, Start::Anew, &never, &|_| ())?;
//! let done = done.ok_or("interrupted")?;
//! assert_eq!(done.found.labels[1].name(), "PB1");
//! assert!(home.join("bifurcations.csv").is_file());
//! // A job that came to its end is not done again.
//! assert_eq!(SweepJob::new(&sweep).start(home)?, Start::Complete);
//! # Ok(())
//! # }
//! ```
//!
//! # Decisions
//!
//! **Four kinds of work, one life.** A sweep, a map, the curves from a row and a comparison differ in what they solve
//! and in their tables, not in how they begin, are interrupted, go on and end. `job::Job` is the first,
//! `job::carry_out` and `run::JobFolder` the second; a `run::Layout` says which files a kind leaves, and whether they
//! grow in their place (a sweep's) or are put there when all are whole. What a job is made of is a TOML text
//! (`Job::made_of`), which its journal and its manifest keep: work on something else is refused with the differences.
//! Options of `pbif curve` are spellings of the keys of `[curve]`, so a curve needs no settings of its own.

mod compare;
mod curve;
mod map;
mod sweep;

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::cancellation::Cancellation;
use crate::continuation::{Point, SourceError, SweepError};
use crate::figure::{Figure, FigureError, write_figures};
use crate::run::{Ending, JobFolder, Layout, PhaseSeconds, RunError, clear_after_kill};
use crate::sweep_file::{Report, Sweep};

pub use compare::CompareJob;
pub(crate) use curve::check_curves;
pub use curve::curve_rows;
pub use curve::{CurveJob, FirstRow};
pub use map::MapJob;
pub(crate) use map::MapShardJob;
pub use sweep::SweepJob;
pub(crate) use sweep::{QUICK_POINTS, draw_sweep, sweep_outcome};

/// Work that a sweep file asks for.
pub trait Job {
    /// What is found.
    type Found;

    /// The sweep file that asks for it.
    fn sweep(&self) -> &Sweep;

    /// What stands in its folder.
    const LAYOUT: Layout;

    /// What it is made of beside the program, as TOML: work on something else is not gone on with.
    fn made_of(&self) -> String {
        self.sweep().to_toml()
    }

    /// What is to be done in a folder so that the job is done there.
    ///
    /// # Errors
    /// [`RunError::OtherSweep`], with every difference, where something else stands there; [`RunError`] where that
    /// cannot be read.
    fn start(&self, home: &Path) -> Result<Start, RunError> {
        let (layout, of) = (Self::LAYOUT, self.made_of());
        if layout.has_part(home) {
            return Ok(Start::GoOn);
        }
        Ok(if layout.is_complete(home, &of)? {
            Start::Complete
        } else {
            Start::Anew
        })
    }

    /// What takes time before there is anything to write, such as steps that are chosen by pilots; `false` where it was
    /// interrupted.
    ///
    /// # Errors
    /// [`JobError`] where the method refuses.
    fn plan(&mut self, context: &Context<'_>) -> Result<bool, JobError> {
        let _ = context;
        Ok(true)
    }

    /// Solves, keeps in `folder` what is solved, and takes from there what is known where it `goes_on`; `None` where it
    /// was interrupted before there was anything to show.
    ///
    /// # Errors
    /// [`JobError`]; solves that fail are data.
    fn solve(
        &mut self,
        folder: &JobFolder,
        goes_on: bool,
        context: &Context<'_>,
    ) -> Result<Option<Self::Found>, JobError>;

    /// How many solves are kept in the folder of a job that did not come to its end.
    fn kept(&self) -> usize {
        0
    }

    /// How a job ended that has found this.
    fn outcome(&self, found: &Self::Found) -> Outcome;

    /// Its files by their names; solving took so many seconds.
    ///
    /// # Errors
    /// [`RunError`] where one cannot be composed.
    fn files(&self, found: &Self::Found, seconds: f64) -> Result<Vec<(String, String)>, RunError>;

    /// Its figures.
    fn figures(&self, found: &Self::Found, context: &Context<'_>) -> Vec<Figure>;

    /// Writes the files.
    ///
    /// # Errors
    /// [`RunError`] where one cannot be composed or written.
    fn write(
        &mut self,
        found: &Self::Found,
        folder: &JobFolder,
        seconds: f64,
    ) -> Result<(), RunError> {
        folder.write(&self.files(found, seconds)?)
    }

    /// Whether there is time for all of its files. An interrupted job ends within two seconds: what takes longer is
    /// left out, and can be made from what is there.
    fn has_time(&self, found: &Self::Found) -> bool {
        let _ = found;
        true
    }

    /// What is written last.
    ///
    /// # Errors
    /// [`RunError::Write`].
    fn seal(&mut self, found: &Self::Found, seconds: PhaseSeconds) -> Result<(), RunError> {
        let _ = (found, seconds);
        Ok(())
    }
}

/// What a job is carried out with.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// Ends it early.
    pub cancellation: &'a Cancellation,
    /// Is told how it goes, from whatever thread.
    pub observer: &'a (dyn Fn(&Progress<'_>) + Sync),
}

impl Context<'_> {
    fn say(&self, words: &str) {
        (self.observer)(&Progress::Says(words));
    }
}

/// What a job tells while it is carried out.
#[derive(Debug, Clone, Copy)]
pub enum Progress<'a> {
    /// What is being done.
    Says(&'a str),
    /// So many of those that are known to be wanted are done; the last in words.
    Done {
        /// What was found.
        words: &'a str,
        /// How many are done.
        done: usize,
        /// How many are wanted.
        wanted: usize,
    },
    /// The next one begins.
    Next {
        /// What is about to be done.
        words: &'a str,
        /// How many are done.
        done: usize,
        /// How many are wanted.
        wanted: usize,
    },
    /// A value of a sweep with all that was found there, whether it was solved now or by an earlier process. Whoever is
    /// told must not wait for another thread: a sweep that is solved on many tells one value at a time.
    Solved(&'a Point),
}

/// What is to be done in a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// All; what is there is kept below `previous/`.
    Anew,
    /// What an earlier process has left open.
    GoOn,
    /// Nothing.
    Complete,
}

/// How a job ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Done.
    Complete,
    /// Finished, but some row is unresolved, did not converge or has no steady state.
    Partial,
    /// Interrupted by the user.
    Interrupted,
}

impl Outcome {
    /// Complete where every part is, partial otherwise; interrupted where it was.
    fn of(interrupted: bool, is_complete: bool) -> Self {
        match (interrupted, is_complete) {
            (true, _) => Self::Interrupted,
            (false, true) => Self::Complete,
            (false, false) => Self::Partial,
        }
    }

    /// How what it leaves ended.
    fn ending(self) -> Ending {
        if self == Self::Interrupted {
            Ending::Interrupted
        } else {
            Ending::Complete
        }
    }
}

/// A job that was carried out.
#[derive(Debug)]
pub struct Done<F> {
    /// What was found.
    pub found: F,
    /// How it ended.
    pub outcome: Outcome,
    /// Files that were put in their place; none of those that grew there.
    pub files: Vec<PathBuf>,
}

/// Why a job was not carried out.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// What is asked for cannot be.
    #[error("bad input")]
    Refused(#[from] Report),
    /// The methods cannot be compared.
    #[error(transparent)]
    Compare(crate::compare::CompareError),
    /// The sweep ended without a result.
    #[error(transparent)]
    Sweep(SweepError),
    /// A source of densities refuses.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// A file cannot be written or read.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
}

/// Carries out a job in the folder `home`. `None` where there is nothing to do, and where it was interrupted before
/// there was anything to show: then the folder is as it was, but for what is solved.
///
/// # Errors
/// [`JobError`]; what was solved is kept ([`Job::kept`]).
pub fn carry_out<J: Job>(
    job: &mut J,
    home: &Path,
    start: Start,
    cancellation: &Cancellation,
    observer: &(dyn Fn(&Progress<'_>) + Sync),
) -> Result<Option<Done<J::Found>>, JobError> {
    let context = Context {
        cancellation,
        observer,
    };
    if start == Start::Complete {
        clear_after_kill(home);
        return Ok(None);
    }
    if !job.plan(&context)? {
        return Ok(None);
    }
    let goes_on = start == Start::GoOn;
    let folder = JobFolder::open(home, J::LAYOUT, goes_on)?;
    if let Some(kept) = folder.kept() {
        context.say(&format!("the earlier run is kept in {}", kept.display()));
    }
    let clock = Instant::now();
    let found = match job.solve(&folder, goes_on, &context) {
        Ok(Some(found)) => found,
        ended => {
            if job.kept() == 0 && !goes_on {
                folder.give_up();
            }
            return ended.map(|_| None);
        }
    };
    let mut seconds = PhaseSeconds {
        sweep: clock.elapsed().as_secs_f64(),
        ..PhaseSeconds::default()
    };
    let clock = Instant::now();
    job.write(&found, &folder, seconds.sweep)?;
    seconds.tables = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let has_time = job.has_time(&found);
    if has_time {
        let formats = &job.sweep().settings.figures.formats;
        let figures = if formats.is_empty() {
            Vec::new()
        } else {
            job.figures(&found, &context)
        };
        folder.check()?;
        write_figures(&figures, formats, &folder.figures()?)?;
    }
    seconds.figures = clock.elapsed().as_secs_f64();
    job.seal(&found, seconds)?;
    let outcome = job.outcome(&found);
    let files = if has_time {
        folder.close(outcome.ending())?
    } else {
        Vec::new()
    };
    Ok(Some(Done {
        found,
        outcome,
        files,
    }))
}

#[cfg(test)]
mod tests;
