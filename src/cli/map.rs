//! `pbif sweep` on a file with `[map]`: the signatures over a box of two parameters, and the curves between them.

pub(super) mod shards;

use std::io::Write as _;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::args::SweepArguments;
use super::curve::codimension_line;
use super::output::OutputFolder;
use super::sweep::progress::Progress;
use super::{CommandError, Outcome};
use crate::cancellation::Cancellation;
use crate::continuation::curve::Curve;
use crate::continuation::map::{MapNode, MapObserver, MapProgress, RegimeMap};
use crate::continuation::{BifurcationStatus, LocateOptions, SourceError};
use crate::figure::{map_figures, write_figures};
use crate::run::{MapCheckpoint, MapFolder, format_with_error};
use crate::sweep_file::{Diagnostic, Sweep};

/// How often what is solved is written.
const EVERY: Duration = Duration::from_secs(2);
/// Columns and rows of the picture that shares of regions are counted in.
const PICTURE: [usize; 2] = [300, 300];
/// Regions smaller than this share of the box are not listed.
const SEEN: f64 = 1e-3;

/// Makes a map and prints what it found; `folder` is where it goes.
///
/// # Errors
/// [`CommandError`] where the box is not allowed, or the results cannot be written.
pub(super) fn run(
    spec: &Sweep,
    folder: &Path,
    arguments: &SweepArguments,
) -> Result<Outcome, CommandError> {
    if let Some(shard) = arguments.shard {
        return shards::run(spec, (folder, shard), arguments);
    }
    let output = OutputFolder::prepare(folder)?;
    let home = MapFolder::new(output.path())?;
    let checkpoint = MapCheckpoint::new(output.path(), &spec.to_toml());
    let known = match arguments.resume {
        true => checkpoint.read()?,
        false => {
            home.keep_unfinished()?;
            Vec::new()
        }
    };
    if arguments.resume && known.is_empty() && is_complete(spec, output.path())? {
        super::print("the map is complete: there is nothing to go on with\n")?;
        return Ok(Outcome::Complete);
    }
    let (threads, cancellation) = super::interruptible(arguments.work.threads)?;
    threads.install(|| {
        let clock = Instant::now();
        let job = Job {
            spec,
            checkpoint: Some(&checkpoint),
            quiet: arguments.work.quiet,
        };
        let solve = |observer: &MapObserver<'_>| spec.map_from(&known, &cancellation, observer);
        let map = job.made(&known, &cancellation, &solve)?;
        let Some(map) = map.filter(|map| !map.nodes.is_empty()) else {
            return interrupted();
        };
        conclude(spec, &map, home, (output.path(), clock))
    })
}

/// What is said where there is nothing to write.
fn interrupted() -> Result<Outcome, CommandError> {
    super::print("interrupted: nothing was written\n")?;
    Ok(Outcome::Interrupted)
}

/// Writes a map with its figures and prints what it found.
fn conclude(
    spec: &Sweep,
    map: &RegimeMap,
    home: MapFolder,
    (path, clock): (&Path, Instant),
) -> Result<Outcome, CommandError> {
    home.write(map, &spec.to_toml(), clock.elapsed().as_secs_f64())?;
    let settings = &spec.settings;
    let figures = map_figures(map, &[], &settings.title, &settings.figure_style)?;
    write_figures(&figures, &settings.figure_formats, &home.figures())?;
    let mut text = summary(map);
    if !map.interrupted {
        MapCheckpoint::new(path, &spec.to_toml()).remove();
    }
    text += "\nfiles\n";
    for file in home.take_place()? {
        text += &format!("  {}\n", file.display());
    }
    super::conclude(&text, outcome(map, &settings.locate), path)
}

/// Whether the folder holds this very map, complete.
fn is_complete(spec: &Sweep, folder: &Path) -> Result<bool, CommandError> {
    Ok(MapFolder::ending(folder, &spec.to_toml())?.is_some_and(|ending| ending == "complete"))
}

