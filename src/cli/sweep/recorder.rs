//! Writes every point as soon as it is done, and shows how far the sweep is.

use super::progress::Progress;
use crate::continuation::{CheckedIndicator, Observer, Point, Subject};
use crate::run::{JournalledSource, Manifest, RunError, RunFolder};

/// What a sweep tells its points.
pub(super) struct Recorder<'a> {
    pub(super) subject: &'a Subject,
    pub(super) folder: &'a mut RunFolder,
    pub(super) manifest: &'a mut Manifest,
    pub(super) progress: &'a Progress,
    pub(super) source: &'a JournalledSource,
    /// What shards saw in their checks.
    pub(super) checks: Vec<CheckedIndicator>,
    /// Points that came from the journal. The tables that are there are replaced when all have come.
    pub(super) given: Vec<Point>,
}

impl Recorder<'_> {
    /// Writes what came from the journal, in the place of what is there.
    ///
    /// # Errors
    /// As [`RunFolder::add_points`].
    pub(super) fn write_given(&mut self) -> Result<(), RunError> {
        let given = std::mem::take(&mut self.given);
        if given.is_empty() {
            return Ok(());
        }
        self.folder.add_points(self.subject, &given)
    }
}

impl Observer for Recorder<'_> {
    fn point(
        &mut self,
        point: &Point,
        done: usize,
        remaining: usize,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        if self.source.is_stored() {
            self.given.push(point.clone());
            return Ok(());
        }
        self.write_given()?;
        self.folder.add_point(self.subject, point)?;
        self.progress.point(self.subject, point, done, remaining);
        self.manifest.points = done;
        Ok(self.folder.write_progress(self.manifest)?)
    }

    fn known_checks(&mut self) -> Vec<CheckedIndicator> {
        std::mem::take(&mut self.checks)
    }
}
