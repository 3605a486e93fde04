//! Shards of a sweep: what each of them says, and the source that has what all of them solved.

use std::path::Path;

use crate::cli::{CommandError, Outcome};
use crate::continuation::{Shard, SweepError, SweepResult};
use crate::run::format_number;
use crate::sweep_file::{Diagnostic, Sweep};

/// Refuses a shard of a sweep that has not so many steps.
///
/// # Errors
/// [`CommandError::Input`].
pub(super) fn check(spec: &Sweep, shard: Shard) -> Result<(), CommandError> {
    let points = spec.settings.points;
    if shard.places(points).is_some() {
        return Ok(());
    }
    let (shards, steps) = (shard.of(), points - 1);
    let error = SweepError::Shards { shards, steps };
    let found = Diagnostic::new(error.to_string())
        .allowed(format!("`--shard K/N` with N from 1 to {steps}"))
        .remedy("give fewer shards, or raise `sweep.points`");
    Err(CommandError::Input(found.into()))
}

/// What is said of a shard that has ended, and how. Rows are the business of the whole, where neighbours on both sides
/// are known.
pub(super) fn told(
    result: &SweepResult,
    (shard, home): (Shard, &Path),
    path: &Path,
) -> (String, Outcome) {
    let family = &result.subject.family;
    let points = result.points.len();
    let mut text = format!(
        "shard {} of {}: {points} points",
        shard.number(),
        shard.of()
    );
    if let (Some(first), Some(last)) = (result.points.first(), result.points.last()) {
        let ends = [first, last].map(|point| format_number(point.value));
        text += &format!(", {} from {} to {}", family.parameter(), ends[0], ends[1]);
    }
    text += &format!(", in {}\n", path.display());
    if result.interrupted {
        text += "interrupted: the same command with `--resume` goes on\n";
        return (text, Outcome::Interrupted);
    }
    text += &format!(
        "`pbif merge {}` puts all {} together when they are done\n",
        home.display(),
        shard.of()
    );
    (text, Outcome::Complete)
}
