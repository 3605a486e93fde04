//! The indicators of a critical point of a joint density that stays one while its type changes, away from a declared
//! centre: a peak that becomes a saddle, or a saddle that becomes a peak, as two others meet it, one from either side;
//! and the same of a crater.
//!
//! That is a pitchfork. It happens on a line on which the density is its own mirror image: the curvature across that
//! line passes zero linearly. The slope at the shoulder between the two ([`super::fold`]) goes there like the power 3/2
//! of the distance, so that its zero says little. Without the mirror image a pitchfork breaks into a fold and a point
//! that stays: the indicator is read only where third derivatives across the line are zero within their own error.

use super::kind::{Read, Traits};
use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::topology::Step;
use crate::topology::field::{Field, Jet};

/// Most steps of Newton's method.
const MOST_STEPS: usize = 30;
/// Farthest from where the search began, in cells.
const FARTHEST: f64 = 6.0;
/// A step that is a smaller share of a cell ends the search.
const SETTLED: f64 = 1e-9;
/// The shortest step must be a smaller share of a cell.
const LONGEST_LAST: f64 = 1e-3;
/// Half the distance over which fourth derivatives are taken, in cells.
const ASIDE: f64 = 0.5;
/// Times their own error that third derivatives across the line may be.
const MIRRORED: f64 = 2.0;
/// Share of a range by which the place of the critical point may lie beside the line, where the curvature is nearly
/// zero.
const BESIDE: f64 = 3e-4;

impl IndicatorKind {
    /// Curvature of a joint density across a line on which it is its own mirror image, at a critical point on that
    /// line: positive when an extremum is there, a peak if `is_peak`, else a crater, and `is_it`; otherwise when a
    /// saddle is there, which becomes that extremum.
    pub(crate) const fn split(is_peak: bool, is_it: bool) -> Self {
        Self(&ALL[is_peak as usize][is_it as usize])
    }
}

/// By whether the extremum is a peak, then by whether it is the one that is there when the indicator is positive.
static ALL: [[Traits; 2]; 2] = [
    [
        across(
            "curvature of a saddle that becomes a crater",
            |density, near| split(density, near, (false, false)),
        ),
        across(
            "curvature of a crater that becomes a saddle",
            |density, near| split(density, near, (false, true)),
        ),
    ],
    [
        Traits {
            words: |step| {
                words(
                    step,
                    ["peaks merge off the centre", "peak splits off the centre"],
                )
            },
            ..across(
                "curvature of a saddle that becomes a peak",
                |density, near| split(density, near, (true, false)),
            )
        },
        Traits {
            words: |step| words(step, ["peak becomes a saddle", "saddle becomes a peak"]),
            ..across(
                "curvature of a peak that becomes a saddle",
                |density, near| split(density, near, (true, true)),
            )
        },
    ],
];

/// One of them, by its code and how it is read.
const fn across(code: &'static str, read: Read) -> Traits {
    Traits {
        name: "curvature across a line of symmetry",
        ..Traits::new(code, read)
    }
}

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
    // On the line third derivatives across it vanish. Where they are nothing but errors, so is the rest of the mirror.
    let third = |jet: Jet| jet.bend(across, across) / jet.value;
    let fourth = fourth(&field, &place, across)? / fine.jet(values).value;
    let own = third(fine.jet(values));
    let second = field.second_scheme().map(|second| third(fine.jet(second)));
    let error = (third(rough.jet(values)) - own).abs()
        + second.map_or(0.0, |second| (second - own).abs())
        + BESIDE * fourth.abs();
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
    // With a slope of μ u + b u² + a u³ across the line, b of the size of its error, extrema meet at μ = b²/(4 a) in
    // place of 0.
    found.systematic_error += 0.375 * own * own / fourth.abs();
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

/// The critical point, by Newton's method. Where the curvature across is nearly zero, what rounding leaves makes steps
/// grow again: the place of the shortest step is kept, which the curvature hardly depends on, as it has an extremum
/// there.
fn settle(field: &Field<'_>, near: &[f64], is_peak: bool) -> Option<Vec<f64>> {
    let cell = [0, 1].map(|k| field.cell_width(k, near[k]));
    let mut place = near.to_vec();
    let mut best = (LONGEST_LAST, None);
    for _ in 0..MOST_STEPS {
        let jet = field.jet(&place)?;
        let (across, along) = directions(&jet, is_peak);
        let [a, b] = [across, along].map(|one| -jet.slope(one) / jet.curvature(one));
        let step = [0, 1].map(|k| (a * across[k] + b * along[k]).clamp(-cell[k], cell[k]));
        let length = (step[0] / cell[0]).abs().max((step[1] / cell[1]).abs());
        if length < best.0 {
            best = (length, Some(place.clone()));
        }
        for k in 0..2 {
            place[k] += step[k] * field.unit(k);
        }
        let away = |k: usize| (place[k] - near[k]).abs() / (cell[k] * field.unit(k));
        let farthest = away(0).max(away(1));
        if length < SETTLED || farthest.is_nan() || farthest > FARTHEST {
            break;
        }
    }
    best.1
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
