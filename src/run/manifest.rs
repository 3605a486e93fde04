//! `run.json`: what was run, by which version, and how it ended.

use serde::{Deserialize, Serialize};

use super::{Provenance, RunError, checksums};
use crate::sweep_file::SweepText;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Ending {
    /// Still running, or killed.
    Running,
    /// All points done.
    Complete,
    /// Stopped by the user.
    Interrupted,
}

/// Seconds of wall-clock time a phase.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseSeconds {
    /// Solving and detecting.
    pub sweep: f64,
    /// Writing tables and arrays.
    pub tables: f64,
    /// Drawing.
    pub figures: f64,
    /// Reading the densities and detecting again, where `pbif detect` did so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detect: Option<f64>,
}

/// The sweep file as it was typed, with its hash.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Typed {
    /// Path of the file as it was given.
    file: String,
    /// Its text, word for word.
    text: String,
    /// SHA-256 of the text, hexadecimal.
    pub(super) hash: String,
    /// What was set on top of it, each as `KEY=VALUE`.
    set: Vec<String>,
}

impl From<SweepText> for Typed {
    fn from(typed: SweepText) -> Self {
        Self {
            hash: hash(&typed.text),
            file: typed.file,
            text: typed.text,
            set: typed.set,
        }
    }
}

impl Typed {
    /// Whether the text is the one that was typed.
    pub(super) fn is_whole(&self) -> bool {
        hash(&self.text) == self.hash
    }

    pub(super) fn text(&self) -> SweepText {
        SweepText {
            file: self.file.clone(),
            text: self.text.clone(),
            set: self.set.clone(),
        }
    }
}

/// The manifest of a run.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Manifest {
    /// Always `pbif`.
    pub program: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// The resolved sweep: every key, defaults filled in.
    pub sweep: serde_json::Value,
    /// The same as text, from which `pbif detect` and `pbif plot` read it again.
    pub sweep_file: String,
    /// SHA-256 of `sweep_file`, hexadecimal.
    pub hash: String,
    /// The sweep file as it was typed, with its hash and what was set on top of it.
    typed: Typed,
    /// Seed of the random streams.
    pub seed: u64,
    /// Threads used; results do not depend on it.
    pub threads: usize,
    /// Which shard of the sweep was run, such as `2/4`; `None` of a whole sweep.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shard: Option<String>,
    /// Of how many shards the run was put together; `None` of one that was run as a whole.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub merged: Option<usize>,
    /// How it ended.
    pub ending: Ending,
    /// Points solved, those that refine brackets included.
    pub points: usize,
    /// Largest Hellinger distance between neighbouring densities; `None` with fewer than two.
    pub largest_distance: Option<f64>,
    /// By what and when it was made.
    pub made: Provenance,
    /// Seconds a phase.
    pub seconds: PhaseSeconds,
    /// Warnings, one sentence each, with the parameter values they concern.
    pub warnings: Vec<String>,
}

impl Manifest {
    /// The manifest of a run that starts now. `resolved` is the resolved sweep file as TOML, `typed` what it was made
    /// of.
    ///
    /// # Errors
    /// [`RunError::Resolved`] when `resolved` is not TOML.
    pub(crate) fn start(
        resolved: &str,
        typed: SweepText,
        seed: u64,
        threads: usize,
    ) -> Result<Self, RunError> {
        let sweep: serde_json::Value = toml::from_str(resolved)?;
        Ok(Self {
            program: env!("CARGO_PKG_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            sweep,
            sweep_file: resolved.to_owned(),
            hash: hash(resolved),
            typed: typed.into(),
            seed,
            threads,
            shard: None,
            merged: None,
            ending: Ending::Running,
            points: 0,
            largest_distance: None,
            made: Provenance::of_this_process(),
            seconds: PhaseSeconds::default(),
            warnings: Vec::new(),
        })
    }
}

/// SHA-256 of a resolved sweep file, hexadecimal.
pub(super) fn hash(resolved: &str) -> String {
    checksums::sum(resolved.as_bytes())
}
