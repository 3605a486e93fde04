//! The shards of a map of regimes on disk: `map.shard.json` in `shards/1-of-4`, `shards/2-of-4`, … of the map's folder.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::RunError;
use super::atomic::write_atomically;
use super::map_checkpoint::{self, differences, node, node_json};
use super::shards::{count, shard_folder};
use crate::continuation::Shard;
use crate::continuation::map::{MapChange, MapShard};
use crate::topology::IndicatorKind;

/// The file of a shard that is complete.
const FILE: &str = "map.shard.json";

/// The shards of a map, all complete.
#[derive(Debug, Clone)]
pub struct MapShards {
    /// The resolved sweep file as TOML.
    pub sweep_file: String,
    /// What each has found, in the order of their numbers.
    pub shards: Vec<MapShard>,
}

impl MapShards {
    /// Writes what a shard has found to its `folder`, whole or not at all; `sweep` is the resolved sweep file.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn write(folder: &Path, sweep: &str, found: &MapShard) -> Result<(), RunError> {
        let text = json!({
            "program": env!("CARGO_PKG_NAME"),
            "version": env!("CARGO_PKG_VERSION"),
            "sweep_file": sweep,
            "nodes": found.nodes.iter().map(node_json).collect::<Vec<_>>(),
            "changes": found.changes.iter().map(change_json).collect::<Vec<_>>(),
        });
        write_atomically(&folder.join(FILE), text.to_string().as_bytes())
    }

    /// Whether a shard's folder holds it, complete, of this sweep.
    ///
    /// # Errors
    /// [`RunError::OtherSweep`] with every difference, [`RunError::Plane`] where the file cannot be understood.
    pub fn is_complete(folder: &Path, sweep: &str) -> Result<bool, RunError> {
        let Some(all) = read(folder)? else {
            return Ok(false);
        };
        check(folder, &all, sweep)?;
        Ok(true)
    }

    /// Whether the shards in a folder are those of a map.
    pub fn are_there(path: &Path) -> bool {
        count(path).is_ok_and(|of| folders(path, of).any(|(_, folder)| is_of_map(&folder)))
    }

    /// Reads the shards in the folder of a map.
    ///
    /// # Errors
    /// [`RunError::NoShards`]; [`RunError::MixedShards`] when the map was cut into shards in more than one way,
    /// [`RunError::MissingShards`] where some are not complete, [`RunError::OtherSweep`] where they are of different
    /// sweeps or of another version, [`RunError::Plane`].
    pub fn open(path: &Path) -> Result<Self, RunError> {
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
            let sweep = found["sweep_file"].as_str().unwrap_or_default();
            check(
                &folder,
                &found,
                sweep_file.get_or_insert_with(|| sweep.to_owned()),
            )?;
            let understood = of_json(shard, &found);
            shards
                .push(understood.ok_or_else(|| broken(&folder, "its nodes cannot be understood"))?);
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

/// The folders of all shards.
fn folders(path: &Path, of: usize) -> impl Iterator<Item = (Shard, PathBuf)> {
    let all = (1..=of).filter_map(move |number| Shard::new(number, of));
    all.map(|shard| (shard, shard_folder(path, shard)))
}

/// Whether a shard's folder is of a map, complete or not.
fn is_of_map(folder: &Path) -> bool {
    let files = [FILE, map_checkpoint::FILE];
    files.iter().any(|file| folder.join(file).is_file())
}

/// The file of a shard; `None` where it is not there.
fn read(folder: &Path) -> Result<Option<Value>, RunError> {
    let Ok(text) = std::fs::read_to_string(folder.join(FILE)) else {
        return Ok(None);
    };
    let all = serde_json::from_str(&text).map_err(|error| broken(folder, &error.to_string()))?;
    Ok(Some(all))
}

fn broken(folder: &Path, message: &str) -> RunError {
    RunError::Plane {
        path: folder.join(FILE),
        message: message.to_owned(),
    }
}

/// Refuses a shard of another sweep or version.
fn check(folder: &Path, found: &Value, sweep: &str) -> Result<(), RunError> {
    let word = |key: &str| found[key].as_str().unwrap_or_default();
    let differences = differences(word("version"), word("sweep_file"), sweep);
    match differences.is_empty() {
        true => Ok(()),
        false => Err(RunError::OtherSweep {
            path: folder.to_owned(),
            differences,
        }),
    }
}

fn change_json(change: &MapChange) -> Value {
    let zero = change.zero.as_ref();
    json!({
        "observable": change.observable,
        "ends": change.ends,
        "zero": zero.map(|(kind, place, at)| json!([kind.code(), place, at])),
    })
}

fn of_json(shard: Shard, value: &Value) -> Option<MapShard> {
    let nodes = value["nodes"].as_array()?.iter().map(node);
    let changes = value["changes"].as_array()?.iter().map(change);
    Some(MapShard {
        shard,
        nodes: nodes.collect::<Option<_>>()?,
        changes: changes.collect::<Option<_>>()?,
        interrupted: false,
    })
}

fn change(value: &Value) -> Option<MapChange> {
    let pair = |value: &Value| Some([value[0].as_f64()?, value[1].as_f64()?]);
    let zero = match &value["zero"] {
        Value::Null => None,
        zero => {
            let place = zero[1].as_array()?.iter().map(Value::as_f64);
            Some((
                IndicatorKind::of_code(zero[0].as_str()?)?,
                place.collect::<Option<_>>()?,
                pair(&zero[2])?,
            ))
        }
    };
    Some(MapChange {
        observable: usize::try_from(value["observable"].as_u64()?).ok()?,
        ends: [pair(&value["ends"][0])?, pair(&value["ends"][1])?],
        zero,
    })
}