/// A map in the making.
struct Job<'a> {
    spec: &'a Sweep,
    /// Where what is solved is kept while the map is made.
    checkpoint: Option<&'a MapCheckpoint>,
    quiet: bool,
}

impl Job<'_> {
    /// The map, or what is wanted of it, that is solved with the nodes that are known; `None` where it was interrupted
    /// before there was anything. What is solved is written now and then, so that a map that is killed can be gone on
    /// with.
    fn made<T>(
        &self,
        known: &[MapNode],
        cancellation: &Cancellation,
        solve: &dyn Fn(&MapObserver<'_>) -> Result<Option<T>, SourceError>,
    ) -> Result<Option<T>, CommandError> {
        let sides = self.spec.settings.map.as_ref();
        let rows = sides.map_or(1, |map| map.points);
        let progress = Progress::new(self.spec.settings.points * rows, self.quiet);
        if !known.is_empty() {
            progress.say(&format!("going on after {} nodes", known.len()));
        }
        let second = sides.map_or("", |map| map.parameter.as_str());
        let first = self.spec.problem.family().parameter();
        let at =
            |values: [f64; 2]| format!("{first} = {:.6}  {second} = {:.6}", values[0], values[1]);
        let solved = Mutex::new((known.to_vec(), Instant::now()));
        let observer = |told: &MapProgress<'_>| match *told {
            MapProgress::Solved { node, done, wanted } => {
                let words: Vec<String> = node.signatures.iter().map(ToString::to_string).collect();
                let text = format!("{}  {}", at(node.values), words.join(", "));
                progress.count(&text, done, wanted);
                // A poisoned lock holds nodes as whole as any other.
                let mut solved = solved.lock().unwrap_or_else(PoisonError::into_inner);
                solved.0.push(node.clone());
                if solved.1.elapsed() >= EVERY {
                    self.keep(&solved.0);
                    solved.1 = Instant::now();
                }
            }
            MapProgress::Met { values, done } => {
                progress.say(&format!("curves: {done} points, {}", at(values)));
            }
        };
        let found = solve(&observer);
        progress.finish();
        if cancellation.is_cancelled() {
            let solved = solved.lock().unwrap_or_else(PoisonError::into_inner);
            self.keep(&solved.0);
        }
        match found {
            Ok(found) => Ok(found),
            Err(SourceError::Interrupted) => Ok(None),
            Err(SourceError::Method(error)) => {
                let title = format!("the box of the map has a corner that is not allowed: {error}");
                let report = Diagnostic::new(title)
                    .remedy("narrow it with `sweep.from`, `sweep.to`, `map.from` and `map.to`");
                Err(CommandError::Input(report.into()))
            }
        }
    }

    /// Writes what is solved. Where that fails the map goes on: it can be made without.
    fn keep(&self, nodes: &[MapNode]) {
        let kept = self.checkpoint.map(|checkpoint| checkpoint.write(nodes));
        if let Some(Err(error)) = kept {
            let text = format!("what is solved cannot be kept: {error}\n");
            // Without a reader of stderr there is nobody to tell.
            let _ = std::io::stderr().lock().write_all(text.as_bytes());
        }
    }
}

