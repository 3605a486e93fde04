//! The tables of a map of regimes, read from its folder or made of a map that was not written: what is shown of one is
//! what stands in them.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::RunError;
use super::codimension::{codimension_two_csv, several_csv};
use super::map::map_csv;
use crate::continuation::map::RegimeMap;

/// The rows of a table, each with its cells by the names of their columns.
pub type Rows = Vec<BTreeMap<String, String>>;

/// The tables of a map of regimes (`docs/maps.md` has their columns).
#[derive(Debug, Clone, PartialEq)]
pub struct MapTables {
    /// The resolved sweep file; empty of a map that was not written.
    pub sweep_file: String,
    /// `map.csv`: the nodes.
    pub nodes: Rows,
    /// `curves.csv`: the points of the curves.
    pub curves: Rows,
    /// `codimension_two.csv`.
    pub codimension_two: Rows,
}

impl MapTables {
    /// Whether a folder is that of a map.
    pub fn is_there(folder: &Path) -> bool {
        folder.join("map.json").is_file()
    }

    /// Reads the tables of a map's folder.
    ///
    /// # Errors
    /// [`RunError::Manifest`] where `map.json` is not what a map leaves, [`RunError::Version`] where it is of another
    /// version, [`RunError::Read`] where a table cannot be read, [`RunError::Table`] where it is none.
    pub fn read(folder: &Path) -> Result<Self, RunError> {
        let text = |name: &str| {
            let path = folder.join(name);
            std::fs::read_to_string(&path).map_err(|source| RunError::Read { path, source })
        };
        let path = folder.join("map.json");
        let broken = |message: String| RunError::Manifest {
            path: path.clone(),
            message,
        };
        let told = text("map.json")?;
        let told: Value = serde_json::from_str(&told).map_err(|error| broken(error.to_string()))?;
        let word = |key: &str| {
            let word = told[key].as_str();
            word.ok_or_else(|| broken(format!("it has no `{key}`")))
        };
        let (program, version) = (word("program")?, word("version")?);
        let own = (env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
        if (program, version) != own {
            return Err(RunError::Version {
                found: format!("{program} {version}"),
                wanted: format!("{} {}", own.0, own.1),
                path,
            });
        }
        Ok(Self {
            sweep_file: word("sweep_file")?.to_owned(),
            nodes: rows(&text("map.csv")?)?,
            curves: rows(&text("curves.csv")?)?,
            codimension_two: rows(&text("codimension_two.csv")?)?,
        })
    }

    /// Whether a folder is that of curves.
    pub fn of_curves_are_there(folder: &Path) -> bool {
        folder.join("curve.json").is_file()
    }

    /// The tables of curves that were begun at a row of a sweep, from their folder. They have no nodes.
    ///
    /// # Errors
    /// As [`MapTables::read`].
    pub fn of_curves(folder: &Path) -> Result<Self, RunError> {
        let table = |name: &str| {
            let path = folder.join(name);
            let text = std::fs::read_to_string(&path);
            rows(&text.map_err(|source| RunError::Read { path, source })?)
        };
        Ok(Self {
            sweep_file: String::new(),
            nodes: Rows::new(),
            curves: table("curves.csv")?,
            codimension_two: table("codimension_two.csv")?,
        })
    }

    /// The tables that a map would leave.
    ///
    /// # Errors
    /// [`RunError::Table`].
    pub fn of(map: &RegimeMap) -> Result<Self, RunError> {
        let (family, plane) = (&map.subject.family, &map.plane);
        Ok(Self {
            sweep_file: String::new(),
            nodes: rows(&map_csv(map)?)?,
            curves: rows(&several_csv(family, plane, &map.curves, &[])?)?,
            codimension_two: rows(&codimension_two_csv(family, plane, &map.curves)?)?,
        })
    }
}

fn rows(text: &str) -> Result<Rows, RunError> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    Ok(reader.deserialize().collect::<Result<Rows, csv::Error>>()?)
}
