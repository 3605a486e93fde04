//! Figures of a sweep as a journal prints them: SVG, and PNG made from the same SVG.
//!
//! plotters lays the data out on a canvas of its own making (`backend`), with sub-pixel places, real subscripts,
//! and heat maps as one embedded picture. Lettering is DejaVu Sans, which comes with the program; no font of the
//! machine is used, and equal results give equal bytes. A new kind of figure is one file like `diagram`
//! and one call in [`draw_all`].

mod backend;
mod bifurcations;
mod branches;
mod colour_bar;
mod compared_joint;
mod compared_marginals;
mod contour;
mod diagram;
mod frame;
mod hatch;
mod heat;
mod joint;
mod legend;
mod marginals;
mod page;
mod render;
mod select;
mod style;
mod symbols;
mod ticks;
mod time_to_accuracy;

use std::convert::Infallible;
use std::io::Write;
use std::path::{Path, PathBuf};

use plotters::drawing::DrawingAreaErrorKind;

use crate::compare::Comparison;
use crate::continuation::SweepResult;
use crate::density::Observable;
use crate::system::Model;

/// File formats of figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Scalable vector graphics; heat maps are embedded pictures.
    Svg,
    /// Pixels, three to a figure pixel (288 to the inch).
    Png,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 2] = [Self::Svg, Self::Png];

    /// Name used in sweep files, and extension of the files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }

    /// The format of that name.
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }
}

/// Why a figure could not be made.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// plotters refused an operation.
    #[error("cannot lay a figure out: {0}")]
    Drawing(#[from] DrawingAreaErrorKind<Infallible>),
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
    /// A file could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// A figure before it is written.
#[derive(Debug, Clone, PartialEq)]
struct Figure {
    /// File name without extension.
    name: String,
    /// The figure as an SVG document.
    svg: String,
}

/// Draws every figure of a sweep into a folder and returns the files, in the order in which they were made:
/// a diagram an observed marginal (`diagram_x.svg`), the marginals at the parameter values `at`, overlaid
/// (`marginals.svg`), and an observed pair's joint densities at these values, each (`joint_xy_-0.5.svg`) and all on
/// one sheet (`joint_xy.svg`).
///
/// For each value in `at` the nearest computed point is taken; points without densities are not drawn, and a
/// figure without any density is not made. `title` (plain text, may be empty) stands above each figure. Files
/// appear complete or not at all.
///
/// # Errors
/// [`FigureError`]; files made before stay.
pub fn draw_all(
    result: &SweepResult,
    model: &Model,
    title: &str,
    at: &[f64],
    formats: &[Format],
    folder: &Path,
) -> Result<Vec<PathBuf>, FigureError> {
    let names = select::Names::new(result, model);
    let chosen = select::nearest(result, at);
    let mut figures = Vec::new();
    for (index, observable) in result.observables.iter().enumerate() {
        if matches!(observable, Observable::Marginal(_)) {
            figures.extend(diagram::diagram(result, index, names, title)?);
        }
    }
    figures.extend(marginals::marginals(result, &chosen, names, title)?);
    for (index, observable) in result.observables.iter().enumerate() {
        if matches!(observable, Observable::Joint(..)) {
            figures.extend(joint::sheet(result, index, &chosen, names, title)?);
            for point in &chosen {
                figures.extend(joint::single(result, index, point, names, title)?);
            }
        }
    }
    save_all(&figures, formats, folder)
}

/// Draws a comparison of methods: marginals by every method (`marginals.svg`), joint densities side by side (`joint_xy.svg`), and the error
/// against time (`time_to_accuracy.svg`). The model and the name of the swept parameter give the symbols.
///
/// # Errors
/// [`FigureError`]; files made before stay.
pub fn draw_comparison(
    comparison: &Comparison,
    (model, parameter): (&Model, &str),
    title: &str,
    formats: &[Format],
    folder: &Path,
) -> Result<Vec<PathBuf>, FigureError> {
    let names = select::Names::of(model, parameter);
    let mut figures = Vec::new();
    figures.extend(compared_marginals::figure(comparison, names, title)?);
    for &observable in &comparison.observables {
        if matches!(observable, Observable::Joint(..)) {
            let sheet = compared_joint::figure(comparison, observable, names, title)?;
            figures.extend(sheet);
        }
    }
    figures.extend(time_to_accuracy::figure(comparison, names, title)?);
    save_all(&figures, formats, folder)
}

/// Writes figures in every format; returns the files.
fn save_all(
    figures: &[Figure],
    formats: &[Format],
    folder: &Path,
) -> Result<Vec<PathBuf>, FigureError> {
    let mut paths = Vec::new();
    for figure in figures {
        for &format in formats {
            paths.push(save(figure, format, folder)?);
        }
    }
    Ok(paths)
}

/// Writes a figure under a temporary name and renames it.
fn save(figure: &Figure, format: Format, folder: &Path) -> Result<PathBuf, FigureError> {
    let path = folder.join(format!("{}.{}", figure.name, format.name()));
    let bytes = match format {
        Format::Svg => figure.svg.clone().into_bytes(),
        Format::Png => render::png(&figure.svg)?,
    };
    let write = || -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let mut builder = tempfile::Builder::new();
        // Temporary files are private by default; figures are as readable as any other file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.prefix(".figure").tempfile_in(folder)?;
        file.write_all(&bytes)?;
        file.persist(&path)?;
        Ok(())
    };
    write().map_err(|source| FigureError::Write {
        path: path.clone(),
        source,
    })?;
    Ok(path)
}
