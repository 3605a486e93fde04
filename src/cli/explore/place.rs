//! Where a page may be written: what a user has there is not replaced, unless it is a page of this program.

use std::fs::Metadata;
use std::io::Read as _;
use std::path::Path;

use super::CommandError;
use crate::PAGE;
use crate::run::check_place;
use crate::sweep_file::Diagnostic;

/// Refuses a place at which something else than a page of this program stands; `force` lets any other regular file be
/// replaced.
///
/// # Errors
/// [`CommandError::Input`] with what stands there; [`CommandError::Run`] where no results can.
pub(super) fn check(file: &Path, force: bool) -> Result<(), CommandError> {
    // What a link leads to would be somebody else's: the link itself is what is judged.
    check_place(file)?;
    let Ok(found) = file.symlink_metadata() else {
        return Ok(());
    };
    let Some((title, remedy)) = wrong(file, &found, force) else {
        return Ok(());
    };
    Err(CommandError::Input(
        Diagnostic::new(title).remedy(remedy).into(),
    ))
}

/// What stands in the way of a page, and what to do.
fn wrong(file: &Path, found: &Metadata, force: bool) -> Option<(String, String)> {
    let shown = file.display();
    if found.is_file() {
        let title = format!("`{shown}` is no page that pbif wrote: it is left as it is");
        let remedy = "name another file with `--html`, or give `--force` to replace this one";
        return (!force && !is_page(file)).then(|| (title, remedy.to_owned()));
    }
    if found.is_dir() {
        let title = format!("`{shown}` is a folder: a page is a file");
        let inside = file.join("explorer.html");
        return Some((title, format!("write `--html {}`", inside.display())));
    }
    if found.is_symlink() {
        let title = format!("`{shown}` is a link, which a page does not replace");
        let remedy = match file.read_link() {
            Ok(target) => format!(
                "name the file itself (the link leads to `{}`), or remove the link",
                target.display()
            ),
            Err(_) => "name another file with `--html`".to_owned(),
        };
        return Some((title, remedy));
    }
    let title = format!("`{shown}` is no file, but a device, a pipe or a socket");
    Some((title, "name another file with `--html`".to_owned()))
}

/// Whether a file begins as a page of this program does.
fn is_page(file: &Path) -> bool {
    let mut start = Vec::new();
    let read = std::fs::File::open(file).and_then(|file| {
        let most = PAGE.len() as u64;
        file.take(most).read_to_end(&mut start)
    });
    read.is_ok() && start == PAGE.as_bytes()
}
