//! `pbif sweep`: prepares the output folder of a sweep.

use std::path::{Path, PathBuf};

use super::args::SweepArguments;
use super::output::OutputFolder;
use super::spec::SweepSpec;
use super::{CommandError, Outcome};

/// Checks that the results can be written.
///
/// # Errors
/// [`CommandError::Output`] when they cannot.
pub(super) fn run(spec: &SweepSpec, arguments: &SweepArguments) -> Result<Outcome, CommandError> {
    let folder = OutputFolder::prepare(&output_path(spec, arguments.out.as_deref()))?;
    // Nothing is computed, so nothing is complete.
    let _ = (folder.path(), arguments.threads, arguments.quiet);
    Ok(Outcome::Partial)
}

/// The folder the results go to: as asked for, or `output/` and the name of the sweep file.
fn output_path(spec: &SweepSpec, out: Option<&Path>) -> PathBuf {
    out.map_or_else(|| Path::new("output").join(&spec.name), Path::to_owned)
}
