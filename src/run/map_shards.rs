//! The shards of a map of regimes on disk: `map.shard.json` in `shards/1-of-4`, `shards/2-of-4`, … of the map's folder.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::journal::differences;
use super::place::read_text;
use super::place::shard_folder;
use super::shards::count;
use super::{Layout, RunError, checksums};
use crate::continuation::Shard;
use crate::continuation::map::{MapChange, MapNode, MapShard};

/// The file of a shard that is complete.
const FILE: &str = "map.shard.json";

/// What is in it.
#[derive(Serialize, Deserialize)]
struct Content {
    program: String,
    version: String,
    sweep_file: String,
    nodes: Vec<MapNode>,
    changes: Vec<MapChange>,
}

/// The shards of a map, all complete.
#[derive(Debug, Clone)]
pub(crate) struct MapShards {
    /// The resolved sweep file as TOML.
    pub sweep_file: String,
    /// What each has found, in the order of their numbers.
    pub shards: Vec<MapShard>,
}

impl MapShards {
    /// Whether the shards in a folder are those of a map.
    pub(crate) fn are_there(path: &Path) -> bool {
        count(path).is_ok_and(|of| folders(path, of).any(|(_, folder)| is_of_map(&folder)))
    }

    /// Reads the shards in the folder of a map.
    ///
    /// # Errors
    /// [`RunError::NoShards`]; [`RunError::MixedShards`] when the map was cut into shards in more than one way,
    /// [`RunError::MissingShards`] where some are not complete, [`RunError::OtherSweep`] where they are of different
    /// sweeps or of another version, [`RunError::Plane`].
    pub(crate) fn open(path: &Path) -> Result<Self, RunError> {
        let of = count(path)?;
        let mut sweep_file: Option<String> = None;
        let (mut shards, mut missing) = (Vec::new(), Vec::new());
        for (shard, folder) in folders(path, of) {
            let Some(found) = read(&folder)? else {
                let words = if is_of_map(&folder) {
                    "not done"
                } else {
                    "not begun"
                };
                missing.push((shard, words.to_owned()));
                continue;
            };
            let wanted = sweep_file.get_or_insert_with(|| found.sweep_file.clone());
            let differences = differences(&found.version, &found.sweep_file, wanted);
            RunError::check_same(&folder, differences)?;
            shards.push(MapShard {
                shard,
                nodes: found.nodes,
                changes: found.changes,
                interrupted: false,
            });
        }
        match sweep_file.filter(|_| missing.is_empty()) {
            Some(sweep_file) => Ok(Self { sweep_file, shards }),
            None => Err(RunError::MissingShards {
                path: path.to_owned(),
                of,
                missing,
            }),
        }
    }
}

/// The file of a shard that is complete, by its name; `sweep` is the resolved sweep file.
///
/// # Errors
/// [`RunError::Json`].
pub(crate) fn map_shard_file(sweep: &str, found: &MapShard) -> Result<(String, String), RunError> {
    let content = Content {
        program: env!("CARGO_PKG_NAME").to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        sweep_file: sweep.to_owned(),
        nodes: found.nodes.clone(),
        changes: found.changes.clone(),
    };
    Ok((FILE.to_owned(), serde_json::to_string(&content)?))
}

/// The folders of all shards.
fn folders(path: &Path, of: usize) -> impl Iterator<Item = (Shard, PathBuf)> {
    let all = (1..=of).filter_map(move |number| Shard::new(number, of));
    all.map(|shard| (shard, shard_folder(path, shard)))
}

/// Whether a shard's folder is of a map, complete or not.
fn is_of_map(folder: &Path) -> bool {
    let files = [FILE, Layout::MAP.part];
    files.iter().any(|file| folder.join(file).is_file())
}

/// The file of a shard; `None` where it is not there.
fn read(folder: &Path) -> Result<Option<Content>, RunError> {
    let path = folder.join(FILE);
    let Ok(text) = read_text(&path) else {
        return Ok(None);
    };
    let content = serde_json::from_str(&text).map_err(|error| RunError::Plane {
        path,
        message: error.to_string(),
    })?;
    checksums::require(folder, &[FILE])?;
    Ok(Some(content))
}
