//! The output folder, checked before any work starts: it must be a folder, or can be made, and be written to.

use std::path::{Path, PathBuf};

use crate::run::{RunError, check_place};

/// Why results cannot be written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum OutputError {
    /// The path, or a part of it, is a file, or a link that leads nowhere.
    #[error("the output `{}` is not a folder: `{}` is {what}", path.display(), file.display())]
    NotAFolder {
        /// The wanted folder.
        path: PathBuf,
        /// What is in its way.
        file: PathBuf,
        /// What that is.
        what: &'static str,
    },
    /// A folder cannot be made.
    #[error("the output folder `{}` cannot be made: {source}", path.display())]
    Create {
        /// The wanted folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The folder is there, but cannot be written to.
    #[error("the output folder `{}` cannot be written to: {source}", path.display())]
    NotWritable {
        /// The wanted folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// No results can stand there.
    #[error(transparent)]
    Place(#[from] RunError),
}

/// A folder that can be written to. Folders that were made for it are removed again when it is dropped while
/// they are empty.
#[derive(Debug)]
pub(crate) struct OutputFolder {
    path: PathBuf,
    /// Folders that were made, outermost first.
    made: Vec<PathBuf>,
}

impl OutputFolder {
    /// Makes the folder where it is not there, and tries to write to it.
    ///
    /// # Errors
    /// [`OutputError`]; whatever was made is then removed.
    pub(crate) fn prepare(path: &Path) -> Result<Self, OutputError> {
        check_place(path)?;
        let mut missing = Vec::new();
        for ancestor in path.ancestors().filter(|part| !part.as_os_str().is_empty()) {
            if ancestor.is_dir() {
                break;
            }
            // A link that leads nowhere is in the way as well.
            if ancestor.symlink_metadata().is_ok() {
                return Err(OutputError::NotAFolder {
                    path: path.to_owned(),
                    file: ancestor.to_owned(),
                    what: if ancestor.exists() {
                        "a file"
                    } else {
                        "a link that leads nowhere"
                    },
                });
            }
            missing.push(ancestor.to_owned());
        }
        let mut folder = Self {
            path: path.to_owned(),
            made: Vec::new(),
        };
        for part in missing.into_iter().rev() {
            match std::fs::create_dir(&part) {
                Ok(()) => folder.made.push(part),
                // Another run that shares it was faster.
                Err(_) if part.is_dir() => {}
                Err(source) => {
                    return Err(OutputError::Create {
                        path: path.to_owned(),
                        source,
                    });
                }
            }
        }
        // Permissions do not tell (a full or read-only disk): only writing does.
        let probe = tempfile::Builder::new().prefix(".pbif-").tempfile_in(path);
        match probe.and_then(tempfile::NamedTempFile::close) {
            Ok(()) => Ok(folder),
            Err(source) => Err(OutputError::NotWritable {
                path: path.to_owned(),
                source,
            }),
        }
    }

    /// The folder.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        // Only empty folders can be removed this way, so results are never lost.
        for part in self.made.iter().rev() {
            if std::fs::remove_dir(part).is_err() {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_made_and_removed_while_empty() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        let folder = OutputFolder::prepare(&path).unwrap();
        assert!(folder.path().is_dir());
        assert_eq!(std::fs::read_dir(&path).unwrap().count(), 0);
        drop(folder);
        assert!(!root.path().join("a").exists() && root.path().exists());
    }

    #[test]
    fn folders_with_results_stay() {
        let root = tempfile::tempdir().unwrap();
        let folder = OutputFolder::prepare(&root.path().join("a/b")).unwrap();
        std::fs::write(folder.path().join("points.csv"), "1").unwrap();
        drop(folder);
        assert!(root.path().join("a/b/points.csv").exists());
        // A folder that was there before stays although nothing was written.
        drop(OutputFolder::prepare(root.path()).unwrap());
        assert!(root.path().exists());
    }

    #[test]
    fn files_in_the_way_are_named() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("file");
        std::fs::write(&file, "").unwrap();
        #[cfg(unix)]
        {
            let link = root.path().join("link");
            std::os::unix::fs::symlink("nowhere", &link).unwrap();
            let error = OutputFolder::prepare(&link).unwrap_err().to_string();
            assert!(error.contains("is a link that leads nowhere"), "{error}");
        }
        for path in [file.clone(), file.join("a/b")] {
            let error = OutputFolder::prepare(&path).unwrap_err();
            assert!(
                matches!(&error, OutputError::NotAFolder { file: named, .. } if *named == file),
                "{error}"
            );
        }
    }
}
