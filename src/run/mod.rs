//! What a run leaves on disk: tables, stored densities, manifest. Every file appears whole or not at all.

mod atomic;
mod bifurcations;
mod folder;
mod manifest;
mod naming;
mod number;
mod store;
mod tables;
#[cfg(test)]
mod tests;

pub use bifurcations::{
    bifurcations_csv, bifurcations_json, bifurcations_markdown, bifurcations_tex,
};
pub use folder::RunFolder;
pub use manifest::{Ending, Manifest, PhaseSeconds};
pub use naming::Naming;
pub use number::{format_number, format_with_error};
pub use store::DensityStore;
pub use tables::{features_csv, points_csv};

use std::path::PathBuf;

/// Why a file of a run could not be written.
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
    /// The array store could not be composed.
    #[error("cannot compose the array store at {}: {message}", path.display())]
    Store {
        /// The store.
        path: PathBuf,
        /// What the Zarr library says.
        message: String,
    },
    /// A resolved sweep that is not TOML.
    #[error("the resolved sweep does not parse: {0}")]
    Resolved(#[from] toml::de::Error),
    /// A value cannot be written as JSON.
    #[error("cannot compose JSON: {0}")]
    Json(#[from] serde_json::Error),
}
