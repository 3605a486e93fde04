//! New files of a folder, written beside their place and put there when they are whole; what was there before is kept
//! for good, in `previous/1`, `previous/2`, …

use std::path::{Path, PathBuf};

use super::RunError;
use super::archive::{self, Entries};
use super::atomic::{clear_unfinished, sync_folder};
use super::lock::{FolderLock, holder_of};
use super::tree::{make, rename};
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
        let room = room.map_err(|source| RunError::Write {
            path: home.to_owned(),
            source,
        })?;
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
        self.room.path().join("fresh")
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
    /// `previous/`; the entries that are `staying` have their second place there.
    ///
    /// The earlier version is whole in `previous/` before the first file is replaced or taken away. Where that cannot
    /// be done, everything is as it was.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub(super) fn take_place(self, staying: &[&str]) -> Result<Placed, RunError> {
        let (fresh, gone) = (self.fresh(), self.room.path().join("gone"));
        make(&gone)?;
        let is_new = |entry: &&str| fresh.join(entry).exists();
        let is_there = |entry: &&str| self.home.join(entry).exists();
        let mut made = None;
        let mut kept = None;
        let mut all = self.entries.to_vec();
        if self.entries.iter().any(&is_there) {
            all.extend(self.about);
            kept = archive::kept_already(&self.home, &all);
            if kept.is_none() {
                made = Some(archive::keep(&self.home, &all, self.room.path())?);
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
        if let Err(error) = archive::take_away(&self.home, &leaving.collect::<Vec<_>>(), &gone) {
            if let Some(made) = &made {
                archive::undo(made);
            }
            return Err(error);
        }
        let mut files = Vec::new();
        // The file that marks the folder comes last: it tells of the others.
        for entry in self.entries.iter().rev().filter(|entry| is_new(entry)) {
            let place = self.home.join(entry);
            rename(&fresh.join(entry), &place)?;
            files.splice(0..0, files_of(place));
        }
        sync_folder(&self.home);
        let lock = self.lock;
        Ok(Placed { files, kept, lock })
    }
}

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
mod tests {
    use super::*;

    const ENTRIES: &[&str] = &["table", "solved", "drawn"];

