//! A solved value with what its densities show beside their features.

use super::Point;
use super::dips::Flanks;
use super::flank::rises_to_uncounted;
use crate::topology::{Detector, Flank};

/// A point with the flanks of its densities.
pub(super) struct SolvedPoint {
    pub(super) point: Point,
    /// Those whose sign is sure.
    pub(super) flanks: Flanks,
    /// Places of the observables in which something is not sure: the sign of a flank; a feature that may be what errors
    /// make; a flank that rises to a peak which errors are too large to count.
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
        let is_unsure = |place: &usize| {
            let (density, detection) =
                (&point.densities[*place].density, &point.detections[*place]);
            let least = detector.floor() * density.maximum();
            let is_uncounted =
                |flank: &Flank| rises_to_uncounted(density, detection, (flank, least));
            !unsure[*place].is_empty()
                || shows_unresolved(&point, *place, detector)
                || flanks[*place].iter().any(is_uncounted)
        };
        let unsure = (0..unsure.len()).filter(is_unsure).collect();
        Self {
            point,
            flanks,
            unsure,
        }
    }
}

/// Whether a density shows a feature that is no lower than what is looked for, and that may be what errors make.
pub(super) fn shows_unresolved(point: &Point, place: usize, detector: &dyn Detector) -> bool {
    let shown = point.densities.get(place).zip(point.detections.get(place));
    shown.is_some_and(|(density, detection)| {
        detection.has_unresolved(detector.floor() * density.density.maximum())
    })
}
