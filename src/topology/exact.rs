//! Features of a density over one axis whose extrema are known from its equations: however narrow they are, none is lost between cells.

use super::significance::Limits;
use super::{Feature, FeatureKind};
use crate::density::{Extremum, Profile};

/// Relative error of a density computed from its logarithm.
const ROUNDING: f64 = 1e-12;

/// Peaks and the valleys that belong to them, judged. Where two hills meet at a valley, the lower one ends there: its peak is as high as it
/// stands above the valley.
pub(super) fn features(profile: &Profile, limits: &Limits) -> Vec<Feature> {
    let mut hills = hills(&profile.extrema);
    let mut features = Vec::new();
    while let Some((place, valley)) = highest_valley(&hills) {
        let (left, right) = (&hills[place].peak, &hills[place + 1].peak);
        let lower = match left.density < right.density {
            true => *left,
            false => *right,
        };
        features.extend(pair(&lower, &valley, limits));
        let kept = match left.density < right.density {
            true => hills[place + 1].peak,
            false => hills[place].peak,
        };
        let above = hills.remove(place + 1);
        hills[place] = Hill {
            peak: kept,
            valley_above: above.valley_above,
        };
    }
    features.extend(hills.first().map(|hill| highest(&hill.peak)));
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
    valleys.max_by(|a, b| a.1.density.total_cmp(&b.1.density))
}

/// A peak with the valley where it ends.
fn pair(peak: &Extremum, valley: &Extremum, limits: &Limits) -> [Feature; 2] {
    let height = peak.density - valley.density;
    let gathered = (peak.gathered_error - valley.gathered_error).abs();
    let judgement = limits.judge_exact(height, peak.density * (gathered + ROUNDING));
    let feature = |of: &Extremum, kind: FeatureKind, partner: Option<Vec<f64>>| Feature {
        kind,
        position: vec![of.place],
        density: of.density,
        persistence: height,
        standard_error: 0.0,
        significance: judgement.significance,
        verdict: judgement.verdict,
        partner,
    };
    [
        feature(peak, FeatureKind::Peak, Some(vec![valley.place])),
        feature(valley, FeatureKind::Valley, None),
    ]
}

/// The highest peak, which ends nowhere.
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
    }
}
