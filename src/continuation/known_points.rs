//! Points of a sweep that were solved before it, by its shards for example.
//!
//! A sweep asks for its values one after the other, since each solve starts from its neighbour. What is solved already
//! needs no such order: its densities are detected in, and compared with their neighbours, on all cores before the
//! first value is asked for.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::Point;
use super::distances::distance_between;
use super::solved_point::SolvedPoint;
use crate::cancellation::Cancellation;
use crate::numerics::sort_ascending;
use crate::topology::Detector;

/// Points that are known, each given to the sweep once, and distances between neighbours among them.
#[derive(Default)]
pub(super) struct KnownPoints {
    /// By the bits of their values.
    points: Mutex<HashMap<u64, SolvedPoint>>,
    /// By the bits of both values, the smaller value first.
    distances: HashMap<[u64; 2], Option<f64>>,
}

impl KnownPoints {
    /// Detects in points where that was not done, and compares neighbours among all of them and among the given values
    /// of the sweep. Cancelled, it leaves out what is not done.
    pub(super) fn new(
        mut points: Vec<Point>,
        detector: &dyn Detector,
        given: &[f64],
        cancellation: &Cancellation,
    ) -> Self {
        if points.is_empty() {
            return Self::default();
        }
        sort_ascending(&mut points, |one| one.value);
        let distances = distances(&points, given, cancellation);
        let points = points.into_par_iter();
        let points = points.filter(|_| !cancellation.is_cancelled());
        let detected = points.map(|mut point| {
            if point.detections.is_empty() {
                point.detect(detector);
            }
            (point.value.to_bits(), SolvedPoint::new(point, detector))
        });
        Self {
            points: Mutex::new(detected.collect()),
            distances,
        }
    }

    /// The point at a value, if it is known and was not taken before.
    pub(super) fn take(&self, value: f64) -> Option<SolvedPoint> {
        // A poisoned lock holds points as whole as any other.
        let mut points = self.points.lock().unwrap_or_else(PoisonError::into_inner);
        points.remove(&value.to_bits())
    }

    /// Largest Hellinger distance over the watched densities of two points; `None` when one has none.
    pub(super) fn distance_between(&self, a: &Point, b: &Point) -> Option<f64> {
        let known = self.distances.get(&pair(a.value, b.value));
        known.copied().unwrap_or_else(|| distance_between(a, b))
    }
}

/// The distance of two points is the same to the bit whichever comes first.
fn pair(a: f64, b: f64) -> [u64; 2] {
    [a.min(b).to_bits(), a.max(b).to_bits()]
}

/// Distances of neighbours among all points, which are ascending, and among those at given values.
fn distances(
    points: &[Point],
    given: &[f64],
    cancellation: &Cancellation,
) -> HashMap<[u64; 2], Option<f64>> {
    let has_density = |point: &&Point| !point.densities.is_empty();
    let all: Vec<&Point> = points.iter().filter(has_density).collect();
    let mut given = given.to_vec();
    given.sort_by(f64::total_cmp);
    let is_given = |point: &Point| {
        let found = given.binary_search_by(|value| value.total_cmp(&point.value));
        found.is_ok()
    };
    let of_given: Vec<&Point> = all.iter().copied().filter(|one| is_given(one)).collect();
    let mut pairs: Vec<[&Point; 2]> = [all, of_given]
        .iter()
        .flat_map(|points| points.windows(2).map(|two| [two[0], two[1]]))
        .collect();
    pairs.sort_by_key(|[a, b]| pair(a.value, b.value));
    pairs.dedup_by_key(|[a, b]| pair(a.value, b.value));
    let pairs = pairs.into_par_iter();
    let pairs = pairs.filter(|_| !cancellation.is_cancelled());
    let distances = pairs.map(|[a, b]| (pair(a.value, b.value), distance_between(a, b)));
    distances.collect()
}
