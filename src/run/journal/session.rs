//! A session whose solves are in a journal.
//!
//! A solve depends on what the session was asked before it, in that order, and on nothing else: the key of a solve is
//! the hash of all of it. So whoever asks for the same is given what is there, in whatever order sessions are opened
//! and on however many threads, and what is not there is solved from where an uninterrupted session would have stood.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use super::kept::{Kept, KeptSolution, Question, in_words};
use super::{Journal, Key};
use crate::continuation::{Sensitivity, Session, Solution, SourceError};
use crate::run::RunError;
use crate::system::Family;

pub(super) struct JournalledSession {
    pub(super) family: Family,
    pub(super) method: &'static str,
    pub(super) known: Arc<Known>,
    pub(super) journal: Journal,
    /// Of all that was asked so far.
    pub(super) key: Key,
    pub(super) inner: Inner,
    pub(super) last: Option<Last>,
    pub(super) seconds: Option<f64>,
}

/// The session that solves what is not in the journal.
pub(super) struct Inner {
    pub(super) session: Box<dyn Session>,
    /// What it is to recall before its next solve: values that were given from the journal, with their memories.
    pub(super) left: Vec<(f64, Vec<u8>)>,
}

/// The last solve, of which more may be asked.
pub(super) struct Last {
    key: Key,
    value: f64,
    kept: Kept,
    /// How many of the answers were given to this session.
    answered: usize,
    /// Whether it is to be written.
    is_new: bool,
}

impl Session for JournalledSession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        self.settle()?;
        let key = self.key.of_value(&self.family, value);
        let kept = self.journal.get::<Kept>(key);
        let kept = kept.map_err(|error| self.journal.end(error))?;
        match kept {
            Some(kept) if kept.is_sound() => self.give(key, value, kept),
            Some(_) => {
                let path = self.journal.path();
                Err(self.journal.end(RunError::Journal { path }))
            }
            None => {
                self.known.solves.fetch_add(1, Ordering::Relaxed);
                if self.known.is_asked {
                    self.solve_now(key, value)
                } else {
                    // Nothing will be asked of it: it is written before it is given.
                    let solution = self.solve_now(key, value)?.detached();
                    self.settle()?;
                    Ok(solution)
                }
            }
        }
    }

    fn seconds(&self) -> Option<f64> {
        self.seconds
    }
}

impl JournalledSession {
    /// A solve that is in the journal.
    fn give(&mut self, key: Key, value: f64, kept: Kept) -> Result<Solution<'_>, SourceError> {
        self.seconds = Some(kept.seconds);
        let solved = kept.solved.clone();
        let is_sensitive = kept.is_sensitive && self.known.is_asked;
        self.last = Some(Last {
            key,
            value,
            kept,
            answered: 0,
            is_new: false,
        });
        let mut solution = solved.map_err(in_words)?.solution(self.method);
        if is_sensitive {
            solution.sensitivity = Some(Box::new(Answers {
                last: &mut self.last,
                live: None,
                inner: Some(&mut self.inner),
                journal: &self.journal,
            }));
        }
        Ok(solution)
    }

    /// A solve that is not.
    fn solve_now(&mut self, key: Key, value: f64) -> Result<Solution<'_>, SourceError> {
        self.seconds = None;
        let session = self.inner.ready(&self.journal)?;
        let clock = Instant::now();
        let solved = session.solve(value);
        let seconds = clock.elapsed().as_secs_f64();
        let last = |solved, is_sensitive| Last {
            key,
            value,
            kept: Kept {
                seconds,
                solved,
                is_sensitive,
                answers: Vec::new(),
                memory: Vec::new(),
            },
            answered: 0,
            is_new: true,
        };
        let mut solution = match solved {
            Ok(solution) => solution,
            Err(SourceError::Interrupted) => return Err(SourceError::Interrupted),
            Err(SourceError::Method(error)) => {
                self.last = Some(last(Err(error.to_string()), false));
                return Err(SourceError::Method(error));
            }
        };
        let live = solution.sensitivity.take();
        self.last = Some(last(Ok(KeptSolution::of(&solution)), live.is_some()));
        solution.sensitivity = live.map(|live| {
            Box::new(Answers {
                last: &mut self.last,
                live: Some(live),
                inner: None,
                journal: &self.journal,
            }) as Box<dyn Sensitivity>
        });
        Ok(solution)
    }

    /// Ends the last solve, of which nothing more can be asked: it is written, or the session is to recall it.
    fn settle(&mut self) -> Result<(), SourceError> {
        let Some(mut last) = self.last.take() else {
            return Ok(());
        };
        if last.answered < last.kept.answers.len() {
            // A session that was asked less stands elsewhere.
            self.inner.again(&mut last, &self.journal)?;
        }
        self.key = last.key.of_questions(&last.kept.answers);
        let mut written = Ok(());
        if last.is_new {
            last.kept.memory = self.inner.session.memory();
            written = self.journal.write(last.key, &last.kept);
        }
        // Journals of early versions do not say which solves are points.
        if self.known.is_swept && (last.is_new || !self.journal.has_point(last.value)) {
            let point = (last.value, last.key);
            written =
                written.and_then(|()| self.journal.write_point(&self.family, point, &last.kept));
        }
        if !last.is_new {
            self.inner.left.push((last.value, last.kept.memory));
        }
        written.map_err(|error| self.journal.end(error))
    }
}

