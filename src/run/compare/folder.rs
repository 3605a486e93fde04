//! The folder of a comparison: written beside its place, and put there when it is whole; what was there before is kept.
//! What is solved stands in its journal meanwhile.

use std::path::{Path, PathBuf};

use super::{
    ComparedRun, PART, accuracy_csv, agreement_csv, compare_csv, compare_json, compare_markdown,
    compare_tex, densities_csv, distances_csv,
};
use crate::run::RunError;
use crate::run::atomic::{sync_all, write_atomically};
use crate::run::checksums;
use crate::run::journal::{Journal, came_to_its_end};
use crate::run::staging::Staging;

/// Everything a comparison leaves in its folder, the file that marks it as one first.
pub(in crate::run) const ENTRIES: [&str; 10] = [
    "compare.json",
    checksums::NAME,
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

    /// Whether the folder holds a comparison that came to its end, and is of what `of` describes.
    ///
    /// # Errors
    /// [`RunError::OtherSweep`], with every difference, where it is of another one; [`RunError::Json`].
    pub fn is_complete(home: &Path, of: &str) -> Result<bool, RunError> {
        came_to_its_end(home, ENTRIES[0], of)
    }

    /// Whether the folder holds solves of a comparison that did not come to its end.
    pub fn has_journal(home: &Path) -> bool {
        home.join(PART).is_file()
    }

    /// A new journal for what a comparison solves, which `of` describes as TOML; that of an unfinished one is kept
    /// below `previous/`.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub fn begin(&self, of: &str) -> Result<Journal, RunError> {
        self.staging.keep_aside(&[PART])?;
        Journal::create(&self.staging.home().join(PART), of)
    }

    /// The journal of the unfinished comparison in the folder.
    ///
    /// # Errors
    /// [`RunError::NoJournal`], [`RunError::OtherSweep`], [`RunError::Journal`], [`RunError::Read`].
    pub fn go_on(&self, of: &str) -> Result<Journal, RunError> {
        Journal::open(&self.staging.home().join(PART), of)
    }

    /// Removes the journal of a comparison that has hardly begun: nothing is left of it.
    pub fn give_up(&self) {
        // One that cannot be removed can be gone on with.
        let _ = std::fs::remove_file(self.staging.home().join(PART));
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

    /// Puts the comparison in its place and returns its files; what an earlier one left goes below `previous/`. The
    /// journal goes, unless the comparison was interrupted.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub fn take_place(self, interrupted: bool) -> Result<Vec<PathBuf>, RunError> {
        let fresh = self.staging.fresh();
        checksums::write_listed(&fresh, &ENTRIES)?;
        sync_all(&[fresh])?;
        let part = self.staging.home().join(PART);
        let placed = self.staging.take_place(&[])?;
        if !interrupted {
            // One that stays is of a comparison that is complete, which is looked at first.
            let _ = std::fs::remove_file(part);
        }
        Ok(placed.files)
    }
}
