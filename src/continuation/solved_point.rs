//! A solved value with what its densities show beside their features.

use super::Point;
use super::dips::Flanks;
use super::flank::rises_to_uncounted;
use crate::density::EstimatedDensity;
use crate::topology::{Detector, Flank, reading_error};

/// Share of the highest value by which peaks may stand out that errors hide, before cells are too wide to count by.
const COARSE: f64 = 0.01;

/// A peak is counted whose height over its saddle is so many errors.
const SAFETY: f64 = 3.0;

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
            let (estimated, detection) = (&point.densities[*place], &point.detections[*place]);
            let density = &estimated.density;
            let least = detector.floor() * density.maximum();
            let is_uncounted =
                |flank: &Flank| rises_to_uncounted(density, detection, (flank, least));
            !unsure[*place].is_empty()
                || may_be_miscounted(&point, *place, detector)
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

/// The share of the highest value of a density by which a peak stands out at least that neither its errors hide nor
/// cells that are wider than it; `None` with sampling noise, which is told otherwise, where there is a centre, at which
/// indicators are read, and where every extremum follows from the equations.
pub(super) fn least_shown(density: &EstimatedDensity) -> Option<f64> {
    let values = density.density.values.iter().zip(&density.standard_error);
    let (value, error) = values.max_by(|one, other| one.0.total_cmp(other.0))?;
    let structure = &density.structure;
    let is_told = structure.centre.is_some() || structure.profile.is_some();
    let is_read = !is_told && !density.is_noisy();
    (is_read && *value > 0.0).then(|| SAFETY * (error + reading_error(density)) / value)
}

/// Whether errors of a density hide peaks that are looked for.
pub(super) fn is_coarse(density: &EstimatedDensity) -> bool {
    least_shown(density).is_some_and(|share| share > COARSE)
}

/// Whether a density of a point may have features that are not counted: it shows one that is no lower than what is
/// looked for, and that may be what errors make, or its errors hide such features.
pub(super) fn may_be_miscounted(point: &Point, place: usize, detector: &dyn Detector) -> bool {
    let shown = point.densities.get(place).zip(point.detections.get(place));
    shown.is_some_and(|(density, detection)| {
        is_coarse(density) || detection.has_unresolved(detector.floor() * density.density.maximum())
    })
}