impl Drop for JournalledSession {
    fn drop(&mut self) {
        if self.last.as_ref().is_some_and(|last| last.is_new) {
            // What cannot be written is told by the journal.
            let _ = self.settle();
        }
    }
}

impl Inner {
    /// The session, where an uninterrupted one would stand.
    fn ready(&mut self, journal: &Journal) -> Result<&mut dyn Session, SourceError> {
        let left = std::mem::take(&mut self.left);
        if !left.is_empty() {
            let left: Vec<(f64, &[u8])> = left.iter().map(|(at, left)| (*at, &left[..])).collect();
            match self.session.recall(&left) {
                Err(SourceError::Method(_)) => {
                    let path = journal.path();
                    return Err(journal.end(RunError::Journal { path }));
                }
                recalled => recalled?,
            }
        }
        Ok(self.session.as_mut())
    }

    /// The last solve and the questions that were asked of it once more: it is to be asked something else than before.
    fn again(
        &mut self,
        last: &mut Last,
        journal: &Journal,
    ) -> Result<Option<Box<dyn Sensitivity + '_>>, SourceError> {
        last.kept.answers.truncate(last.answered);
        last.is_new = true;
        let solution = self.ready(journal)?.solve(last.value)?;
        let mut live = solution.sensitivity;
        for (question, _) in &last.kept.answers {
            if let Some(Err(SourceError::Interrupted)) =
                live.as_mut().map(|live| question.ask(live.as_mut()))
            {
                return Err(SourceError::Interrupted);
            }
        }
        Ok(live)
    }
}

/// How a solution answers: from the journal as long as the same is asked as before, then by its session.
struct Answers<'session> {
    last: &'session mut Option<Last>,
    live: Option<Box<dyn Sensitivity + 'session>>,
    /// The session, until it is to answer.
    inner: Option<&'session mut Inner>,
    journal: &'session Journal,
}

impl Answers<'_> {
    fn answer(&mut self, question: Question) -> Result<Vec<Vec<f64>>, SourceError> {
        let answer = self.find(question);
        if let Err(SourceError::Interrupted) = answer {
            // Without its answers it is no solve to go on from.
            *self.last = None;
        }
        answer
    }

    fn find(&mut self, question: Question) -> Result<Vec<Vec<f64>>, SourceError> {
        let last = self.last.as_mut().ok_or(SourceError::Interrupted)?;
        let stored = last.kept.answers.get(last.answered);
        if let Some((_, answer)) = stored.filter(|(stored, _)| *stored == question) {
            last.answered += 1;
            return answer.clone().map_err(in_words);
        }
        if let Some(inner) = self.inner.take() {
            self.live = inner.again(last, self.journal)?;
        }
        let live = self.live.as_mut().ok_or(SourceError::Interrupted)?;
        let answer = question.ask(live.as_mut());
        let kept = match &answer {
            Ok(densities) => Ok(densities.clone()),
            Err(SourceError::Method(error)) => Err(error.to_string()),
            Err(SourceError::Interrupted) => return answer,
        };
        last.kept.answers.push((question, kept));
        last.answered += 1;
        answer
    }
}

impl Sensitivity for Answers<'_> {
    fn to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        self.answer(Question::ToParameter(name.to_owned()))
    }

    fn jumps_to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        self.answer(Question::JumpsToParameter(name.to_owned()))
    }

    fn along_path(&mut self) -> Result<Vec<Vec<f64>>, SourceError> {
        self.answer(Question::AlongPath)
    }
}

/// What sessions of one source share.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// Whether solutions are asked how they answer to parameters.
    pub(super) is_asked: bool,
    /// Whether what is solved are the points of a sweep.
    pub(super) is_swept: bool,
    /// Values that were solved by this process.
    pub(super) solves: AtomicUsize,
}
