//! A map of regimes, in one piece, of its shards, or a shard of it.

use super::{Context, Job, JobError, Outcome, Progress};
use crate::continuation::curve::Curve;
use crate::continuation::map::{MapMaker, MapProgress, MapShard, RegimeMap};
use crate::continuation::{DensitySource, Shard, SourceError, SweepError};
use crate::figure::{Figure, Figures};
use crate::run::{JobFolder, JournalledSource, Layout, RunError, map_files, map_shard_file};
use crate::sweep_file::{Diagnostic, Report, Sweep};

/// The map of regimes that a sweep file asks for.
pub struct MapJob<'a> {
    sweep: &'a Sweep,
    /// What its shards have found, where it is made of them.
    shards: Option<&'a [MapShard]>,
}

impl<'a> MapJob<'a> {
    /// The map in one piece.
    pub fn new(sweep: &'a Sweep) -> Self {
        let shards = None;
        Self { sweep, shards }
    }

    /// The map of its shards.
    pub(crate) fn merged(sweep: &'a Sweep, shards: &'a [MapShard]) -> Self {
        let shards = Some(shards);
        Self { sweep, shards }
    }
}

impl Job for MapJob<'_> {
    type Found = RegimeMap;
    const LAYOUT: Layout = Layout::MAP;

    fn sweep(&self) -> &Sweep {
        self.sweep
    }

    fn solve(
        &mut self,
        folder: &JobFolder,
        goes_on: bool,
        context: &Context<'_>,
    ) -> Result<Option<RegimeMap>, JobError> {
        let wanted = |maker: &MapMaker<'_>| match self.shards {
            Some(shards) => maker.merged(shards).map(Some),
            None => maker.whole().map(Some),
        };
        let map = make(self, (folder, goes_on), context, &wanted)?;
        Ok(map.filter(|map| !map.nodes.is_empty()))
    }

    fn outcome(&self, found: &RegimeMap) -> Outcome {
        let locate = &self.sweep.settings.locate;
        let is_met = |curve: &Curve| {
            let mut points = curve.points.iter();
            points.all(|point| locate.is_met_by(point.status()))
        };
        let is_complete = found.nodes.iter().all(|node| node.status.is_resolved())
            && found.nodes_with_wide_cells() == 0
            && found.untraced.is_empty()
            && found.curves.iter().all(is_met);
        Outcome::of(found.interrupted, is_complete)
    }

    fn files(&self, found: &RegimeMap, seconds: f64) -> Result<Vec<(String, String)>, RunError> {
        map_files(found, &self.made_of(), seconds)
    }

    fn figures(&self, found: &RegimeMap, _: &Context<'_>) -> Vec<Figure> {
        let settings = &self.sweep.settings;
        Figures::of_map(found, &[], &settings.title)
            .solved_by(settings.method.kind.name(), self.sweep.problem.watched())
            .carried_by(
                self.sweep.problem.family(),
                self.sweep.problem.space().axes(),
            )
            .with_style(&settings.figures.style)
            .draw_all()
    }
}

/// A shard of a map.
pub(crate) struct MapShardJob<'a> {
    sweep: &'a Sweep,
    shard: Shard,
}

impl<'a> MapShardJob<'a> {
    /// A shard of the map that a sweep file asks for.
    ///
    /// # Errors
    /// A report where there are more shards than steps between values of the second parameter.
    pub(crate) fn new(sweep: &'a Sweep, shard: Shard) -> Result<Self, Report> {
        let along = ": a map is cut along its second parameter";
        check_shard(shard, rows(sweep), ("map.points", along))?;
        Ok(Self { sweep, shard })
    }
}

impl Job for MapShardJob<'_> {
    type Found = MapShard;
    const LAYOUT: Layout = Layout::MAP_SHARD;

    fn sweep(&self) -> &Sweep {
        self.sweep
    }

    fn solve(
        &mut self,
        folder: &JobFolder,
        goes_on: bool,
        context: &Context<'_>,
    ) -> Result<Option<MapShard>, JobError> {
        make(self, (folder, goes_on), context, &|maker| {
            maker.shard(self.shard)
        })
    }

    fn outcome(&self, found: &MapShard) -> Outcome {
        Outcome::of(found.interrupted, true)
    }

    fn files(&self, found: &MapShard, _: f64) -> Result<Vec<(String, String)>, RunError> {
        // What an interrupted shard has solved is kept elsewhere.
        if found.interrupted {
            return Ok(Vec::new());
        }
        Ok(vec![map_shard_file(&self.made_of(), found)?])
    }

    fn figures(&self, _: &MapShard, _: &Context<'_>) -> Vec<Figure> {
        Vec::new()
    }
}

/// Values of the second parameter.
fn rows(sweep: &Sweep) -> usize {
    sweep.settings.map.as_ref().map_or(1, |map| map.points)
}

/// Refuses a shard of what has not so many steps; `key` is that of its values.
pub(super) fn check_shard(
    shard: Shard,
    points: usize,
    (key, along): (&str, &str),
) -> Result<(), Report> {
    if shard.places(points).is_some() {
        return Ok(());
    }
    let (shards, steps) = (shard.of(), points.saturating_sub(1));
    let found = Diagnostic::new(SweepError::Shards { shards, steps }.to_string())
        .allowed(format!("`--shard K/N` with N from 1 to {steps}{along}"))
        .remedy(format!("give fewer shards, or raise `{key}`"));
    Err(found.into())
}

/// What is wanted of a map; `None` where it was interrupted before there was anything. What is in the journal is not
/// solved again.
fn make<T>(
    job: &impl Job,
    (folder, goes_on): (&JobFolder, bool),
    context: &Context<'_>,
    wanted: &dyn Fn(&MapMaker<'_>) -> Result<Option<T>, SourceError>,
) -> Result<Option<T>, JobError> {
    let (sweep, journal) = (job.sweep(), folder.journal(&job.made_of(), goes_on)?);
    let solves = journal.solves();
    if solves > 0 {
        context.say(&format!("going on after {solves} solves"));
    }
    let map = sweep.settings.map.as_ref();
    let second = map.map_or("", |map| map.parameter.as_str());
    let first = sweep.problem.family().parameter();
    let at = |values: [f64; 2]| format!("{first} = {:.6}  {second} = {:.6}", values[0], values[1]);
    let observer = |progress: &MapProgress<'_>| match *progress {
        MapProgress::Solved { node, done, wanted } => {
            let words: Vec<String> = node.signatures.iter().map(ToString::to_string).collect();
            let words = &format!("{}  {}", at(node.values), words.join(", "));
            (context.observer)(&Progress::Done {
                words,
                done,
                wanted,
            });
        }
        MapProgress::Met { values, done } => {
            context.say(&format!("curves: {done} points, {}", at(values)));
        }
    };
    let wrap =
        |source| -> Box<dyn DensitySource> { Box::new(JournalledSource::new(source, &journal)) };
    let found = sweep.make_map(&wrap, context.cancellation, &observer, wanted);
    if let Some(error) = journal.failure() {
        return Err(error.into());
    }
    match found {
        Err(SourceError::Interrupted) => Ok(None),
        Err(SourceError::Method(error)) => {
            let title = format!("the box of the map has a corner that is not allowed: {error}");
            let report = Diagnostic::new(title)
                .remedy("narrow it with `sweep.from`, `sweep.to`, `map.from` and `map.to`");
            Err(Report::from(report).into())
        }
        Ok(found) => Ok(found),
    }
}
