//! A run whose tables and figures are made anew from what was solved before.

use std::path::{Path, PathBuf};

use super::atomic::write_atomically;
use super::staging::Staging;
use super::tree::link_tree;
use super::{
    Ending, Layout, Manifest, RunError, RunFolder, StoredRun, checksums, folder, journal, looks,
    research_object, sweep_files,
};
use crate::continuation::SweepResult;

/// What a sweep solved for: a run that is detected again has it too.
const SOLVED: [&str; 3] = ["densities.zarr", "checks.csv", looks::NAME];

/// The new version in the making. Dropped before it is in place, it leaves everything as it was.
#[derive(Debug)]
pub(crate) struct StagedRun {
    staging: Staging,
    /// Whether it replaces the run that was solved.
    same: bool,
    /// Whether the run has come to its end; the densities of another one stand in its journal.
    is_complete: bool,
}

impl StagedRun {
    /// A new version of the run `solved`, to stand at `home`: the folder of that run, or another one that exists.
    ///
    /// # Errors
    /// [`RunError::InUse`], [`RunError::NotOurs`], [`RunError::Read`] or [`RunError::Write`].
    pub(crate) fn new(home: &Path, solved: &StoredRun) -> Result<Self, RunError> {
        let staging = Staging::new(home, Layout::SWEEP.entries)?.with(Layout::SWEEP.about)?;
        let same = is_same(home, solved.path());
        for entry in SOLVED {
            link_tree(&solved.path().join(entry), &staging.fresh().join(entry))?;
        }
        let is_complete = solved.ending() == Ending::Complete;
        Ok(Self {
            staging,
            same,
            is_complete,
        })
    }

    /// Where figures are drawn to.
    pub(crate) fn figures(&self) -> PathBuf {
        self.staging.fresh().join("figures")
    }

    /// Writes all that detection and location make.
    ///
    /// # Errors
    /// [`RunError`] when a file cannot be composed or written.
    pub(crate) fn write(&self, result: &SweepResult) -> Result<(), RunError> {
        let fresh = self.staging.fresh();
        if !self.is_complete {
            folder::write_densities(&fresh, result)?;
        }
        let files = sweep_files(result)?;
        let mut made = files
            .iter()
            .filter(|(name, _)| !SOLVED.contains(&name.as_str()));
        made.try_for_each(|(name, text)| write_atomically(&fresh.join(name), text.as_bytes()))
    }

    /// Writes the manifest.
    ///
    /// # Errors
    /// As [`RunFolder::write_manifest`].
    pub(crate) fn write_manifest(&self, manifest: &Manifest) -> Result<(), RunError> {
        RunFolder::at(&self.staging.fresh()).write_manifest(manifest)
    }

    /// Puts the new version in place and returns its files. A run that was there becomes a complete one below
    /// `previous/`, its densities linked. Curves that were followed from it go with it where rows may have changed.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub(crate) fn take_place(self) -> Result<Vec<PathBuf>, RunError> {
        // A run that goes on needs its journal, which cannot be shared with another folder.
        let (home, fresh) = (self.staging.home(), self.staging.fresh());
        research_object::write(&fresh)?;
        checksums::write(&fresh, Layout::SWEEP.entries)?;
        let mut staying = Vec::new();
        if self.same {
            staying.push(Layout::SWEEP.part);
            if has_the_rows_of(&fresh, home) {
                staying.extend(Layout::SWEEP.about);
            }
        }
        Ok(self.staging.take_place(&staying, &[])?.files)
    }
}

/// Whether two runs with the same densities were detected with the same settings.
fn has_the_rows_of(one: &Path, other: &Path) -> bool {
    let resolved = |run| StoredRun::open(run).map(|run| run.resolved().to_owned());
    match (resolved(one), resolved(other)) {
        (Ok(one), Ok(other)) => journal::different_keys(&one, &other).is_empty(),
        _ => false,
    }
}

fn is_same(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => one == other,
    }
}
