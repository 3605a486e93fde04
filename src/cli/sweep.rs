//! `pbif sweep`: solves along the parameter, writes every row as it comes, then the tables and the figures.

pub(super) mod progress;
pub(super) mod summary;

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::SweepArguments;
use super::output::OutputFolder;
use super::{CommandError, Outcome, warnings};
use crate::cancellation::Cancellation;
use crate::continuation::{
    BifurcationStatus, Observer, Point, Subject, SweepError, SweepResult, sweep,
};
use crate::figure::{Figures, write_figures};
use crate::method::{MethodError, MethodSource};
use crate::run::{Ending, Manifest, RunError, RunFolder};
use crate::sweep_file::Sweep;
use progress::Progress;

/// Runs a sweep and prints what it found.
///
/// # Errors
/// [`CommandError`] when the results cannot be written or the threads not be made; failed points are data.
pub(super) fn run(
    spec: &Sweep,
    name: &str,
    arguments: &SweepArguments,
) -> Result<Outcome, CommandError> {
    let output = OutputFolder::prepare(&output_path(name, arguments.out.as_deref()))?;
    let (threads, cancellation) = super::interruptible(arguments.threads)?;
    let path = output.path().to_owned();
    let prepared = threads.install(|| Run::new(spec, &path, arguments.quiet, cancellation));
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
    source: MethodSource,
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
        cancellation: Cancellation,
    ) -> Result<Self, CommandError> {
        let progress = Progress::new(spec.settings.points, quiet);
        let source = spec.source(&cancellation)?;
        let cells = spec.problem.space().n_cells();
        progress.say(&format!("{}, {cells} cells", source.describe()));
        let resolved = spec.to_toml();
        let threads = rayon::current_num_threads();
        let manifest = Manifest::start(&resolved, spec.settings.method.chosen().seed(), threads)?;
        let folder = RunFolder::create(path)?;
        folder
            .write_manifest(&manifest)
            .map_err(|error| CommandError::from(error).after(written(path, 0)))?;
        Ok(Self {
            spec,
            source,
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
        let result = result.map_err(|error| error.after(written(path, self.folder.points())))?;
        if !self.quiet {
            self.progress.warn(&self.manifest.warnings);
        }
        super::conclude(&summary::text(&result, path), outcome(&result), path)
    }

    fn solve_and_write(&mut self) -> Result<SweepResult, CommandError> {
        let clock = Instant::now();
        let result = self.sweep()?;
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
        Ok(result)
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
            progress: &self.progress,
        };
        sweep(
            &self.source,
            &detector,
            self.spec.settings.points,
            &self.spec.settings.locate,
            &self.cancellation,
            &mut recorder,
        )
        .map_err(
            |SweepError::Observer(error)| match error.downcast::<RunError>() {
                Ok(error) => CommandError::Run(*error),
                Err(error) => CommandError::Sweep(SweepError::Observer(error)),
            },
        )
    }
}

/// What there is in a folder whose run did not come to its end.
fn written(folder: &Path, points: usize) -> String {
    let folder = folder.display();
    match points {
        0 => format!("no point was done; {folder} holds run.json alone"),
        points => format!("{points} points that were done are kept in {folder}"),
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
    let figures = Figures::of_sweep(result, &spec.settings.title, &spec.settings.figures_at);
    Ok(write_figures(
        &figures.draw_all()?,
        &spec.settings.figure_formats,
        folder,
    )?)
}

/// Writes every point as soon as it is done, and shows how far the sweep is.
struct Recorder<'a> {
    subject: &'a Subject,
    folder: &'a mut RunFolder,
    progress: &'a Progress,
}

impl Observer for Recorder<'_> {
    fn point(
        &mut self,
        point: &Point,
        done: usize,
        remaining: usize,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        self.folder.add_point(self.subject, point)?;
        self.progress.point(self.subject, point, done, remaining);
        Ok(())
    }
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
