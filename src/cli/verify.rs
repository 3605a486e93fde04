//! `pbif verify`: whether the files of a run are those that it left, and its densities those of the equations.

use std::hash::{BuildHasher as _, RandomState};

use super::args::VerifyArguments;
use super::{CommandError, Outcome, conclude, interruptible};
use crate::cancellation::Cancellation;
use crate::continuation::Point;
use crate::run::{Checked, Damage, RunError, StoredRun, check_folder, format_number};

/// Checks every file against its checksum and prints those that are not as they were; solves some points again where
/// that is asked for.
///
/// # Errors
/// [`CommandError::Run`] when the run cannot be read, or a point not be solved.
pub(super) fn run(arguments: &VerifyArguments) -> Result<Outcome, CommandError> {
    let folder = &arguments.run;
    // A comparison, curves and a map have no points of their own to solve again.
    if arguments.recompute == 0 && !folder.join("run.json").is_file() {
        let (text, outcome) = files(check_folder(folder)?);
        return conclude(&text, outcome, folder);
    }
    let run = match StoredRun::open(folder) {
        // Which files, is what is asked.
        Err(RunError::Damaged { .. }) => {
            let (text, outcome) = files(check_folder(folder)?);
            return conclude(&text, outcome, folder);
        }
        run => run?,
    };
    let (mut text, mut outcome) = files(run.damage()?);
    if arguments.recompute > 0 && outcome_allows(&run, outcome)? {
        let (threads, cancellation) = interruptible(None)?;
        let again = threads.install(|| recompute(&run, arguments.recompute, &cancellation))?;
        text += &again.0;
        outcome = match again.1 {
            Outcome::Complete => outcome,
            again => again,
        };
    }
    conclude(&text, outcome, run.path())
}

/// Densities are compared where they are as the run left them, or nothing is known of that.
fn outcome_allows(run: &StoredRun, outcome: Outcome) -> Result<bool, CommandError> {
    Ok(outcome == Outcome::Complete || run.damage()?.is_none())
}

/// What is said of the files of a folder.
fn files(checked: Option<Checked>) -> (String, Outcome) {
    let Some((whole, damaged)) = checked else {
        let text = "no checksums: the run is not finished, or of an early version\n";
        return (text.to_owned(), Outcome::Partial);
    };
    if damaged.is_empty() {
        let text = format!("{whole} files are as the run left them\n");
        return (text, Outcome::Complete);
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
    (text, Outcome::Partial)
}

/// Solves points again; those that are not what is stored are said.
fn recompute(
    run: &StoredRun,
    count: usize,
    cancellation: &Cancellation,
) -> Result<(String, Outcome), CommandError> {
    let sweep = run.sweep_file().validate()?.fixed()?;
    let points = pick(run.solved_points(&sweep)?, count);
    let parameter = sweep.problem.family().parameter();
    let (mut text, mut good) = (String::new(), 0);
    for point in &points {
        let found = match run.recompute(&sweep, point, cancellation) {
            Err(_) if cancellation.is_cancelled() => return Ok((text, Outcome::Interrupted)),
            found => found?,
        };
        let word = if found.agrees() {
            "the same density"
        } else {
            "ANOTHER density"
        };
        good += usize::from(found.agrees());
        text += &format!(
            "  {parameter} = {}: {word}, total variation {:.1e} of at most {:.1e}\n",
            format_number(found.value),
            found.apart,
            found.allowed
        );
    }
    let all = points.len();
    text += &format!("{good} of {all} points that were solved again have the stored densities\n");
    let outcome = if good == all {
        Outcome::Complete
    } else {
        Outcome::Partial
    };
    Ok((text, outcome))
}

/// So many of the points, at random, in their order.
fn pick(mut points: Vec<Point>, count: usize) -> Vec<Point> {
    let random = RandomState::new();
    while points.len() > count {
        let place = random.hash_one(points.len()) % points.len() as u64;
        points.remove(place as usize);
    }
    points
}
