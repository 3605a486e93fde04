//! A file of records, to which records are added at its end: length, checksum, content. The first record says of what
//! the others are.

use std::fs::File;
use std::io::{BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use sha2::{Digest as _, Sha256};

use super::differences;
use crate::UNFINISHED;
use crate::bytes::{NotWhatWasWritten, from_bytes, to_bytes};
use crate::run::RunError;
use crate::run::atomic::begin_durably;

/// First bytes of the file: program and format.
const MAGIC: &[u8; 8] = b"pbif-j6\n";

/// Bytes of a length and of a checksum.
const WORD: usize = 8;

/// Time between two times that the disk is waited for: many fast solves share one.
const BETWEEN_WAITS: Duration = Duration::from_secs(1);

/// What is given a record with its place in the file.
type Each<'e> = dyn FnMut(&[u8], Range<u64>) -> Result<(), NotWhatWasWritten> + 'e;

/// The file, open for more.
#[derive(Debug)]
pub(in crate::run) struct Log {
    path: PathBuf,
    file: File,
    /// When the disk was last asked to take all.
    asked: Instant,
    /// The thread that waits for the disk meanwhile.
    waiting: Option<JoinHandle<std::io::Result<()>>>,
}

impl Log {
    /// A new file, of work that `of` describes as TOML. It appears with its first record: a kill leaves none, or one to
    /// go on from.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(in crate::run) fn create(path: PathBuf, of: &str) -> Result<Self, RunError> {
        let first = to_bytes(&(env!("CARGO_PKG_VERSION"), of));
        let file = begin_durably(&path, &[MAGIC, &frame(&first)[..]].concat())?;
        Ok(Self::at(path, file))
    }

    /// Opens a file to go on with it; `each` is given all whole records but the first, with their places.
    ///
    /// # Errors
    /// [`RunError::NoJournal`]; [`RunError::OtherSweep`], with every difference, when it is of other work or of another
    /// version; [`RunError::Journal`], also where `each` does not understand a record; [`RunError::Read`].
    pub(in crate::run) fn open(
        path: PathBuf,
        of: &str,
        each: &mut Each<'_>,
    ) -> Result<Self, RunError> {
        let unreadable = RunError::reading(&path);
        take_own_copy(&path).map_err(unreadable)?;
        let mut file = match File::options().read(true).write(true).open(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(RunError::NoJournal {
                    path: path.parent().unwrap_or(&path).to_owned(),
                    name: path.file_name().unwrap_or_default().to_owned(),
                });
            }
            file => file.map_err(unreadable)?,
        };
        let whole = go_through(&path, &file, Some(of), each)?;
        file.set_len(whole).map_err(unreadable)?;
        file.seek(SeekFrom::Start(whole)).map_err(unreadable)?;
        Ok(Self::at(path, file))
    }

    /// Opens a file that others may write to, for reading alone.
    ///
    /// # Errors
    /// As [`Log::open`], whatever work it is of.
    pub(in crate::run) fn look(path: PathBuf, each: &mut Each<'_>) -> Result<Self, RunError> {
        let file = File::open(&path).map_err(RunError::reading(&path))?;
        go_through(&path, &file, None, each)?;
        Ok(Self::at(path, file))
    }

    fn at(path: PathBuf, file: File) -> Self {
        Self {
            path,
            file,
            asked: Instant::now(),
            waiting: None,
        }
    }

    pub(in crate::run) fn path(&self) -> &Path {
        &self.path
    }

    /// Reads a record where it stands.
    ///
    /// # Errors
    /// [`RunError::Read`].
    pub(in crate::run) fn read(&self, place: &Range<u64>) -> Result<Vec<u8>, RunError> {
        let mut content = vec![0; (place.end - place.start) as usize];
        let read = File::open(&self.path).and_then(|mut file| {
            file.seek(SeekFrom::Start(place.start))?;
            file.read_exact(&mut content)
        });
        read.map_err(RunError::reading(&self.path))?;
        Ok(content)
    }

    /// Adds a record; once a second the disk is asked to take all there are, and waited for beside.
    ///
    /// # Errors
    /// [`RunError::Write`], also where the disk did not take those before.
    pub(in crate::run) fn append(&mut self, content: &[u8]) -> Result<(), RunError> {
        let written = self.file.write_all(&frame(content));
        written.map_err(RunError::writing(&self.path))?;
        let is_free = self.waiting.as_ref().is_none_or(JoinHandle::is_finished);
        if is_free && self.asked.elapsed() >= BETWEEN_WAITS {
            self.ask().map_err(RunError::writing(&self.path))?;
            self.asked = Instant::now();
        }
        Ok(())
    }

    /// Lets a thread wait until everything is on the disk, after what the last one found.
    fn ask(&mut self) -> std::io::Result<()> {
        match self.waiting.take().map(JoinHandle::join) {
            Some(Ok(found)) => found?,
            // It ended early.
            Some(Err(_)) => return self.file.sync_data(),
            None => {}
        }
        let file = self.file.try_clone()?;
        let thread = std::thread::Builder::new().spawn(move || file.sync_data());
        match thread {
            Ok(thread) => self.waiting = Some(thread),
            Err(_) => self.file.sync_data()?,
        }
        Ok(())
    }
}

/// Gives `each` all whole records of a file but the first, which must be of this work; the end of the last one.
fn go_through(
    path: &Path,
    file: &File,
    of: Option<&str>,
    each: &mut Each<'_>,
) -> Result<u64, RunError> {
    let unreadable = RunError::reading(path);
    let broken = || RunError::Journal {
        path: path.to_owned(),
    };
    let mut frames = Frames::new(file).map_err(unreadable)?;
    let first = frames.next().map_err(unreadable)?.ok_or_else(broken)?;
    if let Some(of) = of {
        check_sweep(path, &first, of)?;
    }
    while let Some(frame) = frames.next().map_err(unreadable)? {
        let place = frames.whole - frame.len() as u64..frames.whole;
        each(&frame, place).map_err(|NotWhatWasWritten| broken())?;
    }
    Ok(frames.whole)
}

/// A record with its length and checksum.
fn frame(content: &[u8]) -> Vec<u8> {
    let length = (content.len() as u64).to_le_bytes();
    [&length[..], &checksum(content), content].concat()
}

/// Gives a file that is linked elsewhere, in an earlier version of the run, a copy of its own, to which records can be
/// added.
#[cfg(unix)]
fn take_own_copy(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::MetadataExt as _;
    match path.metadata() {
        Ok(data) if data.nlink() > 1 => {
            let copy = path.with_file_name(format!("{UNFINISHED}journal"));
            std::fs::copy(path, &copy)?;
            std::fs::rename(&copy, path)
        }
        _ => Ok(()),
    }
}

#[cfg(not(unix))]
fn take_own_copy(_: &Path) -> std::io::Result<()> {
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
    let first = from_bytes::<(String, String)>(first);
    let (version, sweep) = first.map_err(|_| RunError::Journal {
        path: path.to_owned(),
    })?;
    let folder = path.parent().unwrap_or(path);
    RunError::check_same(folder, differences(&version, &sweep, resolved))
}
