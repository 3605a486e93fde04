//! `pbif sweep`: solves along the parameter, writes every row as it comes, then the tables and the figures.

pub(super) mod progress;
mod recorder;
pub(super) mod resume;
mod shards;
pub(super) mod summary;

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::SweepArguments;
use super::output::OutputFolder;
use super::{CommandError, Outcome, curve, warnings};
use crate::cancellation::Cancellation;
use crate::continuation::{
    BifurcationStatus, CheckedIndicator, LocateOptions, Shard, SweepError, SweepResult, sweep_shard,
};
use crate::figure::{Figures, write_figures};
use crate::method::MethodError;
use crate::run::{
    Ending, Gathered, Journal, JournalledSource, Manifest, RunError, RunFolder, StoredRun,
    shard_folder,
};
use crate::sweep_file::Sweep;
use progress::Progress;
use recorder::Recorder;
use resume::Begin;

/// Runs a sweep or a shard of it, or goes on with it, and prints what it found.
///
/// # Errors
/// [`CommandError`] when the results cannot be written or the threads not be made; failed points are data.
pub(super) fn run(
    spec: &Sweep,
    name: &str,
    arguments: &SweepArguments,
) -> Result<Outcome, CommandError> {
    let home = output_path(name, arguments.out.as_deref());
    if spec.settings.map.is_some() {
        return super::map::run(spec, &home, arguments);
    }
    let shard = arguments.shard;
    let path = match shard {
        Some(shard) => {
            shards::check(spec, shard)?;
            shard_folder(&home, shard)
        }
        None => home.clone(),
    };
    let output = OutputFolder::prepare(&path)?;
    curve::check(spec)?;
    let begin = match arguments.resume {
        true => resume::begin(spec, output.path(), shard)?,
        false => Begin::Anew,
    };
    let kind = match shard {
        Some(shard) => Kind::Shard(shard, home),
        None => Kind::Whole,
    };
    let (path, quiet) = (output.path(), arguments.work.quiet);
    let (is_whole, how) = (shard.is_none(), (&arguments.work, arguments.resume));
    let follow = |outcome| match is_whole {
        true => curve::after_sweep(spec, path, how, outcome),
        // Curves are those of the whole sweep.
        false => Ok(outcome),
    };
    if let Begin::Done(stored) = begin {
        return follow(resume::show(&stored, path, &kind)?);
    }
    let task = Task {
        spec,
        path,
        kind,
        quiet,
    };
    follow(task.carry_out(begin, arguments.work.threads)?)
}

/// The folder the results go to: as asked for, or `output/` and the name of the sweep file.
fn output_path(name: &str, out: Option<&Path>) -> PathBuf {
    out.map_or_else(|| Path::new("output").join(name), Path::to_owned)
}

/// What is run of a sweep.
pub(super) enum Kind {
    /// All of it.
    Whole,
    /// A shard of that in a folder.
    Shard(Shard, PathBuf),
    /// What so many shards have left open.
    Merged(usize, Gathered),
}

/// A sweep that is to be run.
pub(super) struct Task<'a> {
    pub(super) spec: &'a Sweep,
    /// The folder of the run, which is there.
    pub(super) path: &'a Path,
    pub(super) kind: Kind,
    pub(super) quiet: bool,
}

impl Task<'_> {
    /// Runs it on so many threads (`None`: one a core).
    ///
    /// # Errors
    /// As [`run`].
    pub(super) fn carry_out(
        self,
        begin: Begin,
        threads: Option<usize>,
    ) -> Result<Outcome, CommandError> {
        let (threads, cancellation) = super::interruptible(threads)?;
        match threads.install(|| Run::new(self, &begin, cancellation)) {
            Err(CommandError::Method(MethodError::Cancelled(_))) => {
                super::print("interrupted: nothing was written\n")?;
                Ok(Outcome::Interrupted)
            }
            prepared => threads.install(|| prepared?.carry_out()),
        }
    }
}

