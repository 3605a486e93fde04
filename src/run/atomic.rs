//! Files that appear whole or not at all: written beside their place, then renamed into it.

use std::io::Write;
use std::path::Path;

use super::RunError;

/// Writes a file so that a killed program leaves either the old content or the new. Missing folders on the
/// way are made.
pub(crate) fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    write(path, bytes, false)
}

/// The same so that a machine that loses its power leaves either of them, too. It waits for the disk, about as long as a hundred files
/// take that are written without: for files that tell of others.
pub(super) fn write_durably(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    write(path, bytes, true)?;
    sync_folder(path.parent().unwrap_or(Path::new(".")));
    Ok(())
}

fn write(path: &Path, bytes: &[u8], durably: bool) -> Result<(), RunError> {
    let failed = |source| RunError::Write {
        path: path.to_owned(),
        source,
    };
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(failed)?;
    let mut file = tempfile::Builder::new()
        .permissions_of_new_files()
        .tempfile_in(folder)
        .map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    if durably {
        file.as_file().sync_all().map_err(failed)?;
    }
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Makes the names in a folder durable, where the system lets folders be synchronised.
pub(super) fn sync_folder(folder: &Path) {
    if let Ok(folder) = std::fs::File::open(folder) {
        // A file system that cannot has nothing to be waited for.
        let _ = folder.sync_all();
    }
}

/// Waits until everything below a folder is on the disk.
///
/// # Errors
/// [`RunError::Write`] when the disk takes it not.
#[cfg(target_os = "linux")]
pub(super) fn sync_all_below(folder: &Path) -> Result<(), RunError> {
    let failed = |source| RunError::Write {
        path: folder.to_owned(),
        source,
    };
    // One call for thousands of small files.
    let open = std::fs::File::open(folder).map_err(failed)?;
    rustix::fs::syncfs(open).map_err(|error| failed(error.into()))
}

/// See above: file by file.
#[cfg(not(target_os = "linux"))]
pub(super) fn sync_all_below(folder: &Path) -> Result<(), RunError> {
    let failed = |source| RunError::Write {
        path: folder.to_owned(),
        source,
    };
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() {
            sync_all_below(&path)?;
        } else if let Ok(file) = std::fs::File::options().write(true).open(&path) {
            file.sync_all().map_err(failed)?;
        }
    }
    sync_folder(folder);
    Ok(())
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
