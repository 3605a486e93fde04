//! The peaks and the valley about a centre of symmetry that the indicator proves, when they are too near each other for
//! persistence: features of a marginal then say what its signature says.
//!
//! About the centre p/p(c) = 1 + g u²/2 + k u⁴/24 with g = p''/p and k = p''''/p: for g > 0 > k two peaks stand at
//! u² = -6 g/k, by p g u²/4 above the valley between.

use super::window::around;
use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::topology::reconstruction::interpolating;
use crate::topology::{Feature, FeatureKind, Verdict};

/// Cells on either side of the centre within which peaks belong to it, and the expansion holds.
const REACH: usize = 4;

/// Puts the features about the centre of a marginal right, if the sign of its indicator is beyond doubt.
pub(crate) fn put_right(
    estimated: &EstimatedDensity,
    indicators: &[Indicator],
    doubt: f64,
    features: &mut Vec<Feature>,
) {
    let ([axis], [indicator]) = (estimated.density.axes.as_slice(), indicators) else {
        return;
    };
    let (Some(split), &[centre]) = (indicator.sign(doubt), indicator.place.as_slice()) else {
        return;
    };
    let Some(cells) = around(axis, centre, REACH) else {
        return;
    };
    let reach = axis.edges()[cells.end] - centre;
    let near = |feature: &Feature| (feature.position[0] - centre).abs() <= reach;
    let present = |feature: &&Feature| feature.verdict == Verdict::Present;
    let peaks = |features: &[Feature]| {
        let peaks = features.iter().filter(|one| one.kind == FeatureKind::Peak);
        peaks.filter(present).count()
    };
    let seen: Vec<&Feature> = features
        .iter()
        .filter(|one| near(one))
        .filter(present)
        .collect();
    let complete = peaks(features).is_multiple_of(2) == split;
    if complete
        && (seen.is_empty()
            || (split && seen.len() > 1 && expansion(estimated, indicator, reach).is_none()))
    {
        return;
    }
    let Some(highest) = (features.iter().filter(present))
        .find(|one| one.kind == FeatureKind::Peak)
        .cloned()
    else {
        return;
    };
    let nearest = (features.iter().filter(present))
        .filter(|one| one.kind == FeatureKind::Peak)
        .map(|one| (one.position[0] - centre).abs())
        .fold(f64::INFINITY, f64::min);
    let offset = expansion(estimated, indicator, reach).unwrap_or(nearest);
    if offset > reach && complete {
        return;
    }
    let (density, rise) = at_centre(estimated, indicator, centre, offset);
    let significance = indicator.value.abs() / indicator.systematic_error.max(f64::MIN_POSITIVE);
    let feature = |kind, place: f64, density: f64, persistence: f64| Feature {
        kind,
        position: vec![place],
        density,
        persistence,
        standard_error: 0.0,
        significance: significance.min(1e9),
        verdict: Verdict::Present,
        partner: (split && kind == FeatureKind::Peak).then(|| vec![centre]),
    };
    let limit = offset.max(reach);
    features.retain(|one| {
        (one.position[0] - centre).abs() > limit || !matches!(one.verdict, Verdict::Present)
    });
    let top = if near(&highest) {
        highest.persistence
    } else {
        rise
    };
    let mut made = Vec::new();
    if split {
        made.push(feature(
            FeatureKind::Peak,
            centre - offset,
            density + rise,
            top,
        ));
        made.push(feature(
            FeatureKind::Peak,
            centre + offset,
            density + rise,
            rise,
        ));
        made.push(feature(FeatureKind::Valley, centre, density, rise));
    } else {
        made.push(feature(FeatureKind::Peak, centre, density, top));
    }
    made.append(features);
    made.sort_by(|a, b| {
        a.kind
            .cmp(&b.kind)
            .then(b.persistence.total_cmp(&a.persistence))
    });
    *features = made;
}

/// Distance of the two peaks from the centre by the expansion, where it holds.
fn expansion(estimated: &EstimatedDensity, indicator: &Indicator, reach: f64) -> Option<f64> {
    if indicator.kind != IndicatorKind::Curvature || indicator.sampling_error > 0.0 {
        return None;
    }
    let axis = &estimated.density.axes[0];
    let centre = indicator.place[0];
    let lines = interpolating(axis, around(axis, centre, REACH)?, centre, 5)?;
    let values = &estimated.density.values;
    let fourth = lines[4].apply(values) / lines[0].apply(values);
    let square = -6.0 * indicator.value / fourth;
    (square > 0.0 && square.sqrt() <= reach).then(|| square.sqrt())
}

/// Density at the centre, and the height of the peaks above it.
fn at_centre(
    estimated: &EstimatedDensity,
    indicator: &Indicator,
    centre: f64,
    offset: f64,
) -> (f64, f64) {
    let axis = &estimated.density.axes[0];
    let cell = axis.find(centre).unwrap_or(0);
    let density =
        0.5 * (estimated.density.values[cell] + estimated.density.values[cell.saturating_sub(1)]);
    let rise = match indicator.kind {
        IndicatorKind::Curvature => 0.25 * density * indicator.value * offset * offset,
        // From the kink up: half the slope's rise to the top.
        _ => 0.5 * density * indicator.value * offset,
    };
    (density, rise.max(0.0))
}
