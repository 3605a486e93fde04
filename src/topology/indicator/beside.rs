//! The indicator of a peak and a valley that are born together at a kink which is no centre of symmetry: one of them is
//! the kink, the other comes out of it on one side.
//!
//! There the slope on that side, away from the kink, changes its sign while that on the other side does not. It goes
//! through zero linearly, and nothing else does: there is no inflection.

use std::cmp::Ordering;

use super::kind::Behaviour;
use super::words::Step;
use super::{Indicator, IndicatorKind, exact, window};
use crate::density::EstimatedDensity;
use crate::topology::Feature;
use crate::topology::field::{Field, Jet};
use crate::topology::reconstruction::Line;

/// Distance from the kink at which its sides are told apart, as a share of the range.
const ASIDE: f64 = 1e-9;

/// The slope on one side of a kink.
pub(super) struct BesideKink {
    pub(super) above: bool,
    pub(super) is_valley: bool,
}

impl Behaviour for BesideKink {
    fn code(&self) -> &'static str {
        match (self.above, self.is_valley) {
            (false, false) => "slope below the kink of a peak",
            (false, true) => "slope below the kink of a valley",
            (true, false) => "slope above the kink of a peak",
            (true, true) => "slope above the kink of a valley",
        }
    }
    fn name(&self) -> &'static str {
        "slope beside the kink"
    }
    fn read(&self, estimated: &EstimatedDensity, near: &[f64]) -> Option<Indicator> {
        beside_kink(estimated, *near.first()?, self.above, self.is_valley)
    }
    fn words(&self, step: &Step) -> Option<&'static str> {
        Some(if step.peaks() == Ordering::Greater {
            "peak and valley are born at a kink"
        } else {
            "peak and valley vanish at a kink"
        })
    }
    fn companions(&self, _: usize) -> Vec<IndicatorKind> {
        vec![
            IndicatorKind::beside_kink(!self.above, self.is_valley),
            IndicatorKind::curvature_beside_kink(self.above),
        ]
    }
    fn side_of_kink(&self) -> Option<bool> {
        Some(self.above)
    }
    fn away_from_kink(&self) -> Option<IndicatorKind> {
        // Above a valley, and below a peak, the density rises.
        Some(IndicatorKind::shoulder(self.above == self.is_valley))
    }
    fn mirror(&self) -> Option<IndicatorKind> {
        Some(IndicatorKind::beside_kink(!self.above, self.is_valley))
    }
}

/// The curvature on one side of a kink, a test function.
pub(super) struct CurvatureBesideKink {
    pub(super) above: bool,
}

impl Behaviour for CurvatureBesideKink {
    fn code(&self) -> &'static str {
        if self.above {
            "curvature above the kink"
        } else {
            "curvature below the kink"
        }
    }
    fn read(&self, estimated: &EstimatedDensity, near: &[f64]) -> Option<Indicator> {
        curvature_beside(estimated, *near.first()?, self.above)
    }
    fn is_bifurcation(&self) -> bool {
        false
    }
    fn side_of_kink(&self) -> Option<bool> {
        Some(self.above)
    }
}

/// The slope beside the kink nearest to a place; `None` for joint densities, sampled ones, and kinks that a scheme has
/// blurred because they lie on no face.
fn beside_kink(
    estimated: &EstimatedDensity,
    near: f64,
    above: bool,
    is_valley: bool,
) -> Option<Indicator> {
    if let Some(profile) = &estimated.structure.profile {
        return exact::beside_kink(profile, near, above, is_valley);
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
    let of = |lines: &[Line], values: &[f64]| {
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
