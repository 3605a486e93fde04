//! A source of densities that writes every solve into a journal, and gives those that are there already from it.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::Journal;
use super::record::{Found, Record};
use super::replay::{Keeper, Replay, in_words};
use crate::cancellation::Cancellation;
use crate::continuation::{
    DensitySource, KeptCheck, Session, Solution, SourceError, Subject, Want,
};
use crate::run::RunError;

/// A source whose first session goes on where the journal ends: solves that are in it are given from it, in its order,
/// the same to the bit; all others are solved as they would have been, and written before they are given.
///
/// What cannot be written, or asks for other values than the journal has, ends the session as if it had been
/// interrupted; [`JournalledSource::failure`] says why. The sources that check located values are those of the source
/// itself; whoever observes the sweep keeps what they see by [`JournalledSource::keep_check`].
pub struct JournalledSource {
    source: Box<dyn DensitySource>,
    shared: Arc<Mutex<Shared>>,
}

struct Shared {
    journal: Journal,
    /// Whether the session that writes is open.
    is_open: bool,
    /// Seconds that each stored solve took when it was solved.
    seconds: Vec<(f64, f64)>,
    /// Stored solves that no session has asked for yet.
    waiting: usize,
    failure: Option<RunError>,
}

impl JournalledSource {
    /// Joins a source with a journal of its solves.
    pub fn new(source: Box<dyn DensitySource>, journal: Journal) -> Self {
        let stored = journal.stored.iter();
        let shared = Shared {
            seconds: stored
                .map(|record| (record.value, record.seconds))
                .collect(),
            waiting: journal.stored.len(),
            journal,
            is_open: false,
            failure: None,
        };
        Self {
            source,
            shared: Arc::new(Mutex::new(shared)),
        }
    }

    /// The same with what is known besides: the seconds that values took, and what their checks saw.
    pub fn knowing(self, seconds: Vec<(f64, f64)>, checks: Vec<KeptCheck>) -> Self {
        let mut shared = lock(&self.shared);
        shared.seconds.splice(0..0, seconds);
        shared.journal.checks.extend(checks);
        drop(shared);
        self
    }

    /// Why the session ended, where it was not interrupted. It is told once.
    pub fn failure(&self) -> Option<RunError> {
        lock(&self.shared).failure.take()
    }

    /// Stored solves that are still to be given.
    pub fn waiting(&self) -> usize {
        lock(&self.shared).waiting
    }

    /// What checks of located values have seen. It is told once.
    pub fn kept_checks(&self) -> Vec<KeptCheck> {
        std::mem::take(&mut lock(&self.shared).journal.checks)
    }

    /// Writes what a check of a located value has seen.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn keep_check(&self, check: &KeptCheck) -> Result<(), RunError> {
        lock(&self.shared).journal.add_check(check)
    }

    /// Seconds that the solve of a value took, in whichever process it was solved; `None` for those of this one.
    pub fn seconds(&self, value: f64) -> Option<f64> {
        let shared = lock(&self.shared);
        let found = shared.seconds.iter().find(|(known, _)| *known == value);
        found.map(|(_, seconds)| *seconds)
    }
}

impl std::fmt::Debug for JournalledSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("JournalledSource")
            .field("method", &self.source.method())
            .field("waiting", &self.waiting())
            .finish_non_exhaustive()
    }
}

impl DensitySource for JournalledSource {
    fn method(&self) -> &'static str {
        self.source.method()
    }

    fn subject(&self) -> &Subject {
        self.source.subject()
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        let session = self.source.open(cancellation);
        let mut shared = lock(&self.shared);
        if std::mem::replace(&mut shared.is_open, true) {
            return session;
        }
        Box::new(JournalledSession {
            subject: self.source.subject().clone(),
            session,
            stored: Replay::new(std::mem::take(&mut shared.journal.stored).into()),
            shared: self.shared.clone(),
        })
    }

    fn finer(&self, want: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        self.source.finer(want)
    }

    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        self.source.enclosed(want)
    }
}

struct JournalledSession {
    subject: Subject,
    session: Box<dyn Session>,
    stored: Replay<Record>,
    shared: Arc<Mutex<Shared>>,
}

impl Session for JournalledSession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        if let Some(record) = self.stored.give(value, &self.shared)? {
            lock(&self.shared).waiting = self.stored.waiting();
            return record.solved.map(Solution::from).map_err(in_words);
        }
        self.stored.recall(&mut *self.session, &self.shared)?;
        let clock = Instant::now();
        let solved = match self.session.solve(value) {
            Ok(solution) => Ok(Found::from(solution)),
            Err(SourceError::Interrupted) => return Err(SourceError::Interrupted),
            Err(SourceError::Method(error)) => Err(error.to_string()),
        };
        let record = Record {
            value,
            seconds: clock.elapsed().as_secs_f64(),
            solved,
            memory: self.session.memory(),
        };
        let written = lock(&self.shared)
            .journal
            .add(&record, &self.subject.family);
        if let Err(error) = written {
            return Err(self.shared.end(error));
        }
        record.solved.map(Solution::from).map_err(in_words)
    }
}

impl Keeper for Arc<Mutex<Shared>> {
    fn path(&self) -> PathBuf {
        lock(self).journal.log.path().to_owned()
    }

    fn end(&self, error: RunError) -> SourceError {
        lock(self).failure = Some(error);
        SourceError::Interrupted
    }
}

/// What is shared holds no promises that a panic elsewhere could break.
fn lock(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
