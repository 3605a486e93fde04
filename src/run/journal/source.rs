//! A source of densities that writes every solve into a journal, and gives those that are there already from it.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use super::session::{Inner, JournalledSession, Known};
use super::{Journal, Key};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource, Session, SourceError, Subject, Want};

/// A source all of whose sessions are in a journal, those of its finer and enclosed sources too: solves that are there
/// are given from it, the same to the bit, all others are solved as they would have been, and written.
///
/// What cannot be written or read ends its session as if it had been interrupted; [`Journal::failure`] says why.
pub struct JournalledSource {
    source: Box<dyn DensitySource>,
    journal: Journal,
    /// Which of the sources of the work it is.
    key: Key,
    known: Arc<Known>,
}

impl JournalledSource {
    /// Joins a source with a journal. A solve is written when its session goes on or ends: until then it may be asked
    /// how it answers to parameters.
    pub fn new(source: Box<dyn DensitySource>, journal: &Journal) -> Self {
        let known = Known {
            is_asked: true,
            ..Known::default()
        };
        Self::at(source, journal, Key::of("main"), known)
    }

    /// The same for a sweep, which asks no solution how it answers: every solve is written before it is given.
    pub(crate) fn of_sweep(source: Box<dyn DensitySource>, journal: &Journal) -> Self {
        let known = Known {
            is_swept: true,
            ..Known::default()
        };
        Self::at(source, journal, Key::of("main"), known)
    }

    fn at(source: Box<dyn DensitySource>, journal: &Journal, key: Key, known: Known) -> Self {
        Self {
            source,
            journal: journal.clone(),
            key,
            known: Arc::new(known),
        }
    }

    /// How many values this process has solved, those of checks not counted.
    pub(crate) fn solves(&self) -> usize {
        self.known.solves.load(Ordering::Relaxed)
    }

    /// Whether an earlier process has solved the point at a value.
    pub(crate) fn is_stored(&self, value: f64) -> bool {
        self.journal.has_point(value)
    }

    fn beside(&self, source: Box<dyn DensitySource>, name: &str) -> Box<dyn DensitySource> {
        let known = Known {
            is_asked: self.known.is_asked,
            ..Known::default()
        };
        Box::new(Self::at(source, &self.journal, self.key.then(name), known))
    }
}

impl std::fmt::Debug for JournalledSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("JournalledSource")
            .field("method", &self.source.method())
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
        Box::new(JournalledSession {
            family: self.source.subject().family.clone(),
            method: self.source.method(),
            known: self.known.clone(),
            journal: self.journal.clone(),
            key: self.key,
            inner: Inner {
                session: self.source.open(cancellation),
                left: Vec::new(),
            },
            last: None,
            seconds: None,
        })
    }

    fn segments(&self, values: usize) -> usize {
        self.source.segments(values)
    }

    fn cells(&self) -> Option<usize> {
        self.source.cells()
    }

    fn finer(&self, want: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        let finer = self.source.finer(want)?;
        Ok(finer.map(|source| self.beside(source, &format!("finer {want:?}"))))
    }

    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        let enclosed = self.source.enclosed(want);
        enclosed.map(|source| self.beside(source, &format!("enclosed {want:?}")))
    }
}
