//! The peaks and the valley about a centre of symmetry that the indicator proves, when they are too near each other for
//! persistence: features of a marginal then say what its signature says.
//!
//! The peak that persistence sees in their place is refined to one of them; the other is its mirror image. About the
//! centre p/p(c) = 1 + g u²/2 + k u⁴/24 with g = p''/p and k = p''''/p: peaks at ±u stand by p g u²/4 above the valley
//! between.

use super::window::around;
use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::topology::extremum::density_at;
use crate::topology::{Feature, FeatureErrors, FeatureKind, Verdict};

/// Cells on either side of the centre within which peaks belong to it.
const REACH: usize = 4;

/// Puts the features about the centre of a marginal right, where the sign of its indicator is beyond doubt; elsewhere a
/// peak that stands there alone is moved onto it.
pub(crate) fn correct_about_centre(
    estimated: &EstimatedDensity,
    indicators: &[Indicator],
    doubt: f64,
    features: &mut Vec<Feature>,
) {
    let Some(centre) = Centre::of(estimated, indicators) else {
        return;
    };
    let Some(split) = centre.indicator.sign(doubt) else {
        return centre.hold_alone(features);
    };
    let Some(seen) = centre.to_put_right(features, split) else {
        return;
    };
    let mut made = centre.proven(&seen, split);
    let limit = seen.offset.max(centre.reach);
    // What was in doubt there is what is now proven.
    features.retain(|one| centre.distance(one) > limit || one.verdict == Verdict::Absent);
    made.append(features);
    made.sort_by(|a, b| {
        a.kind
            .cmp(&b.kind)
            .then(b.persistence.total_cmp(&a.persistence))
    });
    *features = made;
}

/// A centre of symmetry.
struct Centre<'a> {
    estimated: &'a EstimatedDensity,
    indicator: &'a Indicator,
    at: f64,
    /// Distance within which peaks belong to it.
    reach: f64,
}

/// What persistence saw.
struct Persistent {
    highest: Feature,
    /// The peak nearest to the centre.
    nearest: Feature,
    /// Its distance.
    offset: f64,
}

impl<'a> Centre<'a> {
    /// The centre of a marginal.
    fn of(estimated: &'a EstimatedDensity, indicators: &'a [Indicator]) -> Option<Self> {
        let ([axis], [indicator]) = (estimated.density.axes.as_slice(), indicators) else {
            return None;
        };
        let &at = indicator.place.first()?;
        let cells = around(axis, at, REACH)?;
        Some(Self {
            estimated,
            indicator,
            at,
            reach: axis.edges()[cells.end] - at,
        })
    }

    fn distance(&self, feature: &Feature) -> f64 {
        (feature.position[0] - self.at).abs()
    }

    /// A peak without a mirror image stands on the centre, as far as can be told. In noise it stays where it was seen.
    fn hold_alone(&self, features: &mut [Feature]) {
        let mut peaks: Vec<&mut Feature> = features
            .iter_mut()
            .filter(|one| one.kind == FeatureKind::Peak && one.verdict == Verdict::Present)
            .collect();
        if let ([peak], Some(density)) = (peaks.as_mut_slice(), density_at(self.estimated, self.at))
            && self.distance(peak) <= self.reach
        {
            peak.position = vec![self.at];
            peak.density = density;
        }
    }

    /// What persistence saw, unless it agrees with the indicator that the centre is a valley between two peaks, or a
    /// peak.
    fn to_put_right(&self, features: &[Feature], split: bool) -> Option<Persistent> {
        let present = features
            .iter()
            .filter(|one| one.verdict == Verdict::Present);
        let near = present
            .clone()
            .filter(|one| self.distance(one) <= self.reach)
            .count();
        let peaks = present.filter(|one| one.kind == FeatureKind::Peak);
        // By symmetry other peaks come in pairs.
        let complete = peaks.clone().count().is_multiple_of(2) == split;
        if complete && (near == 0 || (split && near > 1)) {
            return None;
        }
        let highest = peaks.clone().next()?.clone();
        let nearest = peaks.min_by(|a, b| self.distance(a).total_cmp(&self.distance(b)))?;
        let offset = self.distance(nearest);
        (offset <= self.reach || !complete).then(|| Persistent {
            highest,
            nearest: nearest.clone(),
            offset,
        })
    }

    /// The features that the indicator proves.
    fn proven(&self, seen: &Persistent, split: bool) -> Vec<Feature> {
        let indicator = self.indicator;
        let significance =
            indicator.value.abs() / indicator.systematic_error.max(f64::MIN_POSITIVE);
        let feature = |kind, place: f64, density: f64, persistence: f64| Feature {
            kind,
            position: vec![place],
            density,
            persistence,
            standard_error: 0.0,
            significance: significance.min(1e9),
            verdict: Verdict::Present,
            partner: (split && kind == FeatureKind::Peak).then(|| vec![self.at]),
            errors: FeatureErrors::default(),
        };
        let known = density_at(self.estimated, self.at);
        let density = known.unwrap_or_else(|| beside(self.estimated, self.at));
        let rise = self.rise(density, seen.offset);
        let top = if self.distance(&seen.highest) <= self.reach {
            seen.highest.persistence
        } else {
            rise
        };
        if !split {
            return vec![feature(FeatureKind::Peak, self.at, density, top)];
        }
        let height = known.map_or(density + rise, |_| seen.nearest.density);
        let (left, right) = (self.at - seen.offset, self.at + seen.offset);
        vec![
            feature(FeatureKind::Peak, left, height, top),
            feature(FeatureKind::Peak, right, height, rise),
            feature(FeatureKind::Valley, self.at, density, rise),
        ]
    }

    /// Height of peaks at a distance from the centre above it.
    fn rise(&self, density: f64, offset: f64) -> f64 {
        let rise = if self.indicator.kind == IndicatorKind::CURVATURE {
            0.25 * density * self.indicator.value * offset * offset
        } else {
            // From the kink up: half the slope's rise to the top.
            0.5 * density * self.indicator.value * offset
        };
        rise.max(0.0)
    }
}

/// Mean of the cells beside a place.
fn beside(estimated: &EstimatedDensity, place: f64) -> f64 {
    let (axis, values) = (&estimated.density.axes[0], &estimated.density.values);
    let cells = axis.cells_beside(place);
    cells.map_or(0.0, |[below, above]| 0.5 * (values[above] + values[below]))
}
