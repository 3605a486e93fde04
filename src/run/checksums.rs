//! `checksums.sha256`: the SHA-256 of every file of a finished run, in the form that `sha256sum -c` reads, and whether
//! they are still those.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use sha2::{Digest as _, Sha256};

use super::atomic::write_durably;
use super::place::read_text;
use super::{Damage, RunError, journal, research_object};

/// Name of the file.
pub(super) const NAME: &str = "checksums.sha256";

/// What a check finds: how many files are as the run left them, and those that are not.
pub(crate) type Checked = (usize, Vec<(PathBuf, Damage)>);

/// Checksums by the names of files below a run's folder, with `/` between folders.
pub(super) type Sums = BTreeMap<String, String>;

/// Writes the checksums of all files of a folder that holds these files and folders. A journal is not one of them: it
/// grows.
///
/// # Errors
/// [`RunError::Read`] or [`RunError::Write`].
pub(super) fn write(run: &Path, entries: &[&str]) -> Result<(), RunError> {
    write_knowing(run, entries, &Sums::new())
}

/// The same without reading files whose checksums are known.
///
/// # Errors
/// As [`write`].
pub(super) fn write_knowing(run: &Path, entries: &[&str], known: &Sums) -> Result<(), RunError> {
    let entries = entries.iter().filter(|entry| is_summed(entry));
    let mut sums = Sums::new();
    for entry in entries {
        add(run, entry, known, &mut sums)?;
    }
    write_sums(run, &sums)
}

/// Writes those of some files of a folder anew, which were made anew; what else is in it keeps its checksum, or has
/// none: it may be a user's own, or edited by hand. Files of the folder that are gone are no longer named.
///
/// # Errors
/// As [`write`]; nothing where the run has no checksums.
pub(super) fn renew(run: &Path, folder: &str, made: &[PathBuf]) -> Result<(), RunError> {
    let Some(mut sums) = read(run)? else {
        return Ok(());
    };
    sums.retain(|name, _| !is_below(name, folder) || run.join(name).exists());
    for name in made.iter().filter_map(|path| path.file_name()) {
        let name = format!("{folder}/{}", name.to_string_lossy());
        add(run, &name, &Sums::new(), &mut sums)?;
    }
    write_sums(run, &sums)
}

/// The files of a folder, which may hold the files and folders `all`, that are below the given entries (all, if there
/// are none) and not as the run left them, and how many are; `None` for a folder without checksums.
///
/// # Errors
/// [`RunError::Read`]; [`RunError::Checksums`] when the checksums are not readable themselves.
pub(super) fn check(
    run: &Path,
    all: &[&str],
    entries: &[&str],
) -> Result<Option<Checked>, RunError> {
    let Some(wanted) = read(run)? else {
        return Ok(None);
    };
    let is_asked =
        |name: &str| entries.is_empty() || entries.iter().any(|entry| is_below(name, entry));
    let mut found = Sums::new();
    let there = all.iter();
    for entry in there.filter(|entry| is_summed(entry) && is_asked(entry)) {
        add(run, entry, &Sums::new(), &mut found)?;
    }
    let asked = wanted.iter().filter(|(name, _)| is_asked(name));
    let mut damaged = Vec::new();
    let mut whole = 0;
    for (name, sum) in asked {
        match found.get(name) {
            Some(now) if now == sum => whole += 1,
            Some(_) => damaged.push((run.join(name), Damage::Changed)),
            None => damaged.push((run.join(name), Damage::Missing)),
        }
    }
    // A user's own files beside the figures are nobody's business; a foreign chunk is.
    let foreign = found.keys().filter(|name| !wanted.contains_key(*name));
    let foreign = foreign.filter(|name| is_below(name, "densities.zarr"));
    damaged.extend(foreign.map(|name| (run.join(name), Damage::Added)));
    Ok(Some((whole, damaged)))
}

