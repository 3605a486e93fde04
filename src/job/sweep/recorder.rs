//! Writes every point as soon as it is done, and tells how far the sweep is.

use std::time::{Duration, Instant};

use crate::continuation::{CheckedIndicator, Observer, Point};
use crate::job::{Context, Progress};
use crate::run::{Gathered, JobFolder, Journal, JournalledSource, Manifest, RunError, RunFolder};
use crate::sweep_file::Sweep;

/// Failures as observers hand them on.
type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Time between two manifests while points come from shards.
const BETWEEN_MANIFESTS: Duration = Duration::from_millis(100);

/// What a sweep tells its points.
pub(super) struct Recorder<'a> {
    pub(super) sweep: &'a Sweep,
    pub(super) folder: &'a JobFolder,
    pub(super) run: RunFolder,
    pub(super) manifest: Manifest,
    pub(super) context: &'a Context<'a>,
    pub(super) source: &'a JournalledSource,
    pub(super) journal: &'a Journal,
    /// What shards have solved, and saw in their checks.
    pub(super) known: Gathered,
    /// Points of earlier processes that have not come from the journal yet. Then the tables that are there are
    /// replaced.
    pub(super) missing: usize,
    /// When the manifest last said how many points are done.
    pub(super) told: Option<Instant>,
    /// Points that wait for those.
    pub(super) held: Vec<Point>,
}

impl Recorder<'_> {
    /// Writes the points that are held, in the place of what is there.
    pub(super) fn write_held(&mut self) -> Result<(), RunError> {
        let held = std::mem::take(&mut self.held);
        if held.is_empty() {
            return Ok(());
        }
        self.run.add_points(self.sweep.problem.subject(), &held)
    }

    /// A point in words: its value, and what was found there.
    fn say(&self, point: &Point, done: usize, wanted: usize) {
        let subject = self.sweep.problem.subject();
        let family = &subject.family;
        let mut words = format!("{} = {:.6}", family.parameter(), point.value);
        let status = point.report.status;
        // What is detected in a density that did not converge is of nothing.
        let found = if status.is_resolved() {
            point.detections.as_slice()
        } else {
            &[]
        };
        if found.is_empty() {
            words += &format!(": {}", status.word());
        }
        for (&observable, detection) in subject.observables.iter().zip(found) {
            let name = observable.name(family);
            words += &format!("  {name}: {}", detection.signature);
        }
        let words = &words;
        (self.context.observer)(&Progress::Done {
            words,
            done,
            wanted,
        });
    }
}

impl Observer for Recorder<'_> {
    fn point(&mut self, point: &Point, done: usize, remaining: usize) -> Result<(), Failure> {
        (self.context.observer)(&Progress::Solved(point));
        let family = self.sweep.problem.family();
        let is_of_shard = self.known.holders.keep(self.journal, family, point)?;
        if self.source.is_stored(point.value) {
            self.missing = self.missing.saturating_sub(1);
            self.held.push(point.clone());
            return Ok(());
        }
        if self.missing > 0 {
            self.held.push(point.clone());
            self.say(point, done, done + remaining);
            return Ok(());
        }
        self.folder.check()?;
        self.write_held()?;
        self.run
            .add_points(self.sweep.problem.subject(), std::slice::from_ref(point))?;
        self.say(point, done, done + remaining);
        self.manifest.points = done;
        // Many points that shards have solved come at once: that some of them are told of is enough.
        let is_soon = self
            .told
            .is_some_and(|told| told.elapsed() < BETWEEN_MANIFESTS);
        if is_of_shard && is_soon {
            return Ok(());
        }
        self.told = Some(Instant::now());
        Ok(self.run.write_progress(&self.manifest)?)
    }

    fn closer_look(&mut self, [lower, upper]: [f64; 2]) {
        let parameter = self.sweep.problem.family().parameter();
        self.context.say(&format!(
            "looking closer from {parameter} = {lower:.6} to {upper:.6}, on finer cells"
        ));
    }

    fn known_points(&mut self) -> Vec<Point> {
        let points = std::mem::take(&mut self.known.points);
        let is_left = |point: &&Point| point.detections.is_empty() && !point.densities.is_empty();
        let left = points.iter().filter(is_left).count();
        if left > 0 {
            let all = points.len();
            let words = format!("detecting in {left} of {all} values that shards have solved");
            self.context.say(&words);
        }
        points
    }

    fn known_checks(&mut self) -> Vec<CheckedIndicator> {
        self.known.checks.take().unwrap_or_default()
    }
}
