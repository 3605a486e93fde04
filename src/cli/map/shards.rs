//! `--shard K/N` and `pbif merge` for maps of regimes: each shard solves its share of the rows; the merge follows the
//! curves.

use std::path::Path;
use std::time::Instant;

use super::super::args::{MergeArguments, SweepArguments};
use super::super::output::OutputFolder;
use super::super::{CommandError, Outcome, interruptible, print};
use super::{Job, conclude, interrupted};
use crate::continuation::{Shard, SweepError};
use crate::run::{MapFolder, MapShards, RunError, shard_folder};
use crate::sweep_file::{Diagnostic, Sweep, SweepFile};

/// Solves a shard of a map whose folder is `home`.
///
/// # Errors
/// [`CommandError`] where there are more shards than steps between rows, the box is not allowed, or the results cannot
/// be written.
pub(super) fn run(
    spec: &Sweep,
    (home, shard): (&Path, Shard),
    arguments: &SweepArguments,
) -> Result<Outcome, CommandError> {
    check(spec, shard)?;
    let folder = shard_folder(home, shard);
    let output = OutputFolder::prepare(&folder)?;
    let home_of_shard = MapFolder::new(output.path())?;
    let sweep = spec.to_toml();
    if arguments.resume && MapShards::is_complete(output.path(), &sweep)? {
        print("the shard is complete: there is nothing to go on with\n")?;
        return Ok(Outcome::Complete);
    }
    let journal = match arguments.resume && MapFolder::has_journal(output.path()) {
        true => home_of_shard.go_on(&sweep)?,
        false => home_of_shard.begin(&sweep)?,
    };
    let (threads, cancellation) = interruptible(arguments.work.threads)?;
    threads.install(|| {
        let job = Job {
            spec,
            journal: &journal,
            quiet: arguments.work.quiet,
        };
        let Some(found) = job.made(&cancellation, &|maker| maker.shard(shard))? else {
            return interrupted();
        };
        let mut text = format!(
            "shard {} of {} of a map: {} nodes, in {}\n",
            shard.number(),
            shard.of(),
            found.nodes.len(),
            output.path().display()
        );
        if found.interrupted {
            text += "interrupted: the same command with `--resume` goes on\n";
            return super::super::conclude(&text, Outcome::Interrupted, output.path());
        }
        MapShards::write(output.path(), &sweep, &found)?;
        home_of_shard.close_journal();
        text += &format!(
            "`pbif merge {}` puts all {} together when they are done\n",
            home.display(),
            shard.of()
        );
        super::super::conclude(&text, Outcome::Complete, output.path())
    })
}

/// Refuses a shard of a map that has not so many steps.
fn check(spec: &Sweep, shard: Shard) -> Result<(), CommandError> {
    let rows = spec.settings.map.as_ref().map_or(1, |map| map.points);
    if shard.places(rows).is_some() {
        return Ok(());
    }
    let (shards, steps) = (shard.of(), rows.saturating_sub(1));
    let found = Diagnostic::new(SweepError::Shards { shards, steps }.to_string())
        .allowed(format!(
            "`--shard K/N` with N from 1 to {steps}: a map is cut along its second parameter"
        ))
        .remedy("give fewer shards, or raise `map.points`");
    Err(CommandError::Input(found.into()))
}

/// What is said of shards that cannot be read.
fn refused(error: RunError) -> CommandError {
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

/// Puts the shards of a map together, follows its curves and prints what was found.
///
/// # Errors
/// [`CommandError`] where a shard is not what the map needs, or the results cannot be written.
pub(in crate::cli) fn merge(arguments: &MergeArguments) -> Result<Outcome, CommandError> {
    if arguments.partial {
        let found = Diagnostic::new("`--partial` is for the shards of a sweep")
            .remedy("compute the shards of the map that are missing; each goes on with `--resume`");
        return Err(CommandError::Input(found.into()));
    }
    let shards = MapShards::open(&arguments.run).map_err(refused)?;
    let file = SweepFile::parse("the shards' sweep", &shards.sweep_file);
    let spec = file.validate()?.fixed()?;
    let output = OutputFolder::prepare(arguments.out.as_deref().unwrap_or(&arguments.run))?;
    let home = MapFolder::new(output.path())?;
    let sweep = spec.to_toml();
    let journal = match MapFolder::has_journal(output.path()) {
        true => home.go_on(&sweep).or_else(|_| home.begin(&sweep))?,
        false => home.begin(&sweep)?,
    };
    let (threads, cancellation) = interruptible(arguments.work.threads)?;
    threads.install(|| {
        let clock = Instant::now();
        let job = Job {
            spec: &spec,
            journal: &journal,
            quiet: arguments.work.quiet,
        };
        match job.made(&cancellation, &|maker| {
            maker.merged(&shards.shards).map(Some)
        })? {
            Some(map) => conclude(&spec, &map, home, (output.path(), clock)),
            None => interrupted(),
        }
    })
}
