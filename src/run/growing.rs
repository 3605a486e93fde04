//! Tables that grow by rows while a run goes on.
//!
//! Rows are added at the end of one file, in the order in which points are solved: a row costs the same however many
//! there are. A killed run leaves the rows of the points that were done, the last of them perhaps without its end,
//! which readers leave out. At the end of the run the table is written whole, in ascending order, in its place.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::{RunError, atomic::write_atomically};

/// A table in the making.
#[derive(Debug)]
pub(super) struct GrowingTable {
    path: PathBuf,
    /// Open from the first row on.
    file: Option<File>,
}

impl GrowingTable {
    /// A table that will be made at `path` with its first line.
    pub(super) fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            file: None,
        }
    }

    /// Adds lines at the end; `header` gives the first line of a new table.
    ///
    /// # Errors
    /// [`RunError::Write`], and those of `header`.
    pub(super) fn add(
        &mut self,
        header: impl FnOnce() -> Result<String, RunError>,
        lines: &str,
    ) -> Result<(), RunError> {
        let failed = RunError::writing(&self.path);
        match &mut self.file {
            // One write a point, so that a kill seldom finds a row half written.
            Some(file) => file.write_all(lines.as_bytes()).map_err(failed),
            None => {
                write_atomically(&self.path, (header()? + lines).as_bytes())?;
                let file = File::options().append(true).open(&self.path);
                self.file = Some(file.map_err(failed)?);
                Ok(())
            }
        }
    }

    /// Ends the table: a whole one may now take its place.
    pub(super) fn close(&mut self) {
        self.file = None;
    }
}
