//! The indicator of two critical points of a joint density that are born together away from a centre of symmetry: a
//! peak and a saddle, or a saddle and a crater.
//!
//! Between the two a curve leads along which the density is level across: the crest of a ridge, or the floor of a
//! trench. Along it the slope has an extremum, where the curvature along the curve is zero. That point is there before
//! the birth too, as a shoulder; the slope there, signed so that it is positive when both critical points exist, passes
//! zero linearly.
//!
//! Where a force bends, at a plane, the curvature along the curve jumps there instead of passing zero, and the slope
//! has its extremum on the plane.

use std::cmp::Ordering;

use super::kind::Traits;
use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::topology::field::{BESIDE_BEND, Curvature, Field, Jet, Stencil};

/// Most steps of Newton's method.
const MOST_STEPS: usize = 20;
/// Longest step, in cells.
const LONGEST: f64 = 2.0;
/// Farthest from where the search began, in cells.
const FARTHEST: f64 = 25.0;
/// A step that is a smaller share of a cell ends the search.
const SETTLED: f64 = 1e-7;

impl IndicatorKind {
    /// Slope along a ridge or trench of a joint density where it is nearest to level, positive when a peak and a saddle
    /// (a saddle and a crater) are there.
    pub const FOLD: Self = Self(&FOLD);
}

const FOLD: Traits = Traits {
    words: |step| {
        let words = if step.peaks() == Ordering::Greater {
            "peak and saddle are born"
        } else {
            "peak and saddle vanish"
        };
        (step.craters() == Ordering::Equal).then_some(words)
    },
    ..Traits::new("slope at the shoulder", fold)
};

/// The shoulder nearest to a place; `None` for marginals, for sampled densities, and where there is none.
fn fold(estimated: &EstimatedDensity, near: &[f64]) -> Option<Indicator> {
    let field = Field::new(estimated).filter(|_| near.len() == 2 && !estimated.is_noisy())?;
    let smooth = settle(&field, near);
    let away = |place: &[f64]| {
        let cells = (0..2)
            .map(|k| (place[k] - near[k]).abs() / (field.cell_width(k, near[k]) * field.unit(k)));
        cells.fold(0.0, f64::max)
    };
    let farthest = smooth.as_ref().map_or(FARTHEST, |place| away(place));
    // Curvatures within few cells of a bend are not known well enough to tell an extremum there from that at the bend.
    let is_beside = |one: &AtBend| {
        let width = field.cell_width(one.across, near[one.across]) * field.unit(one.across);
        smooth.as_ref().is_some_and(|place| {
            (place[one.across] - one.place[one.across]).abs() <= BLURRED * width
        })
    };
    let at_bend = at_bend(estimated, &field, near);
    if let Some(found) = at_bend.filter(|one| away(&one.place) < farthest || is_beside(one)) {
        return found.indicator(estimated, &field);
    }
    let place = smooth?;
    let fine = field.stencil(&place, 0)?;
    let rough = field.stencil(&place, 1)?;
    let (along, _) = directions(&fine.jet(&estimated.density.values));
    let direction = orient(&fine.jet(&estimated.density.values), along);
    let slope = |jet: Jet| jet.slope(direction) / jet.value;
    let blur = blur(estimated, &field, &place);
    let mut found = Indicator::derive(
        estimated,
        IndicatorKind::FOLD,
        place,
        |values| slope(fine.jet(values)),
        |values| slope(rough.jet(values)),
    )?;
    found.systematic_error += blur;
    Some(found)
}

/// Cells on either side of a bend in which the density is blurred, see [`blur`].
const BLURRED: f64 = 4.0;

/// What is not known of a slope near a place where a force bends inside a cell: the scheme sees the bend blurred over
/// the cell, and the slope of log p at it may be off by a quarter of the cell's width times the jump of its curvature.
fn blur(estimated: &EstimatedDensity, field: &Field<'_>, place: &[f64]) -> f64 {
    let of = |k: usize, at: f64| -> Option<f64> {
        let width = field.cell_width(k, at);
        let is_near = (place[k] - at).abs() <= BLURRED * width * field.unit(k);
        if !is_near || field.axes()[k].has_face_at(at) {
            return None;
        }
        let mut on = place.to_vec();
        on[k] = at;
        let curvature = |at: &Vec<f64>| {
            let jet = field.jet(at)?;
            Some(jet.second[2 * k] / jet.value - (jet.first[k] / jet.value).powi(2))
        };
        let [below, above] = AtBend::beside(&on, k, field.unit(k));
        Some(0.25 * width * (curvature(&above)? - curvature(&below)?).abs())
    };
    let kinks = estimated.structure.kinks.iter();
    let bends = kinks.filter(|kink| kink.is_bend() && kink.axis < 2);
    bends.filter_map(|kink| of(kink.axis, kink.at)).sum()
}

