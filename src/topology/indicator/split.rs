//! The indicators of a critical point of a joint density that stays one while its type changes, away from a declared
//! centre: a peak that becomes a saddle, or a saddle that becomes a peak, as two others meet it, one from either side;
//! and the same of a crater.
//!
//! That is a pitchfork. It happens on a line on which the density is its own mirror image: the curvature across that
//! line passes zero linearly. The slope at the shoulder between the two ([`super::fold`]) goes there like the power 3/2
//! of the distance, so that its zero says little. Without the mirror image a pitchfork breaks into a fold and a point
//! that stays: the indicator is read only where the slope across the line is zero within its own error.

use super::kind::Traits;
use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::topology::Step;
use crate::topology::field::{Field, Jet};

/// Most steps of Newton's method.
const MOST_STEPS: usize = 20;
/// Farthest from where the search began, in cells.
const FARTHEST: f64 = 6.0;
/// A step that is a smaller share of a cell ends the search.
const SETTLED: f64 = 1e-9;
/// Half the distance over which fourth derivatives are taken, in cells.
const ASIDE: f64 = 0.5;
/// Times its own error that the slope across the line may be.
const MIRRORED: f64 = 2.0;
/// Relative slope over a range that rounding leaves.
const ROUNDING: f64 = 1e-8;

/// By whether the extremum is a peak, then by whether it is the one that is there when the indicator is positive.
pub(super) static ALL: [[Traits; 2]; 2] = [
    [
        Traits {
            name: "curvature across a line of symmetry",
            ..Traits::new(
                "curvature of a saddle that becomes a crater",
                |density, near| split(density, near, (false, false)),
            )
        },
        Traits {
            name: "curvature across a line of symmetry",
            ..Traits::new(
                "curvature of a crater that becomes a saddle",
                |density, near| split(density, near, (false, true)),
            )
        },
    ],
    [
        Traits {
            name: "curvature across a line of symmetry",
            words: |step| {
                words(
                    step,
                    ["peaks merge off the centre", "peak splits off the centre"],
                )
            },
            ..Traits::new(
                "curvature of a saddle that becomes a peak",
                |density, near| split(density, near, (true, false)),
            )
        },
        Traits {
            name: "curvature across a line of symmetry",
            words: |step| words(step, ["peak becomes a saddle", "saddle becomes a peak"]),
            ..Traits::new(
                "curvature of a peak that becomes a saddle",
                |density, near| split(density, near, (true, true)),
            )
        },
    ],
];

