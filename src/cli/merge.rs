//! `pbif merge`: the shards of a sweep, put together to one run.

use std::path::Path;

use super::args::MergeArguments;
use super::output::OutputFolder;
use super::stored::Stored;
use super::sweep::resume::{self, Begin};
use super::sweep::{Kind, Task, draw, summary};
use super::{CommandError, Outcome, curve, warnings};
use crate::continuation::{SweepResult, detect_again};
use crate::run::{Ending, Gathered, Manifest, MapShards, RunError, RunFolder, Shards, StoredRun};
use crate::sweep_file::{MethodKind, Sweep};

/// Puts shards together and prints what is found in all of them.
///
/// # Errors
/// [`CommandError`] when shards are missing or cannot be read, or the results not be written.
pub(super) fn run(arguments: &MergeArguments) -> Result<Outcome, CommandError> {
    if MapShards::are_there(&arguments.run) {
        return super::map::shards::merge(arguments);
    }
    let shards = Shards::open(&arguments.run)?;
    if !arguments.partial {
        shards.check_complete()?;
    }
    let spec = shards.any()?.sweep_file().validate()?.fixed()?;
    let problem = &spec.problem;
    let (subject, cells) = (problem.subject(), (problem.space(), problem.bins()));
    let gathered = shards.gather(subject, cells, &MethodKind::ALL.map(MethodKind::name))?;
    let output = OutputFolder::prepare(arguments.out.as_deref().unwrap_or(&arguments.run))?;
    if !shards.missing().is_empty() {
        return partial(&spec, &shards, gathered, output.path());
    }
    let kind = Kind::Merged(shards.of(), gathered);
    let (path, quiet) = (output.path(), arguments.work.quiet);
    let outcome = match begin(&spec, path, shards.of())? {
        Begin::Done(stored) => resume::show(&stored, path, &kind)?,
        begin => {
            let task = Task {
                spec: &spec,
                path,
                kind,
                quiet,
            };
            task.carry_out(begin, arguments.work.threads)?
        }
    };
    curve::after_sweep(&spec, path, (&arguments.work, true), outcome)
}

/// Goes on where an earlier merge of the same sweep was stopped; one that is complete is not made again.
fn begin(spec: &Sweep, path: &Path, of: usize) -> Result<Begin, CommandError> {
    let run = match StoredRun::open(path) {
        Err(RunError::NotARun { .. }) => return Ok(Begin::Anew),
        run => run?,
    };
    let is_ours = run.merged() == Some(of) && run.check_sweep(&spec.to_toml()).is_ok();
    Ok(match is_ours {
        true if run.ending() == Ending::Complete => {
            Begin::Done(Box::new(Stored::read(path, &[], &[], true)?))
        }
        true if run.can_go_on() => Begin::GoOn,
        _ => Begin::Anew,
    })
}

/// What there is of an incomplete set of shards, as an unfinished run. Nothing is solved.
fn partial(
    spec: &Sweep,
    shards: &Shards,
    gathered: Gathered,
    path: &Path,
) -> Result<Outcome, CommandError> {
    let Gathered { points, checks } = gathered;
    if points.is_empty() {
        shards.check_complete()?;
    }
    let swept = (spec.problem.subject().clone(), spec.settings.points);
    let mut result = detect_again(
        swept,
        &spec.detector(),
        points,
        checks,
        &spec.settings.locate,
    );
    result.interrupted = true;
    write(spec, shards.of(), &result, path)?;
    let mut text = summary::text(&result, path);
    text += &format!("\n{}\n", missing(shards));
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

/// Writes tables, densities, figures, and last the manifest.
fn write(spec: &Sweep, of: usize, result: &SweepResult, path: &Path) -> Result<(), CommandError> {
    let mut folder = RunFolder::create(path)?;
    let seed = spec.settings.method.chosen().seed();
    let mut manifest = Manifest::start(
        &spec.to_toml(),
        spec.settings.typed(),
        seed,
        rayon::current_num_threads(),
    )?;
    manifest.merged = Some(of);
    folder.write_manifest(&manifest)?;
    folder.finish(result)?;
    draw(spec, result, &folder.figures())?;
    manifest.points = result.points.len();
    manifest.largest_distance = result.largest_distance();
    manifest.warnings = warnings::of_points(spec.problem.family(), &result.points);
    manifest.ending = Ending::Interrupted;
    manifest.made.end();
    folder.write_manifest(&manifest)?;
    Ok(folder.seal()?)
}
