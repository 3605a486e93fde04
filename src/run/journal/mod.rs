//! The journal of a job: every solve in full, from which a job that was stopped goes on.
//!
//! One file, to which records are added at the end. A kill leaves at most the last record incomplete, which is then cut
//! off; a machine that loses its power may lose those of the last second. The first record says of which job the others
//! are. It is written for the program that reads it, with every bit of a solution and of what its session remembers;
//! tables and arrays are made from it again. What is read of it is read when it is asked for, so that a journal may be
//! larger than the memory.

mod kept;
mod log;
mod session;
mod solved;
mod source;

pub(in crate::run) use solved::Held;
pub use source::JournalledSource;

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use super::RunError;
use crate::bytes::{from_bytes, to_bytes};
use crate::continuation::SourceError;
use crate::system::Family;
use kept::{Answer, Question};
use log::Log;

/// Name of the file of a sweep.
pub(super) const NAME: &str = "journal.bin";

/// A journal, open for more. Clones are the same journal.
#[derive(Debug, Clone)]
pub struct Journal(Arc<Mutex<Shared>>);

#[derive(Debug)]
struct Shared {
    log: Log,
    /// Where records of earlier processes stand in the file.
    places: HashMap<Key, Range<u64>>,
    failure: Option<RunError>,
}

impl Journal {
    /// A new file, of a job that `of` describes as TOML.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn create(path: &Path, of: &str) -> Result<Self, RunError> {
        let log = Log::create(path.to_owned(), of)?;
        Ok(Self::new(log, HashMap::new()))
    }

    /// Opens the file of an unfinished job to go on with it, and begins one where a run was stopped before that.
    ///
    /// # Errors
    /// [`RunError::NoJournal`]; [`RunError::OtherSweep`], with every difference, when it is of another job or version;
    /// [`RunError::Journal`]; [`RunError::Read`]; [`RunError::Write`].
    pub fn open(path: &Path, of: &str) -> Result<Self, RunError> {
        if path.parent().is_some_and(not_begun) {
            return Self::create(path, of);
        }
        let mut places = HashMap::new();
        let log = Log::open(path.to_owned(), of, &mut |content, place| {
            places.insert(from_bytes(content)?, place);
            Ok(())
        })?;
        Ok(Self::new(log, places))
    }

    /// Opens the file of a run that others may write to, for reading alone; `None` where it has none.
    ///
    /// # Errors
    /// [`RunError::Journal`], [`RunError::Read`].
    pub(super) fn look(run: &Path) -> Result<Option<Self>, RunError> {
        let path = run.join(NAME);
        if !path.is_file() {
            return Ok(None);
        }
        let mut places = HashMap::new();
        let log = Log::look(path, &mut |content, place| {
            places.insert(from_bytes(content)?, place);
            Ok(())
        })?;
        Ok(Some(Self::new(log, places)))
    }

    fn new(log: Log, places: HashMap<Key, Range<u64>>) -> Self {
        Self(Arc::new(Mutex::new(Shared {
            log,
            places,
            failure: None,
        })))
    }

    /// Solves that earlier processes have left.
    pub fn solves(&self) -> usize {
        let shared = self.lock();
        let solves = shared.places.keys();
        let solves = solves.filter(|key| !key.is_of_point() && **key != Key::SHARDS);
        solves.count()
    }

    /// Points of a sweep that earlier processes have left.
    pub(crate) fn points(&self) -> usize {
        let shared = self.lock();
        shared.places.keys().filter(|key| key.is_of_point()).count()
    }

    /// Why a session ended, where it was not interrupted. It is told once.
    pub fn failure(&self) -> Option<RunError> {
        self.lock().failure.take()
    }

    /// What an earlier process has [kept](Journal::keep) by this name.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Journal`].
    pub(crate) fn known<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, RunError> {
        self.get(Key::of(name))
    }

    /// Keeps something by a name.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(crate) fn keep<T: Serialize>(&self, name: &str, what: &T) -> Result<(), RunError> {
        self.write(Key::of(name), what)
    }

    fn get<T: DeserializeOwned>(&self, key: Key) -> Result<Option<T>, RunError> {
        let shared = self.lock();
        let Some(place) = shared.places.get(&key) else {
            return Ok(None);
        };
        let content = shared.log.read(place)?;
        drop(shared);
        let read = from_bytes::<(Key, T)>(&content);
        let read = read.map_err(|_| RunError::Journal { path: self.path() })?;
        Ok(Some(read.1))
    }

    fn write<T: Serialize>(&self, key: Key, what: &T) -> Result<(), RunError> {
        let content = to_bytes(&(key, what));
        self.lock().log.append(&content)
    }

    /// Where it is.
    pub(super) fn path(&self) -> PathBuf {
        self.lock().log.path().to_owned()
    }

    /// Ends a session with an error that is not the method's.
    fn end(&self, error: RunError) -> SourceError {
        self.lock().failure.get_or_insert(error);
        SourceError::Interrupted
    }

    /// What is shared holds no promises that a panic elsewhere could break.
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What a record is of: the hash of all that was asked for until then.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
struct Key([u8; 16]);

