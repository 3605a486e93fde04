//! The journal of a run: every solve in full, written before it is reported, from which an interrupted run goes on.
//!
//! One file, `journal.bin`, to which records are added at the end: length, checksum, content. A kill leaves at most the last record
//! incomplete, which is then cut off; a machine that loses its power may lose those of the last second. The first record says of which sweep the others are. It is written for the program that reads it, with
//! every bit of a solution and of what its session remembers; tables and arrays are made from it again. What checks of located values saw is
//! written as the numbers that were seen, with what their sessions remember.

mod check;
mod record;
mod source;

pub use source::JournalledSource;

use std::fs::File;
use std::io::{BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use sha2::{Digest as _, Sha256};

use super::RunError;
use super::atomic::sync_folder;
use crate::bytes::{Reader, Writer};
use crate::continuation::{KeptCheck, Subject};
use crate::space::CellSpace;
use crate::system::Family;
use record::Record;

/// Name of the file.
pub(super) const NAME: &str = "journal.bin";

/// First bytes of the file: program and format.
const MAGIC: &[u8; 8] = b"pbif-j2\n";

/// Bytes of a length and of a checksum.
const WORD: usize = 8;

/// The journal of a run, open for more.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// What earlier processes have written, in this order.
    stored: Vec<Record>,
    /// What they have seen in checks.
    checks: Vec<KeptCheck>,
    /// Where records are put together.
    room: Vec<u8>,
    /// When the disk was last waited for.
    waited: Instant,
}

/// Time between two waits for the disk: many fast solves share one.
const BETWEEN_WAITS: Duration = Duration::from_secs(1);

impl Journal {
    /// A new journal in a run's folder, of a resolved sweep file.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn create(folder: &Path, resolved: &str) -> Result<Self, RunError> {
        let path = folder.join(NAME);
        let file = File::create_new(&path).map_err(|source| RunError::Write {
            path: path.clone(),
            source,
        })?;
        let mut journal = Self {
            path,
            file,
            stored: Vec::new(),
            checks: Vec::new(),
            room: Vec::new(),
            waited: Instant::now(),
        };
        journal.write(MAGIC)?;
        journal.append(|first| {
            first.text(env!("CARGO_PKG_VERSION")).text(resolved);
        })?;
        sync_folder(folder);
        Ok(journal)
    }

    /// Opens the journal of an unfinished run to go on with it. `resolved` is the sweep that is to be run, `subject` and `space` what it
    /// watches, on which cells.
    ///
    /// # Errors
    /// [`RunError::NoJournal`]; [`RunError::OtherSweep`], with every difference, when the run is of another sweep or version;
    /// [`RunError::Journal`]; [`RunError::Read`].
    pub fn open(
        folder: &Path,
        resolved: &str,
        (subject, space): (&Subject, &CellSpace),
        methods: &[&'static str],
    ) -> Result<Self, RunError> {
        let path = folder.join(NAME);
        let unreadable = |source| RunError::Read {
            path: path.clone(),
            source,
        };
        let broken = || RunError::Journal { path: path.clone() };
        own(&path).map_err(unreadable)?;
        let mut file = match File::options().read(true).write(true).open(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(RunError::NoJournal {
                    path: folder.to_owned(),
                });
            }
            file => file.map_err(unreadable)?,
        };
        let mut frames = Frames::new(&file).map_err(unreadable)?;
        let first = frames.next().map_err(unreadable)?.ok_or_else(broken)?;
        check_sweep(&path, &first, resolved)?;
        let (mut stored, mut checks) = (Vec::new(), Vec::new());
        while let Some(frame) = frames.next().map_err(unreadable)? {
            let reader = &mut Reader::new(&frame);
            let is_check = reader.flag().map_err(|_| broken())?;
            if is_check {
                checks.push(check::read(reader).map_err(|_| broken())?);
            } else {
                let record = Record::read(reader, (subject, space), methods);
                stored.push(record.map_err(|_| broken())?);
            }
        }
        let whole = frames.whole;
        file.set_len(whole).map_err(unreadable)?;
        file.seek(SeekFrom::Start(whole)).map_err(unreadable)?;
        Ok(Self {
            path,
            file,
            stored,
            checks,
            room: Vec::new(),
            waited: Instant::now(),
        })
    }

    /// Solves that are stored.
    pub fn solves(&self) -> usize {
        self.stored.len()
    }

    /// Adds a solve.
    fn add(&mut self, record: &Record, family: &Family) -> Result<(), RunError> {
        self.append(|writer| record.write(writer.flag(false), family))
    }

    /// Adds what was seen in a check.
    fn add_check(&mut self, check: &KeptCheck) -> Result<(), RunError> {
        self.append(|writer| check::write(writer.flag(true), check))
    }

    /// Adds a record; once a second it waits until all are on the disk.
    fn append(&mut self, compose: impl FnOnce(&mut Writer)) -> Result<(), RunError> {
        // The room is used again and again: a new one would cost as much as the writing.
        let mut writer = Writer::after(std::mem::take(&mut self.room));
        writer.count(0).count(0);
        compose(&mut writer);
        let mut frame = writer.finish();
        let (head, content) = frame.split_at_mut(2 * WORD);
        head[..WORD].copy_from_slice(&(content.len() as u64).to_le_bytes());
        head[WORD..].copy_from_slice(&checksum(content));
        let written = self.write(&frame);
        self.room = frame;
        written?;
        if self.waited.elapsed() >= BETWEEN_WAITS {
            self.file
                .sync_data()
                .map_err(|source| self.failed(source))?;
            self.waited = Instant::now();
        }
        Ok(())
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), RunError> {
        let written = self.file.write_all(bytes);
        written.map_err(|source| self.failed(source))
    }

    fn failed(&self, source: std::io::Error) -> RunError {
        RunError::Write {
            path: self.path.clone(),
            source,
        }
    }
}

