//! Regions that are found in a watched density: the basin of a peak, up to the valleys around it, and what lies within
//! the crest of a ring.

use crate::density::{EstimatedDensity, Observable};
use crate::numerics::sort_ascending;
use crate::system::{Basin, BasinOf, Model, PassageQuestion, PassageStart, Region};
use crate::topology::{
    DetectOptions, Detection, Detector, Feature, FeatureKind, PersistenceDetector, Verdict, basin,
    crest,
};

/// How far the borders of basins are moved, in errors of the valleys: not at all, and either way.
pub(super) const MOVED: [f64; 3] = [0.0, 1.0, -1.0];

/// Share of a cell by which the place of a valley may be off of which no error is known.
const UNKNOWN: f64 = 0.5;

/// A question with found regions as inequalities, their borders moved outward by so many of their errors; `None` where
/// a density does not have the peak or the ring, or has no valley beside the peak.
pub(super) fn with_inequalities(
    question: &PassageQuestion,
    model: &Model,
    densities: &[EstimatedDensity],
    moved: f64,
) -> Option<PassageQuestion> {
    let found = |region: &Region| match region.basin() {
        None => Some(region.clone()),
        Some(basin) => inequalities(region, basin, model, densities, moved),
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

/// A region that is found, as inequalities.
fn inequalities(
    region: &Region,
    asked: Basin,
    model: &Model,
    densities: &[EstimatedDensity],
    moved: f64,
) -> Option<Region> {
    let observable = asked.observable();
    let density = densities.iter().find(|one| one.observable == observable)?;
    let detection = PersistenceDetector::new(DetectOptions::default(), 1).detect(density);
    let Observable::Joint(first, second) = observable else {
        let BasinOf::Peak(peak) = asked.of else {
            return None;
        };
        let ends = ends(peak, density, &detection, moved)?;
        return region.between(model, asked.axes.0, ends).ok();
    };
    let borders = match asked.of {
        BasinOf::Peak(peak) => basin(density, &detection, peak)?,
        BasinOf::InsideRing => vec![crest(density, &detection)?],
        BasinOf::OutsideRing => vec![crest(density, &detection)?.other_side()],
    };
    let names = [first, second].map(|axis| model.axes[axis].name.as_str());
    let borders = borders.iter().map(|one| one.inequality(names, moved));
    region.within(model, &borders.collect::<Vec<_>>()).ok()
}

impl Basin {
    /// The density in which it is found.
    pub(crate) fn observable(self) -> Observable {
        match self.axes {
            (axis, None) => Observable::Marginal(axis),
            (first, Some(second)) => Observable::Joint(first, second),
        }
    }
}

/// Both ends of the basin of a peak of a marginal density, none where no other peak is on that side.
fn ends(
    peak: usize,
    density: &EstimatedDensity,
    detection: &Detection,
    moved: f64,
) -> Option<[Option<f64>; 2]> {
    let places = |kind: FeatureKind| {
        let present = detection.features.iter();
        let present = present.filter(|one| one.kind == kind && one.verdict == Verdict::Present);
        let mut all: Vec<(f64, f64)> = present
            .filter_map(|feature| Some((*feature.position.first()?, error(feature, density))))
            .collect();
        sort_ascending(&mut all, |one| one.0);
        all
    };
    let (peaks, valleys) = (places(FeatureKind::Peak), places(FeatureKind::Valley));
    let &(place, _) = peaks.get(peak.checked_sub(1)?)?;
    // Between two neighbouring peaks is a valley, or nobody knows where the basin ends.
    let valley = |other: Option<&(f64, f64)>| match other {
        None => Some(None),
        Some(&(other, _)) => {
            let (low, high) = (place.min(other), place.max(other));
            let between = valleys
                .iter()
                .find(|valley| low < valley.0 && valley.0 < high);
            between.map(|&valley| Some(valley))
        }
    };
    let below = peak.checked_sub(2).and_then(|before| peaks.get(before));
    let (lower, upper) = (valley(below)?, valley(peaks.get(peak))?);
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
