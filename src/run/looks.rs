//! `closer_looks.json`: the rows that were found on finer cells where those of a sweep left changes in doubt, and the
//! sweep file that asked for them. With them `pbif detect` puts these rows in their places without solving.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::RunError;
use super::journal::different_keys;
use super::place::read;
use crate::continuation::CloserLook;

pub(super) const NAME: &str = "closer_looks.json";

#[derive(Serialize, Deserialize)]
struct StoredLooks<Looks> {
    /// The complete sweep file, as TOML.
    sweep_file: String,
    /// In the order in which their rows took the place of others.
    looks: Looks,
}

/// Name and text of the file of looks that a sweep has made; `None` where there are none.
///
/// # Errors
/// [`RunError::Json`].
pub(crate) fn looks_file(
    looks: &[CloserLook],
    sweep_file: &str,
) -> Result<Option<(String, String)>, RunError> {
    if looks.is_empty() {
        return Ok(None);
    }
    let sweep_file = sweep_file.to_owned();
    let text = serde_json::to_string_pretty(&StoredLooks { sweep_file, looks })?;
    Ok(Some((NAME.to_owned(), text + "\n")))
}

/// The looks that a run has stored, where it was made by the same keys as `sweep_file`, a complete one, has: what was
/// counted by other rules says nothing. None where the run has none.
///
/// # Errors
/// [`RunError::Read`], and [`RunError::Looks`] for a file that is none of this program.
pub(super) fn read_looks(run: &Path, sweep_file: &str) -> Result<Vec<CloserLook>, RunError> {
    let path = run.join(NAME);
    if !path.is_file() {
        return Ok(Vec::new());
    }
    let bytes = match read(&path) {
        Ok(bytes) => bytes,
        Err(source) => return Err(RunError::Read { path, source }),
    };
    let stored: StoredLooks<Vec<CloserLook>> =
        serde_json::from_slice(&bytes).map_err(|source| RunError::Looks { path, source })?;
    let is_same = different_keys(&stored.sweep_file, sweep_file).is_empty();
    Ok(if is_same { stored.looks } else { Vec::new() })
}
