//! What there is in a folder of runs, told from small files alone: which runs, of what, how far, and what was found.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::Deserialize;

use super::place::read;
use super::{Ending, RunError, StoredRun, checksums, curve, lock};

/// Folders below one another that are looked into: `output/NAME/shards/1-of-4/previous/2` is five deep.
const DEEPEST: usize = 6;

/// Folders of a run that hold no runs.
const NOT_RUNS: [&str; 4] = ["densities.zarr", "figures", curve::FOLDER, "target"];

/// A located change, or one that could not be located, as `bifurcations.json` has it.
#[derive(Debug, Clone, Deserialize)]
pub struct FoundRow {
    /// Such as `PB1`.
    pub label: String,
    /// The parameter's value.
    pub value: Option<f64>,
    /// Its error.
    pub error: Option<f64>,
    /// The observable that changes; none of end points and of values without a steady state.
    pub observable: Option<String>,
    /// The signature below.
    pub before: Option<String>,
    /// The signature above.
    pub after: Option<String>,
    /// What happens.
    pub change: Option<String>,
    /// `located`, or why not.
    pub status: Option<String>,
}

/// A run in few words.
#[derive(Debug)]
pub struct RunSummary {
    /// The run.
    pub run: StoredRun,
    /// The title of its sweep.
    pub title: String,
    /// The model; `equations` of a system that the sweep file has typed.
    pub model: String,
    /// The swept parameter with both ends.
    pub parameter: (String, f64, f64),
    /// Given values of the sweep.
    pub given: u64,
    /// When `run.json` was last written.
    pub written: Option<SystemTime>,
    /// Who writes to it now.
    pub holder: Option<String>,
    /// Changes that were found, those without a steady state included; `None` where the run has not come so far.
    pub rows: Option<Vec<FoundRow>>,
}

impl RunSummary {
    /// Reads the manifest and the rows.
    ///
    /// # Errors
    /// As [`StoredRun::open`]; [`RunError::Manifest`] when the sweep in it lacks what every sweep has.
    pub fn read(path: &Path) -> Result<Self, RunError> {
        let run = StoredRun::open(path)?;
        checksums::require(path, &["bifurcations.json"])?;
        let file = path.join("run.json");
        let sweep = run.sweep();
        let text = |table: &str, key: &str| sweep[table][key].as_str().map(str::to_owned);
        let number = |key: &str| sweep["sweep"][key].as_f64();
        let lacks = || RunError::Manifest {
            path: file.clone(),
            message: "its sweep has no parameter, ends or points".to_owned(),
        };
        let parameter = text("sweep", "parameter").ok_or_else(lacks)?;
        let ends = (number("from"), number("to"));
        let (Some(from), Some(to)) = ends else {
            return Err(lacks());
        };
        Ok(Self {
            title: sweep["title"].as_str().unwrap_or_default().to_owned(),
            model: text("system", "model").unwrap_or_else(|| "equations".to_owned()),
            parameter: (parameter, from, to),
            given: sweep["sweep"]["points"].as_u64().unwrap_or_default(),
            written: file.metadata().and_then(|data| data.modified()).ok(),
            holder: lock::holder_of(path),
            rows: rows(&path.join("bifurcations.json")),
            run,
        })
    }

    /// How far it is, in words.
    pub(crate) fn state(&self) -> String {
        let points = self.run.points_done();
        let points = points.map_or(String::new(), |points| format!(", {points} points"));
        match (self.run.ending(), &self.holder) {
            (_, Some(holder)) => format!("at work ({holder}){points}"),
            (Ending::Complete, None) => format!("complete{points}"),
            (Ending::Interrupted | Ending::Running, None) => format!("unfinished{points}"),
        }
    }

    /// What was found, in words.
    pub fn found(&self) -> String {
        let Some(rows) = &self.rows else {
            return String::new();
        };
        let changes = rows.iter().filter(|row| row.observable.is_some());
        let (located, open): (Vec<&FoundRow>, Vec<&FoundRow>) =
            changes.partition(|row| row.status.as_deref() == Some("located"));
        match (located.len(), open.len()) {
            (0, 0) => "no change".to_owned(),
            (located, 0) => format!("{located} located"),
            (0, open) => format!("{open} not located"),
            (located, open) => format!("{located} located, {open} not"),
        }
    }
}

/// The rows of a run but its end points; nothing where they are not there or cannot be read.
fn rows(path: &Path) -> Option<Vec<FoundRow>> {
    let bytes = read(path).ok()?;
    let mut rows: Vec<FoundRow> = serde_json::from_slice(&bytes).ok()?;
    rows.retain(|row| !row.label.starts_with("EP"));
    Some(rows)
}

/// All runs in a folder and below: the folder itself, those beside each other in it, earlier versions, and shards. In
/// the order of their names, with numbers by their size.
pub(crate) fn find_runs(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    look(folder, 0, &mut found);
    found
}

fn look(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) {
    if folder.join("run.json").is_file() {
        found.push(folder.to_owned());
    }
    if depth == DEEPEST {
        return;
    }
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut inside: Vec<(Option<u64>, String)> = entries
        // A link may lead back to where it came from.
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()))
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| !name.starts_with('.') && !NOT_RUNS.contains(&name.as_str()))
        .map(|name| {
            let digits: String = name.chars().take_while(char::is_ascii_digit).collect();
            (digits.parse().ok(), name)
        })
        .collect();
    inside.sort();
    for (_, name) in inside {
        look(&folder.join(name), depth + 1, found);
    }
}
