//! The indicator of a peak and a valley that are born together away from a centre of symmetry.
//!
//! At their birth slope and curvature vanish at one place. Before it, the flank has a shoulder there, where its slope
//! comes nearest to zero; after it, the slope between the two has an extremum of the other sign. Followed as one
//! extremum of p', signed so that it is positive when both are there, its value passes zero linearly.

use std::cmp::Ordering;

use super::exact::{self, Flank};
use super::kind::Traits;
use super::window::around;
use super::{Indicator, IndicatorKind};
use crate::density::{EstimatedDensity, Variants};
use crate::space::Axis;
use crate::topology::field::{Field, Jet};
use crate::topology::reconstruction::{Weights, smoothing};

/// Cells on either side when the density is sampled, as a share of all: noise of slopes falls with the window to the
/// power 3/2.
const SAMPLED_SHARE: usize = 12;
/// Least of them.
const LEAST: usize = 3;
/// Most steps of Newton's method.
const MOST_STEPS: usize = 12;
/// Distance from a kink at which its sides are told apart, as a share of the range.
const ASIDE: f64 = 1e-9;
/// A step that is a smaller share of a cell ends the search.
const SETTLED: f64 = 1e-6;

impl IndicatorKind {
    /// Slope at the inflection between a valley and a peak of a marginal, positive when both are there; `rising` where
    /// the density rises with the coordinate between the two.
    pub const fn shoulder(rising: bool) -> Self {
        Self(&BOTH[rising as usize])
    }
}

/// The slope at the inflection where the density falls from valley to peak, and where it rises.
static BOTH: [Traits; 2] = [
    Traits {
        rising: Some(false),
        mirror: || Some(IndicatorKind::shoulder(true)),
        ..AT_INFLECTION
    },
    Traits {
        code: "slope at the rising inflection",
        read: |density, near| shoulder(density, *near.first()?, true),
        rising: Some(true),
        mirror: || Some(IndicatorKind::shoulder(false)),
        ..AT_INFLECTION
    },
];

const AT_INFLECTION: Traits = Traits {
    name: "slope at the inflection",
    words: |step| {
        let several = step.before.peaks.abs_diff(step.after.peaks) > 1;
        Some(match (step.peaks(), several) {
            (Ordering::Greater, true) => "peaks and valleys are born",
            (_, true) => "peaks and valleys vanish",
            (Ordering::Greater, false) => "peak and valley are born",
            (_, false) => "peak and valley vanish",
        })
    },
    ..Traits::new("slope at the falling inflection", |density, near| {
        shoulder(density, *near.first()?, false)
    })
};

/// The extremum of the slope of a marginal nearest to `near`: a maximum of p' where the density rises from valley to
/// peak, else a minimum. `None` for joint densities and when there is none away from the ends and kinks.
pub(super) fn shoulder(estimated: &EstimatedDensity, near: f64, rising: bool) -> Option<Indicator> {
    let [axis] = estimated.density.axes.as_slice() else {
        return None;
    };
    if let Some(profile) = &estimated.structure.profile {
        return exact::shoulder(profile, near, rising, IndicatorKind::shoulder(rising));
    }
    let sign = if rising { 1.0 } else { -1.0 };
    let kind = IndicatorKind::shoulder(rising);
    if matches!(estimated.variants, Variants::Jackknife(_)) {
        return from_samples(estimated, axis, near, sign, kind);
    }
    let field = Field::new(estimated)?;
    let kinked = |face: usize| is_kinked(estimated, axis, face);
    let slope_at = |face: usize| -> Option<f64> {
        let is_inside = 0 < face && face < axis.count() && !kinked(face);
        let jet = is_inside.then(|| field.jet(&[axis.edges()[face]]))??;
        Some(sign * jet.first[0])
    };
    let smooth = steepest(axis, near, slope_at).and_then(|found| settle(&field, sign, &found));
    let bends = bends(estimated, &field).filter(|one| one.rising == rising);
    let places = smooth.into_iter().chain(bends.map(|one| one.place));
    let distance = |place: &f64| (place - near).abs();
    let place = places.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    let (fine, rough) = (field.stencil(&[place], 0)?, field.stencil(&[place], 1)?);
    let of = |jet: Jet| sign * jet.first[0] / (field.unit(0) * jet.value);
    Indicator::derive(
        estimated,
        kind,
        vec![place],
        |values| of(fine.jet(values)),
        |values| of(rough.jet(values)),
    )
}

/// A place where a slope, given on the faces, is largest, and the interval about it.
struct Steepest {
    place: f64,
    within: (f64, f64),
}

