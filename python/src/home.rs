//! The folder of a job: one that was given, or one that lasts as long as somebody holds it.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::TempDir;

/// A folder. One that nobody named is removed with the last who holds it, unless it was kept.
#[derive(Debug)]
pub(crate) struct Home {
    path: PathBuf,
    until: Mutex<Option<TempDir>>,
}

impl Home {
    /// The folder of that name, or one of nobody's.
    pub(crate) fn new(given: Option<PathBuf>) -> std::io::Result<Self> {
        if let Some(path) = given {
            return Ok(Self {
                path,
                until: Mutex::default(),
            });
        }
        let room = tempfile::Builder::new().prefix("pbif-").tempdir()?;
        Ok(Self {
            path: room.path().join("run"),
            until: Mutex::new(Some(room)),
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Keeps the folder for good.
    pub(crate) fn keep(&self) {
        let mut until = self.until.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(room) = until.take() {
            let _ = room.keep();
        }
    }
}
