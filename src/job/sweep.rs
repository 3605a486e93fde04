//! A sweep, a shard of it, or what its shards have left open. Its tables grow while it is solved.

mod recorder;

use std::path::Path;

use super::{Context, Job, JobError, Outcome, Start};
use crate::continuation::{
    DensitySource, LocateOptions, Point, Shard, SourceError, SweepError, SweepResult, detect_again,
    sweep_shard,
};
use crate::figure::{Figure, Figures};
use crate::run::{
    Ending, Gathered, JobFolder, JournalledSource, Layout, Manifest, PhaseSeconds, RunError,
    RunFolder, StoredRun, looks_file, sweep_files, warnings_of_points,
};
use crate::sweep_file::{Report, Sweep};
use recorder::Recorder;

/// Points of an interrupted sweep up to which its densities are stored, summed and drawn.
pub(crate) const QUICK_POINTS: usize = 200;

/// A sweep that is to be run.
pub struct SweepJob<'a> {
    sweep: &'a Sweep,
    part: Part,
    source: Option<Box<dyn DensitySource>>,
    /// The folder and the manifest of a sweep that has begun.
    begun: Option<(RunFolder, Manifest)>,
    /// Points that are stored.
    kept: usize,
}

/// What is run of a sweep.
enum Part {
    Whole,
    Shard(Shard),
    /// What so many shards have left open.
    Merged(usize, Gathered),
    /// What there is of so many shards, some of which are missing: nothing is solved.
    Gathered(usize, Gathered),
}

impl<'a> SweepJob<'a> {
    /// All of a sweep.
    pub fn new(sweep: &'a Sweep) -> Self {
        Self::of(sweep, Part::Whole)
    }

    /// A shard of a sweep.
    ///
    /// # Errors
    /// A report where the sweep has not so many steps.
    pub fn shard(sweep: &'a Sweep, shard: Shard) -> Result<Self, Report> {
        let points = sweep.settings.points;
        super::map::check_shard(shard, points, ("sweep.points", ""))?;
        Ok(Self::of(sweep, Part::Shard(shard)))
    }

    /// The whole sweep of which so many shards have solved this; it solves what they have left open.
    pub(crate) fn merged(sweep: &'a Sweep, shards: usize, gathered: Gathered) -> Self {
        Self::of(sweep, Part::Merged(shards, gathered))
    }

    /// The same without solving, as an unfinished sweep.
    pub(crate) fn gathered(sweep: &'a Sweep, shards: usize, gathered: Gathered) -> Self {
        Self::of(sweep, Part::Gathered(shards, gathered))
    }

    fn of(sweep: &'a Sweep, part: Part) -> Self {
        Self {
            sweep,
            part,
            source: None,
            begun: None,
            kept: 0,
        }
    }

    /// Which shard it is; `None` of a whole sweep.
    pub(crate) fn number(&self) -> Option<Shard> {
        match self.part {
            Part::Shard(shard) => Some(shard),
            _ => None,
        }
    }

    fn manifest(&self) -> Result<Manifest, RunError> {
        let settings = &self.sweep.settings;
        let seed = settings.method.chosen().seed();
        let threads = rayon::current_num_threads();
        let mut manifest = Manifest::start(&self.sweep.to_toml(), settings.typed(), seed, threads)?;
        manifest.shard = self.number().map(|shard| shard.to_string());
        manifest.merged = match self.part {
            Part::Merged(of, _) | Part::Gathered(of, _) => Some(of),
            _ => None,
        };
        Ok(manifest)
    }

    fn detect_again(&self, gathered: Gathered) -> SweepResult {
        let sweep = self.sweep;
        let swept = (sweep.problem.subject().clone(), sweep.settings.points);
        let Gathered { points, checks, .. } = gathered;
        let (detector, locate) = (sweep.detector(), &sweep.settings.locate);
        let mut result = detect_again(swept, &detector, points, (checks, Vec::new()), locate);
        result.interrupted = true;
        result
    }
}

