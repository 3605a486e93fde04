//! The indicator of two critical points of a joint density that are born together away from a centre of symmetry: a peak and a saddle, or
//! a saddle and a crater.
//!
//! Between the two a curve leads along which the density is level across: the crest of a ridge, or the floor of a trench. Along it the
//! slope has an extremum, where the curvature along the curve is zero. That point is there before the birth too, as a shoulder; the slope there,
//! signed so that it is positive when both critical points exist, passes zero linearly.

use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::topology::field::{Curvature, Field, Jet};

/// Most steps of Newton's method.
const MOST_STEPS: usize = 20;
/// Longest step, in cells.
const LONGEST: f64 = 2.0;
/// Farthest from where the search began, in cells.
const FARTHEST: f64 = 25.0;
/// A step that is a smaller share of a cell ends the search.
const SETTLED: f64 = 1e-7;

/// The shoulder nearest to a place; `None` for marginals, for sampled densities, and where there is none.
pub(crate) fn fold(estimated: &EstimatedDensity, near: &[f64]) -> Option<Indicator> {
    let field = Field::new(estimated).filter(|_| near.len() == 2 && !estimated.is_noisy())?;
    let place = settle(&field, near)?;
    let fine = field.stencil(&place, 0)?;
    let rough = field.stencil(&place, 1)?;
    let (along, _) = directions(&fine.jet(&estimated.density.values));
    let direction = oriented(&fine.jet(&estimated.density.values), along);
    let slope = |jet: Jet| jet.slope(direction) / jet.value;
    Indicator::derive(
        estimated,
        IndicatorKind::Fold,
        place,
        |values| slope(fine.jet(values)),
        |values| slope(rough.jet(values)),
    )
}

/// The direction along the curve and the one across: of the smaller and of the larger curvature.
fn directions(jet: &Jet) -> (Curvature, Curvature) {
    let [lower, upper] = jet.principal();
    if lower.value.abs() < upper.value.abs() {
        (lower, upper)
    } else {
        (upper, lower)
    }
}

/// The direction along the curve in which the curvature falls: from the saddle to the peak, from the crater to the saddle.
fn oriented(jet: &Jet, along: Curvature) -> [f64; 2] {
    let [x, y] = along.direction;
    if jet.bend(along.direction, along.direction) > 0.0 {
        [-x, -y]
    } else {
        [x, y]
    }
}

/// The point where the slope across and the curvature along vanish.
fn settle(field: &Field<'_>, near: &[f64]) -> Option<Vec<f64>> {
    let mut place = near.to_vec();
    let cell = [0, 1].map(|k| field.cell_width(k, near[k]));
    for _ in 0..MOST_STEPS {
        let jet = field.jet(&place)?;
        let (along, across) = directions(&jet);
        let sideways = -jet.slope(across.direction) / across.value;
        let bend = jet.bend(along.direction, along.direction);
        let twist = jet.bend(along.direction, across.direction);
        let onward = -(along.value + twist * sideways) / bend;
        let mut longest: f64 = 0.0;
        let step = [0, 1].map(|k| onward * along.direction[k] + sideways * across.direction[k]);
        if step.iter().any(|step| !step.is_finite()) {
            return None;
        }
        let size = (step[0] / cell[0]).hypot(step[1] / cell[1]);
        let share = (LONGEST / size).min(1.0);
        for k in 0..2 {
            let unit = field.unit(k);
            let (low, high) = field.side(k, near[k], FARTHEST * cell[k] * unit);
            let next = place[k] + share * step[k] * unit;
            if next <= low || next >= high {
                return None;
            }
            longest = longest.max((next - place[k]).abs() / (cell[k] * unit));
            place[k] = next;
        }
        if longest < SETTLED {
            return Some(place);
        }
    }
    None
}
