//! Distances between neighbouring points of a sweep.

use rayon::prelude::*;

use super::Point;
use crate::density::hellinger;

/// Largest Hellinger distance over the watched densities of two points; `None` when one has none.
pub(super) fn distance_between(a: &Point, b: &Point) -> Option<f64> {
    let pairs = a.densities.iter().zip(&b.densities);
    pairs
        .filter_map(|(a, b)| hellinger(&a.density, &b.density).ok())
        .reduce(f64::max)
}

/// Fills all distances of ascending points, each from the point with densities before it.
/// `distance` gives that of two points.
pub(super) fn fill_all_distances(
    points: &mut [Point],
    distance: impl Fn(&Point, &Point) -> Option<f64> + Sync,
) {
    let has = |index: &usize| !points[*index].densities.is_empty();
    let solved: Vec<usize> = (0..points.len()).filter(has).collect();
    let pairs = solved.par_windows(2);
    let distances: Vec<Option<f64>> = pairs
        .map(|pair| distance(&points[pair[0]], &points[pair[1]]))
        .collect();
    points.iter_mut().for_each(|point| point.distance = None);
    for (&place, distance) in solved.iter().skip(1).zip(distances) {
        points[place].distance = distance;
    }
}

/// Fills the distances that a new point at `place` changes: its own, and that of the next one with densities.
pub(super) fn fill_distances(points: &mut [Point], place: usize) {
    if points[place].densities.is_empty() {
        return;
    }
    let has = |index: &usize| !points[*index].densities.is_empty();
    let before = (0..place).rev().find(has);
    let after = (place + 1..points.len()).find(has);
    points[place].distance =
        before.and_then(|index| distance_between(&points[index], &points[place]));
    if let Some(after) = after {
        points[after].distance = distance_between(&points[place], &points[after]);
    }
}
