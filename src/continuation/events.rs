//! What appears and what vanishes between two neighbouring points: features matched from one to the other by their places.
//!
//! Features of one kind are paired, the nearest first. What is left on one side was born, or has vanished, in between, and says which
//! indicator passes zero there: the slope between a peak and the saddle where it merges, or from a ring's inside to the ring.

use super::Point;
use crate::density::EstimatedDensity;
use crate::topology::{Feature, FeatureKind, IndicatorKind, Verdict, born_at_kink};

/// Kinds that make a signature.
pub(super) const COUNTED: [FeatureKind; 3] =
    [FeatureKind::Peak, FeatureKind::Crater, FeatureKind::Ring];

/// A feature that one of two neighbouring points has and the other has not.
#[derive(Debug, Clone)]
pub(super) struct Event {
    /// What it is.
    pub(super) feature: FeatureKind,
    /// Whether the point above has it.
    pub(super) above: bool,
    /// The indicator whose zero it is, and where to look for it; `None` where none is known.
    pub(super) indicator: Option<(IndicatorKind, Vec<f64>)>,
    /// Distance of the feature from the centre of symmetry, in ranges; infinite without one.
    pub(super) from_centre: f64,
}

/// All of them for one observable.
pub(super) fn events(a: &Point, b: &Point, observable: usize) -> Vec<Event> {
    let lengths: Vec<f64> = a.densities[observable]
        .density
        .axes
        .iter()
        .map(|axis| axis.to() - axis.from())
        .collect();
    let mut found = Vec::new();
    for kind in COUNTED {
        let (below, above) = unpaired(
            present(a, observable, kind),
            present(b, observable, kind),
            &lengths,
        );
        let centre = a.densities[observable].structure.centre.as_deref();
        let density = |above: bool| match above {
            true => &b.densities[observable],
            false => &a.densities[observable],
        };
        let event = |feature: &Feature, above: bool| Event {
            feature: kind,
            above,
            indicator: indicator(density(above), feature),
            from_centre: centre.map_or(f64::INFINITY, |centre| {
                distance(&feature.position, centre, &lengths)
            }),
        };
        found.extend(below.into_iter().map(|feature| event(feature, false)));
        found.extend(above.into_iter().map(|feature| event(feature, true)));
    }
    without_moats(found)
}

/// A ring comes and goes with the moat inside it: one event.
fn without_moats(mut events: Vec<Event>) -> Vec<Event> {
    for above in [false, true] {
        let rings = |one: &&Event| one.feature == FeatureKind::Ring && one.above == above;
        for _ in 0..events.iter().filter(rings).count() {
            let moat = |one: &Event| one.feature == FeatureKind::Crater && one.above == above;
            if let Some(moat) = events.iter().position(moat) {
                events.remove(moat);
            }
        }
    }
    events
}

fn present(point: &Point, observable: usize, kind: FeatureKind) -> Vec<&Feature> {
    let features = point.detections[observable].features.iter();
    features
        .filter(|one| one.kind == kind && one.verdict == Verdict::Present)
        .collect()
}

/// Distance of two places in units of the ranges.
fn distance(a: &[f64], b: &[f64], lengths: &[f64]) -> f64 {
    let terms = a.iter().zip(b).zip(lengths);
    terms
        .map(|((a, b), length)| ((a - b) / length).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// What is left of two lists when their nearest members have been paired.
fn unpaired<'a>(
    mut below: Vec<&'a Feature>,
    mut above: Vec<&'a Feature>,
    lengths: &[f64],
) -> (Vec<&'a Feature>, Vec<&'a Feature>) {
    while !below.is_empty() && !above.is_empty() {
        let pairs = (0..below.len()).flat_map(|i| (0..above.len()).map(move |j| (i, j)));
        let apart =
            |&(i, j): &(usize, usize)| distance(&below[i].position, &above[j].position, lengths);
        let Some((i, j)) = pairs.min_by(|a, b| apart(a).total_cmp(&apart(b))) else {
            break;
        };
        below.remove(i);
        above.remove(j);
    }
    (below, above)
}

/// The indicator that is zero where a feature is born.
fn indicator(density: &EstimatedDensity, feature: &Feature) -> Option<(IndicatorKind, Vec<f64>)> {
    let partner = feature.partner.as_ref()?;
    let between = || {
        let pairs = feature.position.iter().zip(partner);
        pairs.map(|(a, b)| 0.5 * (a + b)).collect()
    };
    Some(
        match (
            feature.kind,
            feature.position.as_slice(),
            partner.as_slice(),
        ) {
            (FeatureKind::Ring, ..) => (IndicatorKind::Ring, partner.clone()),
            (FeatureKind::Peak, [peak], [valley]) => {
                let rising = valley < peak;
                let at_kink = born_at_kink(density, feature, *valley);
                at_kink.unwrap_or_else(|| (IndicatorKind::Shoulder { rising }, between()))
            }
            (FeatureKind::Peak | FeatureKind::Crater, [_, _], _) => {
                (IndicatorKind::Fold, between())
            }
            _ => return None,
        },
    )
}
