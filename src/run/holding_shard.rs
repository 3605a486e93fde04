//! Shards of which the journal of a merge says that their stores hold densities: what they keep is not written twice.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::place::shard_folder;
use super::{RunError, checksums};
use crate::continuation::Shard;

/// The store of the densities in the folder of a shard.
const DENSITIES: &str = "densities.zarr";

/// A complete shard, whose densities do not change any more.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct HoldingShard {
    number: usize,
    of: usize,
    /// Where it was when it was read.
    folder: PathBuf,
    /// SHA-256 of its checksums, by which it is known again.
    sums: String,
}

impl HoldingShard {
    /// The shard in a folder; `None` of one without checksums, which nobody could know again, and of one whose name is
    /// not UTF-8, as which a journal keeps it.
    pub(super) fn at(folder: &Path, shard: Shard) -> Option<Self> {
        let is_text = |path: &PathBuf| path.to_str().is_some();
        Some(Self {
            number: shard.number(),
            of: shard.of(),
            folder: folder.canonicalize().ok().filter(is_text)?,
            sums: identity(folder)?,
        })
    }

    /// Whether another one is the same shard with the same densities, wherever both are.
    pub(super) fn is(&self, other: &Self) -> bool {
        let known = |shard: &Self| (shard.number, shard.of, shard.sums.clone());
        known(self) == known(other)
    }

    /// Where it is, for the reader of an unfinished merge in a folder: below that, below the run whose earlier version
    /// that is, or where it was.
    ///
    /// # Errors
    /// [`RunError::ShardGone`] where it is not there, or another one is in its place. Whether its densities are those
    /// that it left, [`check_densities`] says of what was read.
    pub(super) fn find(&self, run: &Path) -> Result<PathBuf, RunError> {
        let shard = Shard::new(self.number, self.of);
        let homes = shard.into_iter().flat_map(|shard| {
            let homes = run.ancestors().take(3);
            homes.map(move |home| shard_folder(home, shard))
        });
        let mut places = homes.chain([self.folder.clone()]);
        let found = places.find(|folder| identity(folder).as_ref() == Some(&self.sums));
        found.ok_or_else(|| RunError::ShardGone {
            path: self.folder.clone(),
        })
    }
}

/// Refuses the shard in a folder whose densities are not those that it left: all of them are read for that.
///
/// # Errors
/// [`RunError::Damaged`], [`RunError::Read`], [`RunError::Checksums`].
pub(super) fn check_densities(folder: &Path) -> Result<(), RunError> {
    checksums::require(folder, &[DENSITIES])
}

/// By what the shard in a folder is known: the checksums of its densities. Figures and tables may be made anew.
fn identity(folder: &Path) -> Option<String> {
    let sums = checksums::read(folder).ok()??;
    let mut lines: Vec<String> = sums
        .iter()
        .filter(|(name, _)| name.starts_with(DENSITIES))
        .map(|(name, sum)| format!("{sum}  {name}\n"))
        .collect();
    lines.sort_unstable();
    (!lines.is_empty()).then(|| checksums::sum(lines.concat().as_bytes()))
}
