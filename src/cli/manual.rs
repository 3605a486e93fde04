//! What shells and `man` want to know of the command line, made from it.

use std::path::Path;

use clap::CommandFactory as _;
use clap_complete::Shell;

use super::args::Arguments;
use super::{CommandError, Outcome, conclude, print};
use crate::run::{RunError, write_anywhere};

/// The completions of a shell.
pub(super) fn completions(shell: Shell) -> String {
    let mut bytes = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "pbif", &mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Prints the manual page of the program, or writes that of every command into a folder.
///
/// # Errors
/// [`CommandError::Run`] when a page cannot be written.
pub(super) fn run(folder: Option<&Path>) -> Result<Outcome, CommandError> {
    let mut command = Arguments::command();
    command.build();
    let Some(folder) = folder else {
        return print(&page(command)?);
    };
    let mut text = "files\n".to_owned();
    let mut write = |name: String, command| -> Result<(), CommandError> {
        let path = folder.join(format!("{name}.1"));
        write_anywhere(&path, page(command)?.as_bytes())?;
        text += &format!("  {}\n", path.display());
        Ok(())
    };
    write("pbif".to_owned(), command.clone())?;
    for one in command
        .get_subcommands()
        .filter(|one| one.get_name() != "help")
    {
        let name = format!("pbif-{}", one.get_name());
        write(name.clone(), one.clone().display_name(name))?;
    }
    conclude(&text, Outcome::Complete, folder)
}

fn page(command: clap::Command) -> Result<String, CommandError> {
    let mut bytes = Vec::new();
    let rendered = clap_mangen::Man::new(command).render(&mut bytes);
    rendered.map_err(|source| RunError::Write {
        path: "the manual page".into(),
        source,
    })?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_completed_and_has_a_page() {
        let commands = ["sweep", "merge", "list", "export", "completions"];
        for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
            let text = completions(shell);
            assert!(commands.iter().all(|name| text.contains(name)), "{shell}");
        }
        let mut command = Arguments::command();
        command.build();
        for one in command.get_subcommands() {
            let text = page(one.clone()).unwrap();
            assert!(text.contains(".SH SYNOPSIS"), "{}", one.get_name());
        }
    }
}
