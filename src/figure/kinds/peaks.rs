//! The peak diagram of a marginal: where its peaks and valleys lie, and how high they are, over the parameter.

use crate::continuation::{Point, SweepResult};
use crate::density::EstimatedDensity;
use crate::topology::{Feature, FeatureKind, Verdict};

use super::{Drawn, Kind};
use crate::figure::canvas::style::Stroke;
use crate::figure::parts::along;
use crate::figure::parts::branches::{Branch, branches};
use crate::figure::parts::meeting::{located, meet};
use crate::figure::parts::table::{self, number as number_of};
use crate::figure::parts::track::{Curve, Track};
use crate::figure::parts::view::{self, View};
use crate::figure::parts::{caption, names};
use crate::figure::print::Print;

/// Height of a panel, in pixels.
const HEIGHT: f64 = 170.0;
/// Heights that differ by more than this factor are drawn on a logarithmic axis.
const LOGARITHMIC: f64 = 30.0;

/// The range of places as a share of where the density is, at least: a peak that stays where it is moves by rounding
/// alone.
const LEAST: f64 = 0.02;

/// Exponents of densities nearer to zero are rounding.
const FLAT: f64 = 1e-6;
/// A place so near to an end of the range is there, as a share of a cell.
const AT_END: f64 = 1e-6;

/// A peak diagram an observed marginal.
pub(super) const KIND: Kind = Kind {
    names: &["peaks"],
    usual: None,
    sketches: |sweep| sweep.of_marginals("peaks", draw),
};

/// The figure; `None` without a peak.
fn draw(result: &SweepResult, (number, axis): (usize, usize), print: &Print<'_>) -> Drawn {
    let (family, watched) = (&result.subject.family, result.subject.observables[number]);
    let densities = result.points.iter();
    let densities: Vec<_> = densities
        .filter_map(|point| Some(&view::density(point, number)?.density))
        .collect();
    let window = view::window(&densities, 0)?;
    let kinds = [
        (FeatureKind::Peak, "peak", 0),
        (FeatureKind::Valley, "valley", 1),
    ];
    let (mut places, mut heights) = (Vec::new(), Vec::new());
    let mut followed = kinds.map(|(kind, ..)| branches(&result.points, number, kind, window));
    let changes = located(result, watched);
    meet(&mut followed, &changes, &result.points, window);
    for ((_, name, colour), found) in kinds.into_iter().zip(followed) {
        for branch in found {
            let curve = |places: Vec<(f64, f64)>| Curve {
                name: name.to_owned(),
                stroke: Stroke::curve(colour),
                places,
                errors: Vec::new(),
            };
            heights.push(curve(heights_of(result, number, &branch)));
            places.push(curve(branch.places));
        }
    }
    let values = heights
        .iter()
        .flat_map(|curve| &curve.places)
        .map(|place| place.1);
    let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high), value: f64| {
        (f64::min(low, value), f64::max(high, value))
    });
    let track = |title: String, curves: Vec<Curve>, is_logarithmic: bool, least: f64| Track {
        title,
        is_logarithmic,
        has_zero: false,
        least,
        share: 1.0,
        curves,
    };
    let is_logarithmic = low > 0.0 && high > LOGARITHMIC * low;
    let tracks = [
        track(
            names::axis(family, axis),
            places,
            false,
            LEAST * (window.1 - window.0),
        ),
        track(
            names::density(family, watched),
            heights,
            is_logarithmic,
            0.0,
        ),
    ];
    let seen = format!(
        "Places and heights of the peaks (solid) and valleys (dashed) of the steady-state marginal density {} over {}.{}",
        caption::density(family, watched),
        caption::parameter(family),
        match result
            .points
            .iter()
            .any(|point| has_unbounded(point, number))
        {
            true => " A peak at an end where the density has no bound has no height.",
            false => "",
        }
    );
    let texts = (seen, rows(result, number));
    along::draw((result, print), Some(watched), (&tracks, HEIGHT), texts)
}

/// The table: what is there at each value.
fn rows(result: &SweepResult, number: usize) -> String {
    let parameter = result.subject.family.parameter();
    let columns = [
        parameter,
        "kind",
        "position",
        "density",
        "persistence",
        "significance",
    ];
    let features = result.points.iter().flat_map(|point| {
        let features = point.detections.get(number).into_iter();
        let features = features.flat_map(|detection| &detection.features);
        features.map(move |feature| (point, feature))
    });
    let rows = features.filter(|(_, feature)| feature.verdict == Verdict::Present);
    let row = |(point, feature): (&Point, &Feature)| {
        let position = feature.position.first().copied();
        let is_bounded = position.is_none_or(|place| !is_unbounded(point, number, place));
        let height = |one: f64| {
            if is_bounded {
                number_of(one)
            } else {
                String::new()
            }
        };
        vec![
            number_of(point.value),
            format!("{:?}", feature.kind).to_lowercase(),
            position.map(number_of).unwrap_or_default(),
            height(feature.density),
            height(feature.persistence),
            number_of(feature.significance),
        ]
    };
    table::table(&columns, rows.map(row))
}

