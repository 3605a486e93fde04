//! New files that are moved into their place one after the other. What is to be moved is written down before, so that
//! what a kill leaves half moved is moved to its end by whoever opens the folder next.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::atomic::{sync_folder, write_durably};
use super::lock::FolderLock;
use super::place::read;
use super::tree::rename;
use super::{RunError, archive};
use crate::UNFINISHED;

/// Name of the file in a room that says what is moved.
const NAME: &str = "moves.json";

/// Folder of a room with the new files.
pub(super) const FRESH: &str = "fresh";

/// Folder of a room for what makes way.
pub(super) const GONE: &str = "gone";

/// What is moved between a folder and a room in it, by name.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Moves {
    /// What leaves the folder.
    pub(super) away: Vec<String>,
    /// What comes in this order: the file that marks the folder is the last.
    pub(super) into: Vec<String>,
}

impl Moves {
    /// Writes down what is about to be moved.
    ///
    /// # Errors
    /// [`RunError::Json`], [`RunError::Write`].
    pub(super) fn announce(&self, room: &Path) -> Result<(), RunError> {
        write_durably(&room.join(NAME), &serde_json::to_vec(self)?)
    }

    /// Moves what leaves, as far as it has not left yet: all, or none where one cannot be moved.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(super) fn make_way(&self, home: &Path, room: &Path) -> Result<(), RunError> {
        let gone = room.join(GONE);
        let names = self.away.iter().map(String::as_str);
        let is_left = |name: &&str| home.join(name).exists() && !gone.join(name).exists();
        let left: Vec<&str> = names.filter(is_left).collect();
        archive::take_away(home, &left, &gone)
    }

    /// Moves what comes, as far as it has not come yet.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(super) fn put(&self, home: &Path, room: &Path) -> Result<(), RunError> {
        let fresh = room.join(FRESH);
        for name in self.into.iter().filter(|name| fresh.join(name).exists()) {
            rename(&fresh.join(name), &home.join(name))?;
        }
        sync_folder(home);
        forget(room)
    }

    /// Those that were written down in a room, if they can be read.
    fn of(room: &Path) -> Option<Self> {
        let moves: Self = serde_json::from_slice(&read(&room.join(NAME)).ok()?).ok()?;
        let mut names = moves.away.iter().chain(&moves.into);
        // Nothing is moved between other folders.
        let is_name = |name: &String| Path::new(name).file_name() == Some(name.as_ref());
        names.all(is_name).then_some(moves)
    }
}

/// Takes back what was written down. It goes before the rest of the room, without which it would be read wrongly.
///
/// # Errors
/// [`RunError::Write`].
pub(super) fn forget(room: &Path) -> Result<(), RunError> {
    let path = room.join(NAME);
    std::fs::remove_file(&path).map_err(|source| RunError::Write { path, source })
}

/// Moves to its end what a kill left half moved in a folder. Nothing happens where another process writes there, or the
/// folder cannot be written to: whoever comes next may.
pub(super) fn finish_after_kill(home: &Path) {
    if rooms(home).any(|room| room.join(NAME).exists())
        && let Ok(_lock) = FolderLock::take(home)
    {
        finish(home);
    }
}

/// The same where nobody else writes to the folder.
fn finish(home: &Path) {
    for room in rooms(home) {
        let Some(moves) = Moves::of(&room) else {
            continue;
        };
        let moved = moves.make_way(home, &room);
        if moved.and_then(|()| moves.put(home, &room)).is_ok() {
            // One that cannot be removed is in nobody's way.
            let _ = std::fs::remove_dir_all(room);
        }
    }
}

/// The rooms in a folder.
fn rooms(home: &Path) -> impl Iterator<Item = PathBuf> {
    let entries = std::fs::read_dir(home).into_iter().flatten().flatten();
    let is_room = |entry: &std::fs::DirEntry| {
        let name = entry.file_name();
        let is_unfinished = name.to_string_lossy().starts_with(UNFINISHED);
        is_unfinished && entry.file_type().is_ok_and(|kind| kind.is_dir())
    };
    entries.filter(is_room).map(|entry| entry.path())
}

/// Clears what a killed process has left in a run, which nobody else writes to: what was half moved is moved to its
/// end, and what was in the making is removed, files in the run's folder and below its folders `own`, and rooms in its
/// folder. Other folders are a user's.
pub(super) fn clear_unfinished(run: &Path, own: &[&str]) {
    finish(run);
    let mut open = vec![run.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let is_unfinished = name.starts_with(UNFINISHED);
            match entry.file_type() {
                // What could not be moved has its only place in the room. What cannot be removed is in nobody's way.
                Ok(kind) if kind.is_dir() && folder == run && is_unfinished => {
                    let room = Some(entry.path()).filter(|room| !room.join(NAME).exists());
                    let _ = room.map(std::fs::remove_dir_all);
                }
                Ok(kind) if kind.is_dir() && (folder != run || own.contains(&&*name)) => {
                    open.push(entry.path());
                }
                Ok(kind) if kind.is_file() && is_unfinished => {
                    let _ = std::fs::remove_file(entry.path());
                }
                _ => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_process_left_is_cleared_and_nothing_else() {
        let run = tempfile::tempdir().unwrap();
        let put = |name: &str| {
            let path = run.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, "1").unwrap();
            path
        };
        let left = [
            ".pbif-a1",
            ".pbif-room/kept/points.csv",
            "densities.zarr/p_x/c/.pbif-b2",
            "figures/.pbif-c3",
        ];
        let left = left.map(put);
        let kept = ["points.csv", ".hidden", "notes/.pbif-mine", "figures/x.svg"].map(put);
        clear_unfinished(run.path(), &["densities.zarr", "figures"]);
        assert!(left.iter().all(|path| !path.exists()));
        assert!(kept.iter().all(|path| path.exists()));
    }

    #[test]
    fn nothing_outside_the_folder_is_moved() {
        let place = tempfile::tempdir().unwrap();
        let home = place.path().join("run");
        let room = home.join(".pbif-room");
        std::fs::create_dir_all(room.join(GONE)).unwrap();
        std::fs::write(place.path().join("mine"), "1").unwrap();
        for name in ["../mine", "..", "a/../../mine"] {
            let moves = Moves {
                away: vec![name.to_owned()],
                into: Vec::new(),
            };
            moves.announce(&room).unwrap();
            finish_after_kill(&home);
            assert!(place.path().join("mine").exists() && room.join(NAME).exists());
        }
    }
}
