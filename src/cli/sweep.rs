//! `pbif sweep`: solves along the parameter, writes every row as it comes, then the tables and the figures.

pub(super) mod progress;
mod recorder;
mod resume;
pub(super) mod summary;

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::SweepArguments;
use super::output::OutputFolder;
use super::{CommandError, Outcome, warnings};
use crate::cancellation::Cancellation;
use crate::continuation::{BifurcationStatus, SweepError, SweepResult, sweep};
use crate::figure::{Figures, write_figures};
use crate::method::MethodError;
use crate::run::{Ending, Journal, JournalledSource, Manifest, RunError, RunFolder};
use crate::sweep_file::Sweep;
use progress::Progress;
use recorder::Recorder;
use resume::Begin;

/// Runs a sweep, or goes on with it, and prints what it found.
///
/// # Errors
/// [`CommandError`] when the results cannot be written or the threads not be made; failed points are data.
pub(super) fn run(
    spec: &Sweep,
    name: &str,
    arguments: &SweepArguments,
) -> Result<Outcome, CommandError> {
    let output = OutputFolder::prepare(&output_path(name, arguments.out.as_deref()))?;
    let begin = match arguments.resume {
        true => resume::begin(spec, output.path())?,
        false => Begin::Anew,
    };
    if let Begin::Done(stored) = begin {
        return resume::show(&stored, output.path());
    }
    let (threads, cancellation) = super::interruptible(arguments.threads)?;
    let path = output.path().to_owned();
    let quiet = arguments.quiet;
    let prepared = threads.install(|| Run::new(spec, &path, quiet, begin, cancellation));
    match prepared {
        Err(CommandError::Method(MethodError::Cancelled(_))) => {
            super::print("interrupted: nothing was written\n")?;
            Ok(Outcome::Interrupted)
        }
        prepared => threads.install(|| prepared?.carry_out()),
    }
}

/// The folder the results go to: as asked for, or `output/` and the name of the sweep file.
fn output_path(name: &str, out: Option<&Path>) -> PathBuf {
    out.map_or_else(|| Path::new("output").join(name), Path::to_owned)
}

struct Run<'a> {
    spec: &'a Sweep,
    source: JournalledSource,
    folder: RunFolder,
    manifest: Manifest,
    progress: Progress,
    quiet: bool,
    cancellation: Cancellation,
}

impl<'a> Run<'a> {
    fn new(
        spec: &'a Sweep,
        path: &Path,
        quiet: bool,
        begin: Begin,
        cancellation: Cancellation,
    ) -> Result<Self, CommandError> {
        let progress = Progress::new(spec.settings.points, quiet);
        let source = spec.source(&cancellation)?;
        let cells = spec.problem.space().n_cells();
        progress.say(&format!("{}, {cells} cells", source.describe()));
        let resolved = spec.to_toml();
        let threads = rayon::current_num_threads();
        let manifest = Manifest::start(&resolved, spec.settings.method.chosen().seed(), threads)?;
        let goes_on = matches!(begin, Begin::GoOn);
        let folder = match goes_on {
            true => RunFolder::reopen(path)?,
            false => RunFolder::create(path)?,
        };
        let journal = match goes_on {
            true => resume::journal(spec, path)?,
            false => folder
                .write_manifest(&manifest)
                .and_then(|()| Journal::create(path, &resolved))
                .map_err(|error| CommandError::from(error).after(written(path, 0)))?,
        };
        if goes_on {
            progress.say(&format!("{} points are done already", journal.solves()));
        }
        Ok(Self {
            spec,
            source: JournalledSource::new(Box::new(source), journal),
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
        let points = self.folder.points().max(self.source.waiting());
        let Some(result) = result.map_err(|error| error.after(written(path, points)))? else {
            super::print("interrupted: everything is as it was\n")?;
            return Ok(Outcome::Interrupted);
        };
        if !self.quiet {
            self.progress.warn(&self.manifest.warnings);
        }
        super::conclude(&summary::text(&result, path), outcome(&result), path)
    }

    /// `None` where an interrupt came before what is stored was read.
    fn solve_and_write(&mut self) -> Result<Option<SweepResult>, CommandError> {
        let clock = Instant::now();
        let result = self.sweep()?;
        if let Some(error) = self.source.failure() {
            return Err(error.into());
        }
        if result.interrupted && self.source.waiting() > 0 {
            return Ok(None);
        }
        self.manifest.seconds.sweep = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        self.folder.finish(&result)?;
        self.manifest.seconds.tables = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        self.progress.say("drawing");
        draw(self.spec, &result, &self.folder.figures())?;
        self.manifest.seconds.figures = clock.elapsed().as_secs_f64();
        self.manifest.points = result.points.len();
        self.manifest.largest_distance = result.largest_distance();
        self.manifest.warnings = warnings::of_points(self.spec.problem.family(), &result.points);
        self.manifest.ending = if result.interrupted {
            Ending::Interrupted
        } else {
            Ending::Complete
        };
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

    fn sweep(&mut self) -> Result<SweepResult, CommandError> {
        let detector = self.spec.detector();
        let mut recorder = Recorder {
            subject: self.spec.problem.subject(),
            folder: &mut self.folder,
            manifest: &mut self.manifest,
            progress: &self.progress,
            stored: self.source.waiting(),
            given: Vec::new(),
            source: &self.source,
        };
        let mut result = sweep(
            &self.source,
            &detector,
            self.spec.settings.points,
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
        for point in &mut result.points {
            point.seconds = self.source.seconds(point.value).unwrap_or(point.seconds);
        }
        Ok(result)
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
    let figures = Figures::of_sweep(result, &settings.title, &settings.figures_at)
        .with_style(&settings.figure_style);
    let drawn = figures.draw_named(&settings.figures_drawn)?;
    Ok(write_figures(&drawn, &settings.figure_formats, folder)?)
}

/// How a command ends that gives this result.
pub(super) fn outcome(result: &SweepResult) -> Outcome {
    let unresolved = |status: Option<BifurcationStatus>| {
        status.is_some_and(|status| status != BifurcationStatus::Located)
    };
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