struct Run<'a> {
    spec: &'a Sweep,
    /// `None` of a whole sweep.
    shard: Option<(Shard, PathBuf)>,
    source: JournalledSource,
    journal: Journal,
    /// What shards saw in their checks; `None` where none are put together.
    merged: Option<Vec<CheckedIndicator>>,
    folder: RunFolder,
    manifest: Manifest,
    progress: Progress,
    quiet: bool,
    cancellation: Cancellation,
}

impl<'a> Run<'a> {
    fn new(
        task: Task<'a>,
        begin: &Begin,
        cancellation: Cancellation,
    ) -> Result<Self, CommandError> {
        let Task {
            spec,
            path,
            kind,
            quiet,
        } = task;
        let progress = Progress::new(spec.settings.points, quiet);
        let source = spec.source(&cancellation)?;
        let cells = spec.problem.space().n_cells();
        progress.say(&format!("{}, {cells} cells", source.describe()));
        let resolved = spec.to_toml();
        let threads = rayon::current_num_threads();
        let mut manifest = Manifest::start(
            &resolved,
            spec.settings.typed(),
            spec.settings.method.chosen().seed(),
            threads,
        )?;
        if let Kind::Shard(shard, _) = &kind {
            manifest.shard = Some(shard.to_string());
        }
        if let Kind::Merged(of, _) = &kind {
            manifest.merged = Some(*of);
        }
        let goes_on = matches!(begin, Begin::GoOn);
        let folder = match goes_on {
            true => RunFolder::reopen(path)?,
            false => RunFolder::create(path)?,
        };
        let journal = match goes_on {
            true => Journal::open(&folder.journal(), &resolved)?,
            false => folder
                .write_manifest(&manifest)
                .and_then(|()| Journal::create(&folder.journal(), &resolved))
                .map_err(|error| CommandError::from(error).after(written(path, 0)))?,
        };
        if goes_on {
            let points = StoredRun::open(path)?.points_done().unwrap_or(0);
            progress.say(&format!("{points} points are done already"));
        }
        let (shard, merged) = match kind {
            Kind::Whole => (None, None),
            Kind::Shard(number, home) => (Some((number, home)), None),
            Kind::Merged(_, gathered) => (None, Some(gathered)),
        };
        let (points, merged) = match merged {
            Some(Gathered { points, checks }) => (points, Some(checks.unwrap_or_default())),
            None => (Vec::new(), None),
        };
        let source = JournalledSource::of_sweep(Box::new(source), &journal, points);
        Ok(Self {
            spec,
            shard,
            source,
            journal,
            merged,
            folder,
            manifest,
            progress,
            quiet,
            cancellation,
        })
    }

    /// Does everything; what went wrong on the way comes with what there is all the same.
    fn carry_out(mut self) -> Result<Outcome, CommandError> {
        self.say_what_is_kept();
        let result = self.solve_and_write();
        self.progress.finish();
        let path = self.folder.path();
        let points = self.folder.points().max(self.journal.solves());
        let Some(result) = result.map_err(|error| error.after(written(path, points)))? else {
            super::print("interrupted: everything is as it was\n")?;
            return Ok(Outcome::Interrupted);
        };
        if !self.quiet {
            self.progress.warn(&self.manifest.warnings);
        }
        if let Some((shard, home)) = &self.shard {
            let (text, outcome) = shards::told(&result, (*shard, home), path);
            return super::conclude(&text, outcome, path);
        }
        super::conclude(
            &summary::text(&result, path),
            outcome(&result, &self.spec.settings.locate),
            path,
        )
    }

