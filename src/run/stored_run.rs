//! A finished run, read back: `run.json`, then its points with their densities.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Deserialize;

use super::checks::read_checks;
use super::manifest::{Typed, hash};
use super::place::{FIGURES, folder_in, read};
use super::placing::finish_after_kill;
use super::point_densities::PointDensities;
use super::points_table::read_points;
use super::sealing::seal_after_kill;
use super::spectra::{CORRELATIONS, SPECTRA, read_fluctuations};
use super::{
    Checked, Ending, Layout, PhaseSeconds, RunError, checksums, journal, kept_detections, looks,
};
use crate::continuation::measure::{MEAN, VELOCITY};
use crate::continuation::{CheckedIndicator, Point, Shard, Subject};
use crate::space::{Axis, CellSpace};
use crate::sweep_file::SweepText;

/// The folder of a run that is read.
#[derive(Debug)]
pub struct StoredRun {
    path: PathBuf,
    resolved: String,
    manifest: StoredManifest,
}

/// What is read of `run.json`.
#[derive(Debug, Deserialize)]
struct StoredManifest {
    program: String,
    version: String,
    sweep: serde_json::Value,
    /// The resolved sweep file as text; runs of early versions have `sweep` alone.
    sweep_file: Option<String>,
    hash: String,
    /// Runs of early versions have only the resolved sweep.
    #[serde(default)]
    typed: Option<Typed>,
    seed: u64,
    threads: usize,
    /// A shard alone, such as `2/4`.
    #[serde(default)]
    shard: Option<String>,
    /// Put together of so many shards.
    #[serde(default)]
    merged: Option<usize>,
    ending: Ending,
    /// Runs of early versions may not say so while they are written.
    points: Option<usize>,
    seconds: PhaseSeconds,
    warnings: Vec<String>,
    /// Runs of early versions do not say by what they were made.
    #[serde(default)]
    made: serde_json::Value,
}

impl StoredRun {
    /// Opens a run and checks that it is one of this program, and that its sweep is the one that was run.
    ///
    /// # Errors
    /// [`RunError::NotARun`], [`RunError::Read`], [`RunError::Manifest`], [`RunError::Version`],
    /// [`RunError::Hash`]; [`RunError::Damaged`] by its checksums.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        finish_after_kill(path);
        let file = path.join("run.json");
        if !file.is_file() {
            return Err(RunError::NotARun {
                path: path.to_owned(),
            });
        }
        let broken = |message: String| RunError::Manifest {
            path: file.clone(),
            message,
        };
        let bytes = read(&file).map_err(RunError::reading(&file))?;
        let manifest: StoredManifest =
            serde_json::from_slice(&bytes).map_err(|error| broken(error.to_string()))?;
        check_version(&file, &manifest)?;
        if manifest
            .typed
            .as_ref()
            .is_some_and(|typed| !typed.is_whole())
        {
            return Err(RunError::Hash { path: file });
        }
        let resolved = match &manifest.sweep_file {
            Some(text) => {
                check_hash(&file, text, &manifest.hash)?;
                text.clone()
            }
            None => toml::to_string(&manifest.sweep).map_err(|error| broken(error.to_string()))?,
        };
        if manifest.ending == Ending::Complete {
            seal_after_kill(path);
        }
        checksums::require(path, &["run.json"])?;
        Ok(Self {
            path: path.to_owned(),
            resolved,
            manifest,
        })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The resolved sweep: every key, as JSON.
    pub fn sweep(&self) -> &serde_json::Value {
        &self.manifest.sweep
    }

    /// Version of the program that made it.
    pub(crate) fn version(&self) -> &str {
        &self.manifest.version
    }

    /// The commit that the program was built from, with `-dirty` where files were changed; `None` where the run does
    /// not say.
    pub(crate) fn commit(&self) -> Option<&str> {
        self.manifest.made["commit"].as_str()
    }

    /// When the run was begun, in UTC (ISO 8601); `None` where it does not say.
    pub(crate) fn started(&self) -> Option<&str> {
        self.manifest.made["started"].as_str()
    }

    /// The sweep file as it was typed, word for word, with what was set on top of it; `None` for runs of early
    /// versions.
    pub(crate) fn typed(&self) -> Option<SweepText> {
        self.manifest.typed.as_ref().map(Typed::text)
    }

    /// The resolved sweep file as TOML.
    pub fn resolved(&self) -> &str {
        &self.resolved
    }

    /// How the run ended.
    pub(crate) fn ending(&self) -> Ending {
        self.manifest.ending
    }

    /// Which shard of a sweep it is; `None` of a whole sweep.
    pub(crate) fn shard(&self) -> Option<Shard> {
        let (number, of) = self.manifest.shard.as_deref()?.split_once('/')?;
        Shard::new(number.parse().ok()?, of.parse().ok()?)
    }

    /// Of how many shards it was put together; `None` where it was run as a whole.
    pub(crate) fn merged(&self) -> Option<usize> {
        self.manifest.merged
    }

    /// Points that are done; `None` for runs of early versions that were killed.
    pub(crate) fn points_done(&self) -> Option<usize> {
        self.manifest.points
    }

    /// Whether it is unfinished and can be gone on with.
    pub(crate) fn can_go_on(&self) -> bool {
        self.ending() != Ending::Complete && journal::can_go_on(&self.path)
    }