fn summary(map: &RegimeMap) -> String {
    let family = &map.subject.family;
    let [first, second] = map.plane.sides();
    let refined = map.nodes.iter().filter(|node| node.level > 0).count();
    let mut text = format!(
        "map of {} and {}: {} nodes, {refined} of them where signatures differ\n",
        first.parameter,
        second.parameter,
        map.nodes.len()
    );
    let failed = map.nodes.iter().filter(|node| !node.status.is_resolved());
    let count = failed.clone().count();
    if let Some(node) = failed.clone().next() {
        let reason = node.reason.as_deref().unwrap_or(node.status.word());
        text += &format!("  {count} without a steady state, or not converged: {reason}\n");
    }
    for (index, observable) in map.subject.observables.iter().enumerate() {
        text += &format!("  {}: {}\n", observable.name(family), regimes(map, index));
    }
    for (index, curve) in map.curves.iter().enumerate() {
        text += &line(map, index, curve);
    }
    for point in map.codimension_two() {
        text += &codimension_line(&point, &map.plane);
    }
    for one in &map.untraced {
        let observable = map.subject.observables.get(one.observable);
        let pairs = match one.pairs {
            1 => "1 pair of neighbours".to_owned(),
            pairs => format!("{pairs} pairs of neighbours"),
        };
        text += &format!(
            "not followed: {} changes between {pairs}, one near {} = {}, {} = {}: {}\n",
            observable.map(|one| one.name(family)).unwrap_or_default(),
            first.parameter,
            rough(map, one.near, 0),
            second.parameter,
            rough(map, one.near, 1),
            one.reason
        );
    }
    if map.interrupted {
        text += "interrupted: the tables and figures hold what was done, and `--resume` goes on from there\n";
    }
    text
}

/// One of two values, to a thousandth of its side of the box.
fn rough(map: &RegimeMap, values: [f64; 2], side: usize) -> String {
    format_with_error(values[side], 1e-3 * map.plane.sides()[side].length()).0
}

/// The signatures of an observable with their shares of the box.
fn regimes(map: &RegimeMap, observable: usize) -> String {
    let Some(picture) = map.regions(observable, PICTURE) else {
        return String::new();
    };
    let mut shares: Vec<(String, f64)> = Vec::new();
    for region in picture.regions {
        let words = region.signature.map(|signature| signature.to_string());
        let words = words.unwrap_or_else(|| "no steady state".to_owned());
        match shares.iter_mut().find(|known| known.0 == words) {
            Some(known) => known.1 += region.share,
            None => shares.push((words, region.share)),
        }
    }
    shares.retain(|one| one.1 >= SEEN);
    let words = shares.iter().map(|(words, share)| {
        let percent = 100.0 * share;
        format!("{words} ({percent:.1} % of the box)")
    });
    words.collect::<Vec<_>>().join(", ")
}

/// What a curve is, and from where to where it goes.
fn line(map: &RegimeMap, index: usize, curve: &Curve) -> String {
    let [first, second] = map.plane.sides();
    let located = curve
        .points
        .iter()
        .filter(|point| point.status == BifurcationStatus::Located);
    let errors = curve.points.iter().map(|point| point.error);
    let largest = errors.fold(0.0, f64::max);
    let mut text = format!(
        "C{}  {} of {} is zero: {} points, {} of them located; largest error {largest:.1e} of the sides of the box\n",
        index + 1,
        curve.kind.name(),
        curve.observable.name(&map.subject.family),
        curve.points.len(),
        located.count(),
    );
    for end in &curve.ends {
        let Some(point) = curve.points.get(end.point) else {
            continue;
        };
        let values = [first, second].into_iter().enumerate().map(|(k, side)| {
            let (value, _) = format_with_error(point.values[k], point.error * side.length());
            format!("{} = {value}", side.parameter)
        });
        let values = values.collect::<Vec<_>>().join("  ");
        let words = end.reason.words(&curve.plane);
        text += &format!("      {:<4} {values}  {words}\n", end.label);
    }
    text
}

/// How a command ends that gives this map.
fn outcome(map: &RegimeMap, locate: &LocateOptions) -> Outcome {
    let located = |curve: &Curve| {
        let mut points = curve.points.iter();
        points.all(|point| locate.is_met_by(point.status))
    };
    if map.interrupted {
        Outcome::Interrupted
    } else if map.nodes.iter().all(|node| node.status.is_resolved())
        && map.untraced.is_empty()
        && map.curves.iter().all(located)
    {
        Outcome::Complete
    } else {
        Outcome::Partial
    }
}