/// A place on a plane where a force bends, at which the slope across the plane has an extremum: the density is level
/// along the plane there, and curved to different sides below and above it.
struct AtBend {
    place: Vec<f64>,
    /// The axis that the plane stands on.
    across: usize,
    /// Whether the slope rises to the plane and falls from it.
    rises: bool,
}

/// Distance from a plane at which its sides are told apart, as a share of the range.
const ASIDE: f64 = 1e-9;

impl AtBend {
    /// Places just below and just above the plane.
    fn beside(place: &[f64], across: usize, unit: f64) -> [Vec<f64>; 2] {
        [-1.0, 1.0].map(|side| {
            let mut at = place.to_vec();
            at[across] += side * ASIDE * unit;
            at
        })
    }

    /// The slope in the direction in which the curvature falls; both sides say the same but for their errors.
    fn indicator(self, estimated: &EstimatedDensity, field: &Field<'_>) -> Option<Indicator> {
        let sign = if self.rises { 1.0 } else { -1.0 };
        let across = self.across;
        let [fine, rough, other] = self.stencils(field)?;
        let slope = |stencils: &[Stencil], values: &[f64]| {
            let jets = stencils.iter().map(|one| one.jet(values));
            let slopes = jets.map(|jet| jet.first[across] / jet.value);
            sign * slopes.sum::<f64>() / stencils.len() as f64
        };
        let apart = |values: &[f64]| 2.0 * (slope(&fine, values) - slope(&other, values)).abs();
        let blur = blur(estimated, field, &self.place);
        let mut found = Indicator::derive(
            estimated,
            IndicatorKind::FOLD,
            self.place.clone(),
            |values| slope(&fine, values),
            |values| slope(&rough, values),
        )?;
        found.systematic_error += apart(&estimated.density.values) + blur;
        Some(found)
    }

    /// What the slope is read by: finely, roughly, and otherwise. It is read from cells on both sides, or, where those
    /// are too few, as the mean of either side, and otherwise on one of them.
    fn stencils(&self, field: &Field<'_>) -> Option<[Vec<Stencil>; 3]> {
        if let Some(across) = field.stencils_across(&self.place, self.across) {
            return Some(across.map(|one| vec![one]));
        }
        let beside = Self::beside(&self.place, self.across, field.unit(self.across));
        let on_sides = |level: usize| -> Option<Vec<Stencil>> {
            beside.iter().map(|at| field.stencil(at, level)).collect()
        };
        let fine = on_sides(BESIDE_BEND)?;
        let below = fine.first()?.clone();
        Some([fine, on_sides(1)?, vec![below]])
    }
}

