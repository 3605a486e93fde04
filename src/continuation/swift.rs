//! Where a peak of a joint density moves faster than beside: two changes that undo each other may hide there.
//!
//! Along a branch of peaks the parameter is a function θ(x) of the place, and the speed of the peak is 1/θ'(x). A pair
//! of peak and saddle is born, and another vanishes, where θ(x) turns; between two solved values on either side of both
//! turns nothing is seen of them but a peak that has gone far in a short stretch of the parameter. So it goes where a
//! pair lasts for less than a step of the sweep, and where its peaks are nearer to each other than cells can tell.

use super::Point;
use crate::topology::{Feature, FeatureKind, Verdict};

/// A peak moves fast where it is so many times as fast as in the gaps on either side.
const FASTER: f64 = 2.0;

/// Neighbouring peaks farther apart than this, in ranges, are not one that moved.
const ONE_PEAK: f64 = 0.25;

/// Cells that a peak must have moved where finer ones are to tell whether a pair is there.
pub(super) const WORTH_A_LOOK: f64 = 0.5;

/// A stretch between solved values in which a peak moves fast.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Swift {
    /// Place of the observable among those that are watched.
    pub(super) observable: usize,
    /// The values at its ends, ascending.
    pub(super) ends: [f64; 2],
    /// The solved values next to it.
    pub(super) beside: [f64; 2],
    /// How far the peak moves, in cells.
    pub(super) cells: f64,
}

/// Where peaks move fast over so many gaps between neighbours that count the same; ascending for each observable. None
/// of marginals, whose flanks tell more; of sampled densities; and where there is a centre of symmetry, at which
/// indicators are read.
pub(super) fn swift(points: &[&Point], gaps: usize) -> Vec<Swift> {
    let observables = points.first().map_or(0, |point| point.densities.len());
    let windows = |observable: usize| {
        let windows = points.windows(gaps + 3);
        windows.filter_map(move |window| in_window(window, observable))
    };
    (0..observables).flat_map(windows).collect()
}

/// The fastest peak between the second and the last but one of some neighbours.
fn in_window(window: &[&Point], observable: usize) -> Option<Swift> {
    let last = window.len() - 1;
    let is_usable = |point: &&Point| {
        let density = &point.densities[observable];
        let (structure, axes) = (&density.structure, &density.density.axes);
        let is_smooth = structure.kinks.iter().all(|kink| kink.is_bend());
        axes.len() == 2 && is_smooth && structure.centre.is_none() && !density.is_noisy()
    };
    let inner = &window[1..last];
    let count = |point: &&Point| point.detections[observable].signature;
    let is_level = inner.iter().all(|point| count(point) == count(&inner[0]));
    if !is_level || !window.iter().all(is_usable) {
        return None;
    }
    let speeds = peaks(window[0], observable)
        .filter_map(|first| moves(window, observable, first))
        .filter_map(|moves| {
            let width = |a: usize, b: usize| window[b].value - window[a].value;
            let cells: f64 = moves[1..last - 1].iter().sum();
            let speed = cells / width(1, last - 1);
            let beside = (moves[0] / width(0, 1)).max(moves[last - 1] / width(last - 1, last));
            (speed > FASTER * beside).then_some(cells)
        });
    Some(Swift {
        observable,
        ends: [window[1].value, window[last - 1].value],
        beside: [window[0].value, window[last].value],
        cells: speeds.reduce(f64::max)?,
    })
}

fn peaks(point: &Point, observable: usize) -> impl Iterator<Item = &Feature> {
    let features = point.detections[observable].features.iter();
    features.filter(|one| one.kind == FeatureKind::Peak && one.verdict == Verdict::Present)
}

/// How far a peak moves from each of some neighbours to the next, in cells; `None` where it is lost.
fn moves(window: &[&Point], observable: usize, first: &Feature) -> Option<Vec<f64>> {
    let axes = &window[0].densities[observable].density.axes;
    let apart = |a: &Feature, b: &Feature, is_in_cells: bool| {
        let pairs = a.position.iter().zip(&b.position).zip(axes);
        let each = pairs.map(|((&a, &b), axis)| {
            let cell = axis.find(a).map_or(f64::INFINITY, |cell| axis.width(cell));
            let unit = if is_in_cells {
                cell
            } else {
                axis.to() - axis.from()
            };
            (axis.apart(a, b) / unit).abs()
        });
        each.fold(0.0, f64::max)
    };
    let nearest = |point: &'_ Point, of: &Feature| -> Option<Feature> {
        let near = peaks(point, observable)
            .min_by(|a, b| apart(a, of, false).total_cmp(&apart(b, of, false)))?;
        (apart(near, of, false) <= ONE_PEAK).then(|| near.clone())
    };
    let (mut here, mut moves) = (first.clone(), Vec::new());
    for pair in window.windows(2) {
        let next = nearest(pair[1], &here)?;
        if nearest(pair[0], &next)?.position != here.position {
            return None;
        }
        moves.push(apart(&here, &next, true));
        here = next;
    }
    Some(moves)
}
