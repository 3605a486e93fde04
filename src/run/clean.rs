//! Removing runs: what pbif has written of them, and nothing else.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::archive::PREVIOUS;
use super::lock::FolderLock;
use super::placing::clear_unfinished;
use super::{Ending, Layout, RunError, RunSummary, checksums, curve, find_runs};
use crate::UNFINISHED;

/// Folders of a run that hold runs.
const OF_RUNS: [&str; 2] = [PREVIOUS, "shards"];

/// A run that may go.
#[derive(Debug)]
pub(crate) struct Removable {
    /// Its folder.
    pub path: PathBuf,
    /// Why it may go, in words.
    pub why: &'static str,
    /// Bytes of its files.
    pub bytes: u64,
}

/// The runs in a folder and below that may go: earlier versions, unfinished runs, and shards that were put together.
/// Runs that are being written are left out.
pub(crate) fn removable_runs(folder: &Path) -> Vec<Removable> {
    let runs = find_runs(folder);
    let known = runs.iter().filter_map(|path| {
        let summary = RunSummary::read(path).ok();
        if summary.as_ref().is_some_and(|one| one.holder.is_some()) {
            return None;
        }
        let why = why(folder, path, summary.as_ref())?;
        let names = Layout::SWEEP.entries.iter().chain(Layout::SWEEP.about);
        let bytes = names.map(|name| size(&path.join(name))).sum();
        Some(Removable {
            path: path.clone(),
            why,
            bytes,
        })
    });
    known.collect()
}

fn why(folder: &Path, path: &Path, summary: Option<&RunSummary>) -> Option<&'static str> {
    let below = path.strip_prefix(folder).unwrap_or(path);
    let mut above = below.parent().into_iter().flat_map(Path::components);
    if above.any(|part| part.as_os_str() == PREVIOUS) {
        return Some("earlier");
    }
    let run = &summary?.run;
    if run.ending() != Ending::Complete {
        return Some("unfinished");
    }
    let whole = run.shard().and_then(|_| path.parent()?.parent())?;
    let merged = RunSummary::read(whole).ok()?.run;
    (merged.ending() == Ending::Complete && merged.merged().is_some()).then_some("merged shard")
}

/// Bytes of a file, or of all below a folder.
fn size(path: &Path) -> u64 {
    let Ok(data) = path.symlink_metadata() else {
        return 0;
    };
    if !data.is_dir() {
        return data.len();
    }
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    entries.map(|entry| size(&entry.path())).sum()
}

/// What became of the files of a run that was removed.
#[derive(Debug, Default)]
pub(crate) struct Removal {
    /// How many files are gone.
    pub(crate) files: usize,
    /// What is still there, and why.
    pub(crate) stays: Vec<(PathBuf, Stays)>,
}

/// Why a file stays where a run is removed.
#[derive(Debug)]
pub(crate) enum Stays {
    /// The run has not left it.
    Foreign,
    /// It holds something else than the run left.
    Changed,
    /// It was written after all that the run has left, and there is no checksum of it.
    Later,
    /// The system does not let it go.
    Refused(std::io::Error),
}

impl std::fmt::Display for Stays {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Foreign => formatter.write_str("not of the run"),
            Self::Changed => formatter.write_str("changed since the run ended"),
            Self::Later => {
                formatter.write_str("written after the run's last word, by whom is not known")
            }
            Self::Refused(error) => write!(formatter, "cannot be removed: {error}"),
        }
    }
}

/// Removes what a run has left in its folder and nobody has changed, and the folder itself where nothing else is in it.
/// The file that marks the run goes last, so that one whose removal was cut short can be removed again.
///
/// # Errors
/// [`RunError::NotARun`], [`RunError::InUse`], [`RunError::Write`] of the lock, [`RunError::Read`] and
/// [`RunError::Checksums`]; then nothing was removed.
pub(crate) fn remove_run(path: &Path) -> Result<Removal, RunError> {
    if !path.join(Layout::SWEEP.manifest()).is_file() {
        return Err(RunError::NotARun {
            path: path.to_owned(),
        });
    }
    let lock = FolderLock::take(path)?;
    let mut removal = Removal::default();
    clear_unfinished(path, &[]);
    remove_left(path, Layout::SWEEP, &mut removal)?;
    remove_curves(&path.join(curve::FOLDER), &mut removal)?;
    drop(lock);
    removal.keep_foreign(path);
    // Only empty folders can be removed so.
    let mut empty = Some(path);
    for _ in 0..2 {
        empty = empty.filter(|folder| std::fs::remove_dir(folder).is_ok());
        let parent = empty.and_then(Path::parent);
        empty = parent.filter(|folder| {
            let name = folder.file_name();
            name.is_some_and(|name| OF_RUNS.iter().any(|our| name == *our))
        });
    }
    removal.stays.sort_by(|one, other| one.0.cmp(&other.0));
    Ok(removal)
}

