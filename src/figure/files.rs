//! Figures as files: each appears whole or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::error::FigureError;
use super::print::Figure;
use super::settings::Format;
use crate::UNFINISHED;
use crate::formula::latex;

/// Writes figures in every format into a folder, which is made if need be; returns the files in the order in which they
/// were made. Files of the same names are replaced.
///
/// # Errors
/// [`FigureError`]; files made before stay.
pub fn write_figures(
    figures: &[Figure],
    formats: &[Format],
    folder: &Path,
) -> Result<Vec<PathBuf>, FigureError> {
    let all = figures.par_iter().flat_map_iter(|figure| {
        let formats = formats.iter();
        formats.filter_map(|&format| write(figure, format, folder).transpose())
    });
    all.collect()
}

/// Writes a figure under a temporary name and renames it; nothing where it has nothing in this format.
fn write(figure: &Figure, format: Format, folder: &Path) -> Result<Option<PathBuf>, FigureError> {
    let path = folder.join(format!("{}.{}", figure.name, format.name()));
    let bytes = match format {
        Format::Svg => figure.svg().into_bytes(),
        Format::Png => figure.png()?,
        Format::Pdf => figure.pdf(),
        Format::Csv => figure.data.as_bytes().to_vec(),
        Format::Txt => figure.caption.as_bytes().to_vec(),
        Format::Tex => (latex::with_symbols(figure.caption.trim_end()) + "\n").into_bytes(),
    };
    if bytes.is_empty() {
        return Ok(None);
    }
    let write = || -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let mut builder = tempfile::Builder::new();
        // Temporary files are private by default; figures are as readable as any other file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.prefix(UNFINISHED).tempfile_in(folder)?;
        file.write_all(&bytes)?;
        file.persist(&path)?;
        Ok(())
    };
    write().map_err(|source| FigureError::Write {
        path: path.clone(),
        source,
    })?;
    Ok(Some(path))
}
