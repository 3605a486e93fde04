//! What is said of curves that were followed.

use crate::continuation::BifurcationStatus;
use crate::continuation::curve::{
    CodimensionTwo, CodimensionTwoKind, Curve, CurveTree, LevelCurve, Plane, codimension_two,
    level_name, stability_curves,
};
use crate::job::{CurveJob, Job as _};
use crate::run::{doubt_in_words, format_with_error};
use crate::system::Family;

/// Everything that was found, in lines.
pub(super) fn summary(job: &CurveJob<'_>, tree: &CurveTree) -> String {
    let (mut text, plane) = (String::new(), job.plane());
    for (index, curve) in tree.curves.iter().enumerate() {
        text += &of_curve(job, tree, (index, curve));
    }
    for (index, curve) in tree.levels.iter().enumerate() {
        text += &level_lines(plane, (index, curve), job.row().label());
    }
    text += &stability_lines(job.sweep().problem.family(), plane);
    for point in codimension_two(&tree.curves) {
        text += &codimension_line(&point, plane, job.sweep().problem.family());
    }
    for missed in &tree.missed {
        text += &format!(
            "not followed: {} is zero near {}: {}\n",
            missed.start.kind.name(),
            place(plane, missed.start.values, 1e-3),
            missed.reason
        );
    }
    text
}

/// The curves of a fixed point in a plane, a line each, with both of its ends.
pub(in crate::cli) fn stability_lines(family: &Family, plane: &Plane) -> String {
    let curves = stability_curves(family, plane);
    let lines = curves.iter().map(|curve| {
        let ends = [curve.points.first(), curve.points.last()].into_iter();
        let ends = ends.flatten().map(|end| place(plane, end.values, 1e-4));
        format!(
            "{}  {}: from {}; {} points, known to {:.0e} of the sides of the box\n",
            curve.name,
            curve.kind.words(),
            ends.collect::<Vec<_>>().join("  to "),
            curve.points.len(),
            curve.largest_error()
        )
    });
    lines.collect()
}

/// The curve of a level with its start, of this label, and its ends.
pub(in crate::cli) fn level_lines(
    plane: &Plane,
    (index, curve): (usize, &LevelCurve),
    start: &str,
) -> String {
    let [first, second] = plane.sides();
    let mut text = format!(
        "{}  {} in the plane of {} and {}\n",
        level_name(index),
        curve.words(),
        first.parameter,
        second.parameter
    );
    let ends = curve.ends.iter();
    let ends = ends.map(|end| (end.point, end.label.as_str(), end.reason.words(plane)));
    let mut marks: Vec<(usize, &str, String)> = ends.collect();
    marks.push((curve.start, start, "start".to_owned()));
    marks.sort_by_key(|mark| mark.0);
    for (index, label, words) in marks {
        if let Some(point) = curve.points.get(index) {
            let values = place(plane, point.values, point.error);
            text += &format!("  {label:<5} {values}  {words}\n");
        }
    }
    let located = curve.points.iter();
    let located = located.filter(|point| is_located(point.status())).count();
    let largest = (curve.points.iter()).fold(0.0, |most: f64, point| most.max(point.error));
    text += &format!(
        "  {} points, {located} of them located; largest error {largest:.1e} of the sides of the box\n",
        curve.points.len()
    );
    text
}

