//! Earlier versions of what a folder holds: kept for good in `previous/1`, `previous/2`, …, the highest number the
//! latest.

use std::path::{Path, PathBuf};

use super::RunError;
use super::atomic::sync_folder;
use super::tree::{is_part, link_tree, make, rename};

/// What a folder may hold by this program's doing: files and folders by name, the file that marks the folder first.
pub(super) type Entries = &'static [&'static str];

/// Where earlier versions are kept.
pub(super) const PREVIOUS: &str = "previous";

/// Gives the entries of a folder a second place as a new version and returns where. It appears as a whole: it is put
/// together in `room`, in the same file system.
///
/// # Errors
/// [`RunError::Read`] or [`RunError::Write`]; then everything is as it was.
pub(super) fn keep(home: &Path, entries: &[&str], room: &Path) -> Result<PathBuf, RunError> {
    let kept = room.join("kept");
    make(&kept)?;
    for entry in entries {
        link_tree(&home.join(entry), &kept.join(entry))?;
    }
    let previous = home.join(PREVIOUS);
    if !previous.is_dir() {
        make(&previous)?;
    }
    let number = numbers(&previous).last().map_or(1, |last| last + 1);
    let place = previous.join(number.to_string());
    rename(&kept, &place)?;
    sync_folder(&previous);
    Ok(place)
}

/// Takes back a version that was just made.
pub(super) fn undo(kept: &Path) {
    // One that cannot be removed is a copy too many, and no harm.
    let _ = std::fs::remove_dir_all(kept);
    if let Some(previous) = kept.parent() {
        let _ = std::fs::remove_dir(previous);
    }
}

/// Moves entries of a folder out of the way: all, or none where one cannot be moved.
///
/// # Errors
/// [`RunError::Write`].
pub(super) fn take_away(home: &Path, leaving: &[&str], gone: &Path) -> Result<(), RunError> {
    // Folders first: they are what another owner's rights protect. The file that marks the folder last.
    let (mut order, files): (Vec<&str>, Vec<&str>) =
        (leaving.iter().rev()).partition(|entry| home.join(entry).is_dir());
    order.extend(files);
    for (count, entry) in order.iter().enumerate() {
        if let Err(error) = rename(&home.join(entry), &gone.join(entry)) {
            for moved in order[..count].iter().rev() {
                let _ = std::fs::rename(gone.join(moved), home.join(moved));
            }
            return Err(error);
        }
    }
    Ok(())
}

/// The latest version, where it holds all that is there of the entries: after a kill, or after a run that made the same
/// again.
pub(super) fn kept_already(home: &Path, entries: &[&str]) -> Option<PathBuf> {
    let previous = home.join(PREVIOUS);
    let latest = previous.join(numbers(&previous).last()?.to_string());
    let mut there = entries.iter().filter(|entry| home.join(entry).exists());
    there
        .all(|entry| is_part(&home.join(entry), &latest.join(entry)))
        .then_some(latest)
}

/// Refuses a folder that holds one of the entries by somebody else's doing.
///
/// # Errors
/// [`RunError::NotOurs`].
pub(super) fn check_ours(home: &Path, entries: Entries) -> Result<(), RunError> {
    let there = |entry: &&&str| home.join(entry).symlink_metadata().is_ok();
    match entries.iter().find(there) {
        Some(entry) if *entry != entries[0] => Err(RunError::NotOurs {
            path: home.join(entry),
            mark: entries[0],
        }),
        _ => Ok(()),
    }
}

/// Numbers of the versions that are kept, ascending.
fn numbers(previous: &Path) -> Vec<u64> {
    let entries = std::fs::read_dir(previous).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut numbers: Vec<u64> = names.filter_map(|name| name.parse().ok()).collect();
    numbers.sort_unstable();
    numbers
}
