//! Writes every point as soon as it is done, and shows how far the sweep is.

use std::borrow::Cow;

use super::progress::Progress;
use crate::continuation::{KeptCheck, Observer, Point, Subject};
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
        let point = match self.source.seconds(point.value) {
            Some(seconds) => Cow::Owned(Point {
                seconds,
                ..point.clone()
            }),
            None => Cow::Borrowed(point),
        };
        if done > self.stored {
            self.folder.add_point(self.subject, &point)?;
            self.progress.point(self.subject, &point, done, remaining);
            self.manifest.points = done;
            self.folder.write_progress(self.manifest)?;
            return Ok(());
        }
        self.given.push(point.into_owned());
        if done == self.stored {
            let given = std::mem::take(&mut self.given);
            self.folder.add_points(self.subject, &given)?;
        }
        Ok(())
    }

    fn checked(
        &mut self,
        check: &KeptCheck,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        Ok(self.source.keep_check(check)?)
    }

    fn kept_checks(&mut self) -> Vec<KeptCheck> {
        self.source.kept_checks()
    }
}
