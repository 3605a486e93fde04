//! Why something cannot be drawn.

use std::convert::Infallible;

use plotters::drawing::DrawingAreaErrorKind;

/// Why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// plotters refused an operation.
    #[error("cannot lay a figure out: {0}")]
    Layout(#[from] DrawingAreaErrorKind<Infallible>),
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
}
