//! The folder of a run: which files it holds, and that an earlier run in the same place is kept.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::atomic::{clear_unfinished, sync_all, write_atomically, write_durably};
use super::growing::GrowingTable;
use super::{
    DensityStore, Ending, Manifest, RunError, bifurcations, checks, checksums, features_table,
    journal, lock::FolderLock, points_table, research_object, settling::Settling, staging::Staging,
};
use crate::continuation::{Point, Subject, SweepResult};
use crate::density::EstimatedDensity;

/// The stored densities.
const STORE: &str = "densities.zarr";

/// Everything a run may leave in its folder, the file that marks it as one first.
pub(super) const ENTRIES: [&str; 16] = [
    "run.json",
    research_object::NAME,
    checksums::NAME,
    journal::NAME,
    "points.csv",
    "features.csv",
    "bifurcations.csv",
    "bifurcations.md",
    "bifurcations.tex",
    "bifurcations.json",
    STORE,
    "densities.zarr.new",
    "densities.zarr.old",
    "checks.csv",
    "figures",
    "explorer.html",
];

/// Folders of work that is about a run: it goes where the run goes, so that what stands beside a run is of that run.
pub(super) const ABOUT: [&str; 1] = [super::curve::FOLDER];

/// The folder of a run while it is written.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    store: DensityStore,
    points: GrowingTable,
    features: GrowingTable,
    /// Points that were added.
    added: usize,
    kept: Option<PathBuf>,
    /// The finished store on its way to the disk.
    settling: Mutex<Option<Settling>>,
    /// Keeps other processes away while the run is written.
    _lock: Option<FolderLock>,
}

impl RunFolder {
    /// Prepares a folder: makes it if need be, and moves the files of an earlier run, with the curves that were
    /// followed from it, to `previous/1`, or the next number that is free. Files that are not a run's are left alone.
    /// Until it is dropped, no other process writes to the folder.
    ///
    /// # Errors
    /// [`RunError::InUse`], [`RunError::NotOurs`], [`RunError::Read`], [`RunError::Write`]; then the folder is as it
    /// was.
    pub fn create(path: &Path) -> Result<Self, RunError> {
        std::fs::create_dir_all(path).map_err(|source| RunError::Write {
            path: path.to_owned(),
            source,
        })?;
        // A run is written as it goes on, so that a reader sees how far it is: only the earlier one is staged.
        let placed = Staging::new(path, &ENTRIES)?
            .with(&ABOUT)?
            .take_place(&[])?;
        Ok(Self {
            kept: placed.kept,
            _lock: Some(placed.lock),
            ..Self::fresh(path)
        })
    }

    /// Opens the folder of an unfinished run to go on with it. What is there is replaced whole, when the points of the
    /// run are [added](RunFolder::add_points) again; figures of an interrupted run, which are of other values, are
    /// removed.
    ///
    /// # Errors
    /// [`RunError::InUse`], [`RunError::Write`].
    pub fn reopen(path: &Path) -> Result<Self, RunError> {
        let lock = FolderLock::take(path)?;
        checksums::reopen(path);
        clear_unfinished(path, &[STORE, "figures"]);
        Ok(Self {
            _lock: Some(lock),
            ..Self::fresh(path)
        })
    }

