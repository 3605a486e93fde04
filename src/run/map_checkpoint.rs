//! What a map has solved so far, on disk while it is made, so that one that was interrupted or killed can be gone on
//! with.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::RunError;
use super::atomic::write_atomically;
use super::journal::different_keys;
use crate::continuation::PointStatus;
use crate::continuation::map::MapNode;
use crate::topology::Signature;

/// The file, in the folder of the map.
pub(super) const FILE: &str = "map.part.json";

/// The nodes of a map that is not complete yet.
#[derive(Debug, Clone)]
pub struct MapCheckpoint {
    path: PathBuf,
    sweep: String,
}

impl MapCheckpoint {
    /// In the folder of a map, of a sweep as resolved TOML.
    pub fn new(home: &Path, sweep: &str) -> Self {
        Self {
            path: home.join(FILE),
            sweep: sweep.to_owned(),
        }
    }

    /// Writes the nodes, whole or not at all.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn write(&self, nodes: &[MapNode]) -> Result<(), RunError> {
        let text = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "sweep_file": self.sweep,
            "nodes": nodes.iter().map(node_json).collect::<Vec<_>>(),
        });
        write_atomically(&self.path, text.to_string().as_bytes())
    }

    /// The nodes that are there; none without the file.
    ///
    /// # Errors
    /// [`RunError::OtherSweep`] with every difference where they are of another sweep or version;
    /// [`RunError::Checkpoint`] where the file cannot be understood.
    pub fn read(&self) -> Result<Vec<MapNode>, RunError> {
        let Ok(text) = std::fs::read_to_string(&self.path) else {
            return Ok(Vec::new());
        };
        let broken = |message: String| RunError::Checkpoint {
            path: self.path.clone(),
            message,
        };
        let all: Value = serde_json::from_str(&text).map_err(|error| broken(error.to_string()))?;
        let word = |key: &str| all[key].as_str().unwrap_or("");
        let differences = differences(word("version"), word("sweep_file"), &self.sweep);
        if !differences.is_empty() {
            return Err(RunError::OtherSweep {
                path: self.path.parent().unwrap_or(&self.path).to_owned(),
                differences,
            });
        }
        let nodes = all["nodes"].as_array().map_or(&[][..], Vec::as_slice);
        let nodes: Option<Vec<MapNode>> = nodes.iter().map(node).collect();
        nodes.ok_or_else(|| broken("a node cannot be understood".to_owned()))
    }

    /// Takes the file away: the map is complete.
    pub fn remove(&self) {
        // Not there, or left: a later map replaces it.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// In what a map that is there differs from one that is wanted.
pub(super) fn differences(version: &str, there: &str, here: &str) -> Vec<String> {
    let mut differences = different_keys(there, here);
    let own = env!("CARGO_PKG_VERSION");
    if version != own {
        differences.push(format!("version {version}, not {own}"));
    }
    differences
}

pub(super) fn node_json(node: &MapNode) -> Value {
    let signatures = node.signatures.iter().map(signature_json);
    json!({
        "values": node.values,
        "level": node.level,
        "status": node.status.word(),
        "signatures": signatures.collect::<Vec<_>>(),
        "is_seen": node.is_seen,
        "reason": node.reason,
    })
}

/// The counts of a signature.
pub(super) fn signature_json(one: &Signature) -> Value {
    json!([
        one.peaks,
        one.craters,
        one.rings,
        one.enclosed_peaks,
        one.enclosed_rings
    ])
}

/// What [`signature_json`] wrote.
pub(super) fn signature(value: &Value) -> Option<Signature> {
    let count = |index: usize| Some(value[index].as_u64()? as usize);
    Some(Signature {
        peaks: count(0)?,
        craters: count(1)?,
        rings: count(2)?,
        enclosed_peaks: count(3)?,
        enclosed_rings: count(4)?,
    })
}

/// What [`node_json`] wrote.
pub(super) fn node(value: &Value) -> Option<MapNode> {
    let status = value["status"].as_str()?;
    let signatures = value["signatures"].as_array()?.iter().map(signature);
    Some(MapNode {
        values: [value["values"][0].as_f64()?, value["values"][1].as_f64()?],
        level: value["level"].as_u64()? as usize,
        status: PointStatus::ALL
            .into_iter()
            .find(|one| one.word() == status)?,
        signatures: signatures.collect::<Option<_>>()?,
        is_seen: value["is_seen"].as_bool()?,
        reason: value["reason"].as_str().map(str::to_owned),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_come_back_and_another_sweep_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let sweep = "[sweep]\nfrom = 1.0\n";
        let checkpoint = MapCheckpoint::new(folder.path(), sweep);
        assert!(checkpoint.read().unwrap().is_empty());
        let nodes = [
            MapNode {
                values: [0.1, -3.5],
                level: 1,
                status: PointStatus::Escaping,
                signatures: vec![Signature::of_peaks(2)],
                is_seen: true,
                reason: None,
            },
            MapNode {
                values: [0.2, -3.5],
                level: 0,
                status: PointStatus::Failed,
                signatures: Vec::new(),
                is_seen: false,
                reason: Some("no noise".to_owned()),
            },
        ];
        checkpoint.write(&nodes).unwrap();
        assert_eq!(checkpoint.read().unwrap(), nodes);
        let other = MapCheckpoint::new(folder.path(), "[sweep]\nfrom = 2.0\n");
        let error = other.read().unwrap_err().to_string();
        assert!(error.contains("sweep.from"), "{error}");
        checkpoint.remove();
        assert!(checkpoint.read().unwrap().is_empty());
        std::fs::write(folder.path().join(FILE), "{").unwrap();
        assert!(checkpoint.read().is_err());
    }
}
