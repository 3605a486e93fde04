//! The folder of a job: which files it leaves there, how it begins and goes on, and how what it made takes its place.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::atomic::{sync_all, write_below};
use super::checksums::{Checked, Sums};
use super::lock::FolderLock;
use super::place::{self, FIGURES, folder_in};
use super::placing::{clear_unfinished, finish_after_kill};
use super::staging::Staging;
use super::{Ending, Journal, Layout, RunError, checksums, research_object};

/// Folders in which files grow.
const OWN: [&str; 2] = ["densities.zarr", FIGURES];

/// How many files of whatever the program left in a folder (a run, a comparison, curves or a map) are as it left them,
/// and those that are not; `None` for a folder without checksums.
///
/// # Errors
/// [`RunError::NotARun`] where it left nothing; [`RunError::Read`]; [`RunError::Checksums`] when the checksums are not
/// readable themselves.
pub fn check_folder(folder: &Path) -> Result<Option<Checked>, RunError> {
    finish_after_kill(folder);
    match Layout::of(folder) {
        Some(layout) => checksums::check(folder, layout.entries, &[]),
        None => Err(RunError::NotARun {
            path: folder.to_owned(),
        }),
    }
}

/// Refuses a place at which no job's files can stand: the root of the file system, the inside of what another job has
/// left, and a name that is not UTF-8, which no array store can have.
///
/// # Errors
/// [`RunError::Place`].
pub(crate) fn check_place(home: &Path) -> Result<(), RunError> {
    let entries_of = |folder: &Path| Layout::of(folder).map(|layout| layout.entries);
    place::check(home, &entries_of)
}

/// The folder of a job in the making, from which other writers are kept away. Dropped before it is closed, it leaves
/// what was there, but for files that grow in their place.
#[derive(Debug)]
pub struct JobFolder {
    home: PathBuf,
    layout: Layout,
    place: Destination,
    kept: Option<PathBuf>,
    /// Checksums of files that whoever wrote them has told.
    sums: Mutex<Sums>,
}

/// Where files are written to.
#[derive(Debug)]
enum Destination {
    /// Beside their place.
    Beside(Staging),
    /// There.
    There { lock: FolderLock },
}

/// Removes what a kill left in the making beside a complete job, unless another process is at work there.
pub(crate) fn clear_after_kill(home: &Path) {
    if let Ok(_lock) = FolderLock::take(home) {
        clear_unfinished(home, &OWN);
    }
}

impl JobFolder {
    /// Prepares the folder `home` for a job that begins, or goes on with what is there. What an earlier one left, and
    /// what was followed from it, is kept below `previous/`: of files that grow at once, of others when new ones take
    /// their place, of unfinished work when another one begins. Files that are not the job's are left alone.
    ///
    /// # Errors
    /// [`RunError::Place`], [`RunError::InUse`], [`RunError::NotOurs`], [`RunError::Read`], [`RunError::Write`]; then
    /// the folder is as it was.
    pub(crate) fn open(home: &Path, layout: Layout, goes_on: bool) -> Result<Self, RunError> {
        check_place(home)?;
        std::fs::create_dir_all(home).map_err(RunError::writing(home))?;
        let mut kept = None;
        let place = if layout.grows && goes_on {
            let lock = FolderLock::take(home)?;
            checksums::reopen(home);
            clear_unfinished(home, &OWN);
            Destination::There { lock }
        } else {
            let staging = Staging::new(home, layout.entries)?.with(layout.about)?;
            if layout.grows {
                let placed = staging.take_place(&[], &[])?;
                kept = placed.kept;
                Destination::There { lock: placed.lock }
            } else {
                if !goes_on {
                    staging.keep_aside(&[layout.part])?;
                }
                Destination::Beside(staging)
            }
        };
        Ok(Self {
            home: home.to_owned(),
            layout,
            place,
            kept,
            sums: Mutex::default(),
        })
    }

    /// Where an earlier run is kept that was in the place of files that grow.
    pub(crate) fn kept(&self) -> Option<&Path> {
        self.kept.as_deref()
    }