/// Gives a file that is linked elsewhere, in an earlier version of the run, a copy of its own, to which records can be added.
#[cfg(unix)]
fn own(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::MetadataExt as _;
    match path.metadata() {
        Ok(data) if data.nlink() > 1 => {
            let copy = path.with_extension("copy");
            std::fs::copy(path, &copy)?;
            std::fs::rename(&copy, path)
        }
        _ => Ok(()),
    }
}

#[cfg(not(unix))]
fn own(_: &Path) -> std::io::Result<()> {
    Ok(())
}

/// The records of a file, as far as they are whole.
struct Frames<'f> {
    file: BufReader<&'f File>,
    length: u64,
    /// Bytes up to the end of the last whole record.
    whole: u64,
}

impl<'f> Frames<'f> {
    fn new(file: &'f File) -> std::io::Result<Self> {
        let length = file.metadata()?.len();
        let mut file = BufReader::new(file);
        let mut magic = [0; MAGIC.len()];
        let is_ours = length >= MAGIC.len() as u64 && {
            file.read_exact(&mut magic)?;
            magic == *MAGIC
        };
        Ok(Self {
            file,
            length: if is_ours { length } else { 0 },
            whole: MAGIC.len() as u64,
        })
    }

    /// The next whole record.
    fn next(&mut self) -> std::io::Result<Option<Vec<u8>>> {
        let start = self.whole + 2 * WORD as u64;
        if start > self.length {
            return Ok(None);
        }
        let mut words = [[0; WORD]; 2];
        for word in &mut words {
            self.file.read_exact(word)?;
        }
        let length = u64::from_le_bytes(words[0]);
        if length > self.length - start {
            return Ok(None);
        }
        let mut content = vec![0; length as usize];
        self.file.read_exact(&mut content)?;
        if checksum(&content) != words[1] {
            return Ok(None);
        }
        self.whole = start + length;
        Ok(Some(content))
    }
}

/// First bytes of the SHA-256.
fn checksum(content: &[u8]) -> [u8; WORD] {
    let mut short = [0; WORD];
    short.copy_from_slice(&Sha256::digest(content)[..WORD]);
    short
}

/// Refuses the journal of another version or sweep.
fn check_sweep(path: &Path, first: &[u8], resolved: &str) -> Result<(), RunError> {
    let mut reader = Reader::new(first);
    let (Ok(version), Ok(sweep)) = (reader.text(), reader.text()) else {
        return Err(RunError::Journal {
            path: path.to_owned(),
        });
    };
    let mut differences = Vec::new();
    if version != env!("CARGO_PKG_VERSION") {
        let this = env!("CARGO_PKG_VERSION");
        differences.push(format!("pbif {version} there, {this} here"));
    }
    differences.extend(different_keys(sweep, resolved));
    if differences.is_empty() {
        return Ok(());
    }
    Err(RunError::OtherSweep {
        path: path.parent().unwrap_or(path).to_owned(),
        differences,
    })
}

/// Keys with other values, but for those that only name and draw.
pub(super) fn different_keys(there: &str, here: &str) -> Vec<String> {
    let [there, here] = [there, here].map(|text| {
        let mut keys = std::collections::BTreeMap::new();
        let table: toml::Table = text.parse().unwrap_or_default();
        flatten("", &toml::Value::Table(table), &mut keys);
        keys
    });
    let mut names: Vec<&String> = there.keys().chain(here.keys()).collect();
    names.sort_unstable();
    names.dedup();
    let word = |value: Option<&String>| value.map_or("not given", String::as_str).to_owned();
    names
        .into_iter()
        .filter(|name| *name != "title" && !name.starts_with("figures."))
        .filter(|name| there.get(*name) != here.get(*name))
        .map(|name| {
            let (there, here) = (word(there.get(name)), word(here.get(name)));
            format!("{name} = {there} there, {here} here")
        })
        .collect()
}

/// Values by their whole keys.
fn flatten(
    prefix: &str,
    value: &toml::Value,
    keys: &mut std::collections::BTreeMap<String, String>,
) {
    match value {
        toml::Value::Table(table) => {
            for (name, value) in table {
                let dot = if prefix.is_empty() { "" } else { "." };
                flatten(&format!("{prefix}{dot}{name}"), value, keys);
            }
        }
        value => {
            keys.insert(prefix.to_owned(), value.to_string());
        }
    }
}

#[cfg(test)]
mod tests;