/// The nearest of them.
fn at_bend(estimated: &EstimatedDensity, field: &Field<'_>, near: &[f64]) -> Option<AtBend> {
    let kinks = estimated.structure.kinks.iter();
    let bends = kinks.filter(|kink| kink.is_bend() && kink.axis < 2);
    let found = bends.filter_map(|kink| {
        let (across, along) = (kink.axis, 1 - kink.axis);
        let mut place = near.to_vec();
        place[across] = kink.at;
        for _ in 0..MOST_STEPS {
            let jet = field.jet(&place)?;
            let step = -jet.first[along] / jet.second[2 * along];
            let cell = LONGEST * field.cell_width(along, near[along]);
            place[along] += step.clamp(-cell, cell) * field.unit(along);
            field.cell_at(&place)?;
            if step.abs() < SETTLED * cell {
                break;
            }
        }
        let [below, above] = AtBend::beside(&place, across, field.unit(across)).map(|at| {
            Some(field.stencil(&at, BESIDE_BEND)?.jet(field.values()).second[2 * across] > 0.0)
        });
        let rises = below?;
        (above? != rises).then_some(AtBend {
            place,
            across,
            rises,
        })
    });
    let distance = |one: &AtBend| (one.place[one.across] - near[one.across]).abs();
    found.min_by(|a, b| distance(a).total_cmp(&distance(b)))
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

/// The direction along the curve in which the curvature falls: from the saddle to the peak, from the crater to the
/// saddle.
fn orient(jet: &Jet, along: Curvature) -> [f64; 2] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::{Density, Kink, Observable, Structure};
    use crate::space::{Axis, Grading};

    /// Averages over cells of a function with bends on faces, to rounding.
    fn averages(axis: &Axis, of: &dyn Fn(f64) -> f64) -> Vec<f64> {
        let parts = 64;
        let cells = axis.edges().windows(2);
        let average = |edges: &[f64]| {
            let width = (edges[1] - edges[0]) / f64::from(parts);
            let part = |number: i32| {
                let middle = edges[0] + (f64::from(number) + 0.5) * width;
                let [low, high] = [-1.0, 1.0].map(|side| middle + side * width / 12_f64.sqrt());
                0.5 * (of(low) + of(high))
            };
            (0..parts).map(part).sum::<f64>() / f64::from(parts)
        };
        cells.map(average).collect()
    }

    /// log p = -2 (V - θ x)/σ² - y², V' = x - b (|x + d| - |x - d|)/2 with corners at ±d, where the slope along x is
    /// 2 (θ ± (d - b d))/σ².
    fn cornered(axis: &Axis, theta: f64) -> EstimatedDensity {
        let (b, d, sigma2) = (2.0, 0.8, 0.6);
        let potential = |x: f64| {
            let inside = 0.5 * (1.0 - b) * x.powi(2);
            let beyond = 0.5 * b * (x.abs() - d).max(0.0).powi(2);
            inside + beyond - theta * x
        };
        let across = Axis::uniform(-4.0, 4.0, 40).unwrap();
        let rows = averages(axis, &|x| (-2.0 * potential(x) / sigma2).exp());
        let columns = averages(&across, &|y| (-y * y).exp());
        let values = rows
            .iter()
            .flat_map(|row| columns.iter().map(move |one| row * one));
        let at = |at: f64| Kink {
            axis: 0,
            at,
            jump: Vec::new(),
        };
        EstimatedDensity {
            structure: Structure {
                kinks: vec![at(-d), at(d)],
                ..Structure::default()
            },
            negligible: 1e-9,
            ..EstimatedDensity::new(
                Observable::Joint(0, 1),
                Density {
                    values: values.collect(),
                    axes: vec![axis.clone(), across],
                },
            )
        }
    }

    /// Where errors of several kinds cancel in the differences of reconstructions, these say too little: never on
    /// the uniform cells, at a tenth of the values on graded ones. Read on one side alone, by cubics through four
    /// cells, the slope is off by 0.05 on the uniform cells.
    #[test]
    fn where_a_force_bends_the_slope_is_read_from_cells_on_both_sides() {
        let grading = Grading {
            at: vec![-0.8, 0.8],
            smallest: 0.07,
        };
        let graded = Axis::graded(-4.6, 4.9, 54, &grading).unwrap();
        let uniform = Axis::uniform(-4.8, 4.8, 96).unwrap();
        let finer = [1.5, 2.25].map(|factor| graded.refined(factor));
        for axis in [uniform, graded].iter().chain(&finer) {
            let (mut ratios, mut worst) = (Vec::new(), 0.0_f64);
            for step in 0..81 {
                let theta = 0.6 + 0.005 * f64::from(step);
                let found = fold(&cornered(axis, theta), &[-0.75, 0.05]).unwrap();
                assert_eq!(found.place[0], -0.8);
                let exact = 2.0 * (0.8 - theta) / 0.6;
                let length = axis.to() - axis.from();
                let error = (found.value / length - exact).abs();
                ratios.push(error / (found.systematic_error / length));
                worst = worst.max(error);
            }
            let exceeded = ratios.iter().filter(|ratio| **ratio > 1.0).count();
            let allowed = if axis.is_uniform() {
                0
            } else {
                ratios.len() / 8
            };
            assert!(
                exceeded <= allowed && worst < 3e-4,
                "{}: {exceeded} {worst}",
                axis.count()
            );
        }
    }
}
