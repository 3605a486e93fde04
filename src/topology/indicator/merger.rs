//! The indicators of two peaks of a marginal that merge at the valley between them, away from a centre of symmetry, and
//! of a peak that appears in the middle of a valley.
//!
//! That is a pitchfork. It happens where the density depends on the energy alone, whose states of rest need be no
//! centre of symmetry. There p'/p = δ + a u - b u³ beside the place u = 0 at which (log p)''' vanishes, with δ = 0, and
//! a passes zero. The slope at the inflection ([`super::shoulder`]) goes like the power 3/2 of a: errors turn its sign,
//! or hide its zero.
//!
//! Whether δ is zero nobody knows. With another δ one peak meets the valley where a = 3 (b δ²/4)^{1/3}, and the other
//! one stays. What is read here is a less that, for δ between what errors of the density allow: a zero holds the
//! change, whichever of the two it is.

use std::cmp::Ordering;

use super::kind::Traits;
use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::topology::field::{Field, Jet};

/// Most steps of Newton's method.
const MOST_STEPS: usize = 12;
/// Farthest from where the search began, in cells.
const FARTHEST: f64 = 4.0;
/// A step that is a smaller share of a cell ends the search.
const SETTLED: f64 = 1e-6;
/// Half the distance over which fourth derivatives are taken, in cells.
const ASIDE: f64 = 0.5;

impl IndicatorKind {
    /// Curvature of the logarithm of a marginal where its third derivative vanishes, less that at which one of two
    /// peaks meets the valley between them: positive when that valley is there; with `is_peak`, when a peak is there
    /// between two valleys.
    pub(crate) const fn merger(is_peak: bool) -> Self {
        Self(&BOTH[is_peak as usize])
    }
}

static BOTH: [Traits; 2] = [
    AT_MERGER,
    Traits {
        code: "curvature of a peak between two valleys",
        read: |density, near| merger(density, near, true),
        ..AT_MERGER
    },
];

const AT_MERGER: Traits = Traits {
    name: "curvature where peaks merge",
    keeps_error: true,
    words: |step| match step.peaks() {
        Ordering::Less => Some("peak and valley vanish"),
        Ordering::Equal => None,
        Ordering::Greater => Some("peak and valley are born"),
    },
    ..Traits::new(
        "curvature of a valley between two peaks",
        |density, near| merger(density, near, false),
    )
};

/// The curvature at the place where third derivatives vanish, less that at which a peak meets the valley for the slope
/// there; all of the logarithm of the density. `None` for joint densities, sampled ones, and those whose extrema follow
/// from the equations.
fn merger(estimated: &EstimatedDensity, near: &[f64], is_peak: bool) -> Option<Indicator> {
    let is_read = near.len() == 1 && !estimated.is_noisy();
    let is_read = is_read && estimated.structure.profile.is_none();
    let field = Field::new(estimated).filter(|_| is_read)?;
    let sign = if is_peak { -1.0 } else { 1.0 };
    let (place, bend) = flattest(&field, near[0], sign)?;
    let (fine, rough) = (field.stencil(&[place], 0)?, field.stencil(&[place], 1)?);
    let values = &estimated.density.values;
    let slope = |jet: Jet| jet.first[0] / jet.value;
    let own = slope(fine.jet(values));
    let by_rough = (slope(rough.jet(values)) - own).abs();
    let second = estimated.variants.second_scheme();
    let by_scheme = second.map_or(0.0, |values| (slope(fine.jet(values)) - own).abs());
    let tilts = [-1.0, 1.0].map(|side| (own.abs() + side * (by_rough + by_scheme)).max(0.0));
    let [earliest, latest] = tilts.map(|tilt| 3.0 * (bend * tilt * tilt / 4.0).cbrt());
    let curvature = |jet: Jet| sign * (jet.second[0] / jet.value - slope(jet).powi(2));
    let mut found = Indicator::derive(
        estimated,
        IndicatorKind::merger(is_peak),
        vec![place],
        |values| curvature(fine.jet(values)),
        |values| curvature(rough.jet(values)),
    )?;
    found.value -= 0.5 * (earliest + latest);
    found.systematic_error +=
        0.5 * (latest - earliest) + latest * beyond_cubic(&field, place, (-sign * bend, latest))?;
    Some(found)
}

/// How far third derivatives are from 6 c u, those of the cubic c u³, as a share of them, where a peak meets the valley
/// at the curvature `latest`.
fn beyond_cubic(field: &Field<'_>, place: f64, (c, latest): (f64, f64)) -> Option<f64> {
    let reach = (latest / (3.0 * c.abs())).sqrt();
    if reach == 0.0 {
        return Some(0.0);
    }
    let thirds = [-reach, reach].map(|u| Some(third(field.jet(&[place + u * field.unit(0)])?)));
    Some(((thirds[1]? - thirds[0]?) / (12.0 * reach * c) - 1.0).abs())
}

/// The third derivative of the logarithm of a density.
fn third(jet: Jet) -> f64 {
    let [first, second, third] =
        [jet.first[0], jet.second[0], jet.third[0]].map(|one| one / jet.value);
    third - 3.0 * first * second + 2.0 * first.powi(3)
}

/// Where the third derivative vanishes, by Newton's method, with b there; `None` where b is not positive.
fn flattest(field: &Field<'_>, near: f64, sign: f64) -> Option<(f64, f64)> {
    let width = field.cell_width(0, near);
    let cell = width * field.unit(0);
    let mut place = near;
    for _ in 0..MOST_STEPS {
        let beside = [-ASIDE, ASIDE].map(|step| Some(third(field.jet(&[place + step * cell])?)));
        let fourth = (beside[1]? - beside[0]?) / (2.0 * ASIDE * width);
        let step = -third(field.jet(&[place])?) / fourth * field.unit(0);
        place += step;
        if !step.is_finite() || (place - near).abs() > FARTHEST * cell {
            return None;
        }
        if step.abs() < SETTLED * cell {
            let bend = -sign * fourth / 6.0;
            return (bend > 0.0).then_some((place, bend));
        }
    }
    None
}