impl Job for SweepJob<'_> {
    type Found = SweepResult;
    const LAYOUT: Layout = Layout::SWEEP;

    fn sweep(&self) -> &Sweep {
        self.sweep
    }

    fn start(&self, home: &Path) -> Result<Start, RunError> {
        let run = match StoredRun::open(home) {
            Err(RunError::NotARun { .. }) => return Ok(Start::Anew),
            run => run?,
        };
        let path = || home.to_owned();
        let same = run.check_sweep(&self.sweep.to_toml());
        if let Part::Merged(of, gathered) | Part::Gathered(of, gathered) = &self.part {
            let is_ours = run.merged() == Some(*of) && same.is_ok();
            let goes_on = is_ours && run.can_go_on() && gathered.holders.are_those_of(home)?;
            return Ok(match run.ending() {
                Ending::Complete if is_ours => Start::Complete,
                _ if goes_on => Start::GoOn,
                _ => Start::Anew,
            });
        }
        same?;
        if run.shard() != self.number() {
            return Err(RunError::OtherShard { path: path() });
        }
        if run.can_go_on() && run.merged().is_some() {
            return Err(RunError::BeingMerged { path: path() });
        }
        Ok(match run.ending() {
            Ending::Complete => Start::Complete,
            _ => Start::GoOn,
        })
    }

    fn plan(&mut self, context: &Context<'_>) -> Result<bool, JobError> {
        if matches!(self.part, Part::Gathered(..)) {
            return Ok(true);
        }
        let (source, words) = match self.sweep.described_source(context.cancellation) {
            Err(SourceError::Interrupted) => return Ok(false),
            source => source?,
        };
        let cells = self.sweep.problem.space().n_cells();
        context.say(&format!(
            "{words}, {cells} cells{}",
            self.sweep.long_factorisation()
        ));
        self.source = Some(source);
        Ok(true)
    }

    fn solve(
        &mut self,
        folder: &JobFolder,
        goes_on: bool,
        context: &Context<'_>,
    ) -> Result<Option<SweepResult>, JobError> {
        let manifest = self.manifest()?;
        let run = RunFolder::at(folder.home());
        if !goes_on {
            run.write_manifest(&manifest)?;
        }
        let Some(source) = self.source.take() else {
            let gathered = match &mut self.part {
                Part::Gathered(_, gathered) => std::mem::take(gathered),
                _ => Gathered::default(),
            };
            self.begun = Some((run, manifest));
            return Ok(Some(self.detect_again(gathered)));
        };
        let journal = folder.journal(&self.made_of(), goes_on)?;
        if goes_on {
            let points = StoredRun::open(folder.home())?.points_done().unwrap_or(0);
            context.say(&format!("{points} points are done already"));
        }
        let merged = match &mut self.part {
            Part::Merged(_, gathered) => Some(std::mem::take(gathered)),
            _ => None,
        };
        let is_merged = merged.is_some();
        let known = merged.unwrap_or_default();
        known.holders.tell(&journal)?;
        let source = JournalledSource::of_sweep(source, &journal);
        let mut recorder = Recorder {
            sweep: self.sweep,
            folder,
            run,
            manifest,
            context,
            known,
            journal: &journal,
            missing: journal.points(),
            told: None,
            held: Vec::new(),
            source: &source,
        };
        let shard = self.number().unwrap_or(Shard::WHOLE);
        let settings = &self.sweep.settings;
        let swept = sweep_shard(
            &source,
            &self.sweep.detector(),
            (settings.points, shard),
            &settings.locate,
            context.cancellation,
            &mut recorder,
        );
        self.kept = recorder.run.points().max(journal.solves());
        let result = swept.map_err(JobError::from)?;
        if let Some(error) = journal.failure() {
            return Err(error.into());
        }
        // What is stored was not read to its end: it stays as it is.
        if result.interrupted && recorder.missing > 0 {
            return Ok(None);
        }
        recorder.write_held()?;
        self.begun = Some((recorder.run, recorder.manifest));
        if is_merged {
            let solves = source.solves();
            context.say(&format!("{solves} values were solved that no shard has"));
        }
        Ok(Some(result))
    }

    fn kept(&self) -> usize {
        self.kept
    }

    fn outcome(&self, found: &SweepResult) -> Outcome {
        // Rows are the business of the whole, where neighbours on both sides are known.
        match (self.number(), found.interrupted) {
            (Some(_), false) => Outcome::Complete,
            _ => sweep_outcome(found, &self.sweep.settings.locate),
        }
    }

    fn files(&self, found: &SweepResult, _: f64) -> Result<Vec<(String, String)>, RunError> {
        let looks = looks_file(&found.looks, &self.sweep.to_toml())?;
        Ok(sweep_files(found)?.into_iter().chain(looks).collect())
    }

    fn figures(&self, found: &SweepResult, context: &Context<'_>) -> Vec<Figure> {
        // Those of a shard are those of the whole.
        match self.number() {
            Some(_) => Vec::new(),
            None => {
                context.say("drawing");
                draw_sweep(self.sweep, found)
            }
        }
    }

    fn write(&mut self, found: &SweepResult, folder: &JobFolder, _: f64) -> Result<(), RunError> {
        folder.check()?;
        let has_time = self.has_time(found);
        let is_shard = self.number().is_some() && !found.interrupted;
        match &mut self.begun {
            Some((run, _)) if has_time => {
                folder.add_sums(run.finish(found, &self.sweep.to_toml())?);
                if is_shard {
                    folder.add_sums(run.write_detections(&found.points)?);
                }
                Ok(())
            }
            Some((run, _)) => run.break_off(found, &self.sweep.to_toml()),
            None => Ok(()),
        }
    }

    fn has_time(&self, found: &SweepResult) -> bool {
        let is_stopped = found.interrupted && !matches!(self.part, Part::Gathered(..));
        !is_stopped || found.points.len() <= QUICK_POINTS
    }

    fn seal(&mut self, found: &SweepResult, seconds: PhaseSeconds) -> Result<(), RunError> {
        let Some((run, mut manifest)) = self.begun.take() else {
            return Ok(());
        };
        manifest.seconds = seconds;
        manifest.points = found.points.len();
        manifest.largest_distance = found.largest_distance();
        manifest.warnings = warnings_of_points(self.sweep.problem.family(), &found.points);
        manifest.ending = self.outcome(found).ending();
        manifest.made.end();
        run.write_manifest(&manifest)
    }
}