/// Refuses a folder in which one of these files, or folders with all that they hold, is not as the program left it;
/// nothing is known of one without checksums.
///
/// # Errors
/// [`RunError::Damaged`] with the first; as [`check`].
pub(super) fn require(run: &Path, entries: &[&str]) -> Result<(), RunError> {
    let checked = check(run, entries, entries)?;
    match checked.and_then(|(_, damaged)| damaged.into_iter().next()) {
        Some((path, damage)) => Err(RunError::Damaged { path, damage }),
        None => Ok(()),
    }
}

/// Removes the checksums of an ended run that goes on, and its figures as far as they are as the run left them: the run
/// that goes on draws at other values.
pub(super) fn reopen(run: &Path) {
    let Ok(Some(wanted)) = read(run) else {
        return;
    };
    for (name, sum) in &wanted {
        if !is_below(name, "figures") || name.split('/').any(|part| part == "..") {
            continue;
        }
        let path = run.join(name);
        if is_whole(&path, sum) {
            let _ = std::fs::remove_file(path);
        }
    }
    for name in [NAME, research_object::NAME] {
        let _ = std::fs::remove_file(run.join(name));
    }
}

fn is_summed(entry: &str) -> bool {
    entry != NAME && entry != journal::NAME
}

fn is_below(name: &str, entry: &str) -> bool {
    let rest = name.strip_prefix(entry);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// Adds the checksums of a file, or of all below a folder; nothing where there is none. Those that are known are taken.
fn add(run: &Path, name: &str, known: &Sums, sums: &mut Sums) -> Result<(), RunError> {
    let mut names = Vec::new();
    list(run, name, &mut names)?;
    let summed = names.into_par_iter().map(|name| {
        if let Some(sum) = known.get(&name) {
            return Ok((name, sum.clone()));
        }
        let path = run.join(&name);
        match std::fs::read(&path) {
            Ok(bytes) => Ok((name, sum(&bytes))),
            Err(source) => Err(RunError::Read { path, source }),
        }
    });
    let summed: Vec<Result<(String, String), RunError>> = summed.collect();
    for one in summed {
        sums.extend([one?]);
    }
    Ok(())
}

/// Names of a file, or of all files below a folder.
fn list(run: &Path, name: &str, names: &mut Vec<String>) -> Result<(), RunError> {
    let path = run.join(name);
    let unreadable = RunError::reading(&path);
    let Ok(found) = std::fs::metadata(&path) else {
        return Ok(());
    };
    if found.is_dir() {
        for entry in std::fs::read_dir(&path).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let name = format!("{name}/{}", entry.file_name().to_string_lossy());
            // What a folder says of its entries spares thousands of questions.
            if entry.file_type().map_err(unreadable)?.is_file() {
                names.push(name)
            } else {
                list(run, &name, names)?
            }
        }
    } else if found.is_file() {
        names.push(name.to_owned());
    }
    Ok(())
}