    /// `None` where an interrupt came before what is stored was read.
    fn solve_and_write(&mut self) -> Result<Option<SweepResult>, CommandError> {
        let clock = Instant::now();
        let Some(result) = self.sweep()? else {
            return Ok(None);
        };
        self.manifest.seconds.sweep = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        self.folder.finish(&result)?;
        self.manifest.seconds.tables = clock.elapsed().as_secs_f64();
        // The figures of a shard are those of the whole.
        if self.shard.is_none() {
            let clock = Instant::now();
            self.progress.say("drawing");
            draw(self.spec, &result, &self.folder.figures())?;
            self.manifest.seconds.figures = clock.elapsed().as_secs_f64();
        }
        self.manifest.points = result.points.len();
        self.manifest.largest_distance = result.largest_distance();
        self.manifest.warnings = warnings::of_points(self.spec.problem.family(), &result.points);
        self.manifest.ending = if result.interrupted {
            Ending::Interrupted
        } else {
            Ending::Complete
        };
        self.manifest.made.end();
        self.folder.write_manifest(&self.manifest)?;
        self.folder.seal()?;
        if !result.interrupted {
            self.folder.close_journal()?;
        }
        Ok(Some(result))
    }

    fn say_what_is_kept(&self) {
        if let Some(kept) = self.folder.kept() {
            let kept = kept.display();
            self.progress
                .say(&format!("the earlier run is kept in {kept}"));
        }
    }

    /// `None` as in [`Run::solve_and_write`].
    fn sweep(&mut self) -> Result<Option<SweepResult>, CommandError> {
        let detector = self.spec.detector();
        let mut recorder = Recorder {
            subject: self.spec.problem.subject(),
            folder: &mut self.folder,
            manifest: &mut self.manifest,
            progress: &self.progress,
            checks: self.merged.clone().unwrap_or_default(),
            given: Vec::new(),
            source: &self.source,
        };
        let shard = self
            .shard
            .as_ref()
            .map_or(Shard::WHOLE, |(shard, _)| *shard);
        let result = sweep_shard(
            &self.source,
            &detector,
            (self.spec.settings.points, shard),
            &self.spec.settings.locate,
            &self.cancellation,
            &mut recorder,
        )
        .map_err(|error| match error {
            SweepError::Observer(error) => match error.downcast::<RunError>() {
                Ok(error) => CommandError::Run(*error),
                Err(error) => CommandError::Sweep(SweepError::Observer(error)),
            },
            error => CommandError::Sweep(error),
        })?;
        if let Some(error) = self.journal.failure() {
            return Err(error.into());
        }
        if result.interrupted && !recorder.given.is_empty() {
            return Ok(None);
        }
        recorder.write_given()?;
        if self.merged.is_some() {
            let solves = self.source.solves();
            self.progress
                .say(&format!("{solves} values were solved that no shard has"));
        }
        Ok(Some(result))
    }
}

/// What there is in a folder whose run did not come to its end.
fn written(folder: &Path, points: usize) -> String {
    let folder = folder.display();
    match points {
        0 => format!("no point was done; {folder} holds no results"),
        points => format!(
            "{points} points that were done are kept in {folder}, and `pbif sweep` with `--resume` goes on from there"
        ),
    }
}

/// Draws the figures of a sweep into a folder; returns the files.
///
/// # Errors
/// [`CommandError::Figure`].
pub(super) fn draw(
    spec: &Sweep,
    result: &SweepResult,
    folder: &Path,
) -> Result<Vec<PathBuf>, CommandError> {
    let settings = &spec.settings;
    let figures = Figures::of_sweep(result, &settings.title, &settings.figures.at)
        .with_style(&settings.figures.style);
    let drawn = figures.draw_named(settings.figures.names())?;
    Ok(write_figures(&drawn, &settings.figures.formats, folder)?)
}

/// How a command ends that gives this result.
pub(super) fn outcome(result: &SweepResult, locate: &LocateOptions) -> Outcome {
    let unresolved =
        |status: Option<BifurcationStatus>| status.is_some_and(|status| !locate.is_met_by(status));
    if result.interrupted {
        Outcome::Interrupted
    } else if result
        .points
        .iter()
        .any(|point| !point.report.status.is_resolved())
        || result.labels.iter().any(|row| unresolved(row.status))
    {
        Outcome::Partial
    } else {
        Outcome::Complete
    }
}