    /// All files below a folder with their texts, sorted.
    fn texts(folder: &Path) -> Vec<(String, String)> {
        let mut found = Vec::new();
        let mut open = vec![folder.to_owned()];
        while let Some(next) = open.pop() {
            for entry in std::fs::read_dir(next).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    open.push(path);
                } else {
                    let name = path.strip_prefix(folder).unwrap().to_str().unwrap();
                    found.push((name.to_owned(), std::fs::read_to_string(&path).unwrap()));
                }
            }
        }
        found.sort();
        found
    }

    fn write(folder: &Path, files: &[(&str, &str)]) {
        for (name, text) in files {
            std::fs::create_dir_all(folder.join(name).parent().unwrap()).unwrap();
            std::fs::write(folder.join(name), text).unwrap();
        }
    }

    fn assert_holds(folder: &Path, files: &[(&str, &str)]) {
        let owned = |(name, text): &(&str, &str)| (name.to_string(), text.to_string());
        assert_eq!(texts(folder), files.iter().map(owned).collect::<Vec<_>>());
    }

    #[test]
    fn new_files_take_their_place_and_every_earlier_version_is_kept_whole() {
        let home = tempfile::tempdir().unwrap();
        let home = home.path();
        write(home, &[("notes", "mine"), ("previous/table", "0")]);
        write(home, &[("table", "1"), ("solved/a", "1"), ("drawn/a", "1")]);
        let staging = Staging::new(home, ENTRIES).unwrap();
        write(&staging.fresh(), &[("table", "2"), ("drawn/b", "2")]);
        let placed = staging.take_place(&["solved"]).unwrap();
        assert_eq!(placed.files, [home.join("table"), home.join("drawn/b")]);
        assert_eq!(placed.kept, Some(home.join("previous/1")));
        drop(placed);
        let first = [
            ("previous/1/drawn/a", "1"),
            ("previous/1/solved/a", "1"),
            ("previous/1/table", "1"),
        ];
        let beside = [("notes", "mine")];
        let oldest = [("previous/table", "0")];
        let now = [
            &[("drawn/b", "2")][..],
            &beside,
            &first,
            &oldest,
            &[("solved/a", "1"), ("table", "2")],
        ];
        assert_holds(home, &now.concat());
        // Without new files everything moves away, and nothing that was kept is touched.
        let staging = Staging::new(home, ENTRIES).unwrap();
        assert!(staging.take_place(&[]).unwrap().files.is_empty());
        let second = [
            ("previous/2/drawn/b", "2"),
            ("previous/2/solved/a", "1"),
            ("previous/2/table", "2"),
        ];
        assert_holds(home, &[&beside[..], &first, &second, &oldest].concat());
        // Where nothing was, nothing is kept.
        let staging = Staging::new(home, ENTRIES).unwrap();
        assert_eq!(staging.take_place(&[]).unwrap().kept, None);
        assert_holds(home, &[&beside[..], &first, &second, &oldest].concat());
    }

    #[test]
    fn work_about_the_files_moves_with_them() {
        let home = tempfile::tempdir().unwrap();
        let home = home.path();
        let staged = || Staging::new(home, ENTRIES).unwrap().with(&["about"]);
        write(home, &[("about/a/b", "mine")]);
        // Without files of an earlier version it is somebody else's.
        staged().unwrap().take_place(&[]).unwrap();
        assert_holds(home, &[("about/a/b", "mine")]);
        write(home, &[("table", "1"), ("about/a/b", "1")]);
        let lock = FolderLock::take(&home.join("about/a")).unwrap();
        assert!(matches!(staged(), Err(RunError::InUse { .. })));
        drop(lock);
        staged().unwrap().take_place(&[]).unwrap();
        let kept = [("previous/1/about/a/b", "1"), ("previous/1/table", "1")];
        assert_holds(home, &kept);
        // Where it stays it has a second place.
        write(home, &[("table", "2"), ("about/a/b", "2")]);
        staged().unwrap().take_place(&["about"]).unwrap();
        let second = [("previous/2/about/a/b", "2"), ("previous/2/table", "2")];
        assert_holds(home, &[&[("about/a/b", "2")], &kept[..], &second].concat());
    }

    #[test]
    fn what_a_kill_left_half_moved_is_not_kept_twice() {
        let home = tempfile::tempdir().unwrap();
        let home = home.path();
        write(home, &[("table", "1"), ("previous/1/table", "1")]);
        write(
            home,
            &[("previous/1/solved/a", "1"), (".pbif-x/gone/solved/a", "1")],
        );
        let staging = Staging::new(home, ENTRIES).unwrap();
        staging.take_place(&[]).unwrap();
        let kept = [("previous/1/solved/a", "1"), ("previous/1/table", "1")];
        assert_holds(home, &kept);
    }

    #[test]
    fn what_is_not_ours_is_not_touched() {
        let home = tempfile::tempdir().unwrap();
        let mine = [("drawn/sketch", "mine")];
        write(home.path(), &mine);
        let error = Staging::new(home.path(), ENTRIES).unwrap_err();
        assert!(
            matches!(&error, RunError::NotOurs { path, mark: "table" }
            if *path == home.path().join("drawn")),
            "{error}"
        );
        assert_holds(home.path(), &mine);
    }

    #[cfg(unix)]
    #[test]
    fn a_version_that_cannot_be_moved_stays_where_it_is() {
        use std::os::unix::fs::PermissionsExt as _;
        let home = tempfile::tempdir().unwrap();
        let home = home.path();
        let files = [("solved/a", "1"), ("table", "1")];
        write(home, &files);
        let rights = |mode| std::fs::Permissions::from_mode(mode);
        std::fs::set_permissions(home.join("solved"), rights(0o555)).unwrap();
        let staging = Staging::new(home, ENTRIES).unwrap();
        let taken = staging.take_place(&[]);
        // The superuser may move it all the same.
        if taken.is_err() {
            assert_holds(home, &files);
        }
        for place in [home.join("solved"), home.join("previous/1/solved")] {
            let _ = std::fs::set_permissions(place, rights(0o755));
        }
    }

    #[test]
    fn new_files_that_are_given_up_leave_nothing() {
        let home = tempfile::tempdir().unwrap();
        write(home.path(), &[("table", "1")]);
        let staging = Staging::new(home.path(), ENTRIES).unwrap();
        write(&staging.fresh(), &[("table", "2")]);
        drop(staging);
        assert_holds(home.path(), &[("table", "1")]);
    }
}
