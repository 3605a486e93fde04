//! `pbif clean`: removes earlier versions, unfinished runs and merged shards, after asking.

use std::io::{self, BufRead as _, IsTerminal as _, Write as _};
use std::path::PathBuf;

use super::args::CleanArguments;
use super::{CommandError, Outcome, print};
use crate::run::{Removable, Stays, find_runs, removable_runs, remove_run};
use crate::sweep_file::{Diagnostic, bytes_in_words};

/// Files that are named one by one where they stay.
const NAMED: usize = 20;

/// Lists what may go, asks, and removes it; names what stays.
///
/// # Errors
/// [`CommandError::Input`] when there is no run, or nobody to ask; [`CommandError::Run`] when a run cannot be read, or
/// is written to.
pub(super) fn run(arguments: &CleanArguments) -> Result<Outcome, CommandError> {
    let folder = &arguments.folder;
    if find_runs(folder).is_empty() {
        let title = format!("`{}` holds no runs", folder.display());
        let found = Diagnostic::new(title)
            .remedy("give the folder of a run, or of several, such as `output`");
        return Err(found.into());
    }
    let mut going = removable_runs(folder);
    let all = !arguments.earlier && !arguments.unfinished;
    going.retain(|one| {
        all || arguments.earlier && one.why == "earlier"
            || arguments.unfinished && one.why == "unfinished"
    });
    if going.is_empty() {
        return print("nothing to remove\n");
    }
    print(&list(&going))?;
    if !arguments.yes && !agreed()? {
        print("nothing was removed\n")?;
        return Ok(Outcome::Partial);
    }
    // Earlier versions of an unfinished run stand in its folder: the innermost go first.
    going.reverse();
    let mut stays = Vec::new();
    for (done, one) in going.iter().enumerate() {
        let removal = remove_run(&one.path).map_err(|error| {
            let others = count(going.len());
            CommandError::from(error).after(format!("{done} of {others} were removed"))
        })?;
        stays.extend(removal.stays);
    }
    let is_done = |(_, why): &(PathBuf, Stays)| !matches!(why, Stays::Refused(_));
    print(&format!(
        "{} removed\n{}",
        count(going.len()),
        list_kept(&stays)
    ))?;
    Ok(if stays.iter().all(is_done) {
        Outcome::Complete
    } else {
        Outcome::Partial
    })
}

/// What stays, and why.
fn list_kept(stays: &[(PathBuf, Stays)]) -> String {
    if stays.is_empty() {
        return String::new();
    }
    let named = stays.iter().take(NAMED);
    let lines = named.map(|(path, why)| format!("  {}: {why}\n", path.display()));
    let mut text = format!("what stays\n{}", lines.collect::<String>());
    if stays.len() > NAMED {
        text += &format!("  and {} others\n", stays.len() - NAMED);
    }
    text
}

fn count(runs: usize) -> String {
    match runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    }
}

fn list(going: &[Removable]) -> String {
    let mut text = String::new();
    let mut bytes = 0;
    for one in going {
        bytes += one.bytes;
        let size = bytes_in_words(one.bytes as f64);
        text += &format!("  {:12} {size:>10}  {}\n", one.why, one.path.display());
    }
    text += &format!("{}, {}\n", count(going.len()), bytes_in_words(bytes as f64));
    text
}

/// Asks on the terminal.
fn agreed() -> Result<bool, CommandError> {
    if !io::stdin().is_terminal() {
        let found = Diagnostic::new("there is no terminal to ask whether they may be removed")
            .remedy("give `--yes` to remove them without asking");
        return Err(found.into());
    }
    let mut stderr = io::stderr().lock();
    write!(stderr, "remove them? [y/N] ")?;
    stderr.flush()?;
    let mut answer = String::new();
    io::stdin().lock().read_line(&mut answer)?;
    Ok(matches!(answer.trim().to_lowercase().as_str(), "y" | "yes"))
}