    /// Refuses a sweep that is not the one that was run; titles and figures may differ.
    ///
    /// # Errors
    /// [`RunError::OtherSweep`].
    pub(crate) fn check_sweep(&self, resolved: &str) -> Result<(), RunError> {
        let differences = journal::different_keys(&self.resolved, resolved);
        RunError::check_same(&self.path, differences)
    }

    /// Seed of the random streams.
    pub(crate) fn seed(&self) -> u64 {
        self.manifest.seed
    }

    /// Threads that the run used.
    pub(crate) fn threads(&self) -> usize {
        self.manifest.threads
    }

    /// Seconds that the phases of the run took.
    pub fn seconds(&self) -> PhaseSeconds {
        self.manifest.seconds
    }

    /// Warnings of the run; none where it was killed before it wrote them.
    pub fn warnings(&self) -> &[String] {
        &self.manifest.warnings
    }

    /// What the sweep saw on its finer grid, of the observables of `subject`; `None` where it made no checks.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Column`] and [`RunError::Row`].
    pub(crate) fn checks(
        &self,
        subject: &Subject,
    ) -> Result<Option<Vec<CheckedIndicator>>, RunError> {
        let path = self.path.join("checks.csv");
        let there = path.is_file();
        there.then(|| read_checks(&path, subject)).transpose()
    }

    /// All points in the order of the table, with the densities of the observables of `subject` on these cells (and
    /// bins of quantities), bit for bit as they were solved; detections are empty. A run that was killed may hold a
    /// density whose row was not written: it is left out.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Column`] and [`RunError::Row`] for the table; [`RunError::ReadStore`],
    /// [`RunError::NotStored`], [`RunError::Cells`], [`RunError::NoDensity`] and [`RunError::Memory`] for the
    /// densities.
    pub fn points(
        &self,
        subject: &Subject,
        (space, bins): (&CellSpace, &[Axis]),
        methods: &[&'static str],
    ) -> Result<Vec<Point>, RunError> {
        let table = self.path.join("points.csv");
        let complete = self.ending() == Ending::Complete;
        let mut points = read_points(&table, subject, methods, complete)?;
        if let Some(wanted) = self.manifest.points.filter(|_| complete)
            && wanted != points.len()
        {
            let (path, found) = (table, points.len());
            return Err(RunError::Rows {
                path,
                found,
                wanted,
            });
        }
        read_fluctuations(&self.path, &subject.family, &mut points)?;
        // Only points with a density have moments, and velocities of angles.
        let has_density = |point: &Point| {
            let mut known = [&MEAN, &VELOCITY].into_iter();
            known.any(|kind| point.report.all(kind).next().is_some())
        };
        if !points.iter().any(has_density) {
            return self.check_sums().map(|()| points);
        }
        let densities = PointDensities::open(&self.path, complete, subject, (space, bins))?;
        let wanted = points.iter().filter(|point| has_density(point));
        let wanted: Vec<f64> = wanted.map(|point| point.value).collect();
        densities.check_room(&self.path, &wanted)?;
        let solved = points.par_iter_mut();
        let solved = solved.filter(|point| has_density(point));
        let results: Vec<Result<(), RunError>> =
            solved.map(|point| densities.read(point)).collect();
        // Of several faults the same one is told each time: that of the first point.
        results.into_iter().collect::<Result<(), RunError>>()?;
        densities.check_shards()?;
        self.check_sums()?;
        Ok(points)
    }

    /// Refuses a run whose tables or densities are not those that it left, by its checksums; nothing is known of a run
    /// without.
    fn check_sums(&self) -> Result<(), RunError> {
        let entries = [
            "run.json",
            "points.csv",
            "checks.csv",
            looks::NAME,
            kept_detections::NAME,
            SPECTRA,
            CORRELATIONS,
            "densities.zarr",
        ];
        checksums::require(&self.path, &entries)
    }

    /// How many files are as the run left them, and those that are not; `None` for a run without checksums: one that is
    /// not finished, or of an early version.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Checksums`].
    pub fn damage(&self) -> Result<Option<Checked>, RunError> {
        checksums::check(&self.path, Layout::SWEEP.entries, &[])
    }

    /// Where its figures are drawn.
    ///
    /// # Errors
    /// [`RunError::Elsewhere`].
    pub(crate) fn figures(&self) -> Result<PathBuf, RunError> {
        folder_in(&self.path, FIGURES)
    }

    /// Takes these figures for those of the run: they were drawn again.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Write`], [`RunError::Checksums`].
    pub(crate) fn renew_figures(&self, drawn: &[PathBuf]) -> Result<(), RunError> {
        checksums::renew(&self.path, FIGURES, drawn)
    }
}

/// Versions are compatible when they differ in the last number alone.
fn check_version(file: &Path, manifest: &StoredManifest) -> Result<(), RunError> {
    let of = |version: &str| version.rsplit_once('.').map(|parts| parts.0.to_owned());
    let (program, version) = (env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
    if manifest.program == program && of(&manifest.version) == of(version) {
        return Ok(());
    }
    Err(RunError::Version {
        path: file.to_owned(),
        found: format!("{} {}", manifest.program, manifest.version),
        wanted: format!("{program} {version}"),
    })
}

fn check_hash(file: &Path, text: &str, stored: &str) -> Result<(), RunError> {
    if hash(text) == stored {
        return Ok(());
    }
    Err(RunError::Hash {
        path: file.to_owned(),
    })
}