impl From<SweepError> for JobError {
    fn from(error: SweepError) -> Self {
        match error {
            // What is solved could not be kept.
            SweepError::Observer(error) => match error.downcast::<RunError>() {
                Ok(error) => Self::Run(*error),
                Err(error) => Self::Sweep(SweepError::Observer(error)),
            },
            error => Self::Sweep(error),
        }
    }
}

/// The figures of a sweep that its file names.
pub(crate) fn draw_sweep(sweep: &Sweep, found: &SweepResult) -> Vec<Figure> {
    let settings = &sweep.settings;
    Figures::of_sweep(found, &settings.title, &settings.figures.at)
        .carried_by(sweep.problem.family(), sweep.problem.space().axes())
        .with_style(&settings.figures.style)
        .draw_named(settings.figures.names())
}

/// How a sweep ended that has found this.
pub(crate) fn sweep_outcome(found: &SweepResult, locate: &LocateOptions) -> Outcome {
    let mut points = found.points.iter();
    let mut statuses = found.labels.iter().filter_map(|row| row.status());
    let is_complete = points.all(Point::is_sound)
        && statuses.all(|status| locate.is_met_by(status))
        && found.miscounted().is_empty()
        && found.undecided().is_empty()
        && found.coarse().is_empty();
    Outcome::of(found.interrupted, is_complete)
}