pub(super) fn sum(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn write_sums(run: &Path, sums: &Sums) -> Result<(), RunError> {
    let lines = sums.iter().map(|(name, sum)| format!("{sum}  {name}\n"));
    write_durably(&run.join(NAME), lines.collect::<String>().as_bytes())
}

/// Whether a file is there and has this checksum.
pub(super) fn is_whole(path: &Path, wanted: &str) -> bool {
    let is_file = path.metadata().is_ok_and(|found| found.is_file());
    is_file && std::fs::read(path).is_ok_and(|bytes| sum(&bytes) == wanted)
}

/// The checksums of a folder; `None` where it has none.
///
/// # Errors
/// [`RunError::Read`], [`RunError::Checksums`].
pub(super) fn read(run: &Path) -> Result<Option<Sums>, RunError> {
    let path = run.join(NAME);
    let text = match read_text(&path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        text => text.map_err(RunError::reading(&path))?,
    };
    let mut sums = Sums::new();
    for (index, line) in text.lines().enumerate() {
        let is_sum = |sum: &str| sum.len() == 64 && sum.bytes().all(|b| b.is_ascii_hexdigit());
        let parts = line.split_once("  ").filter(|(sum, _)| is_sum(sum));
        let Some((sum, name)) = parts else {
            let line = index + 1;
            return Err(RunError::Checksums { path, line });
        };
        sums.insert(name.to_owned(), sum.to_owned());
    }
    Ok(Some(sums))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRIES: &[&str] = &["run.json", NAME, "points.csv", "densities.zarr", "figures"];

    #[test]
    fn every_flipped_byte_and_every_missing_file_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path();
        std::fs::create_dir_all(run.join("densities.zarr/p_x/c")).unwrap();
        std::fs::create_dir(run.join("figures")).unwrap();
        let files = [
            "run.json",
            "points.csv",
            "densities.zarr/p_x/c/0",
            "figures/a b.svg",
        ];
        for name in files {
            std::fs::write(run.join(name), name).unwrap();
        }
        assert_eq!(check(run, ENTRIES, &[]).unwrap(), None);
        write(run, ENTRIES).unwrap();
        assert_eq!(check(run, ENTRIES, &[]).unwrap(), Some((4, Vec::new())));
        for name in files {
            let path = run.join(name);
            let whole = std::fs::read(&path).unwrap();
            for place in 0..whole.len() {
                let mut bytes = whole.clone();
                bytes[place] ^= 1;
                std::fs::write(&path, bytes).unwrap();
                let (count, damaged) = check(run, ENTRIES, &[]).unwrap().unwrap();
                assert_eq!((count, damaged), (3, vec![(path.clone(), Damage::Changed)]));
            }
            std::fs::remove_file(&path).unwrap();
            let damaged = check(run, ENTRIES, &[]).unwrap().unwrap().1;
            assert_eq!(damaged, [(path.clone(), Damage::Missing)]);
            std::fs::write(&path, whole).unwrap();
        }
        // A flipped byte of the checksums themselves is a checksum of no file, or none at all.
        let sums = std::fs::read(run.join(NAME)).unwrap();
        for place in 0..sums.len() {
            let mut bytes = sums.clone();
            bytes[place] ^= 1;
            std::fs::write(run.join(NAME), bytes).unwrap();
            let found = check(run, ENTRIES, &[]);
            assert!(
                found.is_err() || !found.unwrap().unwrap().1.is_empty(),
                "{place}"
            );
        }
        std::fs::write(run.join(NAME), sums).unwrap();
        std::fs::write(run.join("densities.zarr/p_x/c/1"), "").unwrap();
        std::fs::write(run.join("figures/mine.svg"), "").unwrap();
        let added = (run.join("densities.zarr/p_x/c/1"), Damage::Added);
        assert_eq!(
            check(run, ENTRIES, &["densities.zarr"]).unwrap(),
            Some((1, vec![added]))
        );
        std::fs::write(run.join("figures/a b.svg"), "drawn again").unwrap();
        renew(run, "figures", &["elsewhere/a b.svg".into()]).unwrap();
        assert_eq!(
            check(run, ENTRIES, &["figures"]).unwrap(),
            Some((1, Vec::new()))
        );
        assert!(!read(run).unwrap().unwrap().contains_key("figures/mine.svg"));
        // A checksum that is known is taken, whatever is in the file.
        let known = Sums::from([("points.csv".to_owned(), sum(b"as it was written"))]);
        write_knowing(run, ENTRIES, &known).unwrap();
        let changed = (run.join("points.csv"), Damage::Changed);
        assert_eq!(check(run, ENTRIES, &[]).unwrap().unwrap().1, [changed]);
        std::fs::write(run.join("points.csv"), "as it was written").unwrap();
        assert_eq!(check(run, ENTRIES, &[]).unwrap().unwrap().1, []);
    }
}