/// The maximum of a slope nearest to a place: the vertex of the parabola through those on three faces.
fn steepest(axis: &Axis, near: f64, slope_at: impl Fn(usize) -> Option<f64>) -> Option<Steepest> {
    let slopes: Vec<Option<f64>> = (0..=axis.count()).map(slope_at).collect();
    let is_maximum = |&face: &usize| {
        let (Some(left), Some(here), Some(right)) =
            (slopes[face - 1], slopes[face], slopes[face + 1])
        else {
            return false;
        };
        here >= left && here > right
    };
    let distance = |face: &usize| (axis.edges()[*face] - near).abs();
    let face = (1..axis.count())
        .filter(is_maximum)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    // Faces are at unequal distances.
    let edges = axis.edges();
    let (h, k) = (edges[face] - edges[face - 1], edges[face + 1] - edges[face]);
    let (left, here, right) = (slopes[face - 1]?, slopes[face]?, slopes[face + 1]?);
    let bend = ((right - here) / k - (here - left) / h) / (0.5 * (h + k));
    let tilt = ((right - here) / k * h + (here - left) / h * k) / (h + k);
    Some(Steepest {
        place: edges[face] + (-tilt / bend).clamp(-h, k),
        within: (edges[face - 1], edges[face + 1]),
    })
}

/// All extrema of the slope of a marginal without noise, of both directions, where the density counts: each is where a
/// pair of peak and valley is born or vanishes when its value passes zero. Values are read on the faces, to a
/// parabola's accuracy.
pub(crate) fn shoulders(estimated: &EstimatedDensity) -> Vec<Flank> {
    let [axis] = estimated.density.axes.as_slice() else {
        return Vec::new();
    };
    if let Some(profile) = &estimated.structure.profile {
        return exact::flanks(profile);
    }
    let Some(field) = Field::new(estimated).filter(|_| !estimated.is_noisy()) else {
        return Vec::new();
    };
    let least = estimated.negligible_height() * estimated.density.maximum();
    let faces = 0..=axis.count();
    let relative = |face: usize| -> Option<f64> {
        let at = axis.edges()[face];
        let is_inside = 0 < face && face < axis.count();
        let jet = (is_inside && !is_kinked(estimated, axis, face)).then(|| field.jet(&[at]))??;
        (jet.value > least).then(|| jet.first[0] / (field.unit(0) * jet.value))
    };
    let slopes: Vec<Option<f64>> = faces.map(relative).collect();
    let triples = slopes.windows(3).enumerate();
    let found = triples.filter_map(|(below, triple)| {
        let [Some(left), Some(here), Some(right)] = *triple else {
            return None;
        };
        Flank::between(axis.edges()[below + 1], [left, here, right])
    });
    let others = bends(estimated, &field).chain(kinks(estimated, &field));
    found.chain(others).collect()
}

/// The extrema that the slope has beside its jumps: a pair is born there when one side turns its sign.
///
/// Densities that the generator finds by quadrature carry a profile, which has them already. This is for densities in
/// closed form that another source gives with their kinks.
fn kinks<'a>(
    estimated: &'a EstimatedDensity,
    field: &'a Field<'_>,
) -> impl Iterator<Item = Flank> + 'a {
    let least = estimated.negligible_height() * estimated.density.maximum();
    let kinks = estimated.structure.kinks.iter();
    let kinks = kinks.filter(|kink| !kink.is_bend() && estimated.is_by_quadrature());
    kinks.flat_map(move |kink| {
        let beside = |step: f64| field.jet(&[kink.at + step * ASIDE * field.unit(0)]);
        let (Some(below), Some(above)) = (beside(-1.0), beside(1.0)) else {
            return Vec::new();
        };
        let slope = |jet: &Jet| jet.first[0] / (field.unit(0) * jet.value);
        let falls = |jet: &Jet| jet.second[0] * jet.value < jet.first[0] * jet.first[0];
        let jumps_up = slope(&above) > slope(&below);
        // The higher side is a maximum where the slope falls away from the jump, the lower one a minimum where it
        // rises.
        let (highest, lowest) = if jumps_up {
            (
                falls(&above).then_some(&above),
                falls(&below).then_some(&below),
            )
        } else {
            (
                (!falls(&below)).then_some(&below),
                (!falls(&above)).then_some(&above),
            )
        };
        let flank = |jet: &Jet, rising: bool| Flank {
            line: 0,
            is_sure: true,
            rising,
            place: kink.at,
            value: if rising { slope(jet) } else { -slope(jet) },
        };
        let flanks = [(highest, true), (lowest, false)];
        let flanks = flanks
            .into_iter()
            .filter_map(|(jet, rising)| Some((jet?, rising)));
        flanks
            .filter(|(jet, _)| jet.value > least)
            .map(|(jet, rising)| flank(jet, rising))
            .collect()
    })
}

