//! `pbif merge`: the shards of a sweep or of a map, put together to one.

use std::path::Path;

use super::args::MergeArguments;
use super::output::OutputFolder;
use super::sweep::summary;
use super::{CommandError, curve, jobs};
use crate::cancellation::Cancellation;
use crate::job::{self, Job as _, MapJob, Outcome, Start, SweepJob};
use crate::run::{Gathered, MapShards, RunError, Shards};
use crate::sweep_file::{Diagnostic, Sweep, SweepFile};

/// Puts shards together and prints what is found in all of them.
///
/// # Errors
/// [`CommandError`] when shards are missing or cannot be read, or the results not be written.
pub(super) fn run(arguments: &MergeArguments) -> Result<Outcome, CommandError> {
    if MapShards::are_there(&arguments.run) {
        return of_map(arguments);
    }
    let shards = Shards::open(&arguments.run)?;
    if !arguments.partial {
        shards.check_complete()?;
    }
    let spec = shards.any()?.sweep_file().validate()?.fixed()?;
    let problem = &spec.problem;
    let (subject, cells) = (problem.subject(), (problem.space(), problem.bins()));
    let path = arguments.out.as_deref().unwrap_or(&arguments.run);
    // Nothing is read of the shards of a merge that is complete.
    let complete = SweepJob::merged(&spec, shards.of(), Gathered::default());
    if shards.missing().is_empty() && complete.start(path)? == Start::Complete {
        let outcome = jobs::run(complete, path, true, &arguments.work)?;
        return curve::after_sweep(&spec, path, (&arguments.work, true), outcome);
    }
    let gathered = shards.gather(subject, cells, &spec.methods())?;
    if !shards.missing().is_empty() {
        return partial(&spec, &shards, gathered, path);
    }
    let job = SweepJob::merged(&spec, shards.of(), gathered);
    let outcome = jobs::run(job, path, true, &arguments.work)?;
    curve::after_sweep(&spec, path, (&arguments.work, true), outcome)
}

/// What there is of an incomplete set of shards, as an unfinished run. Nothing is solved.
fn partial(
    spec: &Sweep,
    shards: &Shards,
    gathered: Gathered,
    path: &Path,
) -> Result<Outcome, CommandError> {
    if gathered.points.is_empty() {
        shards.check_complete()?;
    }
    let output = OutputFolder::prepare(path)?;
    let path = output.path();
    let mut job = SweepJob::gathered(spec, shards.of(), gathered);
    let done = job::carry_out(&mut job, path, Start::Anew, &Cancellation::new(), &|_| ())?;
    let found = done.map(|done| summary::text(&done.found, path));
    let text = format!("{}\n{}\n", found.unwrap_or_default(), missing(shards));
    super::conclude(&text, Outcome::Partial, path)
}

/// Which shards are missing, in words.
fn missing(shards: &Shards) -> String {
    let missing = shards.missing();
    let each = missing.iter();
    let words: Vec<String> = each
        .map(|(shard, words)| format!("{shard} ({words})"))
        .collect();
    let (count, of) = (missing.len(), shards.of());
    format!("missing: {count} of {of} shards: {}", words.join(", "))
}

/// Puts the shards of a map together, follows its curves and prints what was found.
fn of_map(arguments: &MergeArguments) -> Result<Outcome, CommandError> {
    if arguments.partial {
        let found = Diagnostic::new("`--partial` is for the shards of a sweep")
            .remedy("compute the shards of the map that are missing; each goes on with `--resume`");
        return Err(found.into());
    }
    let shards = MapShards::open(&arguments.run).map_err(refusal)?;
    let file = SweepFile::parse("the shards' sweep", &shards.sweep_file);
    let spec = file.validate()?.fixed()?;
    let path = arguments.out.as_deref().unwrap_or(&arguments.run);
    let job = MapJob::merged(&spec, &shards.shards);
    // A map that is there is made again.
    let resume = MapJob::LAYOUT.has_part(path);
    jobs::run(job, path, resume, &arguments.work)
}

/// What is said of shards of a map that cannot be read.
fn refusal(error: RunError) -> CommandError {
    let RunError::MissingShards { path, missing, .. } = &error else {
        return error.into();
    };
    let first = missing.first().map(|(shard, _)| shard.to_string());
    let remedy = format!(
        "`pbif sweep FILE --shard {} --out {} --resume` computes it, and so each of them",
        first.unwrap_or_default(),
        path.display()
    );
    CommandError::Input(Diagnostic::new(error.to_string()).remedy(remedy).into())
}
