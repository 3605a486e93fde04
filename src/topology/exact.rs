//! Features of a density over one axis whose extrema are known from its equations: however narrow they are, none is
//! lost between cells.

use std::cmp::Ordering;

use super::indicator::{Counted, at_centre, correct, peaks_at_ends};
use super::significance::Limits;
use super::{Detection, Feature, FeatureErrors, FeatureKind, Signature, Verdict};
use crate::density::{EstimatedDensity, Extremum, Profile};

/// Relative error of a density computed from its logarithm.
const ROUNDING: f64 = 1e-12;

/// What the equations of a system with one axis say: every extremum is known, no cell has to show it.
///
/// `doubt` is the probability with which signs at the centre may be wrong.
pub(super) fn detection(
    density: &EstimatedDensity,
    profile: &Profile,
    limits: &Limits,
    doubt: f64,
) -> Detection {
    let mut features = features(profile, limits);
    // What lies beyond the ends of the range makes all heights too large by its share.
    for feature in &mut features {
        let beyond = density.truncation.share * feature.density;
        feature.errors.density = feature.errors.density.map(|error| error + beyond);
    }
    features.sort_by(by_kind_and_height);
    let indicators = at_centre(density);
    // Where a split is nearer than rounding lets its peaks be told apart, the centre decides.
    let peaks = present_places(&features, FeatureKind::Peak);
    let counted = Counted {
        signature: Signature {
            at_ends: peaks_at_ends(density).count(),
            ..Signature::of_peaks(peaks.len())
        },
        peaks: &peaks,
        craters: &[],
        rings_around_centre: 0,
    };
    let signature = correct(density, &indicators, doubt, &counted);
    Detection {
        signature,
        is_seen: true,
        indicators,
        features,
    }
}

/// Peaks and the valleys that belong to them, judged. Where two hills meet at a valley, the lower one ends there: its
/// peak is as high as it stands above the valley. The partner of a peak is the higher of the valleys beside it, with
/// which it was born or will vanish.
fn features(profile: &Profile, limits: &Limits) -> Vec<Feature> {
    let mut hills = hills(&profile.extrema);
    let mut features = Vec::new();
    while let Some((place, valley)) = highest_valley(&hills) {
        let (left, right) = (&hills[place].peak, &hills[place + 1].peak);
        let lower = if left.log_density < right.log_density {
            *left
        } else {
            *right
        };
        let [peak, valley] = pair(&lower, &valley, limits);
        let partner = higher_beside(&profile.extrema, &lower).map(|place| vec![place]);
        features.extend([Feature { partner, ..peak }, valley]);
        let kept = if left.log_density < right.log_density {
            hills[place + 1].peak
        } else {
            hills[place].peak
        };
        let above = hills.remove(place + 1);
        hills[place] = Hill {
            peak: kept,
            valley_above: above.valley_above,
        };
    }
    features.extend(hills.first().map(|hill| Feature {
        partner: higher_beside(&profile.extrema, &hill.peak).map(|place| vec![place]),
        ..highest(&hill.peak)
    }));
    features
}

/// A hill with the valley that follows it.
struct Hill {
    peak: Extremum,
    valley_above: Option<Extremum>,
}

fn hills(extrema: &[Extremum]) -> Vec<Hill> {
    let mut hills: Vec<Hill> = Vec::new();
    for extremum in extrema {
        match (extremum.is_peak, hills.last_mut()) {
            (true, _) => hills.push(Hill {
                peak: *extremum,
                valley_above: None,
            }),
            (false, Some(hill)) => hill.valley_above = Some(*extremum),
            // Below the first peak the density only rises.
            (false, None) => {}
        }
    }
    hills
}

/// The highest valley between two hills, and the number of the hill below it.
fn highest_valley(hills: &[Hill]) -> Option<(usize, Extremum)> {
    let between = hills.iter().enumerate().take(hills.len().saturating_sub(1));
    let valleys = between.filter_map(|(place, hill)| Some((place, hill.valley_above?)));
    valleys.max_by(|a, b| a.1.log_density.total_cmp(&b.1.log_density))
}

/// A peak and the valley where it ends, both as high as the peak stands above the valley.
fn pair(peak: &Extremum, valley: &Extremum, limits: &Limits) -> [Feature; 2] {
    let height = peak.density - valley.density;
    let gathered = (peak.gathered_error - valley.gathered_error).abs();
    // In units of the peak's own height: the density of a peak may be too small for a number.
    let own = -(valley.log_density - peak.log_density).exp_m1();
    let judgement = limits.judge_exact(own, gathered + ROUNDING);
    let feature = |of: &Extremum, kind: FeatureKind| Feature {
        kind,
        position: vec![of.place],
        density: of.density,
        persistence: height,
        standard_error: 0.0,
        significance: judgement.significance,
        verdict: judgement.verdict,
        partner: None,
        errors: exact_errors(of),
    };
    [
        feature(peak, FeatureKind::Peak),
        feature(valley, FeatureKind::Valley),
    ]
}

