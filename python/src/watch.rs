//! Long work on a thread of its own, while the thread that asked for it hears signals and tells how the work goes.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pbif::cancellation::Cancellation;
use pbif::continuation::Point;
use pbif::job::Progress;
use pyo3::prelude::*;

use crate::drift::Failure;

/// How often signals are asked for. An interrupt waits no longer than this before the work is asked to stop.
const PATIENCE: Duration = Duration::from_millis(20);

/// What work tells.
pub(crate) enum Told {
    /// Words, and how many are done of how many where that is known.
    Words(String, Option<(usize, usize)>),
    /// A value that was solved.
    Solved(Box<Point>),
}

/// Hears what work tells.
pub(crate) type Ear<'a> = &'a dyn Fn(Told) -> PyResult<()>;

/// A step of a job in words; `None` of a value, which is told in words besides.
pub(crate) fn words(step: &Progress<'_>) -> Option<Told> {
    Some(match *step {
        Progress::Solved(_) => return None,
        Progress::Says(words) => Told::Words(words.to_owned(), None),
        Progress::Done {
            words,
            done,
            wanted,
        }
        | Progress::Next {
            words,
            done,
            wanted,
        } => Told::Words(words.to_owned(), Some((done, wanted))),
    })
}

/// Tells a function in Python the words.
pub(crate) fn tell_words(function: Option<&Bound<'_, PyAny>>, told: Told) -> PyResult<()> {
    match (told, function) {
        (Told::Words(words, counts), Some(function)) => function.call1((words, counts)).map(drop),
        _ => Ok(()),
    }
}

/// Carries out `work` without holding the interpreter, and lets `ear` hear what it tells, on the thread that asked for
/// the work, which nothing of the work waits for. A signal whose handler raises, as that of Ctrl-C does, an `ear` that
/// raises, and a drift in Python that raises cancel the work; what was raised comes beside what it gave.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    cancellation: &Cancellation,
    ear: Option<Ear<'_>>,
    failure: Option<&Failure>,
    work: impl FnOnce(&(dyn Fn(Told) + Sync)) -> T + Send,
) -> (T, Option<PyErr>) {
    let (say, mut said) = mpsc::channel::<Told>();
    let wants = ear.is_some();
    std::thread::scope(|scope| {
        let working = scope.spawn(move || {
            work(&|told| {
                if wants {
                    let _ = say.send(told);
                }
            })
        });
        let mut raised = None;
        loop {
            let heard;
            (said, heard) = py.detach(move || {
                let heard = said.recv_timeout(PATIENCE);
                (said, heard)
            });
            let has_ended = matches!(heard, Err(RecvTimeoutError::Disconnected));
            let react = || {
                py.check_signals()?;
                failure.map_or(Ok(()), Failure::raised)?;
                match (heard, ear) {
                    (Ok(told), Some(ear)) => ear(told),
                    _ => Ok(()),
                }
            };
            if raised.is_none()
                && let Err(error) = react()
            {
                cancellation.cancel();
                raised = Some(error);
            }
            if has_ended {
                break;
            }
        }
        let ended = py.detach(|| working.join());
        // What was raised after the last look.
        raised = raised.or_else(|| failure.and_then(|failure| failure.raised().err()));
        (
            ended.unwrap_or_else(|fault| std::panic::resume_unwind(fault)),
            raised,
        )
    })
}
