//! The folder of a comparison: written beside its place, and put there when it is whole; what was there before is kept.

use std::path::{Path, PathBuf};

use super::{
    ComparedRun, accuracy_csv, agreement_csv, compare_csv, compare_json, compare_markdown,
    compare_tex, densities_csv, distances_csv,
};
use crate::run::RunError;
use crate::run::atomic::write_atomically;
use crate::run::folder::PREVIOUS;

/// Everything a comparison leaves in its folder.
const ENTRIES: [&str; 9] = [
    "compare.csv",
    "compare.md",
    "compare.tex",
    "compare.json",
    "distances.csv",
    "agreement.csv",
    "accuracy.csv",
    "densities.csv",
    "figures",
];

/// A comparison's folder in the making. Dropped before it is in place, it leaves what was there.
#[derive(Debug)]
pub struct CompareFolder {
    home: PathBuf,
    staging: tempfile::TempDir,
}

impl CompareFolder {
    /// Prepares to write to `home`, an existing folder.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn new(home: &Path) -> Result<Self, RunError> {
        let staging = tempfile::Builder::new().prefix(".pbif-").tempdir_in(home);
        Ok(Self {
            home: home.to_owned(),
            staging: staging.map_err(|source| failed(home, source))?,
        })
    }

    /// Where figures are drawn to.
    pub fn figures(&self) -> PathBuf {
        self.fresh().join("figures")
    }

    fn fresh(&self) -> PathBuf {
        self.staging.path().join("fresh")
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
            write_atomically(&self.fresh().join(name), text.as_bytes())?;
        }
        Ok(())
    }

    /// Moves what an earlier comparison left into `previous/`, in place of what was there, and puts the new one in its place. Returns the
    /// files.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn take_place(self) -> Result<Vec<PathBuf>, RunError> {
        let earlier: Vec<&str> = ENTRIES
            .into_iter()
            .filter(|entry| self.home.join(entry).exists())
            .collect();
        if !earlier.is_empty() {
            let previous = self.home.join(PREVIOUS);
            if previous.exists() {
                rename(&previous, &self.staging.path().join("older"))?;
            }
            std::fs::create_dir(&previous).map_err(|source| failed(&previous, source))?;
            for entry in earlier {
                rename(&self.home.join(entry), &previous.join(entry))?;
            }
        }
        let mut files = Vec::new();
        for entry in ENTRIES {
            let (fresh, place) = (self.fresh().join(entry), self.home.join(entry));
            if !fresh.exists() {
                continue;
            }
            rename(&fresh, &place)?;
            match std::fs::read_dir(&place) {
                Ok(inside) => {
                    let mut inside: Vec<PathBuf> = inside.flatten().map(|one| one.path()).collect();
                    inside.sort();
                    files.extend(inside);
                }
                Err(_) => files.push(place),
            }
        }
        Ok(files)
    }
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