/// Whether a kink lies on a face, or in a cell beside it: slopes on both sides of it do not follow from each other.
fn is_kinked(estimated: &EstimatedDensity, axis: &Axis, face: usize) -> bool {
    let at = axis.edges()[face];
    let mut kinks = estimated.structure.kinks.iter();
    kinks.any(|kink| match axis.face_at(kink.at) {
        Some(_) => axis.is_same_place(at, kink.at),
        None => axis
            .find(kink.at)
            .is_some_and(|cell| cell == face || cell + 1 == face),
    })
}

/// The places where the slope has an extremum because the drift bends: it rises to the place on one side, and falls
/// from it on the other. For densities by quadrature without a profile: curves take it away, as they follow the cells,
/// and sources of densities in closed form have none.
fn bends<'a>(
    estimated: &'a EstimatedDensity,
    field: &'a Field<'_>,
) -> impl Iterator<Item = Flank> + 'a {
    let least = estimated.negligible_height() * estimated.density.maximum();
    let kinks = estimated.structure.kinks.iter();
    let bends = kinks.filter(|kink| kink.is_bend() && estimated.is_by_quadrature());
    bends.filter_map(move |kink| {
        let beside = |step: f64| field.jet(&[kink.at + step * ASIDE * field.unit(0)]);
        let (below, above) = (beside(-1.0)?, beside(1.0)?);
        let slope = above.first[0] / (field.unit(0) * above.value);
        // Of the slope of the logarithm.
        let rises = |jet: &Jet| jet.second[0] * jet.value > jet.first[0] * jet.first[0];
        let is_turn = above.value > least && rises(&below) != rises(&above);
        is_turn.then(|| Flank {
            line: 0,
            is_sure: true,
            rising: rises(&below),
            place: kink.at,
            value: if rises(&below) { slope } else { -slope },
        })
    })
}

/// The zero of the curvature there, by Newton's method: the slope at the vertex of a parabola is too low by the square
/// of its distance.
fn settle(field: &Field<'_>, sign: f64, found: &Steepest) -> Option<f64> {
    let (low, high) = found.within;
    let mut place = found.place;
    for _ in 0..MOST_STEPS {
        let jet = field.jet(&[place])?;
        let step = -field.unit(0) * jet.second[0] / jet.third[0];
        // A maximum of the slope, and in the interval: else the parabola's vertex is all that is known.
        let next = place + step;
        if sign * jet.third[0] >= 0.0 || !(low..=high).contains(&next) {
            return Some(found.place);
        }
        place = next;
        if step.abs() < SETTLED * (high - low) {
            break;
        }
    }
    Some(place)
}

/// The same of a sampled density, by polynomials nearest to many cells.
fn from_samples(
    estimated: &EstimatedDensity,
    axis: &Axis,
    near: f64,
    sign: f64,
    kind: IndicatorKind,
) -> Option<Indicator> {
    let slope_at = |face: usize| -> Option<f64> {
        let lines = lines(estimated, axis.edges()[face], 0)?;
        Some(sign * lines[1].apply(&estimated.density.values))
    };
    let place = steepest(axis, near, slope_at)?.place;
    let (fine, rough) = (lines(estimated, place, 0)?, lines(estimated, place, 1)?);
    let of =
        |lines: &[Weights], values: &[f64]| sign * lines[1].apply(values) / lines[0].apply(values);
    Indicator::derive(
        estimated,
        kind,
        vec![place],
        |values| of(&fine, values),
        |values| of(&rough, values),
    )
}

/// Lines for the value and slope of a sampled marginal at a place that has no kink within their reach.
fn lines(estimated: &EstimatedDensity, at: f64, level: usize) -> Option<Vec<Weights>> {
    let axis = &estimated.density.axes[0];
    let reach = (axis.count() / SAMPLED_SHARE).max(LEAST);
    let cells = around(axis, at, reach)?;
    let inside = |kink: f64| {
        let face = axis.face_at(kink).or(axis.find(kink)).unwrap_or(0);
        cells.start < face && face < cells.end
    };
    if estimated
        .structure
        .kinks
        .iter()
        .any(|kink| !kink.is_bend() && inside(kink.at))
    {
        return None;
    }
    smoothing(axis, cells, at, 3 + level, 2)
}