    /// A folder that is written beside its place, in which nothing was before.
    pub(super) fn fresh(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            store: DensityStore::new(&path.join(STORE)),
            points: GrowingTable::new(&path.join("points.csv")),
            features: GrowingTable::new(&path.join("features.csv")),
            added: 0,
            kept: None,
            settling: Mutex::default(),
            _lock: None,
        }
    }

    /// Where the earlier run is kept that was in the folder.
    pub fn kept(&self) -> Option<&Path> {
        self.kept.as_deref()
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The journal, until the run is complete.
    pub fn journal(&self) -> PathBuf {
        self.path.join(journal::NAME)
    }

    /// Folder of the figures; made by whoever draws the first one.
    pub fn figures(&self) -> PathBuf {
        self.path.join("figures")
    }

    /// Writes `run.json`. One that says that the run has ended waits until everything else is on the disk.
    ///
    /// # Errors
    /// [`RunError::Json`] or [`RunError::Write`].
    pub fn write_manifest(&self, manifest: &Manifest) -> Result<(), RunError> {
        if manifest.ending != Ending::Running {
            // The journal of a complete run is about to be removed.
            let mut done = match manifest.ending {
                Ending::Complete => vec![journal::NAME],
                _ => Vec::new(),
            };
            // A poisoned lock holds work as whole as any other.
            let settling = self.settling.lock();
            let settling = settling.unwrap_or_else(PoisonError::into_inner).take();
            if let Some(settling) = settling {
                settling.end()?;
                done.push(STORE);
            }
            let kept = ENTRIES.iter().filter(|entry| !done.contains(entry));
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
    pub fn write_progress(&self, manifest: &Manifest) -> Result<(), RunError> {
        let text = serde_json::to_string_pretty(manifest)? + "\n";
        self.write("run.json", &text)
    }

    /// Stores a point's densities and adds its rows to the tables. What this costs does not depend on how many points
    /// there are: until [`RunFolder::finish`], rows stand in the order in which the points came.
    ///
    /// # Errors
    /// [`RunError`] when a file cannot be composed or written.
    pub fn add_point(&mut self, subject: &Subject, point: &Point) -> Result<(), RunError> {
        let Subject {
            family,
            observables,
            ..
        } = subject;
        if !point.densities.is_empty() {
            self.store.append(family, point.value, &point.densities)?;
        }
        // The row comes after its density, which a reader of the row may look for.
        let rows: Vec<_> = features_table::found(observables, point).collect();
        let columns = features_table::columns(family);
        self.features
            .add(|| columns.header(), &columns.lines(&rows)?)?;
        let columns = points_table::of_subject(subject);
        self.points
            .add(|| columns.header(), &columns.lines([point])?)?;
        self.added += 1;
        Ok(())
    }

    /// The same of several points at once, the first of the run: whatever was there of the tables and the store is
    /// replaced.
    ///
    /// # Errors
    /// As [`RunFolder::add_point`].
    pub fn add_points(&mut self, subject: &Subject, points: &[Point]) -> Result<(), RunError> {
        let family = &subject.family;
        self.store.replace(family, &with_densities(points))?;
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

    /// Describes a run that has ended for archives, and writes the checksums of all its files, see
    /// `docs/run-folder.md`.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Manifest`] or [`RunError::Write`].
    pub fn seal(&self) -> Result<(), RunError> {
        research_object::write(&self.path)?;
        checksums::write(&self.path)
    }

    /// Removes the journal of a run that is complete.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn close_journal(&self) -> Result<(), RunError> {
        let path = self.journal();
        match std::fs::remove_file(&path) {
            Err(source) if path.exists() => Err(RunError::Write { path, source }),
            _ => Ok(()),
        }
    }

    /// How many points were added so far.
    pub fn points(&self) -> usize {
        self.added
    }

    /// Writes all tables of a finished sweep and puts the stored densities in ascending order. They are brought to the
    /// disk while the caller goes on, to the figures for example, until the manifest is written.
    ///
    /// # Errors
    /// [`RunError`] when a file cannot be composed or written.
    pub fn finish(&mut self, result: &SweepResult) -> Result<(), RunError> {
        self.points.close();
        self.features.close();
        self.write_tables(result)?;
        if let Some(checks) = &result.checks {
            let text = checks::checks_csv(&result.subject, checks)?;
            self.write("checks.csv", &text)?;
        }
        let densities = with_densities(&result.points);
        let before = self.store.replaced(&result.subject.family, &densities)?;
        self.settling = Some(Settling::begin(self.store.path(), before)).into();
        Ok(())
    }

    /// Writes all tables that detection and location make.
    ///
    /// # Errors
    /// [`RunError`] when a file cannot be composed or written.
    pub fn write_tables(&self, result: &SweepResult) -> Result<(), RunError> {
        let (subject, points) = (&result.subject, &result.points);
        let family = &subject.family;
        self.write("points.csv", &points_table::points_csv(subject, points)?)?;
        self.write(
            "features.csv",
            &features_table::features_csv(subject, points)?,
        )?;
        let labels = &result.labels;
        self.write(
            "bifurcations.csv",
            &bifurcations::bifurcations_csv(family, labels)?,
        )?;
        self.write(
            "bifurcations.json",
            &bifurcations::bifurcations_json(family, labels)?,
        )?;
        self.write(
            "bifurcations.md",
            &bifurcations::bifurcations_markdown(family, labels),
        )?;
        self.write(
            "bifurcations.tex",
            &bifurcations::bifurcations_tex(family, labels),
        )
    }

    fn write(&self, name: &str, text: &str) -> Result<(), RunError> {
        write_atomically(&self.path.join(name), text.as_bytes())
    }
}

/// The densities of those points that have some.
fn with_densities(points: &[Point]) -> Vec<(f64, &[EstimatedDensity])> {
    let solved = points.iter().filter(|point| !point.densities.is_empty());
    solved
        .map(|point| (point.value, point.densities.as_slice()))
        .collect()
}
