//! `pbif verify`: whether the files of a run are those that it left.

use super::args::VerifyArguments;
use super::{CommandError, Outcome, conclude, print};
use crate::run::{Damage, StoredRun};

/// Checks every file against its checksum and prints those that are not as they were.
///
/// # Errors
/// [`CommandError::Run`] when the run cannot be read.
pub(super) fn run(arguments: &VerifyArguments) -> Result<Outcome, CommandError> {
    let run = StoredRun::open(&arguments.run)?;
    let Some((whole, damaged)) = run.damage()? else {
        let text = "no checksums: the run is not finished, or of an early version\n";
        return conclude(text, Outcome::Partial, run.path());
    };
    if damaged.is_empty() {
        return print(&format!("{whole} files are as the run left them\n"));
    }
    let mut text = String::new();
    for (path, damage) in &damaged {
        text += &format!("  {:8} {}\n", damage.word(), path.display());
    }
    let bad = damaged
        .iter()
        .filter(|(_, damage)| *damage != Damage::Added)
        .count();
    text += &format!(
        "{bad} of {} files are not as the run left them\n",
        whole + bad
    );
    conclude(&text, Outcome::Partial, run.path())
}
