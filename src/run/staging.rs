//! New files of a folder, written beside their place and put there when they are whole; what was there before is kept in
//! `previous/`.

use std::path::{Path, PathBuf};

use super::RunError;

/// Where the files that were there before are kept.
const PREVIOUS: &str = "previous";

/// New files in the making. Dropped before they are in place, they leave the folder as it was.
#[derive(Debug)]
pub(super) struct Staging {
    home: PathBuf,
    entries: &'static [&'static str],
    room: tempfile::TempDir,
}

impl Staging {
    /// Room beside the files of `home`, an existing folder. `entries` are the names of all files and folders that may ever stand
    /// there by this program's doing; others are left alone.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(super) fn new(home: &Path, entries: &'static [&'static str]) -> Result<Self, RunError> {
        let room = tempfile::Builder::new().prefix(".pbif-").tempdir_in(home);
        let room = room.map_err(|source| failed(home, source))?;
        let staging = Self {
            home: home.to_owned(),
            entries,
            room,
        };
        make(&staging.fresh())?;
        Ok(staging)
    }

    /// The folder to write the new files to.
    pub(super) fn fresh(&self) -> PathBuf {
        self.room.path().join("fresh")
    }

    /// Puts the new files in place. Those that were there before go to `previous/`, in place of what it held, but for the
    /// entries that are `staying`: these have a second place there. Returns the new files, those in folders by name.
    ///
    /// Every file that is replaced is there at any moment, in its old or its new form; a kill between leaves the earlier files
    /// whole in `previous/`.
    ///
    /// # Errors
    /// [`RunError::Read`] or [`RunError::Write`].
    pub(super) fn take_place(self, staying: &[&str]) -> Result<Vec<PathBuf>, RunError> {
        let (fresh, old) = (self.fresh(), self.room.path().join("old"));
        make(&old)?;
        self.keep_earlier(staying, &old)?;
        let mut files = Vec::new();
        for entry in self.entries {
            let (new, place) = (fresh.join(entry), self.home.join(entry));
            if !new.exists() {
                continue;
            }
            // A file is replaced in one step; a folder must make room first.
            if place.is_dir() {
                rename(&place, &old.join(entry))?;
            }
            rename(&new, &place)?;
            files.extend(files_of(place));
        }
        Ok(files)
    }

    /// Moves what was there to `previous/`; what is replaced or stays is given a second place there.
    fn keep_earlier(&self, staying: &[&str], old: &Path) -> Result<(), RunError> {
        let earlier = || {
            let there = |entry: &&&str| self.home.join(entry).exists();
            self.entries.iter().filter(there)
        };
        if earlier().next().is_none() {
            return Ok(());
        }
        let (kept, previous) = (self.room.path().join("kept"), self.home.join(PREVIOUS));
        make(&kept)?;
        let (linked, moved): (Vec<&str>, Vec<&str>) = earlier()
            .partition(|entry| staying.contains(entry) || self.fresh().join(entry).exists());
        for entry in linked {
            link_tree(&self.home.join(entry), &kept.join(entry))?;
        }
        if previous.exists() {
            rename(&previous, &old.join(PREVIOUS))?;
        }
        rename(&kept, &previous)?;
        for entry in moved {
            rename(&self.home.join(entry), &previous.join(entry))?;
        }
        Ok(())
    }
}

/// Gives a file or folder a second place: files are linked, and copied where the file system cannot link. What stands in the
/// two places is then never changed, only replaced, so either may be rewritten or removed. Nothing where `from` is not there.
///
/// # Errors
/// [`RunError::Read`] or [`RunError::Write`].
pub(super) fn link_tree(from: &Path, to: &Path) -> Result<(), RunError> {
    let unreadable = |source| RunError::Read {
        path: from.to_owned(),
        source,
    };
    if from.is_dir() {
        make(to)?;
        for entry in std::fs::read_dir(from).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            link_tree(&entry.path(), &to.join(entry.file_name()))?;
        }
    } else if from.is_file() && std::fs::hard_link(from, to).is_err() {
        std::fs::copy(from, to).map_err(|source| failed(to, source))?;
    }
    Ok(())
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

fn make(folder: &Path) -> Result<(), RunError> {
    std::fs::create_dir(folder).map_err(|source| failed(folder, source))
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
    fn new_files_take_their_place_and_earlier_ones_are_kept_whole() {
        let home = tempfile::tempdir().unwrap();
        let home = home.path();
        write(home, &[("notes", "mine"), ("previous/table", "0")]);
        write(home, &[("table", "1"), ("solved/a", "1"), ("drawn/a", "1")]);
        let staging = Staging::new(home, ENTRIES).unwrap();
        write(&staging.fresh(), &[("table", "2"), ("drawn/b", "2")]);
        let files = staging.take_place(&["solved"]).unwrap();
        assert_eq!(files, [home.join("table"), home.join("drawn/b")]);
        let now = [
            ("drawn/b", "2"),
            ("notes", "mine"),
            ("previous/drawn/a", "1"),
            ("previous/solved/a", "1"),
            ("previous/table", "1"),
            ("solved/a", "1"),
            ("table", "2"),
        ];
        assert_holds(home, &now);
        // Without new files everything moves away.
        let staging = Staging::new(home, ENTRIES).unwrap();
        assert!(staging.take_place(&[]).unwrap().is_empty());
        let now = [
            ("notes", "mine"),
            ("previous/drawn/b", "2"),
            ("previous/solved/a", "1"),
            ("previous/table", "2"),
        ];
        assert_holds(home, &now);
        // Where nothing was, the version before the last stays.
        Staging::new(home, ENTRIES)
            .unwrap()
            .take_place(&[])
            .unwrap();
        assert_holds(home, &now);
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
