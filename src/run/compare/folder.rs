//! The folder of a comparison: written beside its place, and put there when it is whole; what was there before is kept.

use std::path::{Path, PathBuf};

use super::{
    ComparedRun, accuracy_csv, agreement_csv, compare_csv, compare_json, compare_markdown,
    compare_tex, densities_csv, distances_csv,
};
use crate::run::RunError;
use crate::run::atomic::{sync_all, write_atomically};
use crate::run::staging::Staging;

/// Everything a comparison leaves in its folder, the file that marks it as one first.
const ENTRIES: [&str; 9] = [
    "compare.json",
    "compare.csv",
    "compare.md",
    "compare.tex",
    "distances.csv",
    "agreement.csv",
    "accuracy.csv",
    "densities.csv",
    "figures",
];

/// A comparison's folder in the making. Dropped before it is in place, it leaves what was there.
#[derive(Debug)]
pub struct CompareFolder {
    staging: Staging,
}

impl CompareFolder {
    /// Prepares to write to `home`, an existing folder; other processes are kept away from it.
    ///
    /// # Errors
    /// [`RunError::InUse`], [`RunError::NotOurs`], [`RunError::Write`].
    pub fn new(home: &Path) -> Result<Self, RunError> {
        let staging = Staging::new(home, &ENTRIES)?;
        Ok(Self { staging })
    }

    /// Where figures are drawn to.
    pub fn figures(&self) -> PathBuf {
        self.staging.fresh().join("figures")
    }

    /// Writes all tables.
    ///
    /// # Errors
    /// [`RunError`] when a file cannot be composed or written.
    pub fn write(&self, run: &ComparedRun<'_>) -> Result<(), RunError> {
        for (name, text) in [
            ("compare.csv", compare_csv(run)?),
            ("compare.md", compare_markdown(run)),
            ("compare.tex", compare_tex(run)),
            ("compare.json", compare_json(run)?),
            ("distances.csv", distances_csv(run)?),
            ("agreement.csv", agreement_csv(run)?),
            ("accuracy.csv", accuracy_csv(run)?),
            ("densities.csv", densities_csv(run)?),
        ] {
            write_atomically(&self.staging.fresh().join(name), text.as_bytes())?;
        }
        Ok(())
    }

    /// Puts the comparison in its place and returns its files; what an earlier one left goes below `previous/`.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub fn take_place(self) -> Result<Vec<PathBuf>, RunError> {
        sync_all(&[self.staging.fresh()])?;
        Ok(self.staging.take_place(&[])?.files)
    }
}
