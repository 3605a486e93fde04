//! Removing runs: what pbif has written of them, and nothing else.

use std::path::{Path, PathBuf};

use super::archive::PREVIOUS;
use super::lock::FolderLock;
use super::{Ending, Layout, RunError, RunSummary, checksums, curve, find_runs};

/// The folder of figures, in which users put their own.
const FIGURES: &str = "figures";

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

/// Removes what a run has left in its folder, and the folder itself where nothing else is in it. The file that marks
/// the run goes last, so that one whose removal was cut short can be removed again.
///
/// # Errors
/// [`RunError::NotARun`], [`RunError::InUse`], [`RunError::Write`].
pub(crate) fn remove_run(path: &Path) -> Result<(), RunError> {
    if !path.join(Layout::SWEEP.manifest()).is_file() {
        return Err(RunError::NotARun {
            path: path.to_owned(),
        });
    }
    let lock = FolderLock::take(path)?;
    remove_curves(&path.join(curve::FOLDER))?;
    remove_entries(path, Layout::SWEEP.entries)?;
    drop(lock);
    // Only empty folders can be removed so.
    let mut empty = Some(path);
    for _ in 0..2 {
        empty = empty.filter(|folder| std::fs::remove_dir(folder).is_ok());
        let parent = empty.and_then(Path::parent);
        let ours = [PREVIOUS, "shards"];
        empty = parent.filter(|folder| {
            folder
                .file_name()
                .is_some_and(|name| ours.iter().any(|our| name == *our))
        });
    }
    Ok(())
}

/// Removes the curves that were followed from a run, with the earlier ones in their folders.
fn remove_curves(folder: &Path) -> Result<(), RunError> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    for path in entries.map(|entry| entry.path()) {
        let ours = Layout::CURVES;
        let is_ours = path.join(ours.manifest()).is_file() || ours.has_part(&path);
        if !path.is_dir() || !is_ours {
            continue;
        }
        let lock = FolderLock::take(&path)?;
        remove_curves(&path.join(PREVIOUS))?;
        remove_entries(&path, &[ours.entries, &[ours.part]].concat())?;
        drop(lock);
        // Only empty folders can be removed so.
        let _ = std::fs::remove_dir(&path);
    }
    let _ = std::fs::remove_dir(folder);
    Ok(())
}

/// Removes files and folders from the last to the first, which marks the folder; of the figures those that are as the
/// program left them: an annotated one is somebody's work.
fn remove_entries(path: &Path, entries: &[&str]) -> Result<(), RunError> {
    checksums::reopen(path);
    let _ = std::fs::remove_dir(path.join(FIGURES));
    for entry in entries.iter().rev().filter(|entry| **entry != FIGURES) {
        let place = path.join(entry);
        let removed = match place.symlink_metadata() {
            Ok(data) if data.is_dir() => std::fs::remove_dir_all(&place),
            Ok(_) => std::fs::remove_file(&place),
            Err(_) => continue,
        };
        removed.map_err(|source| RunError::Write {
            path: place,
            source,
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_runs_stays() {
        let home = tempfile::tempdir().unwrap();
        let run = home.path().join("previous/1");
        std::fs::create_dir_all(run.join("figures")).unwrap();
        for name in ["run.json", "points.csv", "figures/a.svg", "figures/b.svg"] {
            std::fs::write(run.join(name), name).unwrap();
        }
        checksums::write(&run, Layout::SWEEP.entries).unwrap();
        for name in ["figures/a.svg", "figures/mine.svg", "notes.txt"] {
            std::fs::write(run.join(name), "mine").unwrap();
        }
        remove_run(&run).unwrap();
        let names = |folder: &Path| {
            let entries = std::fs::read_dir(folder).unwrap().flatten();
            let mut names: Vec<_> = entries.map(|entry| entry.file_name()).collect();
            names.sort();
            names
        };
        assert_eq!(names(&run), ["figures", "notes.txt"]);
        assert_eq!(names(&run.join("figures")), ["a.svg", "mine.svg"]);
        std::fs::remove_dir_all(run.join("figures")).unwrap();
        assert!(matches!(remove_run(&run), Err(RunError::NotARun { .. })));
        // Without notes nothing is left, the folder of earlier runs neither.
        std::fs::remove_file(run.join("notes.txt")).unwrap();
        std::fs::write(run.join("run.json"), "{}").unwrap();
        remove_run(&run).unwrap();
        assert!(!home.path().join("previous").exists() && home.path().exists());
    }

    #[test]
    fn the_curves_of_a_run_go_with_it_and_what_stands_beside_them_stays() {
        let home = tempfile::tempdir().unwrap();
        let run = home.path().join("run");
        let put = |name: &str| {
            let path = run.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "{}").unwrap();
        };
        put("run.json");
        for name in ["PB1-a", "PB1-a/previous/1", "PB2-a"] {
            put(&format!("curves/{name}/curve.json"));
            put(&format!("curves/{name}/curves.csv"));
        }
        put("curves/PB3-a/curve.part.bin");
        let mine = ["curves/PB2-a/notes.txt", "curves/mine/curves.csv"];
        for name in mine {
            put(name);
        }
        remove_run(&run).unwrap();
        assert!(mine.iter().all(|name| run.join(name).is_file()));
        assert!(!run.join("run.json").exists() && !run.join("curves/PB2-a/curve.json").exists());
        assert!(!run.join("curves/PB1-a").exists() && !run.join("curves/PB3-a").exists());
    }

    #[test]
    fn a_run_that_is_written_is_not_removed() {
        let home = tempfile::tempdir().unwrap();
        std::fs::write(home.path().join("run.json"), "{}").unwrap();
        let _lock = FolderLock::take(home.path()).unwrap();
        let error = remove_run(home.path()).unwrap_err();
        assert!(matches!(error, RunError::InUse { .. }));
        assert!(home.path().join("run.json").exists());
    }
}
