//! One writer a folder: a lock that tells who holds it and that ends with its process, however that ends.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

use super::RunError;

/// Name of the lock's file.
const NAME: &str = ".pbif.lock";

/// How often a lock is taken that its last holder removed in that moment.
const TRIES: usize = 8;

/// The right to write to a folder, until it is dropped.
#[derive(Debug)]
pub(super) struct FolderLock {
    path: PathBuf,
    /// The system's lock hangs on the open file: the process may be killed, and no stale lock is left.
    file: File,
}

impl FolderLock {
    /// Takes the lock of an existing folder. On file systems that know no locks there is none, and no protection.
    ///
    /// # Errors
    /// [`RunError::InUse`] when another process writes to the folder; [`RunError::Write`].
    pub(super) fn take(folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(NAME);
        let failed = RunError::writing(&path);
        for _ in 0..TRIES {
            let mut options = OpenOptions::new();
            options.read(true).write(true).create(true).truncate(false);
            let mut file = options.open(&path).map_err(failed)?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => {
                    return Err(RunError::InUse {
                        path: folder.to_owned(),
                        holder: holder(&mut file),
                    });
                }
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            // The holder before removes the file when it ends: a lock on a file without a name is none.
            if is_there(&file, &path) {
                sign(&mut file).map_err(failed)?;
                return Ok(Self { path, file });
            }
        }
        Err(RunError::InUse {
            path: folder.to_owned(),
            holder: "another process".to_owned(),
        })
    }
}

/// Who writes to a folder now; `None` where nobody does, or there is no telling.
pub(super) fn holder_of(folder: &Path) -> Option<String> {
    let path = folder.join(NAME);
    let mut file = path.is_file().then(|| File::open(path).ok())??;
    match file.try_lock_shared() {
        Err(TryLockError::WouldBlock) => Some(holder(&mut file)),
        _ => None,
    }
}

impl FolderLock {
    /// Whether the folder is still the one whose lock was taken.
    pub(super) fn holds(&self) -> bool {
        is_there(&self.file, &self.path)
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // Removed while it is still held, so that nobody else's file is.
        if self.holds() {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Who holds a lock, by its file.
fn holder(file: &mut File) -> String {
    let mut text = String::new();
    match file.take(200).read_to_string(&mut text) {
        Ok(_) if !text.trim().is_empty() => text.trim().to_owned(),
        _ => "another process".to_owned(),
    }
}

/// Writes who holds the lock.
fn sign(file: &mut File) -> std::io::Result<()> {
    let host = sysinfo::System::host_name();
    let host = host.map_or(String::new(), |host| format!(" on {host}"));
    file.set_len(0)?;
    file.rewind()?;
    writeln!(file, "process {}{host}", std::process::id())
}

/// Whether an open file still has its name.
#[cfg(unix)]
fn is_there(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    match (file.metadata(), path.metadata()) {
        (Ok(open), Ok(named)) => open.dev() == named.dev() && open.ino() == named.ino(),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_there(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_one_writer_who_is_named() {
        let home = tempfile::tempdir().unwrap();
        let lock = FolderLock::take(home.path()).unwrap();
        let error = FolderLock::take(home.path()).unwrap_err();
        let words = format!("process {}", std::process::id());
        assert!(error.to_string().contains(&words), "{error}");
        let words = format!("process {}", std::process::id());
        assert!(holder_of(home.path()).unwrap().contains(&words));
        drop(lock);
        assert_eq!(holder_of(home.path()), None);
        assert_eq!(std::fs::read_dir(home.path()).unwrap().count(), 0);
        // What a killed process leaves is a file without a lock.
        std::fs::write(home.path().join(NAME), "process 1 on elsewhere").unwrap();
        FolderLock::take(home.path()).unwrap();
    }
}
