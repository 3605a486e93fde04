//! `pbif clean`: removes earlier versions, unfinished runs and merged shards, after asking.

use std::io::{self, BufRead as _, IsTerminal as _, Write as _};

use super::args::CleanArguments;
use super::{CommandError, Outcome, print};
use crate::run::{Removable, find_runs, removable_runs, remove_run};
use crate::sweep_file::{Diagnostic, bytes_in_words};

/// Lists what may go, asks, and removes it.
///
/// # Errors
/// [`CommandError::Input`] when there is no run, or nobody to ask; [`CommandError::Run`] when a file cannot be removed.
pub(super) fn run(arguments: &CleanArguments) -> Result<Outcome, CommandError> {
    let folder = &arguments.folder;
    if find_runs(folder).is_empty() {
        let title = format!("`{}` holds no runs", folder.display());
        let found = Diagnostic::new(title)
            .remedy("give the folder of a run, or of several, such as `output`");
        return Err(CommandError::Input(found.into()));
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
    print(&listed(&going))?;
    if !arguments.yes && !agreed()? {
        print("nothing was removed\n")?;
        return Ok(Outcome::Partial);
    }
    // Earlier versions of an unfinished run stand in its folder: the innermost go first.
    going.reverse();
    for (done, one) in going.iter().enumerate() {
        remove_run(&one.path).map_err(|error| {
            CommandError::from(error).after(format!("{done} of {} runs were removed", going.len()))
        })?;
    }
    print(&format!("{} removed\n", count(going.len())))
}

fn count(runs: usize) -> String {
    match runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    }
}

fn listed(going: &[Removable]) -> String {
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
        return Err(CommandError::Input(found.into()));
    }
    let mut stderr = io::stderr().lock();
    write!(stderr, "remove them? [y/N] ")?;
    stderr.flush()?;
    let mut answer = String::new();
    io::stdin().lock().read_line(&mut answer)?;
    Ok(matches!(answer.trim().to_lowercase().as_str(), "y" | "yes"))
}