/// Whether one of the peaks of a point has no height.
fn has_unbounded(point: &Point, number: usize) -> bool {
    let features = point.detections.get(number).into_iter();
    let mut present = features
        .flat_map(|detection| &detection.features)
        .filter(|one| one.verdict == Verdict::Present);
    present.any(|one| {
        let place = one.position.first();
        place.is_some_and(|&place| is_unbounded(point, number, place))
    })
}

/// Whether a density grows beyond any bound towards a place, an end of its range at which the noise dies.
fn is_unbounded(point: &Point, number: usize, place: f64) -> bool {
    let grows = |estimated: &EstimatedDensity| {
        let (profile, axis) = (
            estimated.structure.profile.as_ref()?,
            &estimated.density.axes[0],
        );
        let ends = [axis.from(), axis.to()].into_iter().zip(profile.ends);
        let mut own = ends.filter(|(end, _)| (place - end).abs() <= AT_END * axis.width(0));
        let exponent = own.next()?.1?;
        Some(exponent < -FLAT)
    };
    view::density(point, number)
        .and_then(grows)
        .unwrap_or(false)
}

/// The densities at the places of a branch, where they are bounded: as they were found where it was solved, else
/// between those beside it.
fn heights_of(result: &SweepResult, number: usize, branch: &Branch) -> Vec<(f64, f64)> {
    let points = &result.points;
    let found = |value: f64, position: f64| {
        let mut points = along::detections(result, number);
        let (_, detection) = points.find(|(at, _)| *at == value)?;
        let features = detection.features.iter();
        let mut own = features.filter(|one| one.kind == branch.kind);
        let feature = own.find(|one| one.position.first() == Some(&position))?;
        Some(feature.density)
    };
    let grows = |value: f64, position: f64| {
        let after = points.partition_point(|point| point.value < value);
        let beside = [after.checked_sub(1), Some(after)];
        let solved = points.get(after).is_some_and(|point| point.value == value);
        let beside = &beside[usize::from(solved)..];
        let mut beside = beside.iter().filter_map(|index| points.get((*index)?));
        beside.any(|point| is_unbounded(point, number, position))
    };
    let height = |&(value, position): &(f64, f64)| {
        if grows(value, position) {
            return None;
        }
        let height =
            found(value, position).or_else(|| between(&result.points, number, (value, position)));
        Some((value, height?))
    };
    branch.places.iter().filter_map(height).collect()
}

/// The density at a place, linear in the parameter between the points of the sweep beside it.
fn between(points: &[Point], number: usize, (value, place): (f64, f64)) -> Option<f64> {
    let after = points.partition_point(|point| point.value < value);
    let pair = [after.checked_sub(1)?, after].map(|index| points.get(index));
    let [Some(before), Some(after)] = pair else {
        return None;
    };
    let height = |point: &Point| {
        let view = View::new(view::density(point, number)?);
        view.along(&[place]).first().copied()
    };
    let share = (value - before.value) / (after.value - before.value);
    let height = (1.0 - share) * height(before)? + share * height(after)?;
    height.is_finite().then_some(height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::{Density, EstimatedDensity, Observable, Structure, Variants};
    use crate::figure::parts::branches::tests::point;
    use crate::space::Axis;

    #[test]
    fn heights_between_solved_values_are_linear_in_the_parameter() {
        let at = |value: f64, density: f64| Point {
            densities: vec![EstimatedDensity {
                observable: Observable::Marginal(0),
                standard_error: Vec::new(),
                density: Density {
                    axes: vec![Axis::uniform(-1.0, 1.0, 20).unwrap()],
                    values: vec![density; 20],
                },
                variants: Variants::None,
                structure: Structure::default(),
                negligible: 0.0,
                truncation: Default::default(),
            }],
            ..point(value, None)
        };
        let points = [at(0.0, 1.0), at(1.0, 3.0)];
        assert_eq!(between(&points, 0, (0.25, 0.1)), Some(1.5));
        for outside in [(-0.5, 0.1), (1.5, 0.1), (0.25, 2.0)] {
            assert_eq!(between(&points, 0, outside), None);
        }
    }
}
