//! Detection and location repeated on the points of a finished sweep, without solving.

use super::sweep::fill_distances;
use super::{LocateOptions, Plan, Point, SweepResult, locate::label_points};
use crate::topology::Detector;

/// Detects and locates again on all points there are, those that once refined brackets included. What the points
/// held of detections and distances is replaced; points without a density stay as they are.
pub fn detect_again(
    plan: &Plan,
    detector: &dyn Detector,
    mut points: Vec<Point>,
    options: &LocateOptions,
) -> SweepResult {
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    for point in &mut points {
        let densities = point.densities.iter();
        point.detections = densities.map(|one| detector.detect(one)).collect();
        point.distance = None;
    }
    fill_distances(&mut points);
    let labels = label_points(&points, &plan.observables, options);
    SweepResult {
        parameter: plan.parameter.clone(),
        observables: plan.observables.clone(),
        points,
        labels,
        interrupted: false,
    }
}