/// A curve with its ends.
fn of_curve(job: &CurveJob<'_>, tree: &CurveTree, (index, curve): (usize, &Curve)) -> String {
    let family = job.sweep().problem.family();
    let [first, second] = curve.plane.sides();
    let what = format!(
        "{} of {} is zero",
        curve.kind.name(),
        curve.observable.name(family)
    );
    let number = match tree.curves.len() {
        1 => String::new(),
        _ => format!("C{}  ", index + 1),
    };
    let mut text = match index {
        0 => format!(
            "{number}{what}, followed from {} in the plane of {} and {}\n",
            job.row().label(),
            first.parameter,
            second.parameter
        ),
        _ => format!("{number}{what}\n"),
    };
    let mut line = |label: &str, index: usize, words: &str| {
        if let Some(point) = curve.points.get(index) {
            let values = place(&curve.plane, point.values, point.error);
            text += &format!("  {label:<4} {values}  {words}\n");
        }
    };
    let first_end = curve.ends.first().filter(|_| curve.ends.len() > 1);
    if let Some(end) = first_end {
        line(&end.label, end.point, &end.reason.words(&curve.plane));
    }
    if index == 0 {
        line(job.row().label(), curve.start, "start");
    }
    for split in &curve.degenerate {
        line(&split.label, split.point, turn_in_words(split.kind));
    }
    if let Some(end) = curve.ends.last() {
        line(&end.label, end.point, &end.reason.words(&curve.plane));
    }
    let errors = curve.points.iter().map(|point| point.error);
    let largest = errors.fold(0.0, f64::max);
    let checked = curve.points.iter().filter(|point| point.checked).count();
    let located = curve.points.iter();
    let located = located.filter(|point| is_located(point.status())).count();
    text += &format!(
        "  {} points, {located} of them located, {checked} checked; largest error {largest:.1e} of the sides of the box\n",
        curve.points.len()
    );
    let tolerance = job.options().tolerance;
    text + &sampling_in_words(curve, tolerance)
}

/// What sampling leaves open, where it is more than the tolerance; nothing for densities that are not sampled.
fn sampling_in_words(curve: &Curve, tolerance: f64) -> String {
    let sampling = curve.points.iter().map(|point| point.parts.sampling);
    let largest = sampling.fold(0.0, f64::max);
    if largest <= tolerance {
        return String::new();
    }
    let times = (largest / tolerance).powi(2).ceil();
    format!(
        "  sampling alone is up to {largest:.1e} of the sides of the box, and the tolerance is {tolerance:.1e}: {times:.0} times the samples would meet it, or a larger `locate.relative_tolerance`\n"
    )
}

/// Values of both parameters to the digits that an error, a share of the sides of the box, leaves.
fn place(plane: &Plane, values: [f64; 2], error: f64) -> String {
    let sides = plane.sides().iter().zip(values);
    let values = sides.map(|(side, value)| {
        let (value, _) = format_with_error(value, error * side.length());
        format!("{} = {value}", side.parameter)
    });
    values.collect::<Vec<_>>().join("  ")
}

/// What differs from a point between the ends of a curve on.
fn turn_in_words(kind: CodimensionTwoKind) -> &'static str {
    match kind {
        CodimensionTwoKind::DegenerateSplit => {
            "degenerate split: from here on peaks are born away from the centre"
        }
        CodimensionTwoKind::DegenerateKink => {
            "degenerate kink: from here on peaks are born away from the kink"
        }
        _ => "crossing: what the change leads to differs from here on",
    }
}

/// A point of codimension two in a line.
pub(in crate::cli) fn codimension_line(
    point: &CodimensionTwo,
    plane: &Plane,
    family: &Family,
) -> String {
    let curves = point.curves.iter().map(|index| format!("C{}", index + 1));
    let curves = curves.collect::<Vec<_>>().join(" and ");
    let words = match point.kind {
        CodimensionTwoKind::Cusp => format!("cusp of {curves}"),
        CodimensionTwoKind::DegenerateSplit => format!(
            "degenerate split of {curves}: births at the centre turn into births away from it"
        ),
        CodimensionTwoKind::DegenerateKink => {
            format!("degenerate kink of {curves}: births at the kink turn into births away from it")
        }
        CodimensionTwoKind::KinkCorner => format!(
            "corner of {curves}: the slopes on both sides of the kink vanish, and nothing happens on these lines beyond"
        ),
        CodimensionTwoKind::Crossing if point.curves.len() < 2 => {
            format!("crossing of {curves} with a curve that was not followed")
        }
        CodimensionTwoKind::Crossing => format!("crossing of {curves}"),
    };
    let doubt = point.doubts.first().map(|doubt| {
        let (status, words) = (doubt.status().word(), doubt_in_words(family, doubt));
        format!("; {status}: {words}")
    });
    format!(
        "{}  {}  {words}; known to {:.1e} of the sides of the box{}\n",
        point.label,
        place(plane, point.values, point.error),
        point.error,
        doubt.unwrap_or_default()
    )
}

fn is_located(status: BifurcationStatus) -> bool {
    status == BifurcationStatus::Located
}
