//! The indicator of a ring that is born together with the moat inside it.
//!
//! Along a ray from a point inside, the density falls to the moat and rises to the ring. Before both are there it has a
//! shoulder; the largest outward slope beyond the first inflection, which is positive when they are there, passes zero
//! linearly. A ring is of one height, and born everywhere at once: the mean over several rays is the indicator, and
//! what they differ by a part of its error.

use super::kind::Traits;
use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::numerics::ends_of;
use crate::topology::field::{Field, Jet, Stencil};

/// Rays from the point inside.
const RAYS: usize = 12;
/// Points on a ray at which the slope is looked at.
const POINTS: usize = 100;
/// Density, as a share of the largest on the ray, below which a ray ends.
const FAINT: f64 = 1e-6;
/// Share of the density by which the second scheme may differ where a ray goes on: beyond, slopes are those of what the
/// cells do not resolve.
const UNSURE: f64 = 0.1;
/// Most steps of Newton's method.
const MOST_STEPS: usize = 8;

impl IndicatorKind {
    /// Outward slope of a joint density between a moat and the ring around it, positive when both are there.
    pub const RING: Self = Self(&RING);
}

const RING: Traits = Traits::new("slope to the ring", ring_slope);

/// Where the outward slope on a ray is largest.
struct Shoulder {
    direction: [f64; 2],
    place: Vec<f64>,
    fine: Stencil,
    rough: Stencil,
}

/// The outward slope over the density at the shoulder around a point; `None` for marginals, for sampled densities, and
/// where some ray has no shoulder.
fn ring_slope(estimated: &EstimatedDensity, inside: &[f64]) -> Option<Indicator> {
    let field = Field::new(estimated).filter(|_| inside.len() == 2 && !estimated.is_noisy())?;
    let shoulders: Option<Vec<Shoulder>> =
        (0..RAYS).map(|ray| shoulder(&field, inside, ray)).collect();
    let shoulders = shoulders?;
    let slope = |jet: Jet, direction: [f64; 2]| jet.slope(direction) / jet.value;
    let values = &estimated.density.values;
    let each = shoulders
        .iter()
        .map(|one| slope(one.fine.jet(values), one.direction));
    let (low, high) = ends_of(each);
    let mean = |of: &dyn Fn(&Shoulder) -> f64| shoulders.iter().map(of).sum::<f64>() / RAYS as f64;
    let mut indicator = Indicator::derive(
        estimated,
        IndicatorKind::RING,
        inside.to_vec(),
        |values| mean(&|one| slope(one.fine.jet(values), one.direction)),
        |values| mean(&|one| slope(one.rough.jet(values), one.direction)),
    )?;
    indicator.systematic_error += (high - low) / (RAYS as f64).sqrt();
    // The sum is over cells near the rays, not near the point inside.
    indicator.sensitivity = sensitivity(&field, &shoulders, values);
    Some(indicator)
}

/// The same as of other indicators: relative errors of one, independent in the cells of the stencils.
fn sensitivity(field: &Field<'_>, shoulders: &[Shoulder], values: &[f64]) -> f64 {
    let squares = shoulders.iter().map(|one| {
        let jet = one.fine.jet(values);
        let width = (0..2)
            .map(|k| field.cell_width(k, one.place[k]))
            .fold(f64::INFINITY, f64::min);
        // Weights of a first derivative are of the order of one over a cell.
        (jet.value / (width * jet.value)).powi(2)
    });
    squares.sum::<f64>().sqrt() / RAYS as f64
}

fn shoulder(field: &Field<'_>, inside: &[f64], ray: usize) -> Option<Shoulder> {
    let angle = std::f64::consts::TAU * (ray as f64 + 0.5) / RAYS as f64;
    let direction = [angle.cos(), angle.sin()];
    let at = |s: f64| -> Vec<f64> {
        (0..2)
            .map(|k| inside[k] + s * direction[k] * field.unit(k))
            .collect()
    };
    let length = length(field, inside, direction);
    let is_sure = |place: &[f64]| {
        let cell = field.cell_at(place);
        let both = field.second_scheme().zip(cell);
        both.is_none_or(|(second, cell)| {
            let value = field.values()[cell];
            (second[cell] - value).abs() <= UNSURE * value
        })
    };
    let slopes: Vec<(f64, f64, f64)> = (1..POINTS)
        .filter_map(|point| {
            let s = length * point as f64 / POINTS as f64;
            let jet = field.jet(&at(s))?;
            Some((s, jet.value, jet.slope(direction)))
        })
        .take_while(|one| is_sure(&at(one.0)))
        .collect();
    let highest = slopes.iter().map(|one| one.1).fold(0.0, f64::max);
    let visible = slopes
        .iter()
        .take_while(|one| one.1 > FAINT * highest)
        .count();
    let slopes = &slopes[..visible];
    let relative = |index: usize| slopes[index].2 / slopes[index].1;
    let peak = (1..visible.saturating_sub(1))
        .filter(|&i| slopes[i].2 >= slopes[i - 1].2 && slopes[i].2 > slopes[i + 1].2)
        .max_by(|&a, &b| relative(a).total_cmp(&relative(b)))?;
    let (mut s, spacing) = (slopes[peak].0, length / POINTS as f64);
    let (low, high) = (s - spacing, s + spacing);
    for _ in 0..MOST_STEPS {
        let jet = field.jet(&at(s))?;
        let bend = jet.bend(direction, direction);
        let curvature = jet.curvature(direction);
        s = (s - curvature / bend).clamp(low, high);
    }
    let place = at(s);
    Some(Shoulder {
        direction,
        fine: field.stencil(&place, 0)?,
        rough: field.stencil(&place, 1)?,
        place,
    })
}

/// Length of a ray up to the end of a range.
fn length(field: &Field<'_>, inside: &[f64], direction: [f64; 2]) -> f64 {
    let axes = field.axes().iter().enumerate();
    axes.map(|(k, axis)| {
        let end = if direction[k] > 0.0 {
            axis.to()
        } else {
            axis.from()
        };
        (end - inside[k]) / (direction[k] * field.unit(k))
    })
    .fold(f64::INFINITY, f64::min)
}