    /// Takes checksums of files, by their names in the folder, from whoever wrote them: they are not read again.
    pub(crate) fn add_sums(&self, sums: Sums) {
        self.lock_sums().extend(sums);
    }

    /// A poisoned lock holds checksums as whole as any other.
    fn lock_sums(&self) -> MutexGuard<'_, Sums> {
        self.sums.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Where the files are to stand.
    pub fn home(&self) -> &Path {
        &self.home
    }

    /// The file for what is solved, until the job has come to its end.
    fn part(&self) -> PathBuf {
        self.home.join(self.layout.part)
    }

    /// Where files are written to.
    pub fn path(&self) -> PathBuf {
        match &self.place {
            Destination::Beside(staging) => staging.fresh(),
            Destination::There { .. } => self.home.clone(),
        }
    }

    /// Where figures are drawn.
    ///
    /// # Errors
    /// [`RunError::Elsewhere`].
    pub(crate) fn figures(&self) -> Result<PathBuf, RunError> {
        folder_in(&self.path(), FIGURES)
    }

    /// Refuses to go on where the folder was removed or moved meanwhile: what is written by names would be put
    /// together of parts, or in another's place.
    ///
    /// # Errors
    /// [`RunError::Gone`].
    pub(crate) fn check(&self) -> Result<(), RunError> {
        let lock = match &self.place {
            Destination::Beside(staging) => staging.lock(),
            Destination::There { lock } => lock,
        };
        match lock.holds() {
            true => Ok(()),
            false => Err(RunError::Gone {
                path: self.home.clone(),
            }),
        }
    }

    /// Writes files by their names.
    ///
    /// # Errors
    /// [`RunError::Gone`], [`RunError::Write`].
    pub(crate) fn write(&self, files: &[(String, String)]) -> Result<(), RunError> {
        self.check()?;
        let path = self.path();
        let mut files = files.iter();
        files.try_for_each(|(name, text)| write_below(&path, &path.join(name), text.as_bytes()))
    }

    /// The journal of a job that is made of what `of` describes as TOML: a new one, or that of the unfinished job.
    ///
    /// # Errors
    /// As [`Journal::create`] and [`Journal::open`].
    pub(crate) fn journal(&self, of: &str, goes_on: bool) -> Result<Journal, RunError> {
        if goes_on {
            Journal::open(&self.part(), of)
        } else {
            Journal::create(&self.part(), of)
        }
    }

    /// Removes what was solved: nothing is left of a job that has hardly begun.
    pub(crate) fn give_up(self) {
        // One that cannot be removed can be gone on with.
        let _ = std::fs::remove_file(self.part());
        if self.layout.grows {
            let _ = std::fs::remove_file(self.home.join(self.layout.manifest()));
        }
    }

    /// Writes the checksums, puts the files in their place and returns those that were not there yet; what an earlier
    /// job left goes below `previous/`. What was solved goes where the job is complete.
    ///
    /// # Errors
    /// [`RunError::Gone`], [`RunError::Read`], [`RunError::Manifest`] or [`RunError::Write`].
    pub(crate) fn close(self, ending: Ending) -> Result<Vec<PathBuf>, RunError> {
        self.check()?;
        let (part, path) = (self.part(), self.path());
        let known = std::mem::take(&mut *self.lock_sums());
        let files = match self.place {
            Destination::Beside(staging) => {
                if self.layout.entries.contains(&checksums::NAME) {
                    checksums::write_knowing(&path, self.layout.entries, &known)?;
                }
                sync_all(&[path])?;
                let done = match ending {
                    Ending::Complete => &[self.layout.part][..],
                    _ => &[],
                };
                staging.take_place(&[], done)?.files
            }
            Destination::There { .. } => {
                research_object::write(&path)?;
                checksums::write_knowing(&path, self.layout.entries, &known)?;
                Vec::new()
            }
        };
        if ending != Ending::Complete {
            return Ok(files);
        }
        match std::fs::remove_file(&part) {
            Err(source) if part.exists() => Err(RunError::Write { path: part, source }),
            _ => Ok(files),
        }
    }
}
