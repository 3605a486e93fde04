//! Why a figure could not be made or written.

use std::path::PathBuf;

/// Why a figure could not be made or written.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// The SVG could not be read back to measure or render it.
    #[error("cannot render a figure: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// A picture of that size cannot be made.
    #[error("cannot make a picture of {width} × {height} pixels")]
    Raster {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// A PNG could not be encoded.
    #[error("cannot encode a PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// A PDF could not be written.
    #[error("cannot write a PDF: {0}")]
    Pdf(String),
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
