//! A job of the library, carried out for Python: with or without figures, and short when it is interrupted.

use std::path::Path;

use pbif::cancellation::Cancellation;
use pbif::continuation::Point;
use pbif::figure::Figure;
use pbif::job::{Context, Job, JobError, Outcome, Progress, Start, carry_out};
use pbif::run::{JobFolder, Layout, PhaseSeconds, RunError};
use pbif::sweep_file::Sweep;
use pyo3::prelude::*;

use crate::drift::Failure;
use crate::error;
use crate::watch::{Ear, Told, tell_words, watched, words};

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

/// Sees every value of a sweep, one at a time, on the thread that asked for it.
pub(crate) type Eye<'a> = &'a dyn Fn(Box<Point>) -> PyResult<()>;

/// Carries out a job in a folder; `None` where it is complete there already. `eye` sees what is solved, in the order in
/// which it is.
///
/// # Errors
/// `pbif.Interrupted` with the folder when it was interrupted, whatever a signal, `tell` or `eye` raised, or why the job
/// was not carried out. What was raised has a note of where the work is kept (Python 3.11 and later).
pub(crate) fn carried_out<J>(
    py: Python<'_>,
    job: J,
    (home, failure): (&Path, Option<&Failure>),
    how: &How<'_>,
    eye: Option<Eye<'_>>,
) -> PyResult<Option<J::Found>>
where
    J: Job + Send,
    J::Found: Send,
{
    let cancellation = Cancellation::new();
    let (draws, resume, threads) = (how.figures, how.resume, how.threads);
    let mut job = Brief { job, draws };
    let kept = || home.exists().then_some(home);
    let hear = |heard| match (heard, eye) {
        (Told::Solved(point), Some(eye)) => eye(point),
        (heard, _) => tell_words(how.tell.as_ref(), heard),
    };
    let (is_told, is_seen) = (how.tell.is_some(), eye.is_some());
    let ear: Option<Ear<'_>> = (is_told || is_seen).then_some(&hear);
    let (ended, raised) = watched(py, &cancellation, ear, failure, |say| {
        let mut run = || {
            let start = if resume {
                job.start(home)?
            } else {
                Start::Anew
            };
            let done = carry_out(&mut job, home, start, &cancellation, &|step| match step {
                Progress::Solved(point) if is_seen => say(Told::Solved(Box::new((*point).clone()))),
                step if is_told => words(step).into_iter().for_each(say),
                _ => (),
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
        if by_hand {
            return Err(error::interrupted(py, kept()));
        }
        if let Some(home) = kept() {
            let note = format!("what was solved is kept in {}", home.display());
            // Before Python 3.11 there are no notes.
            let _ = raised.value(py).call_method1("add_note", (note,));
        }
        return Err(raised);
    }
    let ended = ended.map_err(|error| error::other(py, error))?;
    match ended.map_err(|error| error::job(py, &error))? {
        (Start::Complete, _) => Ok(None),
        (_, Some(done)) if done.outcome != Outcome::Interrupted => Ok(Some(done.found)),
        _ => Err(error::interrupted(py, kept())),
    }
}
