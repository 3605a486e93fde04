//! A new version of the tables and figures of a run, written beside the old one and put in its place when it is whole.

use std::path::{Path, PathBuf};

use super::folder::{ENTRIES, PREVIOUS, SOLVED};
use super::{RunError, RunFolder};

/// A new version in the making. Dropped before it is in place, it leaves the run as it was.
#[derive(Debug)]
pub struct StagedRun {
    home: PathBuf,
    staging: tempfile::TempDir,
}

impl StagedRun {
    /// A new version of the run at `home`.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn new(home: &Path) -> Result<Self, RunError> {
        let staging = tempfile::Builder::new().prefix(".pbif-").tempdir_in(home);
        let staging = staging.map_err(|source| failed(home, source))?;
        Ok(Self {
            home: home.to_owned(),
            staging,
        })
    }

    /// The folder to write the new version to; everything but what was solved for.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn folder(&self) -> Result<RunFolder, RunError> {
        let path = self.fresh();
        std::fs::create_dir_all(&path).map_err(|source| failed(&path, source))?;
        Ok(RunFolder::fresh(&path))
    }

    fn fresh(&self) -> PathBuf {
        self.staging.path().join("fresh")
    }

    /// Puts the new version in place. The version before becomes a complete run in `previous/`, its densities linked, in place of what
    /// was there.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn take_place(self) -> Result<(), RunError> {
        let previous = self.home.join(PREVIOUS);
        let kept = self.staging.path().join("kept");
        std::fs::create_dir(&kept).map_err(|source| failed(&kept, source))?;
        for entry in ENTRIES {
            link_tree(&self.home.join(entry), &kept.join(entry))?;
        }
        if previous.exists() {
            rename(&previous, &self.staging.path().join("older"))?;
        }
        rename(&kept, &previous)?;
        // A file is replaced in one step; a folder must make room first.
        for entry in ENTRIES.into_iter().filter(|entry| !SOLVED.contains(entry)) {
            let (fresh, place) = (self.fresh().join(entry), self.home.join(entry));
            if place.is_dir() {
                rename(&place, &self.staging.path().join(entry))?;
            }
            if fresh.exists() {
                rename(&fresh, &place)?;
            }
        }
        Ok(())
    }
}

/// Gives the store of densities a second place: files are linked, and copied where the file system cannot link. The
/// program never changes a file in place, so either place may be rewritten or removed.
pub(super) fn link_tree(from: &Path, to: &Path) -> Result<(), RunError> {
    if from.is_dir() {
        std::fs::create_dir(to).map_err(|source| failed(to, source))?;
        let entries = std::fs::read_dir(from).map_err(|source| RunError::Read {
            path: from.to_owned(),
            source,
        })?;
        for entry in entries {
            let entry = entry.map_err(|source| RunError::Read {
                path: from.to_owned(),
                source,
            })?;
            link_tree(&entry.path(), &to.join(entry.file_name()))?;
        }
    } else if from.is_file() && std::fs::hard_link(from, to).is_err() {
        std::fs::copy(from, to).map_err(|source| failed(to, source))?;
    }
    Ok(())
}

fn rename(from: &Path, to: &Path) -> Result<(), RunError> {
    std::fs::rename(from, to).map_err(|source| failed(to, source))
}

fn failed(path: &Path, source: std::io::Error) -> RunError {
    RunError::Write {
        path: path.to_owned(),
        source,
    }
}