/// What happens to peaks: fewer of them, more of them.
fn words(step: &Step, [fewer, more]: [&'static str; 2]) -> Option<&'static str> {
    match step.peaks() {
        std::cmp::Ordering::Less => Some(fewer),
        std::cmp::Ordering::Equal => None,
        std::cmp::Ordering::Greater => Some(more),
    }
}

/// The curvature across the line at the critical point near a place, positive where the extremum is there; with
/// `is_it` false, where the saddle that takes its place is. `None` for marginals, sampled densities, and where the
/// density is not its own mirror image.
fn split(
    estimated: &EstimatedDensity,
    near: &[f64],
    (is_peak, is_it): (bool, bool),
) -> Option<Indicator> {
    let field = Field::new(estimated).filter(|_| near.len() == 2 && !estimated.is_noisy())?;
    let place = settle(&field, near, is_peak)?;
    let (fine, rough) = (field.stencil(&place, 0)?, field.stencil(&place, 1)?);
    let values = &estimated.density.values;
    let (across, _) = directions(&fine.jet(values), is_peak);
    let slope = |jet: Jet| jet.slope(across) / jet.value;
    let own = slope(fine.jet(values));
    let second = field.second_scheme().map(|second| slope(fine.jet(second)));
    let error = (slope(rough.jet(values)) - own).abs()
        + second.map_or(0.0, |second| (second - own).abs())
        + ROUNDING;
    if own.abs() > MIRRORED * error {
        return None;
    }
    let sign = if is_peak == is_it { -1.0 } else { 1.0 };
    let kind = IndicatorKind::split(is_peak, is_it);
    let curvature = |jet: Jet| sign * jet.curvature(across) / jet.value;
    let mut found = Indicator::derive(
        estimated,
        kind,
        place.clone(),
        |values| curvature(fine.jet(values)),
        |values| curvature(rough.jet(values)),
    )?;
    // With slope h at the line and -h + μ u + a u³ across it, extrema meet at μ = 3 ∛(a h²/4) in place of 0.
    let cubic = fourth(&field, &place, across)? / (6.0 * fine.jet(values).value);
    let imperfect = if own.abs() <= ROUNDING { 0.0 } else { error };
    found.systematic_error += 3.0 * (0.25 * cubic.abs() * imperfect * imperfect).cbrt();
    Some(found)
}

/// The direction across the line, along which the curvature passes zero, and the one along it: of a peak the upper
/// curvature does, of a crater the lower.
fn directions(jet: &Jet, is_peak: bool) -> ([f64; 2], [f64; 2]) {
    let [lower, upper] = jet.principal().map(|one| one.direction);
    if is_peak {
        (upper, lower)
    } else {
        (lower, upper)
    }
}

/// The place on the line where the slope along it is zero. Newton's method for the critical point comes near to it, but
/// slowly where the curvature across is nearly zero; third derivatives across the line, which vanish on it, tell the
/// rest.
fn settle(field: &Field<'_>, near: &[f64], is_peak: bool) -> Option<Vec<f64>> {
    let to_critical_point = |place: &[f64]| {
        let jet = field.jet(place)?;
        let frame = directions(&jet, is_peak);
        let step = |direction| -jet.slope(direction) / jet.curvature(direction);
        Some((frame, [step(frame.0), step(frame.1)]))
    };
    let to_line = |place: &[f64]| {
        let jet = field.jet(place)?;
        let (across, along) = directions(&jet, is_peak);
        let sideways = -jet.bend(across, across) / fourth(field, place, across)?;
        let onward = -jet.slope(along) / jet.curvature(along);
        Some(((across, along), [sideways, onward]))
    };
    let (critical, _) = steps(field, near, near, &to_critical_point)?;
    let (place, last) = steps(field, &critical, near, &to_line)?;
    (last < SETTLED).then_some(place)
}

/// A frame of two directions, and a step along each.
type Moves = (([f64; 2], [f64; 2]), [f64; 2]);

/// Goes on by steps until they are short, or for so many; returns the place and the last step, in cells. `None` where
/// it leads away from where the search began.
fn steps(
    field: &Field<'_>,
    from: &[f64],
    near: &[f64],
    step: &dyn Fn(&[f64]) -> Option<Moves>,
) -> Option<(Vec<f64>, f64)> {
    let cell = [0, 1].map(|k| field.cell_width(k, near[k]));
    let mut place = from.to_vec();
    let mut longest = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let ((first, second), [a, b]) = step(&place)?;
        longest = 0.0;
        for k in 0..2 {
            let step = (a * first[k] + b * second[k]).clamp(-cell[k], cell[k]);
            place[k] += step * field.unit(k);
            let away = (place[k] - near[k]).abs();
            if away.is_nan() || away > FARTHEST * cell[k] * field.unit(k) {
                return None;
            }
            longest = longest.max((step / cell[k]).abs());
        }
        if longest < SETTLED {
            break;
        }
    }
    Some((place, longest))
}

/// The fourth derivative across the line.
fn fourth(field: &Field<'_>, place: &[f64], across: [f64; 2]) -> Option<f64> {
    let cell = [0, 1].map(|k| field.cell_width(k, place[k]));
    let aside = ASIDE * cell[0].min(cell[1]);
    let third = |side: f64| {
        let at: Vec<f64> = (0..2)
            .map(|k| place[k] + side * aside * across[k] * field.unit(k))
            .collect();
        Some(field.jet(&at)?.bend(across, across))
    };
    Some((third(1.0)? - third(-1.0)?) / (2.0 * aside))
}
