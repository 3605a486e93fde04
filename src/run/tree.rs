//! Files and folders as trees: linked, compared, moved.

use std::path::Path;

use super::RunError;
use super::place::read;

/// Gives a file or folder a second place: files are linked, and copied where the file system cannot link. What stands
/// in the two places is then never changed, only replaced, so either may be rewritten or removed. Nothing where `from`
/// is not there.
///
/// # Errors
/// [`RunError::Read`] or [`RunError::Write`].
pub(super) fn link_tree(from: &Path, to: &Path) -> Result<(), RunError> {
    let unreadable = RunError::reading(from);
    if from.is_dir() {
        make(to)?;
        for entry in std::fs::read_dir(from).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            link_tree(&entry.path(), &to.join(entry.file_name()))?;
        }
    } else {
        link(from, to)?;
    }
    Ok(())
}

/// The same of a file alone.
///
/// # Errors
/// [`RunError::Write`].
pub(super) fn link(from: &Path, to: &Path) -> Result<(), RunError> {
    if std::fs::hard_link(from, to).is_ok() || !from.is_file() {
        return Ok(());
    }
    // Its folder may not be there yet.
    if let Some(folder) = to.parent().filter(|folder| !folder.is_dir()) {
        std::fs::create_dir_all(folder).map_err(RunError::writing(folder))?;
        if std::fs::hard_link(from, to).is_ok() {
            return Ok(());
        }
    }
    std::fs::copy(from, to).map_err(RunError::writing(to))?;
    Ok(())
}

/// Whether everything below `part` is also below `whole`, with the same bytes.
pub(super) fn is_part(part: &Path, whole: &Path) -> bool {
    if part.is_dir() {
        let Ok(mut entries) = std::fs::read_dir(part) else {
            return false;
        };
        return entries.all(|entry| {
            entry.is_ok_and(|entry| is_part(&entry.path(), &whole.join(entry.file_name())))
        });
    }
    let sizes = [part, whole].map(|file| file.metadata().map(|data| data.len()).ok());
    if sizes[0].is_none() || sizes[0] != sizes[1] {
        return false;
    }
    is_same_file(part, whole) || matches!((read(part), read(whole)), (Ok(a), Ok(b)) if a == b)
}

/// Whether two names are of one file.
#[cfg(unix)]
fn is_same_file(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    match (one.metadata(), other.metadata()) {
        (Ok(one), Ok(other)) => one.dev() == other.dev() && one.ino() == other.ino(),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_same_file(_: &Path, _: &Path) -> bool {
    false
}

/// Makes a folder that is not there.
pub(super) fn make(folder: &Path) -> Result<(), RunError> {
    std::fs::create_dir(folder).map_err(RunError::writing(folder))
}

/// Moves a file or folder.
pub(super) fn rename(from: &Path, to: &Path) -> Result<(), RunError> {
    std::fs::rename(from, to).map_err(RunError::writing(to))
}
