//! A solved value with what its densities show beside their features.

use super::Point;
use super::dips::Flanks;
use crate::topology::Detector;

/// A point with the flanks of its densities.
pub(super) struct SolvedPoint {
    pub(super) point: Point,
    /// Those whose sign is sure.
    pub(super) flanks: Flanks,
    /// Places of the observables of which one is not.
    pub(super) unsure: Vec<usize>,
}

impl SolvedPoint {
    /// A point in whose densities was detected.
    pub(super) fn new(point: Point, detector: &dyn Detector) -> Self {
        let found = point.densities.iter().zip(&point.detections);
        let flanks = found.map(|(density, detected)| detector.flanks(density, detected));
        let (flanks, unsure): (Flanks, Flanks) = flanks
            .map(|all| all.into_iter().partition(|one| one.is_sure))
            .unzip();
        let unsure = (0..unsure.len()).filter(|&place| !unsure[place].is_empty());
        let unsure = unsure.collect();
        Self {
            point,
            flanks,
            unsure,
        }
    }
}
