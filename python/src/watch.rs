//! Long work on a thread of its own, while the thread that asked for it hears signals and tells how the work goes.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pbif::cancellation::Cancellation;
use pbif::job::Progress;
use pyo3::prelude::*;

use crate::drift::Failure;

/// How often signals are asked for. An interrupt waits no longer than this before the work is asked to stop.
const PATIENCE: Duration = Duration::from_millis(20);

/// What work tells: words, and how many are done of how many where that is known.
pub(crate) type Told = (String, Option<(usize, usize)>);

/// A step of a job, as work tells it.
pub(crate) fn told(step: &Progress<'_>) -> Told {
    match *step {
        Progress::Says(words) => (words.to_owned(), None),
        Progress::Done {
            words,
            done,
            wanted,
        }
        | Progress::Next {
            words,
            done,
            wanted,
        } => (words.to_owned(), Some((done, wanted))),
    }
}

/// Carries out `work` without holding the interpreter, and calls `tell` with what it tells. A signal whose handler
/// raises, as that of Ctrl-C does, a `tell` that raises, and a drift in Python that raises cancel the work; what was
/// raised comes beside what it gave.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    cancellation: &Cancellation,
    tell: Option<&Bound<'_, PyAny>>,
    failure: Option<&Failure>,
    work: impl FnOnce(&(dyn Fn(Told) + Sync)) -> T + Send,
) -> (T, Option<PyErr>) {
    let (say, mut said) = mpsc::channel::<Told>();
    let wants = tell.is_some();
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
            let react = || {
                py.check_signals()?;
                failure.map_or(Ok(()), Failure::raised)?;
                match (&heard, tell) {
                    (Ok((words, counts)), Some(tell)) => tell.call1((words, *counts)).map(drop),
                    _ => Ok(()),
                }
            };
            if raised.is_none()
                && let Err(error) = react()
            {
                cancellation.cancel();
                raised = Some(error);
            }
            if heard == Err(RecvTimeoutError::Disconnected) {
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
