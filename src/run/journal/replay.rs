//! What a session of an earlier process has solved: given again in its order, and then recalled by the session that
//! goes on.

use std::collections::VecDeque;
use std::path::PathBuf;

use super::record::Record;
use crate::continuation::{Session, SourceError};
use crate::run::RunError;

/// A stored solve, with or without what was asked of it.
pub(super) trait Stored {
    /// The solve.
    fn record(&mut self) -> &mut Record;
}

impl Stored for Record {
    fn record(&mut self) -> &mut Record {
        self
    }
}

/// Where solves are stored, and what went wrong with them is told.
pub(super) trait Keeper {
    /// The file.
    fn path(&self) -> PathBuf;

    /// Ends a session with an error that is not the method's.
    fn end(&self, error: RunError) -> SourceError;
}

/// The solves of one session.
pub(super) struct Replay<R> {
    stored: VecDeque<R>,
    /// What the session is to recall before its first solve.
    left: Vec<(f64, Vec<u8>)>,
}

impl<R: Stored> Replay<R> {
    pub(super) fn new(stored: VecDeque<R>) -> Self {
        Self {
            stored,
            left: Vec::new(),
        }
    }

    /// How many are still to be given.
    pub(super) fn waiting(&self) -> usize {
        self.stored.len()
    }

    /// The next stored solve, which must be of the value that is asked for; `None` where the session is to solve
    /// itself.
    pub(super) fn give(
        &mut self,
        value: f64,
        keeper: &impl Keeper,
    ) -> Result<Option<R>, SourceError> {
        let Some(mut next) = self.stored.pop_front() else {
            return Ok(None);
        };
        let record = next.record();
        if record.value.to_bits() != value.to_bits() {
            return Err(keeper.end(RunError::JournalOrder {
                path: keeper.path(),
                stored: record.value,
                wanted: value,
            }));
        }
        let memory = std::mem::take(&mut record.memory);
        self.left.push((value, memory));
        Ok(Some(next))
    }

    /// Lets a session recall what was given, once.
    pub(super) fn recall(
        &mut self,
        session: &mut dyn Session,
        keeper: &impl Keeper,
    ) -> Result<(), SourceError> {
        let left = std::mem::take(&mut self.left);
        if left.is_empty() {
            return Ok(());
        }
        let left: Vec<(f64, &[u8])> = left.iter().map(|(v, bytes)| (*v, &bytes[..])).collect();
        match session.recall(&left) {
            Err(SourceError::Method(_)) => Err(keeper.end(RunError::Journal {
                path: keeper.path(),
            })),
            recalled => recalled,
        }
    }
}

/// What a method said, as its error.
pub(super) fn in_words(words: String) -> SourceError {
    SourceError::Method(words.into())
}
