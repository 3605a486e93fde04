//! The indicator of places where both principal curvatures of a joint density pass zero together: a peak that becomes
//! the bottom within a ring, and the saddle at which two rings merge.
//!
//! Where a density depends on the energy alone it is level at every state of rest when its slope over the energy is
//! zero at that energy. The signs of both curvatures turn there at once, so that neither the lower nor the upper one
//! shows it at a saddle; the curvature along one axis does. It is positive at the bottom within a ring and, from ring
//! to ring, at the saddle between two.
//!
//! Where the slope over the energy is nearly zero the density is all but flat about the state of rest, and its extremum
//! is nowhere in particular. With log p = c (H - H₀)² third derivatives vanish at the state of rest, and fourth ones do
//! not: there it is.

use super::kind::{Read, Traits};
use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::topology::field::{Field, Jet};

/// Steps of Newton's method for the place.
const STEPS: usize = 6;
/// Longest way from where the search began, in cells.
const FARTHEST: f64 = 2.0;
/// Half the distance over which fourth derivatives are taken, in cells.
const ASIDE: f64 = 0.5;

impl IndicatorKind {
    /// Curvature of a joint density along one axis at a place that turns from a peak to the bottom within a ring, or at
    /// the saddle between two rings: positive when the ring is there. Both principal curvatures pass zero there
    /// together.
    pub(crate) const fn level(along_second: bool) -> Self {
        Self(&BOTH[along_second as usize])
    }
}

/// The curvature along the first axis at such a place, and along the second.
static BOTH: [Traits; 2] = [
    along(
        "curvature along the first axis at a state of rest",
        |density, near| level(density, near, false),
    ),
    along(
        "curvature along the second axis at a state of rest",
        |density, near| level(density, near, true),
    ),
];

/// One of them, by its code and how it is read.
const fn along(code: &'static str, read: Read) -> Traits {
    Traits {
        name: "curvature at a state of rest",
        ..Traits::new(code, read)
    }
}

/// The curvature along an axis at the state of rest near a place; `None` for marginals and sampled densities.
fn level(estimated: &EstimatedDensity, near: &[f64], along_second: bool) -> Option<Indicator> {
    let field = Field::new(estimated).filter(|_| near.len() == 2 && !estimated.is_noisy())?;
    let place = at_rest(&field, near)?;
    let (fine, rough) = (field.stencil(&place, 0)?, field.stencil(&place, 1)?);
    let of = |jet: Jet| jet.second[if along_second { 2 } else { 0 }] / jet.value;
    Indicator::derive(
        estimated,
        IndicatorKind::level(along_second),
        place,
        |values| of(fine.jet(values)),
        |values| of(rough.jet(values)),
    )
}

/// Where the third derivatives along both axes vanish, or where the search began when there is no such place near.
fn at_rest(field: &Field<'_>, near: &[f64]) -> Option<Vec<f64>> {
    let mut place = near.to_vec();
    for _ in 0..STEPS {
        for k in 0..2 {
            let third = |at: &[f64]| field.jet(at).map(|jet| jet.third[3 * k]);
            let width = field.cell_width(k, near[k]);
            let beside = |sign: f64| {
                let mut at = place.clone();
                at[k] += sign * ASIDE * width * field.unit(k);
                third(&at)
            };
            let fourth = (beside(1.0)? - beside(-1.0)?) / (2.0 * ASIDE * width);
            let step = -third(&place)? / fourth * field.unit(k);
            let next = place[k] + step;
            if (next - near[k]).abs() > FARTHEST * width * field.unit(k) || !next.is_finite() {
                return Some(near.to_vec());
            }
            place[k] = next;
        }
    }
    Some(place)
}
