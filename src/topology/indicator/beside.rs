//! The indicator of a peak and a valley that are born together at a kink which is no centre of symmetry: one of them is
//! the kink, the other comes out of it on one side.
//!
//! There the slope on that side, away from the kink, changes its sign while that on the other side does not. It goes
//! through zero linearly, and nothing else does: there is no inflection.

use std::cmp::Ordering;

use super::kind::Step;
use super::kind::Traits;
use super::{Indicator, IndicatorKind, exact, window};
use crate::density::EstimatedDensity;
use crate::topology::Feature;
use crate::topology::field::{Field, Jet};
use crate::topology::reconstruction::Weights;

/// Distance from the kink at which its sides are told apart, as a share of the range.
const ASIDE: f64 = 1e-9;

impl IndicatorKind {
    /// Slope of a marginal on one side of a kink, away from it, `above` where that is the side of larger coordinates;
    /// positive when the kink is an extremum, of the two the valley if `is_valley`, and another one lies on that side.
    pub(crate) const fn beside_kink(above: bool, is_valley: bool) -> Self {
        Self(&SLOPES[above as usize][is_valley as usize])
    }

    /// A test function: curvature of the logarithm of a marginal on one side of a kink.
    pub(super) const fn curvature_beside_kink(above: bool) -> Self {
        Self(&CURVATURES[above as usize])
    }
}

/// Defines what the slope on one side of a kink is, that of a peak or that of a valley.
macro_rules! slope {
    ($code:literal, $above:literal, $is_valley:literal) => {
        Traits {
            name: "slope beside the kink",
            words: birth_or_loss,
            companions: |_| {
                vec![
                    IndicatorKind::beside_kink(!$above, $is_valley),
                    IndicatorKind::curvature_beside_kink($above),
                ]
            },
            side_of_kink: Some($above),
            // Above a valley, and below a peak, the density rises.
            away_from_kink: || Some(IndicatorKind::shoulder($above == $is_valley)),
            mirror: || Some(IndicatorKind::beside_kink(!$above, $is_valley)),
            ..Traits::new($code, |density, near| {
                beside_kink(density, *near.first()?, $above, $is_valley)
            })
        }
    };
}

/// The slopes below a kink, of a peak and of a valley, and those above it.
static SLOPES: [[Traits; 2]; 2] = [
    [
        slope!("slope below the kink of a peak", false, false),
        slope!("slope below the kink of a valley", false, true),
    ],
    [
        slope!("slope above the kink of a peak", true, false),
        slope!("slope above the kink of a valley", true, true),
    ],
];

fn birth_or_loss(step: &Step) -> Option<&'static str> {
    Some(if step.peaks() == Ordering::Greater {
        "peak and valley are born at a kink"
    } else {
        "peak and valley vanish at a kink"
    })
}

/// The curvatures below a kink and above it, test functions.
static CURVATURES: [Traits; 2] = [
    Traits {
        is_bifurcation: false,
        side_of_kink: Some(false),
        ..Traits::new("curvature below the kink", |density, near| {
            curvature_beside(density, *near.first()?, false)
        })
    },
    Traits {
        is_bifurcation: false,
        side_of_kink: Some(true),
        ..Traits::new("curvature above the kink", |density, near| {
            curvature_beside(density, *near.first()?, true)
        })
    },
];

/// The slope beside the kink nearest to a place; `None` for joint densities, sampled ones, and kinks that a scheme has
/// blurred because they lie on no face.
fn beside_kink(
    estimated: &EstimatedDensity,
    near: f64,
    above: bool,
    is_valley: bool,
) -> Option<Indicator> {
    if let Some(profile) = &estimated.structure.profile {
        return exact::beside_kink(
            profile,
            near,
            (above, is_valley),
            IndicatorKind::beside_kink(above, is_valley),
        );
    }
    let at = nearest(estimated, near)?;
    let field = Field::new(estimated).filter(|_| !estimated.is_noisy())?;
    let side = if above { 1.0 } else { -1.0 };
    let place = [at + side * ASIDE * field.unit(0)];
    let (fine, rough) = (field.stencil(&place, 0)?, field.stencil(&place, 1)?);
    let sign = if is_valley { side } else { -side };
    let of = |jet: Jet| sign * jet.first[0] / (field.unit(0) * jet.value);
    Indicator::derive(
        estimated,
        IndicatorKind::beside_kink(above, is_valley),
        vec![at],
        |values| of(fine.jet(values)),
        |values| of(rough.jet(values)),
    )
}

/// (log p)'' on one side of the kink nearest to a place; `None` where [`beside_kink`] is.
fn curvature_beside(estimated: &EstimatedDensity, near: f64, above: bool) -> Option<Indicator> {
    let at = nearest(estimated, near).filter(|_| !estimated.is_noisy())?;
    let lines = window::one_sided(&estimated.density.axes[0], at, above)?;
    let of = |lines: &[Weights], values: &[f64]| {
        let [p, slope, bend] = [0, 1, 2].map(|order: usize| lines[order].apply(values));
        bend / p - (slope / p).powi(2)
    };
    let [fine, rough] = lines.both();
    Indicator::derive(
        estimated,
        IndicatorKind::curvature_beside_kink(above),
        vec![at],
        |values| of(fine, values),
        |values| of(rough, values),
    )
}

/// The kink of a marginal nearest to a place, if what is beside it can be read.
fn nearest(estimated: &EstimatedDensity, near: f64) -> Option<f64> {
    if estimated.density.axes.len() != 1 {
        return None;
    }
    let distance = |at: f64| (at - near).abs();
    let kinks = estimated.structure.kinks.iter();
    let kinks = kinks.filter(|kink| !kink.is_bend()).map(|kink| kink.at);
    let at = kinks.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
    is_seen(estimated, at).then_some(at)
}

/// Whether what is beside a kink can be read off the cells: it lies on a face, or no scheme has blurred it.
fn is_seen(estimated: &EstimatedDensity, kink: f64) -> bool {
    let axes = &estimated.density.axes;
    estimated.is_by_quadrature() || axes.iter().all(|axis| axis.has_face_at(kink))
}

/// The indicator of a peak that was born, or vanishes, with its valley at a kink: one of the two lies on it.
pub(crate) fn born_at_kink(
    estimated: &EstimatedDensity,
    peak: &Feature,
    valley: f64,
) -> Option<(IndicatorKind, Vec<f64>)> {
    let ([axis], &[peak]) = (estimated.density.axes.as_slice(), peak.position.as_slice()) else {
        return None;
    };
    if estimated.is_noisy() {
        return None;
    }
    let is_kink = |at: f64| {
        let mut kinks = estimated.structure.kinks.iter();
        kinks.any(|kink| {
            !kink.is_bend() && axis.is_same_place(kink.at, at) && is_seen(estimated, kink.at)
        })
    };
    let kind = IndicatorKind::beside_kink;
    match (is_kink(valley), is_kink(peak)) {
        (true, false) => Some((kind(peak > valley, true), vec![valley])),
        (false, true) => Some((kind(valley > peak, false), vec![peak])),
        _ => None,
    }
}
