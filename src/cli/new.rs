//! `pbif new`: writes a commented sweep file to start from, or lists those that there are.

use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write as _};
use std::path::Path;

use super::CommandError;
use crate::sweep_file::{Diagnostic, StartingFile, starting_files};

/// What stands in the comments of a starting file for its own name.
const STAND_IN: &str = "FILE";

/// The starting files with their titles.
pub(super) fn list() -> String {
    let mut text = "Starting files:\n\n".to_owned();
    let longest = starting_files().iter().map(|file| file.name.len()).max();
    let width = longest.unwrap_or(0);
    for file in starting_files() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {:width$}  {}", file.name, file.title());
    }
    text += "\nWrite one: pbif new FILE --like NAME\n";
    text
}

/// Writes the starting file of a name; an existing file is never replaced.
///
/// # Errors
/// [`CommandError::Input`] where there is no such starting file, or the file cannot be made.
pub(super) fn write(path: &Path, like: &str) -> Result<String, CommandError> {
    let refuse = |diagnostic: Diagnostic| CommandError::Input(diagnostic.into());
    let mut files = starting_files().iter();
    let Some(file) = files.find(|file| file.name == like) else {
        let names = starting_files().iter().map(|file| file.name);
        let title = format!("there is no starting file `{like}`");
        return Err(refuse(Diagnostic::new(title).nearest(like, names)));
    };
    let name = path.display().to_string();
    let made = OpenOptions::new().write(true).create_new(true).open(path);
    let written = made.and_then(|mut made| made.write_all(text(file, &name).as_bytes()));
    written.map_err(|error| {
        let diagnostic = match error.kind() {
            ErrorKind::AlreadyExists => Diagnostic::new(format!("`{name}` is there already"))
                .remedy("give another name, or remove it first"),
            _ => Diagnostic::new(format!("cannot write `{name}`: {error}"))
                .remedy("check the folder"),
        };
        refuse(diagnostic)
    })?;
    Ok(format!(
        "{name}: {}\n\nChange it, then\n  pbif check {name}\n  pbif sweep {name}\n",
        file.title()
    ))
}

/// The text with the file's own name in its comments.
fn text(file: &StartingFile, name: &str) -> String {
    let lines = file.text.lines().map(|line| match line.starts_with('#') {
        true => line.replace(STAND_IN, name),
        false => line.to_owned(),
    });
    let mut text = lines.collect::<Vec<_>>().join("\n");
    text.push('\n');
    text
}
