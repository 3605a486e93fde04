//! `pbif sweep` on a file with `[map]`: the signatures over a box of two parameters, and the curves between them.

pub(super) mod shards;

use std::path::Path;
use std::time::Instant;

use super::args::SweepArguments;
use super::curve::codimension_line;
use super::output::OutputFolder;
use super::sweep::progress::Progress;
use super::{CommandError, Outcome};
use crate::cancellation::Cancellation;
use crate::continuation::curve::Curve;
use crate::continuation::map::{MapMaker, MapProgress, RegimeMap};
use crate::continuation::{BifurcationStatus, DensitySource, LocateOptions, SourceError};
use crate::figure::{Figures, write_figures};
use crate::run::{Journal, JournalledSource, MapFolder, RunError, format_with_error};
use crate::sweep_file::{Diagnostic, Sweep};

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
    let Some(journal) = journal(&home, output.path(), &spec.to_toml(), arguments.resume)? else {
        super::print("the map is complete: there is nothing to go on with\n")?;
        return Ok(Outcome::Complete);
    };
    let (threads, cancellation) = super::interruptible(arguments.work.threads)?;
    threads.install(|| {
        let clock = Instant::now();
        let job = Job {
            spec,
            journal: &journal,
            quiet: arguments.work.quiet,
        };
        let map = job.made(&cancellation, &|maker| maker.whole().map(Some))?;
        let Some(map) = map.filter(|map| !map.nodes.is_empty()) else {
            return interrupted();
        };
        conclude(spec, &map, home, (output.path(), clock))
    })
}

/// The journal of a map that begins, or goes on where there is one; `None` where the map is complete.
fn journal(
    home: &MapFolder,
    path: &Path,
    sweep: &str,
    resume: bool,
) -> Result<Option<Journal>, RunError> {
    if resume && MapFolder::has_journal(path) {
        return home.go_on(sweep).map(Some);
    }
    if resume && MapFolder::ending(path, sweep)?.is_some_and(|ending| ending == "complete") {
        return Ok(None);
    }
    home.begin(sweep).map(Some)
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
    let figures = Figures::of_map(map, &[], &settings.title).with_style(&settings.figures.style);
    let figures = figures.draw_all()?;
    write_figures(&figures, &settings.figures.formats, &home.figures())?;
    let mut text = summary(map);
    text += "\nfiles\n";
    for file in home.take_place(map.interrupted)? {
        text += &format!("  {}\n", file.display());
    }
    super::conclude(&text, outcome(map, &settings.locate), path)
}

/// A map in the making.
struct Job<'a> {
    spec: &'a Sweep,
    /// Where what is solved is kept while the map is made.
    journal: &'a Journal,
    quiet: bool,
}

impl Job<'_> {
    /// The map, or what is wanted of it; `None` where it was interrupted before there was anything. What is in the
    /// journal is not solved again.
    fn made<T>(
        &self,
        cancellation: &Cancellation,
        wanted: &dyn Fn(&MapMaker<'_>) -> Result<Option<T>, SourceError>,
    ) -> Result<Option<T>, CommandError> {
        let sides = self.spec.settings.map.as_ref();
        let rows = sides.map_or(1, |map| map.points);
        let progress = Progress::new(self.spec.settings.points * rows, self.quiet);
        let solves = self.journal.solves();
        if solves > 0 {
            progress.say(&format!("going on after {solves} solves"));
        }
        let second = sides.map_or("", |map| map.parameter.as_str());
        let first = self.spec.problem.family().parameter();
        let at =
            |values: [f64; 2]| format!("{first} = {:.6}  {second} = {:.6}", values[0], values[1]);
        let observer = |told: &MapProgress<'_>| match *told {
            MapProgress::Solved { node, done, wanted } => {
                let words: Vec<String> = node.signatures.iter().map(ToString::to_string).collect();
                let text = format!("{}  {}", at(node.values), words.join(", "));
                progress.count(&text, done, wanted);
            }
            MapProgress::Met { values, done } => {
                progress.say(&format!("curves: {done} points, {}", at(values)));
            }
        };
        let wrap = |source| {
            let source = JournalledSource::new(source, self.journal);
            Box::new(source) as Box<dyn DensitySource>
        };
        let found = self.spec.make_map(&wrap, cancellation, &observer, wanted);
        progress.finish();
        if let Some(error) = self.journal.failure() {
            return Err(error.into());
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
