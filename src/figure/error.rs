//! Why a figure could not be made or written.

use std::path::PathBuf;

use super::canvas::DrawError;

/// Why a figure could not be made or written.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// It could not be drawn.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// Nothing was given to draw.
    #[error("there is nothing to draw")]
    Nothing,
    /// The model has no friction law, or one that exerts no force with the values it has.
    #[error("`{model}` has no friction force to draw")]
    NoFriction {
        /// Name of the model.
        model: String,
    },
    /// There is no figure of that name.
    #[error("there is no figure `{name}`, only {}", known.join(", "))]
    Unknown {
        /// The name.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// A file could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}
