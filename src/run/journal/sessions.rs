//! All sessions of a source written into one journal, those of its finer and enclosed sources too, with the answers to
//! what was asked of their solutions: what a curve needs to go on where it was.
//!
//! Sessions are numbered in the order in which they are opened. Whoever asks for the same in the same order is given
//! what is stored, and where a session's records end, it goes on as it would have.

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::asked::{Answer, Asked};
use super::log::Log;
use super::record::{Found, Record};
use super::replay::{Keeper, Replay, in_words};
use crate::cancellation::Cancellation;
use crate::continuation::{
    DensitySource, Sensitivity, Session, Solution, SourceError, Subject, Want,
};
use crate::run::RunError;
use crate::system::Family;

/// The journal of all sessions of a source. Clones are the same journal.
#[derive(Debug, Clone)]
pub struct SessionJournal(Arc<Mutex<Shared>>);

#[derive(Debug)]
struct Shared {
    log: Log,
    stored: BTreeMap<usize, VecDeque<Asked>>,
    /// Sessions that were opened by this process.
    sessions: usize,
    failure: Option<RunError>,
}

impl SessionJournal {
    /// A new file, of work that `of` describes as TOML.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn create(path: PathBuf, of: &str) -> Result<Self, RunError> {
        Ok(Self::of(Log::create(path, of)?, BTreeMap::new()))
    }

    /// Opens the file of unfinished work to go on with it.
    ///
    /// # Errors
    /// [`RunError::NoJournal`]; [`RunError::OtherSweep`], with every difference; [`RunError::Journal`];
    /// [`RunError::Read`].
    pub fn open(
        path: PathBuf,
        of: &str,
        family: &Family,
        methods: &[&'static str],
    ) -> Result<Self, RunError> {
        let mut stored: BTreeMap<usize, VecDeque<Asked>> = BTreeMap::new();
        let log = Log::open(path, of, &mut |reader| {
            let session = reader.count()?;
            let asked = Asked::read(reader, family, methods)?;
            stored.entry(session).or_default().push_back(asked);
            Ok(())
        })?;
        Ok(Self::of(log, stored))
    }

    fn of(log: Log, stored: BTreeMap<usize, VecDeque<Asked>>) -> Self {
        Self(Arc::new(Mutex::new(Shared {
            log,
            stored,
            sessions: 0,
            failure: None,
        })))
    }

    /// Solves that are stored and not given yet.
    pub fn waiting(&self) -> usize {
        self.lock().stored.values().map(VecDeque::len).sum()
    }

    /// Why a session ended, where it was not interrupted. It is told once.
    pub fn failure(&self) -> Option<RunError> {
        self.lock().failure.take()
    }

    /// What is shared holds no promises that a panic elsewhere could break.
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Keeper for SessionJournal {
    fn path(&self) -> PathBuf {
        self.lock().log.path().to_owned()
    }

    fn end(&self, error: RunError) -> SourceError {
        self.lock().failure.get_or_insert(error);
        SourceError::Interrupted
    }
}

/// A source whose sessions are in a journal.
///
/// What cannot be written, or asks for other values than the journal has, ends its session as if it had been
/// interrupted; [`SessionJournal::failure`] says why.
pub struct RecordedSource {
    source: Box<dyn DensitySource>,
    journal: SessionJournal,
}

impl RecordedSource {
    /// Joins a source with a journal of its sessions.
    pub fn new(source: Box<dyn DensitySource>, journal: SessionJournal) -> Self {
        Self { source, journal }
    }

    fn beside(&self, source: Box<dyn DensitySource>) -> Box<dyn DensitySource> {
        Box::new(Self::new(source, self.journal.clone()))
    }
}

impl std::fmt::Debug for RecordedSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RecordedSource")
            .field("method", &self.source.method())
            .finish_non_exhaustive()
    }
}

impl DensitySource for RecordedSource {
    fn method(&self) -> &'static str {
        self.source.method()
    }

    fn subject(&self) -> &Subject {
        self.source.subject()
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        let mut shared = self.journal.lock();
        let number = shared.sessions;
        shared.sessions += 1;
        let stored = shared.stored.remove(&number).unwrap_or_default();
        Box::new(RecordedSession {
            number,
            family: self.source.subject().family.clone(),
            session: self.source.open(cancellation),
            stored: Replay::new(stored),
            unwritten: None,
            journal: self.journal.clone(),
        })
    }

    fn finer(&self, want: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        Ok(self.source.finer(want)?.map(|source| self.beside(source)))
    }

    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        self.source.enclosed(want).map(|source| self.beside(source))
    }
}

