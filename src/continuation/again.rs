//! Detection and location repeated on the points of a finished sweep, without solving.

use super::grid::{Checked, FinerIndicator, GridCheck, check, known};
use super::span::Span;
use super::sweep::fill_distances;
use super::{Goal, LocateOptions, Point, Subject, SweepResult, locate::label_points};
use crate::topology::Detector;

/// Detects and locates again on all points there are, those that once refined brackets included, of a sweep with `given` given
/// values. What the points held of detections and distances is replaced; points without a density stay as they are.
///
/// Located values are checked against `finer`, what a sweep saw on its finer grid ([`SweepResult::finer`]). With unchanged
/// settings that is the same check. Other settings may ask for values that were not solved: the zero then comes from those that were,
/// and a change near which there are none is unconfirmed.
pub fn detect_again(
    (subject, given): (Subject, usize),
    detector: &dyn Detector,
    mut points: Vec<Point>,
    finer: Option<Vec<FinerIndicator>>,
    options: &LocateOptions,
) -> SweepResult {
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    for point in &mut points {
        let densities = point.densities.iter();
        point.detections = densities.map(|one| detector.detect(one)).collect();
        point.distance = None;
    }
    for place in 0..points.len() {
        fill_distances(&mut points, place);
    }
    let span = Span::new(&subject, given);
    let options = &options.goal(span.length());
    let seen = finer.as_deref().filter(|_| options.grid_check);
    let mut on_finer =
        |checked: &Checked<'_>| seen.and_then(|seen| repeat(seen, checked, span, options));
    let labels = label_points(
        &points,
        &subject.observables,
        detector,
        options,
        &mut on_finer,
    );
    SweepResult {
        subject,
        points,
        labels,
        finer,
        interrupted: false,
    }
}

/// The check by what was seen.
fn repeat(
    seen: &[FinerIndicator],
    checked: &Checked<'_>,
    span: Span,
    options: &Goal,
) -> Option<GridCheck> {
    let mut evaluate = |value: f64| known(seen, checked, value);
    let same = check(&mut evaluate, checked, span, options.tolerance);
    same.or_else(|| Some(nearest_zero(seen, checked, span)))
}

/// The zero nearest to the one sought, of those that earlier checks went to; none farther than a step of the sweep.
fn nearest_zero(seen: &[FinerIndicator], checked: &Checked<'_>, span: Span) -> GridCheck {
    let alike = seen
        .iter()
        .filter(|one| one.observable == checked.observable && one.kind == checked.kind.name());
    let known = alike.filter_map(|one| Some((one.value, one.indicator?)));
    let sought = checked.root.value;
    // The nearer a value to its zero, the less the slope matters, which is the one at the zero sought.
    let zeros = known.map(|(value, indicator)| {
        let zero = value - indicator / checked.root.slope;
        ((zero - value).abs(), zero)
    });
    let near = zeros.filter(|(_, zero)| (zero - sought).abs() <= span.step);
    let best = near.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(GridCheck::Unconfirmed, |(_, zero)| {
        GridCheck::Confirmed(zero)
    })
}
