//! The files of a run, those that grow while it is solved and those that are written when it has ended.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::atomic::{sync_all, write_atomically, write_durably};
use super::checksums::Sums;
use super::growing::GrowingTable;
use super::kept_detections::write_detections;
use super::looks::looks_file;
use super::spectra::fluctuation_files;
use super::store::write_store;
use super::{
    Ending, Layout, Manifest, RunError, bifurcations_csv, bifurcations_json, bifurcations_markdown,
    bifurcations_tex, checks, features_csv, features_table, miscounted_in_words, points_csv,
    points_table, settling::Settling,
};
use crate::continuation::{Point, Subject, SweepResult};

/// The stored densities.
const STORE: &str = "densities.zarr";

/// The files of a run while they are written.
#[derive(Debug)]
pub(crate) struct RunFolder {
    path: PathBuf,
    points: GrowingTable,
    features: GrowingTable,
    /// Points that were added.
    added: usize,
    /// The finished store on its way to the disk.
    settling: Mutex<Option<Settling>>,
}

impl RunFolder {
    /// Nothing is written yet. Whoever writes to the folder of a run opens it first ([`JobFolder`](super::JobFolder)).
    pub(crate) fn at(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            points: GrowingTable::new(&path.join("points.csv")),
            features: GrowingTable::new(&path.join("features.csv")),
            added: 0,
            settling: Mutex::default(),
        }
    }

    /// Writes `run.json`. One that says that the run has ended waits until everything else is on the disk.
    ///
    /// # Errors
    /// [`RunError::Json`] or [`RunError::Write`].
    pub(crate) fn write_manifest(&self, manifest: &Manifest) -> Result<(), RunError> {
        if manifest.ending != Ending::Running {
            // The journal of a complete run is about to be removed.
            let mut done = match manifest.ending {
                Ending::Complete => vec![Layout::SWEEP.part],
                _ => Vec::new(),
            };
            // A poisoned lock holds work as whole as any other.
            let settling = self.settling.lock();
            let settling = settling.unwrap_or_else(PoisonError::into_inner).take();
            if let Some(settling) = settling {
                settling.end()?;
                done.push(STORE);
            }
            let kept = Layout::SWEEP.entries.iter();
            let kept = kept.filter(|entry| !done.contains(entry));
            let places: Vec<PathBuf> = kept.map(|entry| self.path.join(entry)).collect();
            sync_all(&places)?;
        }
        let text = serde_json::to_string_pretty(manifest)? + "\n";
        write_durably(&self.path.join("run.json"), text.as_bytes())
    }

    /// Writes how far a run is into `run.json`, without waiting for the disk.
    ///
    /// # Errors
    /// [`RunError::Json`] or [`RunError::Write`].
    pub(crate) fn write_progress(&self, manifest: &Manifest) -> Result<(), RunError> {
        let text = serde_json::to_string_pretty(manifest)? + "\n";
        write_atomically(&self.path.join("run.json"), text.as_bytes())
    }

    /// The same of several points at once, the first of the run: whatever was there of the tables is replaced.
    ///
    /// # Errors
    /// As [`RunFolder::add_point`].
    pub(crate) fn add_points(
        &mut self,
        subject: &Subject,
        points: &[Point],
    ) -> Result<(), RunError> {
        let family = &subject.family;
        let observables = &subject.observables;
        let found = points
            .iter()
            .flat_map(|point| features_table::found(observables, point));
        let rows: Vec<_> = found.collect();
        let columns = features_table::columns(family);
        self.features
            .add(|| columns.header(), &columns.lines(&rows)?)?;
        let columns = points_table::of_subject(subject);
        self.points
            .add(|| columns.header(), &columns.lines(points)?)?;
        self.added += points.len();
        Ok(())
    }

    /// How many points were added so far.
    pub(crate) fn points(&self) -> usize {
        self.added
    }

    /// Writes the tables of a sweep that ends at once; `sweep_file` is the complete file that was run. Its densities
    /// stay in the journal, as a kill leaves them.
    ///
    /// # Errors
    /// [`RunError`] when a file cannot be composed or written.
    pub(crate) fn break_off(
        &mut self,
        result: &SweepResult,
        sweep_file: &str,
    ) -> Result<(), RunError> {
        self.points.close();
        self.features.close();
        for (name, text) in sweep_files(result)?
            .into_iter()
            .chain(looks_file(&result.looks, sweep_file)?)
        {
            write_atomically(&self.path.join(name), text.as_bytes())?;
        }
        Ok(())
    }

    /// Writes all files of a finished sweep, its densities among them, which are brought to the disk while the caller
    /// goes on, to the figures for example, until the manifest is written. Returns the checksums of the files of the
    /// store by their names in the folder.
    ///
    /// # Errors
    /// [`RunError`] when a file cannot be composed or written.
    pub(crate) fn finish(
        &mut self,
        result: &SweepResult,
        sweep_file: &str,
    ) -> Result<Sums, RunError> {
        self.break_off(result, sweep_file)?;
        let sums = write_densities(&self.path, result)?;
        self.settling = Some(Settling::begin(self.path.join(STORE))).into();
        Ok(sums)
    }

    /// Writes what a complete shard has detected, for the merge, and returns the checksum of the file by its name.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(crate) fn write_detections(&self, points: &[Point]) -> Result<Sums, RunError> {
        write_detections(&self.path, points)
    }
}

/// Writes all densities of a sweep into a folder and returns the checksums of their files by their names in it.
///
/// # Errors
/// [`RunError::Write`].
pub(super) fn write_densities(run: &Path, result: &SweepResult) -> Result<Sums, RunError> {
    let solved = result
        .points
        .iter()
        .filter(|point| !point.densities.is_empty());
    let stored = solved.map(|point| (point.value, &point.densities[..], &point.report.fields[..]));
    let (path, stored) = (run.join(STORE), stored.collect::<Vec<_>>());
    let sums = write_store(&path, &result.subject.family, &stored)?.into_iter();
    Ok(sums
        .map(|(name, sum)| (format!("{STORE}/{name}"), sum))
        .collect())
}

/// The files of a sweep by their names, but for its manifest and its densities.
///
/// # Errors
/// [`RunError`] when one cannot be composed.
pub(crate) fn sweep_files(result: &SweepResult) -> Result<Vec<(String, String)>, RunError> {
    let SweepResult {
        subject,
        points,
        labels,
        checks,
        ..
    } = result;
    let family = &subject.family;
    let miscounted =
        miscounted_in_words(result).map_or_else(String::new, |words| format!("\n{words}\n"));
    let markdown = bifurcations_markdown(family, labels) + &miscounted;
    let mut files = vec![
        ("points.csv", points_csv(subject, points)?),
        ("features.csv", features_csv(subject, points)?),
        ("bifurcations.csv", bifurcations_csv(family, labels)?),
        ("bifurcations.json", bifurcations_json(family, labels)?),
        ("bifurcations.md", markdown),
        ("bifurcations.tex", bifurcations_tex(family, labels)),
    ];
    if let Some(checks) = checks {
        files.push(("checks.csv", checks::checks_csv(subject, checks)?));
    }
    files.extend(fluctuation_files(family, points)?);
    let files = files.into_iter();
    Ok(files.map(|(name, text)| (name.to_owned(), text)).collect())
}
