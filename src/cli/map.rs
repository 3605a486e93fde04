//! `pbif sweep` on a file with `[map]`: the signatures over a box of two parameters, and the curves between them.

use std::path::Path;
use std::time::Instant;

use super::args::SweepArguments;
use super::output::OutputFolder;
use super::sweep::progress::Progress;
use super::{CommandError, Outcome};
use crate::cancellation::Cancellation;
use crate::continuation::BifurcationStatus;
use crate::continuation::SourceError;
use crate::continuation::curve::Curve;
use crate::continuation::map::{MapProgress, RegimeMap};
use crate::figure::{map_figures, write_figures};
use crate::run::{MapFolder, format_with_error};
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
    if arguments.shard.is_some() {
        let report = Diagnostic::new("a map of regimes cannot be made in shards")
            .remedy("leave `--shard` out: its strips run side by side on the cores of one machine");
        return Err(CommandError::Input(report.into()));
    }
    if arguments.resume {
        let report = Diagnostic::new("a map of regimes cannot be gone on with")
            .remedy("leave `--resume` out: a map is made anew, and an earlier one is kept");
        return Err(CommandError::Input(report.into()));
    }
    let output = OutputFolder::prepare(folder)?;
    let home = MapFolder::new(output.path())?;
    let (threads, cancellation) = super::interruptible(arguments.work.threads)?;
    threads.install(|| {
        let clock = Instant::now();
        let map = made(spec, arguments.work.quiet, &cancellation)?;
        let Some(map) = map.filter(|map| !map.nodes.is_empty()) else {
            super::print("interrupted: nothing was written\n")?;
            return Ok(Outcome::Interrupted);
        };
        home.write(&map, &spec.to_toml(), clock.elapsed().as_secs_f64())?;
        let settings = &spec.settings;
        let figures = map_figures(&map, &settings.title, &settings.figure_style)?;
        write_figures(&figures, &settings.figure_formats, &home.figures())?;
        let mut text = summary(&map);
        text += "\nfiles\n";
        for file in home.take_place()? {
            text += &format!("  {}\n", file.display());
        }
        super::conclude(&text, outcome(&map), output.path())
    })
}

/// The map; `None` where it was interrupted before there was anything.
fn made(
    spec: &Sweep,
    quiet: bool,
    cancellation: &Cancellation,
) -> Result<Option<RegimeMap>, CommandError> {
    let rows = spec.settings.map.as_ref().map_or(1, |map| map.points);
    let progress = Progress::new(spec.settings.points * rows, quiet);
    let sides = spec.settings.map.as_ref();
    let second = sides.map_or("", |map| map.parameter.as_str());
    let first = spec.problem.family().parameter();
    let at = |values: [f64; 2]| format!("{first} = {:.6}  {second} = {:.6}", values[0], values[1]);
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
    let found = spec.map(cancellation, &observer);
    progress.finish();
    match found {
        Ok(map) => Ok(map),
        Err(SourceError::Interrupted) => Ok(None),
        Err(SourceError::Method(error)) => {
            let title = format!("the box of the map has a corner that is not allowed: {error}");
            let report = Diagnostic::new(title)
                .remedy("narrow it with `sweep.from`, `sweep.to`, `map.from` and `map.to`");
            Err(CommandError::Input(report.into()))
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
        let values = [first, second].into_iter().enumerate().map(|(k, side)| {
            let (value, _) = format_with_error(point.values[k], point.error * side.length());
            format!("{} = {value}", side.parameter)
        });
        let values = values.collect::<Vec<_>>().join("  ");
        let curves = point.curves.iter().map(|index| format!("C{}", index + 1));
        let curves = curves.collect::<Vec<_>>().join(" and ");
        text += &format!(
            "{}  {values}  cusp, where {curves} end; known to {:.1e} of the sides of the box\n",
            point.label, point.error
        );
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
        text += "interrupted: the tables and figures hold what was done\n";
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
fn outcome(map: &RegimeMap) -> Outcome {
    let located = |curve: &Curve| {
        let mut points = curve.points.iter();
        points.all(|point| point.status == BifurcationStatus::Located)
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
