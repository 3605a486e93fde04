//! A job of the library, carried out for Python: with or without figures, and short when it is interrupted.

use std::path::Path;

use pbif::cancellation::Cancellation;
use pbif::figure::Figure;
use pbif::job::{Context, Job, JobError, Outcome, Start, carry_out};
use pbif::run::{JobFolder, Layout, PhaseSeconds, RunError};
use pbif::sweep_file::Sweep;
use pyo3::prelude::*;

use crate::drift::Failure;
use crate::error;
use crate::watch::{told, watched};

/// How a job is carried out.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct How<'py> {
    /// Whether it goes on with what is in the folder.
    resume: bool,
    /// Whether the figures that the sweep file names are drawn into the folder.
    figures: bool,
    /// Threads of its own; without a number those of the process.
    threads: Option<usize>,
    /// Is called with how it goes.
    tell: Option<Bound<'py, PyAny>>,
}

/// A job that draws only where that is wanted, and that writes only what it must when it is interrupted: what it has
/// solved. An interrupt of a notebook is to be answered at once, and tables can be made from that.
struct Brief<J> {
    job: J,
    draws: bool,
}

impl<J: Job> Job for Brief<J> {
    type Found = J::Found;
    const LAYOUT: Layout = J::LAYOUT;

    fn sweep(&self) -> &Sweep {
        self.job.sweep()
    }

    fn made_of(&self) -> String {
        self.job.made_of()
    }

    fn start(&self, home: &Path) -> Result<Start, RunError> {
        self.job.start(home)
    }

    fn plan(&mut self, context: &Context<'_>) -> Result<bool, JobError> {
        self.job.plan(context)
    }

    fn solve(
        &mut self,
        folder: &JobFolder,
        goes_on: bool,
        context: &Context<'_>,
    ) -> Result<Option<J::Found>, JobError> {
        self.job.solve(folder, goes_on, context)
    }

    fn kept(&self) -> usize {
        self.job.kept()
    }

    fn outcome(&self, found: &J::Found) -> Outcome {
        self.job.outcome(found)
    }

    fn files(&self, found: &J::Found, seconds: f64) -> Result<Vec<(String, String)>, RunError> {
        self.job.files(found, seconds)
    }

    fn figures(&self, found: &J::Found, context: &Context<'_>) -> Vec<Figure> {
        match self.draws {
            true => self.job.figures(found, context),
            false => Vec::new(),
        }
    }

    fn write(
        &mut self,
        found: &J::Found,
        folder: &JobFolder,
        seconds: f64,
    ) -> Result<(), RunError> {
        self.job.write(found, folder, seconds)
    }

    fn has_time(&self, found: &J::Found) -> bool {
        self.outcome(found) != Outcome::Interrupted && self.job.has_time(found)
    }

    fn seal(&mut self, found: &J::Found, seconds: PhaseSeconds) -> Result<(), RunError> {
        self.job.seal(found, seconds)
    }
}

/// Carries out a job in a folder; `None` where it is complete there already.
///
/// # Errors
/// `pbif.Interrupted` with the folder when it was interrupted, whatever a signal or `tell` raised, or why the job was
/// not carried out.
pub(crate) fn carried_out<J>(
    py: Python<'_>,
    job: J,
    (home, failure): (&Path, Option<&Failure>),
    how: &How<'_>,
) -> PyResult<Option<J::Found>>
where
    J: Job + Send,
    J::Found: Send,
{
    let cancellation = Cancellation::new();
    let (draws, resume, threads) = (how.figures, how.resume, how.threads);
    let mut job = Brief { job, draws };
    let kept = || home.exists().then_some(home);
    let (ended, raised) = watched(py, &cancellation, how.tell.as_ref(), failure, |tell| {
        let mut run = || {
            let start = if resume {
                job.start(home)?
            } else {
                Start::Anew
            };
            let done = carry_out(&mut job, home, start, &cancellation, &|step| {
                tell(told(step));
            })?;
            Ok((start, done))
        };
        match threads {
            None => Ok(run()),
            Some(threads) => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                pool.build().map(|pool| pool.install(run))
            }
        }
    });
    if let Some(raised) = raised {
        let by_hand = raised.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py);
        return Err(if by_hand {
            error::interrupted(py, kept())
        } else {
            raised
        });
    }
    let ended = ended.map_err(|error| error::other(py, error))?;
    match ended.map_err(|error| error::job(py, &error))? {
        (Start::Complete, _) => Ok(None),
        (_, Some(done)) if done.outcome != Outcome::Interrupted => Ok(Some(done.found)),
        _ => Err(error::interrupted(py, kept())),
    }
}
