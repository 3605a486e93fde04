//! Why a file of a run could not be written or read, in words.

use std::path::{Path, PathBuf};

use crate::continuation::Shard;

/// Why a file of a run could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The file system refused.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A table could not be composed.
    #[error("cannot compose a table: {0}")]
    Table(#[from] csv::Error),
    /// A resolved sweep that is not TOML.
    #[error("the resolved sweep does not parse: {0}")]
    Resolved(#[from] toml::de::Error),
    /// A value cannot be written as JSON.
    #[error("cannot compose JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// What closer looks have found cannot be read.
    #[error("{} is not what a sweep of pbif has left: {source}", path.display())]
    Looks {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// Another process writes to the folder.
    #[error("`{}` is being written to by {holder}", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
        /// Process and machine.
        holder: String,
    },
    /// A file or folder stands where a run's would, without the file that marks a run.
    #[error("`{}` is there, but no {mark} beside it: whose it is cannot be told, and it is not touched", path.display())]
    NotOurs {
        /// What stands there.
        path: PathBuf,
        /// The file that would mark it.
        mark: &'static str,
    },
    /// A place at which no run can stand.
    #[error("`{}` is no place for results: {why}", path.display())]
    Place {
        /// The place.
        path: PathBuf,
        /// Why not.
        why: String,
    },
    /// A folder of a run that is a link out of it.
    #[error("`{}` is a link to `{}`, out of the run: nothing is written there", path.display(), target.display())]
    Elsewhere {
        /// The link.
        path: PathBuf,
        /// Where it leads.
        target: PathBuf,
    },
    /// A folder that was removed while it was written to.
    #[error("`{}` was removed or moved while it was written to: what was solved since then has no place", path.display())]
    Gone {
        /// The folder.
        path: PathBuf,
    },
    /// A line of the checksums that is none.
    #[error("{}, line {line}: not a checksum and a name", path.display())]
    Checksums {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
    },
    /// A file that is not as the run left it.
    #[error("{} is {}: it is not what the run left", path.display(), damage.word())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What became of it.
        damage: Damage,
    },
    /// A table with other rows than the run has points.
    #[error("{} has {found} rows; the run left {wanted}", path.display())]
    Rows {
        /// The table.
        path: PathBuf,
        /// How many it has.
        found: usize,
        /// How many the run left.
        wanted: usize,
    },
    /// More densities than there is memory for.
    #[error("the densities in {} take {bytes} of memory, and the system gives this process less", path.display())]
    Memory {
        /// The run.
        path: PathBuf,
        /// What they take, with what is read and drawn beside them.
        bytes: String,
    },
    /// A stored density that is not finite.
    #[error("{}: the density of `{observable}` at {parameter} = {value} has values that are missing or no numbers", path.display())]
    NotFinite {
        /// The store.
        path: PathBuf,
        /// The observable.
        observable: String,
        /// The swept parameter.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// An unfinished run without a journal.
    #[error("{} has no {} to go on from", path.display(), name.display())]
    NoJournal {
        /// The folder.
        path: PathBuf,
        /// The journal.
        name: std::ffi::OsString,
    },
    /// A journal that cannot be read.
    #[error("{} is not the journal of this run, or is damaged", path.display())]
    Journal {
        /// The file.
        path: PathBuf,
    },
    /// An unfinished run of another sweep.
    #[error("the run in {} is of another sweep: {}", path.display(), differences.join("; "))]
    OtherSweep {
        /// The folder.
        path: PathBuf,
        /// What differs, key by key.
        differences: Vec<String>,
    },
    /// A run without densities.
    #[error("the run has no density at any value: nothing to export")]
    NothingToExport,
    /// A format that cannot hold what is exported.
    #[error("cannot export to {}: {message}", path.display())]
    Export {
        /// The file.
        path: PathBuf,
        /// What it cannot hold.
        message: String,
    },
    /// A folder without shards.
    #[error("`{}` holds no shards of a sweep", path.display())]
    NoShards {
        /// The folder.
        path: PathBuf,
    },
    /// Shards of a sweep that was cut in more than one way.
    #[error("{} holds shards of a sweep that was cut in several ways: into {}", path.display(), in_words(counts))]
    MixedShards {
        /// The folder of the shards.
        path: PathBuf,
        /// The numbers of shards, ascending.
        counts: Vec<usize>,
    },
    /// Shards that are not complete.
    #[error("{} of {of} shards in {} are not complete: {}", missing.len(), path.display(), name_missing(missing))]
    MissingShards {
        /// The folder of the run.
        path: PathBuf,
        /// How many shards there should be.
        of: usize,
        /// Which are not complete, with what there is of them in words.
        missing: Vec<(Shard, String)>,
    },
    /// An unfinished run that is being put together of shards.
    #[error("the run in {} is being put together of shards", path.display())]
    BeingMerged {
        /// The folder.
        path: PathBuf,
    },
    /// A run in the place of a shard that it is not.
    #[error("the run in {} is not that shard of a sweep", path.display())]
    OtherShard {
        /// The folder.
        path: PathBuf,
    },
    /// A shard whose densities an unfinished run was made of, and which is not there as it was.
    #[error("densities of this unfinished run are in the shard {}, which is gone or was computed anew", path.display())]
    ShardGone {
        /// Where the shard was.
        path: PathBuf,
    },
    /// A folder without a manifest.
    #[error("`{}` is not the folder of a run: it has no run.json", path.display())]
    NotARun {
        /// The folder.
        path: PathBuf,
    },
    /// A file of a run is missing or cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// What figures of curves and maps are drawn from again cannot be understood.
    #[error("{} does not hold the curves of a plane: {message}", path.display())]
    Plane {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// `run.json` is not what a run leaves.
    #[error("{} is not the manifest of a run: {message}", path.display())]
    Manifest {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// A run by another program, or by a version whose files may differ.
    #[error("{} is of {found}; this is {wanted}", path.display())]
    Version {
        /// The manifest.
        path: PathBuf,
        /// Program and version that wrote it.
        found: String,
        /// This program and version.
        wanted: String,
    },
    /// A point that cannot be solved again.
    #[error("{parameter} = {value} cannot be solved again: {message}")]
    Recompute {
        /// The swept parameter.
        parameter: String,
        /// Its value.
        value: f64,
        /// Why not.
        message: String,
    },
    /// A sweep that was changed after the run.
    #[error("the sweep in {} is not the one that was run: its hash does not fit", path.display())]
    Hash {
        /// The manifest.
        path: PathBuf,
    },
    /// A table without a column that it must have.
    #[error("{} has no column `{column}`", path.display())]
    Column {
        /// The table.
        path: PathBuf,
        /// The column.
        column: String,
    },
    /// A cell of a table that does not hold what it should.
    #[error("{}, line {line}, column `{column}`: `{value}` is not {wanted}", path.display())]
    Row {
        /// The table.
        path: PathBuf,
        /// Line of the file, counted from 1.
        line: u64,
        /// The column.
        column: String,
        /// What stands there.
        value: String,
        /// What should.
        wanted: String,
    },
    /// The array store cannot be read.
    #[error("cannot read the array store {}: {message}", path.display())]
    ReadStore {
        /// The store.
        path: PathBuf,
        /// Why not.
        message: String,
    },
    /// The store has no such density.
    #[error("the run has not stored the density of `{observable}`, only of {}", stored.join(", "))]
    NotStored {
        /// The observable.
        observable: String,
        /// Those that are stored.
        stored: Vec<String>,
    },
    /// A quantity has another formula than the stored one of that name.
    #[error("the stored density of `{observable}` is that of another formula")]
    OtherFormula {
        /// The observable.
        observable: String,
    },
    /// The stored densities are on other cells than the sweep says.
    #[error("{}: the cells of axis `{axis}` are not those of the sweep in run.json", path.display())]
    Cells {
        /// The store.
        path: PathBuf,
        /// The axis.
        axis: String,
    },
    /// A point whose density is missing in the store.
    #[error("{} has no density at {parameter} = {value}, which points.csv says was solved", path.display())]
    NoDensity {
        /// The store.
        path: PathBuf,
        /// The swept parameter.
        parameter: String,
        /// Its value.
        value: f64,
    },
}

impl RunError {
    /// Of a file or folder that cannot be written, moved or removed.
    pub(crate) fn writing(path: &Path) -> impl Fn(std::io::Error) -> Self + Copy {
        |source| Self::Write {
            path: path.to_owned(),
            source,
        }
    }

    /// Of a file or folder that cannot be read.
    pub(super) fn reading(path: &Path) -> impl Fn(std::io::Error) -> Self + Copy {
        |source| Self::Read {
            path: path.to_owned(),
            source,
        }
    }

    /// Of an array store that cannot be read, or is not what was written.
    pub(super) fn store<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> Self {
        |error| Self::ReadStore {
            path: path.to_owned(),
            message: error.to_string(),
        }
    }

    /// That what lies in a folder is of the same version and sweep as what is made here.
    ///
    /// # Errors
    /// [`RunError::OtherSweep`].
    pub(super) fn check_same(folder: &Path, differences: Vec<String>) -> Result<(), Self> {
        if differences.is_empty() {
            return Ok(());
        }
        Err(Self::OtherSweep {
            path: folder.to_owned(),
            differences,
        })
    }
}

/// What became of a file of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Damage {
    /// It is not there.
    Missing,
    /// It holds something else than the run left.
    Changed,
    /// The run has not left it, and it stands among the run's densities.
    Added,
}

impl Damage {
    /// In a word.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Missing => "missing",
            Self::Changed => "changed",
            Self::Added => "added",
        }
    }
}

/// Numbers with "and" before the last.
fn in_words(counts: &[usize]) -> String {
    let words: Vec<String> = counts.iter().map(usize::to_string).collect();
    match words.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => words.join(""),
    }
}

/// Shards with what there is of them.
fn name_missing(missing: &[(Shard, String)]) -> String {
    let each = missing.iter();
    let words: Vec<String> = each
        .map(|(shard, words)| format!("{shard} ({words})"))
        .collect();
    words.join(", ")
}
