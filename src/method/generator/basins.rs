//! Regions that are found: the basin of a peak of a watched marginal density, between the valleys beside it.

use crate::density::{EstimatedDensity, Observable};
use crate::system::{Basin, Model, PassageQuestion, PassageStart, Region};
use crate::topology::{
    DetectOptions, Detector, Feature, FeatureKind, PersistenceDetector, Verdict,
};

/// How far the ends of basins are moved, in errors of the valleys: not at all, and either way.
pub(super) const MOVED: [f64; 3] = [0.0, 1.0, -1.0];

/// Share of a cell by which the place of a valley may be off of which no error is known.
const UNKNOWN: f64 = 0.5;

/// A question with found regions as intervals, their ends moved outward by so many errors of the valleys; `None`
/// where a density does not have the peak, or has no valley beside it.
pub(super) fn with_intervals(
    question: &PassageQuestion,
    model: &Model,
    densities: &[EstimatedDensity],
    moved: f64,
) -> Option<PassageQuestion> {
    let found = |region: &Region| match region.basin() {
        None => Some(region.clone()),
        Some(basin) => {
            let ends = ends(basin, densities, moved)?;
            region.between(model, basin.axis, ends).ok()
        }
    };
    Some(PassageQuestion {
        until: found(&question.until)?,
        start: match &question.start {
            PassageStart::Region(region) => PassageStart::Region(found(region)?),
            other => other.clone(),
        },
        ..question.clone()
    })
}

/// Both ends of a basin, none where no other peak is on that side.
fn ends(basin: Basin, densities: &[EstimatedDensity], moved: f64) -> Option<[Option<f64>; 2]> {
    let density = densities
        .iter()
        .find(|one| one.observable == Observable::Marginal(basin.axis))?;
    let detection = PersistenceDetector::new(DetectOptions::default(), 1).detect(density);
    let places = |kind: FeatureKind| {
        let present = detection.features.iter();
        let present = present.filter(|one| one.kind == kind && one.verdict == Verdict::Present);
        let mut all: Vec<(f64, f64)> = present
            .filter_map(|feature| Some((*feature.position.first()?, error(feature, density))))
            .collect();
        all.sort_by(|one, other| one.0.total_cmp(&other.0));
        all
    };
    let (peaks, valleys) = (places(FeatureKind::Peak), places(FeatureKind::Valley));
    let &(peak, _) = peaks.get(basin.peak.checked_sub(1)?)?;
    // Between two neighbouring peaks is a valley, or nobody knows where the basin ends.
    let valley = |other: Option<&(f64, f64)>| match other {
        None => Some(None),
        Some(&(other, _)) => {
            let (low, high) = (peak.min(other), peak.max(other));
            let between = valleys
                .iter()
                .find(|valley| low < valley.0 && valley.0 < high);
            between.map(|&valley| Some(valley))
        }
    };
    let below = basin
        .peak
        .checked_sub(2)
        .and_then(|before| peaks.get(before));
    let (lower, upper) = (valley(below)?, valley(peaks.get(basin.peak))?);
    if lower.is_none() && upper.is_none() {
        return None;
    }
    Some([
        lower.map(|(at, error)| at - moved * error),
        upper.map(|(at, error)| at + moved * error),
    ])
}

/// By how much the place of a valley may be off.
fn error(feature: &Feature, density: &EstimatedDensity) -> f64 {
    let known = feature.errors.position.first().copied();
    known.filter(|error| error.is_finite()).unwrap_or_else(|| {
        let axis = density.density.axes.first();
        axis.map_or(0.0, |axis| {
            UNKNOWN * (axis.to() - axis.from()) / axis.count() as f64
        })
    })
}
