//! Files that appear whole or not at all: written beside their place, then renamed into it.

use std::fs::{File, FileType};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::RunError;
use crate::UNFINISHED;

/// Writes a file into a folder that is there, so that a killed program leaves either the old content or the new.
pub(crate) fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    write(path, bytes, false).map(drop)
}

/// The same of a file that a user wants anywhere: missing folders on the way are made.
pub(crate) fn write_anywhere(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(RunError::writing(folder))?;
    write_atomically(path, bytes)
}

/// The same of a file below the folder `home`; folders that are missing on the way from there are made, see
/// [`make_below`].
pub(super) fn write_below(home: &Path, path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    // Most folders are there already: they are made only where they are missed.
    write_atomically(path, bytes).or_else(|_| {
        make_below(home, path.parent().unwrap_or(home))?;
        write_atomically(path, bytes)
    })
}

/// Makes a folder below `home` with those on the way. `home` itself is not made: where it was moved or removed, nothing
/// takes its place.
pub(super) fn make_below(home: &Path, folder: &Path) -> Result<(), RunError> {
    let mut folders: Vec<&Path> = folder.ancestors().collect();
    folders.retain(|one| one.starts_with(home) && *one != home && !one.is_dir());
    for folder in folders.into_iter().rev() {
        match std::fs::create_dir(folder) {
            // Somebody else may have made it meanwhile.
            Err(source) if !folder.is_dir() => {
                return Err(RunError::writing(folder)(source));
            }
            _ => {}
        }
    }
    Ok(())
}

/// The same so that a machine that loses its power leaves either of them, too. It waits for the disk, about as long as
/// a hundred files take that are written without: for files that tell of others.
pub(super) fn write_durably(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    begin_durably(path, bytes).map(drop)
}

/// The same of a file that is to grow: it is given open, at its end.
pub(super) fn begin_durably(path: &Path, bytes: &[u8]) -> Result<File, RunError> {
    let file = write(path, bytes, true)?;
    sync_folder(path.parent().unwrap_or(Path::new(".")));
    Ok(file)
}

fn write(path: &Path, bytes: &[u8], durably: bool) -> Result<File, RunError> {
    let failed = RunError::writing(path);
    let folder = path.parent().unwrap_or(Path::new("."));
    let begun = || {
        let mut builder = tempfile::Builder::new();
        let builder = builder.prefix(UNFINISHED).permissions_of_new_files();
        builder.tempfile_in(folder)
    };
    let mut file = begun().map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    if durably {
        file.as_file().sync_all().map_err(failed)?;
    }
    file.persist(path).map_err(|error| failed(error.error))
}

/// Makes the names in a folder durable, where the system lets folders be synchronised.
pub(super) fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        // A file system that cannot has nothing to be waited for.
        let _ = folder.sync_all();
    }
}

/// Files that the disk is asked to take side by side: it puts what is asked for at one time into one go.
const AT_ONCE: usize = 16;

/// Waits until files, and folders with all that they hold, are on the disk; those that are not there are left out. Only
/// they are waited for, not what other programs write meanwhile.
///
/// # Errors
/// [`RunError::Read`] when a folder cannot be read, [`RunError::Write`] when the disk takes a file not.
pub(super) fn sync_all(places: &[PathBuf]) -> Result<(), RunError> {
    let (mut files, mut open, mut folders) = (Vec::new(), Vec::new(), Vec::new());
    let mut sort = |path: PathBuf, kind: FileType, open: &mut Vec<PathBuf>| match () {
        () if kind.is_dir() => open.push(path),
        () if kind.is_file() => files.push(path),
        () => {}
    };
    for place in places {
        if let Ok(found) = place.metadata() {
            sort(place.clone(), found.file_type(), &mut open);
        }
    }
    while let Some(path) = open.pop() {
        for entry in std::fs::read_dir(&path).map_err(RunError::reading(&path))? {
            let entry = entry.map_err(RunError::reading(&path))?;
            // What a folder says of its entries spares thousands of questions.
            let kind = entry.file_type();
            let kind = kind.map_err(RunError::reading(&path))?;
            sort(entry.path(), kind, &mut open);
        }
        folders.push(path);
    }
    sync_each(&files, sync_file)?;
    // Names of files that are not on the disk would be worth nothing.
    sync_each(&folders, |folder| {
        sync_folder(folder);
        Ok(())
    })
}

fn sync_each(
    paths: &[PathBuf],
    sync: impl Fn(&Path) -> Result<(), RunError> + Sync,
) -> Result<(), RunError> {
    let next = AtomicUsize::new(0);
    let failure = Mutex::new(None);
    let work = || {
        while let Some(path) = paths.get(next.fetch_add(1, Ordering::Relaxed)) {
            if let Err(error) = sync(path) {
                let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
                failure.get_or_insert(error);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..AT_ONCE.min(paths.len()) {
            // Where there is no thread to be had, the others do its work.
            let _ = std::thread::Builder::new().spawn_scoped(scope, work);
        }
        work();
    });
    let failure = failure.into_inner().unwrap_or_else(PoisonError::into_inner);
    failure.map_or(Ok(()), Err)
}

fn sync_file(path: &Path) -> Result<(), RunError> {
    // Some systems synchronise only what may be written.
    let mut options = File::options();
    options.read(true).write(cfg!(windows));
    let synced = options.open(path).and_then(|file| file.sync_all());
    synced.map_err(RunError::writing(path))
}

/// Temporary files are private by default; results should be as readable as any other new file.
trait NewFilePermissions {
    fn permissions_of_new_files(&mut self) -> &mut Self;
}

impl NewFilePermissions for tempfile::Builder<'_, '_> {
    #[cfg(unix)]
    fn permissions_of_new_files(&mut self) -> &mut Self {
        use std::os::unix::fs::PermissionsExt;
        // The process's umask takes away from this what the user wants taken away.
        self.permissions(std::fs::Permissions::from_mode(0o666))
    }

    #[cfg(not(unix))]
    fn permissions_of_new_files(&mut self) -> &mut Self {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_below_is_waited_for_and_what_is_not_there_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("a/b/c");
        std::fs::create_dir_all(&deep).unwrap();
        for number in 0..100 {
            std::fs::write(deep.join(number.to_string()), "x").unwrap();
        }
        sync_all(&[folder.path().join("a"), folder.path().join("missing")]).unwrap();
        assert!(sync_file(&deep.join("gone")).is_err());
        sync_all(&[]).unwrap();
    }

    #[test]
    fn folders_are_made_below_a_home_that_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let home = folder.path().join("run");
        let file = home.join("store/p_x/c/0");
        assert!(write_below(&home, &file, b"1").is_err());
        assert!(!home.exists());
        std::fs::create_dir(&home).unwrap();
        write_below(&home, &file, b"1").unwrap();
        write_below(&home, &file, b"2").unwrap();
        assert_eq!(std::fs::read(file).unwrap(), b"2");
    }
}
