//! What `pbif sweep` prints of a map of regimes: the signatures over a box of two parameters, and the curves between
//! them.

use std::path::Path;

use super::CommandError;
use super::curve::{codimension_line, level_lines, stability_lines};
use super::jobs::{Printed, files};
use super::sweep::shard_in_words;
use crate::continuation::BifurcationStatus;
use crate::continuation::curve::Curve;
use crate::continuation::map::{MapShard, RegimeMap, UntracedChange};
use crate::job::{Done, Job, MapJob, MapShardJob, Outcome};
use crate::run::{format_with_error, warnings_of_nodes};

/// Columns and rows of the picture that shares of regions are counted in.
const PICTURE: [usize; 2] = [300, 300];
/// Regions smaller than this share of the box are not listed.
const SEEN: f64 = 1e-3;

impl Printed for MapJob<'_> {
    fn planned(&self) -> Option<usize> {
        planned(self)
    }

    fn text(&self, done: &Done<RegimeMap>, _: &Path) -> String {
        summary(&done.found) + "\n" + &files(&done.files)
    }

    fn complete(&self, _: &Path) -> Result<(String, Outcome), CommandError> {
        let text = "the map is complete: there is nothing to go on with\n";
        Ok((text.to_owned(), Outcome::Complete))
    }

    fn warnings(&self, found: &RegimeMap) -> Vec<String> {
        warnings_of_nodes(found)
    }
}

impl Printed for MapShardJob<'_> {
    fn planned(&self) -> Option<usize> {
        planned(self)
    }

    fn text(&self, done: &Done<MapShard>, home: &Path) -> String {
        let found = &done.found;
        let what = format!(" of a map: {} nodes", found.nodes.len());
        shard_in_words(found.shard, &what, (found.interrupted, home))
    }

    fn complete(&self, _: &Path) -> Result<(String, Outcome), CommandError> {
        let text = "the shard is complete: there is nothing to go on with\n";
        Ok((text.to_owned(), Outcome::Complete))
    }
}

/// Nodes of the coarse grid.
fn planned(job: &impl Job) -> Option<usize> {
    let settings = &job.sweep().settings;
    let rows = settings.map.as_ref().map_or(1, |map| map.points);
    Some(settings.points * rows)
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
    text += &stability_lines(&map.subject.family, &map.plane);
    for level in map.levels.iter().enumerate() {
        text += &level_lines(&map.plane, level, "start");
    }
    for point in map.codimension_two() {
        text += &codimension_line(&point, &map.plane, &map.subject.family);
    }
    for one in &map.untraced {
        let what = match &one.of {
            UntracedChange::Signature(index) => {
                let observable = map.subject.observables.get(*index);
                observable.map(|one| one.name(family)).unwrap_or_default()
            }
            UntracedChange::Level(asked) => asked.measure.clone(),
        };
        let pairs = match one.pairs {
            1 => "1 pair of neighbours".to_owned(),
            pairs => format!("{pairs} pairs of neighbours"),
        };
        text += &format!(
            "not followed: {what} changes between {pairs}, one near {} = {}, {} = {}: {}\n",
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
        let words = words.unwrap_or_else(|| "no steady state, or not converged".to_owned());
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
        .filter(|point| point.status() == BifurcationStatus::Located);
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
