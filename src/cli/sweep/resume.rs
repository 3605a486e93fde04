//! `pbif sweep --resume`: whether there is a run to go on with.

use std::path::Path;

use super::{Kind, outcome, shards, summary};
use crate::cli::stored::Stored;
use crate::cli::{CommandError, Outcome};
use crate::continuation::Shard;
use crate::run::{Ending, RunError, StoredRun};
use crate::sweep_file::Sweep;

/// How a run begins.
pub(in crate::cli) enum Begin {
    /// From the first point.
    Anew,
    /// After the points that are in its journal.
    GoOn,
    /// It is complete.
    Done(Box<Stored>),
}

/// Looks at what is in a folder.
///
/// # Errors
/// [`CommandError::Run`] when there is a run that cannot be read, or one of another sweep.
pub(super) fn begin(
    spec: &Sweep,
    path: &Path,
    shard: Option<Shard>,
) -> Result<Begin, CommandError> {
    let run = match StoredRun::open(path) {
        Err(RunError::NotARun { .. }) => return Ok(Begin::Anew),
        run => run?,
    };
    run.check_sweep(&spec.to_toml())?;
    if run.shard() != shard {
        let path = path.to_owned();
        return Err(RunError::OtherShard { path }.into());
    }
    if run.can_go_on() && run.merged().is_some() {
        let path = path.to_owned();
        return Err(RunError::BeingMerged { path }.into());
    }
    if run.ending() != Ending::Complete {
        return Ok(Begin::GoOn);
    }
    Ok(Begin::Done(Box::new(Stored::read(path, &[], &[], true)?)))
}

/// Prints what a complete run has found.
///
/// # Errors
/// [`CommandError::Print`].
pub(in crate::cli) fn show(
    stored: &Stored,
    path: &Path,
    kind: &Kind,
) -> Result<Outcome, CommandError> {
    let done = format!(
        "the run in {} is complete: nothing was solved\n",
        path.display()
    );
    if let Kind::Shard(shard, home) = kind {
        let (text, outcome) = shards::told(&stored.result, (*shard, home), path);
        return crate::cli::conclude(&(done + &text), outcome, path);
    }
    let text = done + &summary::text(&stored.result, path);
    crate::cli::conclude(
        &text,
        outcome(&stored.result, &stored.spec.settings.locate),
        path,
    )
}
