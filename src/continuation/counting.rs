//! A source that counts what its sessions solve, those of its finer and enclosed sources too.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::{DensitySource, Session, Solution, SourceError, Subject, Want};
use crate::cancellation::Cancellation;

/// How many values were solved, by how often the cells were refined.
pub(super) type Solves = [AtomicUsize; MOST_REFINED];

/// Refinements that are told from each other; more often refined cells are counted as the last of them.
const MOST_REFINED: usize = 16;

/// Counts the solves of a source. The counts do not depend on the number of threads once all sessions have ended.
pub(super) struct CountingSource {
    source: Box<dyn DensitySource>,
    /// How often its cells were refined.
    times: u8,
    solves: Arc<Solves>,
}

impl CountingSource {
    pub(super) fn new(source: Box<dyn DensitySource>, times: u8, solves: &Arc<Solves>) -> Self {
        let solves = solves.clone();
        Self {
            source,
            times,
            solves,
        }
    }

    fn beside(&self, source: Box<dyn DensitySource>, times: u8) -> Box<dyn DensitySource> {
        Box::new(Self::new(source, times, &self.solves))
    }
}

impl DensitySource for CountingSource {
    fn method(&self) -> &'static str {
        self.source.method()
    }

    fn subject(&self) -> &Subject {
        self.source.subject()
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        Box::new(CountingSession {
            session: self.source.open(cancellation),
            place: usize::from(self.times).min(MOST_REFINED - 1),
            solves: self.solves.clone(),
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
        Ok(finer.map(|source| self.beside(source, self.times.saturating_add(1))))
    }

    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        let enclosed = self.source.enclosed(want);
        enclosed.map(|source| self.beside(source, self.times))
    }
}

struct CountingSession {
    session: Box<dyn Session>,
    place: usize,
    solves: Arc<Solves>,
}

impl Session for CountingSession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        self.solves[self.place].fetch_add(1, Ordering::Relaxed);
        self.session.solve(value)
    }

    fn seconds(&self) -> Option<f64> {
        self.session.seconds()
    }

    fn memory(&self) -> Vec<u8> {
        self.session.memory()
    }

    fn recall(&mut self, left: &[(f64, &[u8])]) -> Result<(), SourceError> {
        self.session.recall(left)
    }
}
