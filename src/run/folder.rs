//! The folder of a run: which files it holds, and that an earlier run in the same place is kept.

use std::path::{Path, PathBuf};

use super::growing::GrowingTable;
use super::{
    DensityStore, Manifest, RunError, atomic::write_atomically, bifurcations, checks,
    features_table, points_table, staging::Staging,
};
use crate::continuation::{Point, Subject, SweepResult};
use crate::density::EstimatedDensity;

/// Everything a run may leave in its folder.
pub(super) const ENTRIES: [&str; 10] = [
    "run.json",
    "points.csv",
    "features.csv",
    "bifurcations.csv",
    "bifurcations.md",
    "bifurcations.tex",
    "bifurcations.json",
    "densities.zarr",
    "checks.csv",
    "figures",
];

/// The folder of a run while it is written.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    store: DensityStore,
    points: GrowingTable,
    features: GrowingTable,
}

impl RunFolder {
    /// Prepares a folder: makes it if need be, and moves the files of an earlier run into `previous/`, in place of
    /// what was there. Files that are not a run's are left alone.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn create(path: &Path) -> Result<Self, RunError> {
        std::fs::create_dir_all(path).map_err(|source| RunError::Write {
            path: path.to_owned(),
            source,
        })?;
        // A run is written as it goes on, so that a reader sees how far it is: only the earlier one is staged.
        Staging::new(path, &ENTRIES)?.take_place(&[])?;
        Ok(Self::fresh(path))
    }

    /// A folder that is written beside its place, in which nothing was before.
    pub(super) fn fresh(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            store: DensityStore::new(&path.join("densities.zarr")),
            points: GrowingTable::new(&path.join("points.csv")),
            features: GrowingTable::new(&path.join("features.csv")),
        }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Folder of the figures; made by whoever draws the first one.
    pub fn figures(&self) -> PathBuf {
        self.path.join("figures")
    }

    /// Writes `run.json`.
    ///
    /// # Errors
    /// [`RunError::Json`] or [`RunError::Write`].
    pub fn write_manifest(&self, manifest: &Manifest) -> Result<(), RunError> {
        let text = serde_json::to_string_pretty(manifest)? + "\n";
        self.write("run.json", &text)
    }

    /// Stores a point's densities and adds its rows to the tables. What this costs does not depend on how many points there
    /// are: until [`RunFolder::finish`], rows stand in the order in which the points came.
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
        let columns = points_table::columns(family, observables, &[]);
        self.points
            .add(|| columns.header(), &columns.lines([point])?)
    }

    /// Writes all tables of a finished sweep and puts the stored densities in ascending order.
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
        let densities: Vec<(f64, &[EstimatedDensity])> = result
            .points
            .iter()
            .filter(|point| !point.densities.is_empty())
            .map(|point| (point.value, point.densities.as_slice()))
            .collect();
        self.store.replace(&result.subject.family, &densities)
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
