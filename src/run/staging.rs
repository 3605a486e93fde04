//! New files of a folder, written beside their place and put there when they are whole; what was there before is kept
//! for good, in `previous/1`, `previous/2`, …

use std::path::{Path, PathBuf};

use super::RunError;
use super::archive::{self, Entries};
use super::lock::{FolderLock, holder_of};
use super::placing::{FRESH, GONE, Moves, clear_unfinished, forget};
use super::tree::make;
use crate::UNFINISHED;

/// New files in the making. Dropped before they are in place, they leave the folder as it was. While it lives, no other
/// process writes to the folder.
#[derive(Debug)]
pub(super) struct Staging {
    home: PathBuf,
    entries: Entries,
    /// Folders of work of its own that is about the files, see [`Staging::with`].
    about: Entries,
    room: tempfile::TempDir,
    lock: FolderLock,
}

impl Staging {
    /// Room beside the files of `home`, an existing folder, of which other writers are kept away. `entries` are the
    /// names of all files and folders that may ever stand there by this program's doing; others are left alone.
    ///
    /// # Errors
    /// [`RunError::InUse`] when another process writes there; [`RunError::NotOurs`] when one of the entries is there
    /// without the first, which marks the folder; [`RunError::Read`] and [`RunError::Write`].
    pub(super) fn new(home: &Path, entries: Entries) -> Result<Self, RunError> {
        let lock = FolderLock::take(home)?;
        clear_unfinished(home, &[]);
        archive::check_ours(home, entries)?;
        let room = tempfile::Builder::new().prefix(UNFINISHED).tempdir_in(home);
        let room = room.map_err(RunError::writing(home))?;
        let staging = Self {
            home: home.to_owned(),
            entries,
            about: &[],
            room,
            lock,
        };
        make(&staging.fresh())?;
        Ok(staging)
    }

    /// The same where folders beside the files hold folders of work that is about them: where the files of an earlier
    /// version move, they do.
    ///
    /// # Errors
    /// [`RunError::InUse`] when another process writes to one of those folders.
    pub(super) fn with(self, about: Entries) -> Result<Self, RunError> {
        let folders = about.iter().map(|name| self.home.join(name));
        let entries = folders.flat_map(std::fs::read_dir).flatten().flatten();
        for path in entries.map(|entry| entry.path()) {
            if let Some(holder) = holder_of(&path) {
                return Err(RunError::InUse { path, holder });
            }
        }
        Ok(Self { about, ..self })
    }

    /// Where the files are to stand.
    pub(super) fn home(&self) -> &Path {
        &self.home
    }

    /// What keeps other writers away.
    pub(super) fn lock(&self) -> &FolderLock {
        &self.lock
    }

    /// The folder to write the new files to.
    pub(super) fn fresh(&self) -> PathBuf {
        self.room.path().join(FRESH)
    }

    /// Gives files of unfinished work, if there are any, a place of their own below `previous/`.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub(super) fn keep_aside(&self, names: &[&str]) -> Result<(), RunError> {
        let there = |name: &&&str| self.home.join(name).exists();
        if names.iter().any(|name| there(&name)) {
            archive::keep(&self.home, names, self.room.path())?;
        }
        for name in names.iter().filter(there) {
            let path = self.home.join(name);
            std::fs::remove_file(&path).map_err(|source| RunError::Write { path, source })?;
        }
        Ok(())
    }

    /// Puts the new files in place. Those that were there before become a complete version of their own below
    /// `previous/`; the entries that are `staying` have their second place there, and what is `done` with goes.
    ///
    /// The earlier version is whole in `previous/` before the first file is replaced or taken away. Where that cannot
    /// be done, everything is as it was. What is begun is ended after a kill by whoever opens the folder next.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub(super) fn take_place(self, staying: &[&str], done: &[&str]) -> Result<Placed, RunError> {
        let (moves, made, kept) = self.begin(staying, done)?;
        if let Err(error) = moves.make_way(&self.home, self.room.path()) {
            forget(self.room.path())?;
            if let Some(made) = &made {
                archive::undo(made);
            }
            return Err(error);
        }
        moves.put(&self.home, self.room.path())?;
        let places = moves.into.iter().rev().map(|name| self.home.join(name));
        let files = places.flat_map(files_of).collect();
        let lock = self.lock;
        Ok(Placed { files, kept, lock })
    }

    /// Keeps the earlier version and writes down what is to be moved: that, the version where one was made now, and
    /// where the earlier one is.
    fn begin(&self, staying: &[&str], done: &[&str]) -> Result<Begun, RunError> {
        let (fresh, room) = (self.fresh(), self.room.path());
        make(&room.join(GONE))?;
        let is_new = |entry: &&str| fresh.join(entry).exists();
        let is_there = |entry: &&str| self.home.join(entry).exists();
        let (mut made, mut kept) = (None, None);
        let mut all = self.entries.to_vec();
        if self.entries.iter().any(&is_there) {
            all.extend(self.about);
            kept = archive::kept_already(&self.home, &all);
            if kept.is_none() {
                made = Some(archive::keep(&self.home, &all, room)?);
                kept.clone_from(&made);
            }
        }
        // A file is replaced in one step; folders, and what is not there any more, make room first.
        let leaving = all.into_iter().filter(|entry| {
            let stays = if is_new(entry) {
                !self.home.join(entry).is_dir()
            } else {
                staying.contains(entry)
            };
            is_there(entry) && !stays
        });
        let leaving = leaving.chain(done.iter().copied().filter(is_there));
        // The file that marks the folder comes last: it tells of the others.
        let coming = self.entries.iter().rev().copied().filter(is_new);
        let moves = Moves {
            away: leaving.map(str::to_owned).collect(),
            into: coming.map(str::to_owned).collect(),
        };
        moves.announce(room)?;
        Ok((moves, made, kept))
    }
}

/// What is to be moved, the version that was kept now, and where the earlier version is.
type Begun = (Moves, Option<PathBuf>, Option<PathBuf>);

/// What stands where it should.
#[derive(Debug)]
pub(super) struct Placed {
    /// The new files, those in folders by name.
    pub(super) files: Vec<PathBuf>,
    /// Where the earlier version is.
    pub(super) kept: Option<PathBuf>,
    /// Whoever goes on writing holds on to it.
    pub(super) lock: FolderLock,
}

/// A file, or the files of a folder by name.
fn files_of(path: PathBuf) -> Vec<PathBuf> {
    match std::fs::read_dir(&path) {
        Ok(inside) => {
            let mut inside: Vec<PathBuf> = inside.flatten().map(|one| one.path()).collect();
            inside.sort();
            inside
        }
        Err(_) => vec![path],
    }
}

#[cfg(test)]
mod tests;
