//! `pbif sweep`: solves along the parameter, writes every row as it comes, then the tables and the figures.

pub(super) mod summary;

use std::path::Path;

use super::args::SweepArguments;
use super::jobs::{self, Printed};
use super::stored::Stored;
use super::{CommandError, curve};
use crate::continuation::{Shard, SweepResult};
use crate::job::{
    Done, Job as _, MapJob, MapShardJob, Outcome, SweepJob, check_curves, sweep_outcome,
};
use crate::run::{format_number, shard_folder, warnings_of_points};
use crate::sweep_file::Sweep;

/// Runs a sweep or a map, whole or a shard of it, or goes on with it, and prints what it found.
///
/// # Errors
/// [`CommandError`] when the results cannot be written or the threads not be made; failed points are data.
pub(super) fn run(
    spec: &Sweep,
    name: &str,
    arguments: &SweepArguments,
) -> Result<Outcome, CommandError> {
    let default = || Path::new("output").join(name);
    let home = &arguments.out.clone().unwrap_or_else(default);
    let (resume, work) = (arguments.resume, &arguments.work);
    if let Some(shard) = arguments.shard {
        let folder = shard_folder(home, shard);
        return if spec.settings.map.is_some() {
            jobs::run(MapShardJob::new(spec, shard)?, &folder, resume, work)
        } else {
            // Curves are those of the whole sweep.
            jobs::run(SweepJob::shard(spec, shard)?, &folder, resume, work)
        };
    }
    if spec.settings.map.is_some() {
        return jobs::run(MapJob::new(spec), home, resume, work);
    }
    check_curves(spec)?;
    let outcome = jobs::run(SweepJob::new(spec), home, resume, work)?;
    curve::after_sweep(spec, home, (work, resume), outcome)
}

impl Printed for SweepJob<'_> {
    fn planned(&self) -> Option<usize> {
        Some(self.sweep().settings.points)
    }

    fn text(&self, done: &Done<SweepResult>, home: &Path) -> String {
        match self.number() {
            Some(shard) => of_shard(&done.found, shard, home),
            None => summary::text(&done.found, home),
        }
    }

    fn complete(&self, home: &Path) -> Result<(String, Outcome), CommandError> {
        let Stored { spec, result, .. } = Stored::read(home, &[], &[], true)?;
        let done = home.display();
        let done = format!("the run in {done} is complete: nothing was solved\n");
        Ok(match self.number() {
            Some(shard) => (done + &of_shard(&result, shard, home), Outcome::Complete),
            None => {
                let outcome = sweep_outcome(&result, &spec.settings.locate);
                (done + &summary::text(&result, home), outcome)
            }
        })
    }

    fn kept_in_words(&self) -> String {
        format!("{} points that were done are kept", self.kept())
    }

    fn warnings(&self, found: &SweepResult) -> Vec<String> {
        warnings_of_points(self.sweep().problem.family(), &found.points)
    }
}

/// What a shard has solved.
fn of_shard(result: &SweepResult, shard: Shard, path: &Path) -> String {
    let family = &result.subject.family;
    let points = result.points.len();
    let mut what = format!("{points} points");
    if let (Some(first), Some(last)) = (result.points.first(), result.points.last()) {
        let ends = [first, last].map(|point| format_number(point.value));
        what += &format!(", {} from {} to {}", family.parameter(), ends[0], ends[1]);
    }
    shard_in_words(shard, &format!(": {what}"), (result.interrupted, path))
}

/// What is said of a shard that has ended.
pub(super) fn shard_in_words(
    shard: Shard,
    what: &str,
    (interrupted, path): (bool, &Path),
) -> String {
    let (number, of) = (shard.number(), shard.of());
    let home = path.ancestors().nth(2).unwrap_or(path).display();
    let next = if interrupted {
        "interrupted: the same command with `--resume` goes on".to_owned()
    } else {
        format!("`pbif merge {home}` puts all {of} together when they are done")
    };
    let path = path.display();
    format!("shard {number} of {of}{what}, in {path}\n{next}\n")
}
