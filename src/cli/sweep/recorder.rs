//! Writes every point as soon as it is done, and shows how far the sweep is.

use super::progress::Progress;
use crate::continuation::{Observer, Point, Subject};
use crate::run::{JournalledSource, Manifest, RunFolder};

/// What a sweep tells its points.
pub(super) struct Recorder<'a> {
    pub(super) subject: &'a Subject,
    pub(super) folder: &'a mut RunFolder,
    pub(super) manifest: &'a mut Manifest,
    pub(super) progress: &'a Progress,
    pub(super) source: &'a JournalledSource,
    /// How many points come from the journal.
    pub(super) stored: usize,
    /// Those that have come. The tables that are there are replaced when all have.
    pub(super) given: Vec<Point>,
}

impl Observer for Recorder<'_> {
    fn point(
        &mut self,
        point: &Point,
        done: usize,
        remaining: usize,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        if done > self.stored {
            self.folder.add_point(self.subject, point)?;
            self.progress.point(self.subject, point, done, remaining);
            self.manifest.points = done;
            self.folder.write_progress(self.manifest)?;
            return Ok(());
        }
        let mut point = point.clone();
        point.seconds = self.source.seconds(point.value).unwrap_or(point.seconds);
        self.given.push(point);
        if done == self.stored {
            let given = std::mem::take(&mut self.given);
            self.folder.add_points(self.subject, &given)?;
        }
        Ok(())
    }
}
