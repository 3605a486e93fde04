//! Where a run is read from and written to: files that are files, folders that are a run's own.

use std::io;
use std::path::{Component, Path, PathBuf};

use super::RunError;
use crate::continuation::Shard;

/// The folder of all shards in that of a run.
pub(super) const SHARDS: &str = "shards";

/// Where a shard of the run in `folder` stands.
pub(crate) fn shard_folder(folder: &Path, shard: Shard) -> PathBuf {
    let name = format!("{}-of-{}", shard.number(), shard.of());
    folder.join(SHARDS).join(name)
}

/// Reads a file, whatever links lead to it. What is none is refused: a pipe would be waited for without end.
pub(super) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let kind = path.metadata()?.file_type();
    let other = match () {
        () if kind.is_file() => return std::fs::read(path),
        () if kind.is_dir() => "a folder",
        () => "a device, a pipe or a socket",
    };
    Err(io::Error::other(format!("it is {other}, not a file")))
}

/// The same of a file that holds text.
pub(super) fn read_text(path: &Path) -> io::Result<String> {
    let text = String::from_utf8(read(path)?);
    text.map_err(|_| io::Error::other("it is not UTF-8"))
}

/// Refuses a folder below which something else than files and folders stands.
///
/// # Errors
/// [`RunError::Read`].
pub(super) fn check_files(folder: &Path) -> Result<(), RunError> {
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            match entry.file_type() {
                Ok(kind) if kind.is_file() => {}
                Ok(kind) if kind.is_dir() => open.push(path),
                _ if path.is_dir() || path.is_file() => {}
                _ => {
                    let source = io::Error::other("it is not a file");
                    return Err(RunError::Read { path, source });
                }
            }
        }
    }
    Ok(())
}

/// The folder of this name in a run, to be written to.
///
/// # Errors
/// [`RunError::Elsewhere`] where it is a link that leads out of the run.
pub(super) fn folder_in(run: &Path, name: &str) -> Result<PathBuf, RunError> {
    let path = run.join(name);
    if path.is_symlink() {
        let places = [&path, run].map(Path::canonicalize);
        let is_inside = match &places {
            [Ok(folder), Ok(run)] => folder.starts_with(run),
            _ => false,
        };
        if !is_inside {
            let target = path.read_link().unwrap_or_default();
            return Err(RunError::Elsewhere { path, target });
        }
    }
    Ok(path)
}

/// Names of what a job has left in a folder; `None` where none has.
type EntriesOf<'a> = dyn Fn(&Path) -> Option<&'static [&'static str]> + 'a;

/// Refuses the root of the file system, the inside of what `entries_of` tells of a folder, figures apart, and a name
/// that is not UTF-8.
///
/// # Errors
/// [`RunError::Place`].
pub(super) fn check(home: &Path, entries_of: &EntriesOf<'_>) -> Result<(), RunError> {
    let refused = |why: String| {
        Err(RunError::Place {
            path: home.to_owned(),
            why,
        })
    };
    if home.to_str().is_none() {
        return refused("its name is not UTF-8, which tables and messages are".to_owned());
    }
    let place = whole(home);
    if place.parent().is_none() {
        return refused("it is the root of the file system".to_owned());
    }
    for (folder, run) in place.ancestors().zip(place.ancestors().skip(1)) {
        let Some(entries) = entries_of(run) else {
            continue;
        };
        let name = folder.file_name().and_then(|name| name.to_str());
        let name = name.filter(|name| *name != FIGURES && folder.is_dir());
        if name.is_some_and(|name| entries.contains(&name)) {
            let why = format!("it lies among the files of the run in {}", run.display());
            return refused(why);
        }
    }
    Ok(())
}

/// The figures of a run.
pub(super) const FIGURES: &str = "figures";

/// A path from the root on, without links and steps back as far as it is there.
fn whole(path: &Path) -> PathBuf {
    let mut whole = std::env::current_dir().unwrap_or_default();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                whole.pop();
            }
            Component::CurDir => {}
            part => whole.push(part),
        }
        if let Ok(found) = whole.canonicalize() {
            whole = found;
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::super::check_place;
    use super::*;

    #[test]
    fn runs_stand_in_folders_of_their_own() {
        let home = tempfile::tempdir().unwrap();
        let run = home.path().join("run");
        std::fs::create_dir_all(run.join("densities.zarr/p_x")).unwrap();
        std::fs::write(run.join("run.json"), "{}").unwrap();
        let is_free = |place: &Path| check_place(place).is_ok();
        for name in [
            "new",
            "run",
            "run/figures",
            "run/new",
            "run/densities.zarr/../a",
        ] {
            assert!(is_free(&home.path().join(name)), "{name}");
        }
        for name in [
            "densities.zarr",
            "densities.zarr/p_x/new/a",
            "a/../densities.zarr",
        ] {
            assert!(!is_free(&run.join(name)), "{name}");
        }
        for root in ["/", "/../.", "/tmp/.."] {
            assert!(!is_free(Path::new(root)), "{root}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_not_waited_for_and_links_are_not_followed_out() {
        let home = tempfile::tempdir().unwrap();
        let (run, pipe) = (home.path().join("run"), home.path().join("run/points.csv"));
        std::fs::create_dir(&run).unwrap();
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if made.is_ok_and(|made| made.success()) {
            assert!(read(&pipe).is_err() && check_files(&run).is_err());
        }
        assert!(read(&run).is_err());
        let link = |to: &Path, name: &str| std::os::unix::fs::symlink(to, run.join(name)).unwrap();
        std::fs::create_dir(run.join("drawn")).unwrap();
        link(&run.join("drawn"), "inside");
        link(home.path(), "outside");
        link(&run.join("nothing"), "dangling");
        assert!(folder_in(&run, "inside").is_ok() && folder_in(&run, "figures").is_ok());
        for name in ["outside", "dangling"] {
            let refused = folder_in(&run, name);
            assert!(matches!(refused, Err(RunError::Elsewhere { .. })), "{name}");
        }
    }
}
