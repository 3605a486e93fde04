//! Pairs of neighbouring points whose signatures differ: which feature makes the difference, and whether
//! narrowing the pair would still teach anything.

use super::events::COUNTED;
use super::{Goal, Point};
use crate::topology::{Detection, Feature, FeatureKind, Verdict};

/// Number of features of a kind that a detection counts.
pub(super) fn count(detection: &Detection, kind: FeatureKind) -> usize {
    match kind {
        FeatureKind::Peak => detection.signature.peaks,
        FeatureKind::Crater => detection.signature.craters,
        FeatureKind::Ring => detection.signature.rings,
        FeatureKind::Valley => 0,
    }
}

/// Whether a pair need not be narrowed further: it is as narrow as wanted, or, in every observable that
/// differs, the feature that makes the difference is unresolved on the side where it is not counted. There
/// bisection would only chase the confidence level; a quarter of the sweep's step is close enough to show
/// where the data stop telling.
pub(super) fn is_settled(a: &Point, b: &Point, step: f64, options: &Goal) -> bool {
    let width = (a.value - b.value).abs();
    if width <= options.tolerance {
        return true;
    }
    // Rounding must not ask for one more halving.
    width <= step / 4.0 * (1.0 + 1e-9) && is_undecided(a, b)
}

fn is_undecided(a: &Point, b: &Point) -> bool {
    let mut differing = a
        .detections
        .iter()
        .zip(&b.detections)
        .filter(|(a, b)| a.signature != b.signature);
    differing.all(|(a, b)| {
        COUNTED.iter().any(|&kind| {
            let (low, high) = if count(a, kind) < count(b, kind) {
                (a, b)
            } else {
                (b, a)
            };
            count(low, kind) != count(high, kind)
                && deciding_feature(low, kind, count(low, kind))
                    .is_some_and(|feature| feature.verdict == Verdict::Unresolved)
        })
    })
}

/// The feature whose presence makes the count exceed `counted`.
pub(super) fn deciding_feature(
    detection: &Detection,
    kind: FeatureKind,
    counted: usize,
) -> Option<&Feature> {
    detection.ranked(kind, counted)
}