struct RecordedSession {
    number: usize,
    family: Family,
    session: Box<dyn Session>,
    stored: Replay<Asked>,
    /// The last solve, of which more may be asked; `None` where an answer was interrupted.
    unwritten: Option<Asked>,
    journal: SessionJournal,
}

impl Session for RecordedSession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        self.write_last()?;
        if let Some(asked) = self.stored.give(value, &self.journal)? {
            return self.told(asked);
        }
        self.stored.recall(&mut *self.session, &self.journal)?;
        let clock = Instant::now();
        let solved = self.session.solve(value);
        let seconds = clock.elapsed().as_secs_f64();
        let asked = |solved, answers_questions| Asked {
            record: Record {
                value,
                seconds,
                solved,
                memory: Vec::new(),
            },
            answers_questions,
            answers: Vec::new(),
        };
        let mut solution = match solved {
            Ok(solution) => solution,
            Err(SourceError::Interrupted) => return Err(SourceError::Interrupted),
            Err(SourceError::Method(error)) => {
                self.unwritten = Some(asked(Err(error.to_string()), false));
                return Err(SourceError::Method(error));
            }
        };
        let inner = solution.sensitivity.take();
        self.unwritten = Some(asked(Ok(Found::copied(&solution)), inner.is_some()));
        solution.sensitivity = inner.map(|inner| {
            let unwritten = &mut self.unwritten;
            Box::new(Answering { inner, unwritten }) as Box<dyn Sensitivity>
        });
        Ok(solution)
    }

    fn memory(&self) -> Vec<u8> {
        self.session.memory()
    }
}

impl RecordedSession {
    /// Writes the last solve, of which nothing more can be asked.
    fn write_last(&mut self) -> Result<(), SourceError> {
        let Some(mut asked) = self.unwritten.take() else {
            return Ok(());
        };
        asked.record.memory = self.session.memory();
        let (number, family) = (self.number, &self.family);
        let written = self
            .journal
            .lock()
            .log
            .append(|writer| asked.write(writer.count(number), family));
        written.map_err(|error| self.journal.end(error))
    }

    /// A stored solve, which can be asked what it was asked.
    fn told(&self, asked: Asked) -> Result<Solution<'static>, SourceError> {
        let Asked {
            record,
            answers_questions,
            answers,
        } = asked;
        let mut solution = record.solved.map(Solution::from).map_err(in_words)?;
        solution.sensitivity = answers_questions.then(|| {
            let journal = self.journal.clone();
            Box::new(Told { answers, journal }) as Box<dyn Sensitivity>
        });
        Ok(solution)
    }
}

impl Drop for RecordedSession {
    fn drop(&mut self) {
        // What cannot be written is told by the journal.
        let _ = self.write_last();
    }
}

/// A solution that is asked; the answers are kept.
struct Answering<'session> {
    inner: Box<dyn Sensitivity + 'session>,
    unwritten: &'session mut Option<Asked>,
}

impl Answering<'_> {
    fn keep(
        &mut self,
        name: &str,
        answer: Result<Vec<Vec<f64>>, SourceError>,
    ) -> Result<Vec<Vec<f64>>, SourceError> {
        let kept = match &answer {
            Ok(densities) => Ok(densities.clone()),
            Err(SourceError::Method(error)) => Err(error.to_string()),
            Err(SourceError::Interrupted) => {
                // Without its answers it is no solve to go on from.
                *self.unwritten = None;
                return answer;
            }
        };
        if let Some(asked) = &mut self.unwritten {
            asked.answers.push((name.to_owned(), kept));
        }
        answer
    }
}

impl Sensitivity for Answering<'_> {
    fn to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        let answer = self.inner.to_parameter(name);
        self.keep(name, answer)
    }

    fn jumps_to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        let answer = self.inner.jumps_to_parameter(name);
        self.keep(&jumps_by(name), answer)
    }

    fn along_path(&mut self) -> Result<Vec<Vec<f64>>, SourceError> {
        let answer = self.inner.along_path();
        self.keep("", answer)
    }
}

/// A stored solution that is asked the same again.
struct Told {
    answers: Vec<(String, Answer)>,
    journal: SessionJournal,
}

/// What answers on jumps are kept as: no parameter has a space in its name.
fn jumps_by(name: &str) -> String {
    format!("jumps by {name}")
}

impl Sensitivity for Told {
    fn to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        let found = self.answers.iter().find(|(known, _)| known == name);
        match found {
            Some((_, answer)) => answer.clone().map_err(in_words),
            None => {
                let path = self.journal.path();
                Err(self.journal.end(RunError::Journal { path }))
            }
        }
    }

    fn jumps_to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        self.to_parameter(&jumps_by(name))
    }

    fn along_path(&mut self) -> Result<Vec<Vec<f64>>, SourceError> {
        self.to_parameter("")
    }
}
