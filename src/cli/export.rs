//! `pbif export`: the densities of a run as a file for other programs.

use std::path::PathBuf;

use super::args::ExportArguments;
use super::stored::Stored;
use super::{CommandError, Outcome, conclude};
use crate::run::{RunError, check_place, export};
use crate::sweep_file::Diagnostic;

/// Writes the file, or the folder of tables, and says what is in it.
///
/// # Errors
/// [`CommandError::Run`] when the run cannot be read or the file not be written; [`CommandError::Input`] when something
/// stands in its place.
pub(super) fn run(arguments: &ExportArguments) -> Result<Outcome, CommandError> {
    let out = arguments.out.clone().unwrap_or_else(|| beside(arguments));
    if out.symlink_metadata().is_ok() {
        let title = format!(
            "`{}` is there already, and is not overwritten",
            out.display()
        );
        let found =
            Diagnostic::new(title).remedy("give another place with `--out PATH`, or remove it");
        return Err(found.into());
    }
    check_place(&out)?;
    let stored = Stored::read(&arguments.run, &[], &[], true)?;
    let result = &stored.result;
    if let Some(parent) = out.parent() {
        std::fs::create_dir_all(parent).map_err(RunError::writing(parent))?;
    }
    let title = &stored.spec.settings.title;
    export(result, title, arguments.format, &out)?;
    let points = result
        .points
        .iter()
        .filter(|point| !point.densities.is_empty());
    let names = result.subject.observables.iter();
    let names: Vec<String> = names
        .map(|observable| format!("p_{}", observable.name(&result.subject.family)))
        .collect();
    let mut text = format!(
        "{}: {} at {} values\n",
        out.display(),
        names.join(", "),
        points.count()
    );
    if result.interrupted {
        text += "the run is unfinished: these are the values that are done\n";
    }
    conclude(&text, Outcome::Complete, &out)
}

/// The name of the run's folder with the format's ending, beside it.
fn beside(arguments: &ExportArguments) -> PathBuf {
    // `.` and `..` have no name of their own.
    let run = arguments
        .run
        .canonicalize()
        .unwrap_or(arguments.run.clone());
    let name = run
        .file_name()
        .map(|name| name.to_string_lossy().into_owned());
    let name = name.unwrap_or_else(|| "run".to_owned()) + arguments.format.ending();
    match arguments.run.file_name() {
        Some(_) => arguments.run.with_file_name(name),
        None => PathBuf::from(name),
    }
}
