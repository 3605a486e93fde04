//! The journal of a run: every solve in full, written before it is reported, from which an interrupted run goes on.
//!
//! One file, `journal.bin`, to which records are added at the end. A kill leaves at most the last record incomplete,
//! which is then cut off; a machine that loses its power may lose those of the last second. The first record says of
//! which sweep the others are. It is written for the program that reads it, with every bit of a solution and of what
//! its session remembers; tables and arrays are made from it again. What checks of located values saw is written as the
//! numbers that were seen, with what their sessions remember.

mod asked;
mod check;
mod log;
mod profile;
mod record;
mod replay;
mod sessions;
mod source;

pub use sessions::{RecordedSource, SessionJournal};
pub use source::JournalledSource;

pub(super) use log::Log;
pub(super) use record::{read_density, read_report, write_density, write_report};

use std::path::Path;

use super::RunError;
use crate::continuation::KeptCheck;
use crate::system::Family;
use record::Record;

/// Name of the file.
pub(super) const NAME: &str = "journal.bin";

/// The journal of a run, open for more.
#[derive(Debug)]
pub struct Journal {
    log: Log,
    /// What earlier processes have written, in this order.
    stored: Vec<Record>,
    /// What they have seen in checks.
    checks: Vec<KeptCheck>,
}

impl Journal {
    /// A new journal in a run's folder, of a resolved sweep file.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn create(folder: &Path, resolved: &str) -> Result<Self, RunError> {
        Ok(Self {
            log: Log::create(folder.join(NAME), resolved)?,
            stored: Vec::new(),
            checks: Vec::new(),
        })
    }

    /// Opens the journal of an unfinished run to go on with it, and begins one where the run was stopped before that.
    /// `resolved` is the sweep that is to be run, `family` what it runs through.
    ///
    /// # Errors
    /// [`RunError::NoJournal`]; [`RunError::OtherSweep`], with every difference, when the run is of another sweep or
    /// version; [`RunError::Journal`]; [`RunError::Read`]; [`RunError::Write`].
    pub fn open(
        folder: &Path,
        resolved: &str,
        family: &Family,
        methods: &[&'static str],
    ) -> Result<Self, RunError> {
        if not_begun(folder) {
            return Self::create(folder, resolved);
        }
        let (mut stored, mut checks) = (Vec::new(), Vec::new());
        let log = Log::open(folder.join(NAME), resolved, &mut |reader| {
            let is_check = reader.flag()?;
            if is_check {
                checks.push(check::read(reader)?);
            } else {
                stored.push(Record::read(reader, family, methods)?);
            }
            Ok(())
        })?;
        Ok(Self {
            log,
            stored,
            checks,
        })
    }

    /// Solves that are stored.
    pub fn solves(&self) -> usize {
        self.stored.len()
    }

    /// Adds a solve.
    fn add(&mut self, record: &Record, family: &Family) -> Result<(), RunError> {
        self.log
            .append(|writer| record.write(writer.flag(false), family))
    }

    /// Adds what was seen in a check.
    fn add_check(&mut self, check: &KeptCheck) -> Result<(), RunError> {
        self.log
            .append(|writer| check::write(writer.flag(true), check))
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

/// Whether the manifest of a comparison or of curves says that they came to their end; `false` where there is none.
///
/// # Errors
/// [`RunError::OtherSweep`], with every difference, where it is of something else than `of`; [`RunError::Json`].
pub(super) fn came_to_its_end(home: &Path, manifest: &str, of: &str) -> Result<bool, RunError> {
    let Ok(text) = std::fs::read_to_string(home.join(manifest)) else {
        return Ok(false);
    };
    let there: serde_json::Value = serde_json::from_str(&text)?;
    let differences = different_keys(there["made_of"].as_str().unwrap_or_default(), of);
    if !differences.is_empty() {
        return Err(RunError::OtherSweep {
            path: home.to_owned(),
            differences,
        });
    }
    Ok(there["ending"] == "complete")
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
