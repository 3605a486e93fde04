//! `pbif new`: writes a commented sweep file to start from, or lists those that there are.

use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write as _};
use std::path::Path;

use super::CommandError;
use crate::sweep_file::{Diagnostic, StartingFile, starting_files};

/// The starting file where none is named.
const STANDARD: &str = "vanderpol";
/// What stands in the comments of a starting file for its own name.
const STAND_IN: &str = "FILE";

/// The starting files with their titles.
fn list() -> String {
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

/// What `pbif new` does: it lists the starting files where neither a file nor one of them is named, and writes one
/// where a file is.
///
/// # Errors
/// [`CommandError::Input`] where there is no such starting file, no file to write, or it cannot be made.
pub(super) fn run(path: Option<&Path>, like: Option<&str>) -> Result<String, CommandError> {
    let is_known = |name: &str| starting_files().iter().any(|file| file.name == name);
    let title = match (path, like) {
        (None, None) => return Ok(list()),
        (None, Some(like)) => (
            format!("no file is named that is to be like `{like}`"),
            like,
        ),
        (Some(path), None) => match path.to_str().filter(|name| is_known(name)) {
            Some(name) => (
                format!("`{name}` is a starting file, not a file to write"),
                name,
            ),
            None => return write(path, STANDARD),
        },
        (Some(path), Some(like)) => return write(path, like),
    };
    let (title, name) = title;
    let diagnostic = Diagnostic::new(title);
    Err(CommandError::Input(if is_known(name) {
        diagnostic
            .remedy(format!("write `pbif new {name}.toml --like {name}`"))
            .into()
    } else {
        unknown(name).into()
    }))
}

/// There is no starting file of a name.
fn unknown(like: &str) -> Diagnostic {
    let names = starting_files().iter().map(|file| file.name);
    let title = format!("there is no starting file `{like}`");
    let diagnostic = Diagnostic::new(title).nearest(like, names);
    match crate::system::registry::find(like) {
        Ok(_) => diagnostic.remedy(format!(
            "`{like}` is a built-in model: `pbif systems {like}` shows it, and `model = \"{like}\"` in [system] takes it"
        )),
        Err(_) => diagnostic,
    }
}

/// Writes the starting file of a name; an existing file is never replaced.
///
/// # Errors
/// [`CommandError::Input`] where there is no such starting file, or the file cannot be made.
fn write(path: &Path, like: &str) -> Result<String, CommandError> {
    let refuse = |diagnostic: Diagnostic| diagnostic.into();
    let mut files = starting_files().iter();
    let Some(file) = files.find(|file| file.name == like) else {
        return Err(refuse(unknown(like)));
    };
    let name = path.display().to_string();
    let made = OpenOptions::new().write(true).create_new(true).open(path);
    let written = made.and_then(|mut made| made.write_all(text(file, &name).as_bytes()));
    written.map_err(|error| {
        let diagnostic = match error.kind() {
            ErrorKind::AlreadyExists => Diagnostic::new(format!("`{name}` is there already"))
                .remedy("give another name, or remove it first"),
            ErrorKind::NotFound => Diagnostic::new(format!("cannot write `{name}`: {error}"))
                .remedy("make its folder first"),
            _ => Diagnostic::new(format!("cannot write `{name}`: {error}"))
                .remedy("write to a folder that is yours, or choose another name"),
        };
        refuse(diagnostic)
    })?;
    let typed = as_typed(&name);
    Ok(format!(
        "{}: {}\n\nChange it, then\n  pbif check {typed}\n  pbif sweep {typed}\n",
        on_one_line(&name),
        file.title()
    ))
}

/// A name in the characters that a comment can hold.
fn on_one_line(name: &str) -> String {
    name.replace(char::is_control, "\u{fffd}")
}

/// A name as it is typed after a command.
fn as_typed(name: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "._-/\\:+~".contains(c);
    let shown = if name.starts_with('-') {
        format!("./{name}")
    } else {
        name.to_owned()
    };
    if shown.chars().all(is_plain) {
        shown
    } else {
        format!("'{}'", shown.replace('\'', r"'\''"))
    }
}

/// The text with the file's own name in its comments.
fn text(file: &StartingFile, name: &str) -> String {
    let lines = file.text.lines().map(|line| {
        if line.starts_with('#') {
            line.replace(STAND_IN, &as_typed(&on_one_line(name)))
        } else {
            line.to_owned()
        }
    });
    let mut text = lines.collect::<Vec<_>>().join("\n");
    text.push('\n');
    text
}