/// How the keys of points begin; that a hash does is out of the question.
const POINT: [u8; 16] = [0xff; 16];

impl Key {
    /// That of the shards which hold densities.
    const SHARDS: Self = Self([0xfe; 16]);

    fn of(name: &str) -> Self {
        Self([0; 16]).then(name)
    }

    fn then(self, next: impl AsRef<[u8]>) -> Self {
        let digest = Sha256::new_with_prefix(self.0).chain_update(next);
        let mut key = [0; 16];
        key.copy_from_slice(&digest.finalize()[..16]);
        Self(key)
    }

    /// A solve at a value of a family's coordinate, with the parameters there: a path may have been laid in between.
    fn of_value(self, family: &Family, value: f64) -> Self {
        let parameters = family.values_at(value);
        let parameters = parameters.iter().flat_map(|values| values.as_slice());
        let numbers = std::iter::once(&value).chain(parameters);
        self.then(
            numbers
                .flat_map(|number| number.to_le_bytes())
                .collect::<Vec<u8>>(),
        )
    }

    /// A point of a sweep, whatever was solved before it.
    fn of_point(value: f64) -> Self {
        let mut key = POINT;
        // Zero is one value.
        key[8..].copy_from_slice(&(value + 0.0).to_le_bytes());
        Self(key)
    }

    fn is_of_point(&self) -> bool {
        self.0[..8] == POINT[..8]
    }

    /// The same where its solution was asked something.
    fn of_questions(self, answers: &[(Question, Answer)]) -> Self {
        let questions = answers.iter().map(|(question, _)| format!("{question:?}"));
        questions.fold(self, Self::then)
    }
}

/// Whether an unfinished run was stopped between its manifest and its journal, with nothing done.
fn not_begun(run: &Path) -> bool {
    let is_there = |name: &str| run.join(name).exists();
    is_there("run.json") && !is_there(NAME) && !is_there("points.csv")
}

/// Whether an unfinished run has what it needs to be gone on with.
pub(super) fn can_go_on(run: &Path) -> bool {
    run.join(NAME).is_file() || not_begun(run)
}

/// In what unfinished or complete work that is there differs from what is wanted.
pub(super) fn differences(version: &str, there: &str, here: &str) -> Vec<String> {
    let own = env!("CARGO_PKG_VERSION");
    let mut differences = different_keys(there, here);
    if version != own {
        differences.push(format!("pbif {version} there, {own} here"));
    }
    differences
}

/// Keys with other values, but for those that only name and draw, or say what is done with a run once it is there.
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
        .filter(|name| *name != "title" && !AFTERWARDS.iter().any(|one| name.starts_with(one)))
        .filter(|name| there.get(*name) != here.get(*name))
        .map(|name| {
            let (there, here) = (word(there.get(name)), word(here.get(name)));
            format!("{name} = {there} there, {here} here")
        })
        .collect()
}

/// Beginnings of keys on which no solve depends.
const AFTERWARDS: [&str; 2] = ["figures.", "curve."];

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
