//! A folder that is made beside the one whose place it takes.
//!
//! Where the system can, the two change places in one step. Where it cannot, a kill between two steps leaves the place
//! empty, and readers take what stands beside it.

use std::path::{Path, PathBuf};

use super::RunError;
use super::tree::rename;

/// A folder in the making, `NAME.new`; dropped before it is in place, it is removed.
pub(super) struct Fresh {
    /// Where it is made.
    pub(super) path: PathBuf,
}

impl Fresh {
    /// Room beside `place`; what a kill left there is removed.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(super) fn beside(place: &Path) -> Result<Self, RunError> {
        let path = beside(place, "new");
        if path.exists() {
            remove(&path)?;
        }
        Ok(Self { path })
    }

    /// Puts it into its place and gives what was there, which is removed when it is dropped.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(super) fn take_place(self, place: &Path) -> Result<Option<Leftover>, RunError> {
        if !place.exists() {
            rename(&self.path, place)?;
            return Ok(None);
        }
        if exchange(&self.path, place) {
            let old = Leftover(self.path.clone());
            // What stands there now is the old one.
            std::mem::forget(self);
            return Ok(Some(old));
        }
        let old = beside(place, "old");
        if old.exists() {
            remove(&old)?;
        }
        rename(place, &old)?;
        rename(&self.path, place)?;
        Ok(Some(Leftover(old)))
    }
}

/// A folder whose place was taken; dropped, it is removed.
#[derive(Debug)]
pub(super) struct Leftover(PathBuf);

impl Drop for Leftover {
    fn drop(&mut self) {
        // One that cannot be removed is in nobody's way.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

impl Drop for Fresh {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.path);
    }
}

/// Where the folder of this place is, which a kill may have left beside it; `mark` is the file that it has when it is
/// whole.
pub(super) fn standing(place: &Path, mark: &str) -> PathBuf {
    let beside = ["new", "old"].map(|word| beside(place, word));
    let mut all = [place.to_owned()].into_iter().chain(beside);
    all.find(|folder| folder.join(mark).is_file())
        .unwrap_or_else(|| place.to_owned())
}

fn beside(place: &Path, word: &str) -> PathBuf {
    let mut name = place.as_os_str().to_owned();
    name.push(".");
    name.push(word);
    PathBuf::from(name)
}

fn remove(folder: &Path) -> Result<(), RunError> {
    std::fs::remove_dir_all(folder).map_err(|source| RunError::Write {
        path: folder.to_owned(),
        source,
    })
}

/// Lets two folders change places in one step; `false` where the system cannot.
#[cfg(target_os = "linux")]
fn exchange(one: &Path, other: &Path) -> bool {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE).is_ok()
}

#[cfg(not(target_os = "linux"))]
fn exchange(_: &Path, _: &Path) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, text: &str) {
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(folder.join("mark"), text).unwrap();
    }

    fn read(folder: &Path) -> String {
        std::fs::read_to_string(folder.join("mark")).unwrap()
    }

    #[test]
    fn a_new_folder_takes_the_place_of_the_old_one_or_nothing_happens() {
        let home = tempfile::tempdir().unwrap();
        let place = home.path().join("store");
        write(&beside(&place, "new"), "left over");
        for text in ["1", "2", "3"] {
            let fresh = Fresh::beside(&place).unwrap();
            assert!(!fresh.path.exists());
            write(&fresh.path, text);
            fresh.take_place(&place).unwrap();
            assert_eq!(read(&place), text);
        }
        let given_up = Fresh::beside(&place).unwrap();
        write(&given_up.path, "4");
        drop(given_up);
        assert_eq!(std::fs::read_dir(home.path()).unwrap().count(), 1);
        assert_eq!(read(&standing(&place, "mark")), "3");
    }

    #[test]
    fn what_a_kill_left_beside_the_place_is_found() {
        let home = tempfile::tempdir().unwrap();
        let place = home.path().join("store");
        write(&beside(&place, "old"), "old");
        assert_eq!(read(&standing(&place, "mark")), "old");
        std::fs::create_dir(beside(&place, "new")).unwrap();
        assert_eq!(
            read(&standing(&place, "mark")),
            "old",
            "the new one is not whole"
        );
        write(&beside(&place, "new"), "new");
        assert_eq!(read(&standing(&place, "mark")), "new");
    }
}