/// Place of the higher of the valleys beside a peak.
fn higher_beside(extrema: &[Extremum], peak: &Extremum) -> Option<f64> {
    let index = extrema.iter().position(|one| one.place == peak.place)?;
    let below = index.checked_sub(1).and_then(|index| extrema.get(index));
    let beside = below.into_iter().chain(extrema.get(index + 1));
    let higher = beside.max_by(|a, b| a.log_density.total_cmp(&b.log_density))?;
    Some(higher.place)
}

/// The highest peak, which is as high as its density.
fn highest(peak: &Extremum) -> Feature {
    Feature {
        kind: FeatureKind::Peak,
        position: vec![peak.place],
        density: peak.density,
        persistence: peak.density,
        standard_error: 0.0,
        significance: f64::INFINITY,
        verdict: super::Verdict::Present,
        partner: None,
        errors: exact_errors(peak),
    }
}

/// Errors of what follows from the equations: rounding, and what its height has gathered.
fn exact_errors(extremum: &Extremum) -> FeatureErrors {
    FeatureErrors {
        position: vec![ROUNDING * extremum.place.abs()],
        density: Some(extremum.density * (extremum.gathered_error + ROUNDING)),
    }
}

/// The order in which features are listed.
pub(super) fn by_kind_and_height(a: &Feature, b: &Feature) -> Ordering {
    let heights = b.persistence.total_cmp(&a.persistence);
    a.kind.cmp(&b.kind).then(heights)
}

/// Places of the features of a kind that are present.
pub(super) fn present_places(features: &[Feature], kind: FeatureKind) -> Vec<Vec<f64>> {
    let present = features
        .iter()
        .filter(|feature| feature.kind == kind && feature.verdict == Verdict::Present);
    present.map(|feature| feature.position.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::{DetectOptions, Verdict};

    /// Extrema at 0, 1, 2 …, a peak first.
    fn profile(densities: &[f64]) -> Profile {
        let extrema = densities
            .iter()
            .enumerate()
            .map(|(index, &density)| Extremum {
                place: index as f64,
                is_peak: index % 2 == 0,
                density,
                log_density: density.ln(),
                gathered_error: 0.0,
            });
        Profile {
            extrema: extrema.collect(),
            ..Profile::default()
        }
    }

    fn found(densities: &[f64]) -> Vec<Feature> {
        let limits = Limits::new(&DetectOptions::default(), 1, 1, 100, (1.0, 0.0));
        features(&profile(densities), &limits)
    }

    #[test]
    fn a_hill_ends_where_it_meets_a_higher_one_and_vanishes_with_the_valley_beside_it() {
        // The outer hills are higher than the middle one: it ends at the higher valley, then they meet at the lower
        // one.
        let features = found(&[0.9, 0.2, 0.4, 0.3, 0.8]);
        let of = |place: f64| features.iter().find(|one| one.position == [place]).unwrap();
        let close = |value: f64, expected: f64| (value - expected).abs() < 1e-15;
        assert!(close(of(2.0).persistence, 0.1) && close(of(3.0).persistence, 0.1));
        assert!(close(of(4.0).persistence, 0.6) && close(of(1.0).persistence, 0.6));
        assert_eq!(of(0.0).persistence, 0.9);
        assert_eq!(of(2.0).partner, Some(vec![3.0]));
        assert_eq!(of(4.0).partner, Some(vec![3.0]));
        assert_eq!(of(0.0).partner, Some(vec![1.0]));
        assert!(features.iter().all(|one| one.verdict == Verdict::Present));
    }

    #[test]
    fn what_is_no_higher_than_rounding_is_absent_and_nothing_has_no_features() {
        let features = found(&[0.9, 0.3, 0.3 * (1.0 + 1e-13)]);
        let peaks = features.iter().filter(|one| one.kind == FeatureKind::Peak);
        let present = peaks.filter(|one| one.verdict == Verdict::Present);
        assert_eq!(present.count(), 1);
        assert!(found(&[]).is_empty());
        // A density that is zero is no peak of its own.
        assert_eq!(found(&[0.9, 0.0, 0.0])[0].verdict, Verdict::Absent);
    }
}