/// Removes the curves that were followed from a run, with the earlier ones in their folders.
fn remove_curves(folder: &Path, removal: &mut Removal) -> Result<(), RunError> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    for path in entries.map(|entry| entry.path()) {
        let ours = Layout::CURVES;
        let is_ours = path.join(ours.manifest()).is_file() || ours.has_part(&path);
        if !path.is_dir() || path.is_symlink() || !is_ours {
            continue;
        }
        let lock = FolderLock::take(&path)?;
        clear_unfinished(&path, &[]);
        remove_curves(&path.join(PREVIOUS), removal)?;
        remove_left(&path, ours, removal)?;
        drop(lock);
        // Only empty folders can be removed so.
        let _ = std::fs::remove_dir(&path);
    }
    let _ = std::fs::remove_dir(folder);
    Ok(())
}

/// Removes the files of a job, those that its checksums name first, the one that marks the folder last. A job that was
/// killed has no checksums: of it go journal, what is named as parts of an array store are, and tables that are no
/// later than the file that marks the folder, which a job writes anew after each of its tables.
fn remove_left(folder: &Path, layout: Layout, removal: &mut Removal) -> Result<(), RunError> {
    let sums = checksums::read(folder)?;
    let manifest = layout.manifest();
    let marked = written(&folder.join(manifest));
    let mut files = Vec::new();
    for entry in layout.entries.iter().rev() {
        list(folder, entry, &mut files);
    }
    for name in files
        .iter()
        .filter(|name| *name != manifest && *name != checksums::NAME)
    {
        let path = folder.join(name);
        let sum = sums.as_ref().map(|sums| sums.get(name));
        match sum {
            _ if name == layout.part || is_unfinished(name) => removal.remove(path),
            Some(Some(sum)) if checksums::is_whole(&path, sum) => removal.remove(path),
            Some(Some(_)) => removal.stays.push((path, Stays::Changed)),
            None if is_of_store(name) => removal.remove(path),
            None if layout.entries.contains(&name.as_str()) => {
                match written(&path).is_some_and(|at| Some(at) <= marked) {
                    true => removal.remove(path),
                    false => removal.stays.push((path, Stays::Later)),
                }
            }
            _ => {}
        }
    }
    removal.remove(folder.join(layout.part));
    let marks = folder.join(manifest);
    let is_left = |sum: &String| checksums::is_whole(&marks, sum);
    let sum = sums.as_ref().and_then(|sums| sums.get(manifest));
    match sum.is_none_or(is_left) {
        true => {
            removal.remove(folder.join(checksums::NAME));
            removal.remove(marks);
        }
        // It is known to be changed as long as its checksum is there.
        false => removal.stays.push((marks, Stays::Changed)),
    }
    let folders = layout.entries.iter().map(|entry| folder.join(entry));
    folders.for_each(|entry| remove_empty(&entry));
    Ok(())
}

/// When a file was last written.
fn written(path: &Path) -> Option<SystemTime> {
    path.symlink_metadata().ok()?.modified().ok()
}

/// Names of a file, or of the files below a folder, without following links.
fn list(folder: &Path, name: &str, names: &mut Vec<String>) {
    let path = folder.join(name);
    let Ok(found) = path.symlink_metadata() else {
        return;
    };
    if !found.is_dir() {
        names.push(name.to_owned());
        return;
    }
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    for entry in entries.filter_map(|entry| entry.file_name().into_string().ok()) {
        list(folder, &format!("{name}/{entry}"), names);
    }
}

/// Whether a file is one in the making that a kill left.
fn is_unfinished(name: &str) -> bool {
    let last = name.rsplit('/').next();
    last.is_some_and(|last| last.starts_with(UNFINISHED))
}

/// Whether a name is that of metadata or a chunk in an array store.
fn is_of_store(name: &str) -> bool {
    let parts: Vec<&str> = name.split('/').collect();
    let is_store = parts[0].starts_with("densities.zarr");
    let is_number = |part: &&str| part.bytes().all(|byte| byte.is_ascii_digit());
    let is_chunk = parts.get(2) == Some(&"c") && parts.iter().skip(3).all(is_number);
    is_store && (parts.last() == Some(&"zarr.json") || is_chunk)
}

/// Removes the empty folders below a folder, and itself where nothing is left in it.
fn remove_empty(folder: &Path) {
    if folder.symlink_metadata().is_ok_and(|found| found.is_dir()) {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.for_each(|entry| remove_empty(&entry.path()));
        let _ = std::fs::remove_dir(folder);
    }
}

impl Removal {
    /// Removes a file that is there.
    fn remove(&mut self, path: PathBuf) {
        match std::fs::remove_file(&path) {
            Ok(()) => self.files += 1,
            Err(_) if path.symlink_metadata().is_err() => {}
            Err(error) => self.stays.push((path, Stays::Refused(error))),
        }
    }

    /// Adds what stands in the folder of a run and is not told of yet; runs below it are not of it.
    fn keep_foreign(&mut self, run: &Path) {
        let mut open = vec![run.to_owned()];
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
                let path = entry.path();
                let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
                let holds_runs =
                    folder == run && OF_RUNS.iter().any(|our| entry.file_name() == *our);
                match is_folder {
                    true if holds_runs => {}
                    true => open.push(path),
                    false if self.stays.iter().any(|(known, _)| *known == path) => {}
                    false => self.stays.push((path, Stays::Foreign)),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
