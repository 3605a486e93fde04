//! Who watches a comparison: told how far it is, and keeper of what is solved, so that one that was ended early can be
//! gone on with.

use super::{CompareError, CompareStep, Solved};
use crate::cancellation::{Cancellation, Cancelled};

/// What a keeper may say instead of keeping.
type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Whoever watches a comparison. A closure is told how far it is, and keeps nothing.
pub trait CompareObserver {
    /// A step is about to begin.
    fn step(&mut self, progress: &CompareStep);

    /// What the next solve gave before, in the order in which solves were [kept](CompareObserver::keep); `None` where
    /// it is still to be made.
    ///
    /// # Errors
    /// What keeps the comparison from going on.
    fn known(&mut self) -> Result<Option<Vec<Solved>>, Failure> {
        Ok(None)
    }

    /// A solve is done, by one method or by those that share samples.
    ///
    /// # Errors
    /// What keeps the comparison from going on.
    fn keep(&mut self, solved: &[Solved]) -> Result<(), Failure> {
        let _ = solved;
        Ok(())
    }
}

impl<F: FnMut(&CompareStep)> CompareObserver for F {
    fn step(&mut self, progress: &CompareStep) {
        self(progress);
    }
}

/// The steps of a comparison, in their order.
pub(super) struct Steps<'a> {
    observer: &'a mut dyn CompareObserver,
    done: usize,
    total: usize,
    pub(super) cancellation: &'a Cancellation,
}

impl<'a> Steps<'a> {
    pub(super) fn new(
        observer: &'a mut dyn CompareObserver,
        total: usize,
        cancellation: &'a Cancellation,
    ) -> Self {
        Self {
            observer,
            done: 0,
            total,
            cancellation,
        }
    }

    /// Tells of the next step, unless it is to be the last.
    pub(super) fn next(&mut self, next: String) -> Result<(), CompareError> {
        let (done, total) = (self.done, self.total);
        self.observer.step(&CompareStep { done, total, next });
        self.done += 1;
        self.cancellation
            .check()
            .map_err(|Cancelled| CompareError::Interrupted)
    }

    /// What a solve gives: what is known of it, or what it gives now, which is kept.
    pub(super) fn solved(
        &mut self,
        solve: &mut dyn FnMut() -> Result<Vec<Solved>, CompareError>,
    ) -> Result<Vec<Solved>, CompareError> {
        let known = self.observer.known();
        if let Some(mut known) = known.map_err(CompareError::Observer)? {
            for solved in &mut known {
                solved.report.method = solved.method.source();
            }
            return Ok(known);
        }
        let solved = solve()?;
        self.observer
            .keep(&solved)
            .map_err(CompareError::Observer)?;
        Ok(solved)
    }
}
