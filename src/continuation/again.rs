//! Detection and location repeated on the points of a finished sweep, without solving.

use rayon::prelude::*;

use super::distances::{distance_between, fill_all_distances};
use super::doubt::{CheckedBy, Doubt};
use super::grid::{Checked, CheckedIndicator, Checks, FinerZero, Seen, check, known, leak};
use super::look::{CloserLook, with_looks};
use super::span::Span;
use super::{Goal, LocateOptions, Point, Subject, SweepResult, locate::label_points};
use crate::numerics::sort_ascending;
use crate::topology::Detector;

/// Detects and locates again on all points there are, those that once refined brackets included, of a sweep with
/// `given` given values. What the points held of detections and distances is replaced; points without a density stay as
/// they are.
///
/// Located values are checked against `checks`, what a sweep saw in its checks ([`SweepResult::checks`]). With
/// unchanged settings that is the same check. Other settings may ask for values that were not solved: the zero then
/// comes from those that were, and a change near which there are none is unconfirmed. What closer looks of that sweep
/// have found, with the same settings, takes the place of rows in doubt as it did then.
pub(crate) fn detect_again(
    (subject, given): (Subject, usize),
    detector: &dyn Detector,
    mut points: Vec<Point>,
    (checks, looks): (Option<Vec<CheckedIndicator>>, Vec<CloserLook>),
    options: &LocateOptions,
) -> SweepResult {
    sort_ascending(&mut points, |one| one.value);
    points
        .par_iter_mut()
        .for_each(|point| point.detect(detector));
    fill_all_distances(&mut points, distance_between);
    let span = Span::new(&subject, given);
    let options = &options.goal(span.length());
    let mut repeated = Repeated {
        seen: checks.as_deref().filter(|_| options.grid_check),
        span,
        options,
    };
    let labels = label_points(&points, &subject, detector, options, &mut repeated);
    let labels = with_looks(labels, &looks, (&points, &subject.observables));
    SweepResult {
        subject,
        points,
        labels,
        checks,
        looks,
        interrupted: false,
    }
}

/// The checks by what was seen.
struct Repeated<'a> {
    seen: Option<&'a [CheckedIndicator]>,
    span: Span,
    options: &'a Goal,
}

impl Checks for Repeated<'_> {
    fn on_finer_cells(
        &mut self,
        checked: &Checked<'_>,
        times: u8,
    ) -> Option<Result<FinerZero, Doubt>> {
        let (seen, by) = (self.seen?, CheckedBy::FinerCells(times));
        let mut evaluate = |value: f64| known(seen, by, checked, value);
        let same = check(&mut evaluate, checked, self.span, self.options.tolerance);
        same.or_else(|| match nearest_zero(seen, by, checked, self.span) {
            Some(zero) => Some(Ok(zero)),
            None => (times == 1).then_some(Err(Doubt::NotOnFinerCells)),
        })
    }

    fn between_closed_ends(&mut self, checked: &Checked<'_>) -> Option<Result<f64, Doubt>> {
        let seen = self.seen?;
        let same = known(seen, CheckedBy::ClosedEnds, checked, checked.root.value);
        match same {
            Seen::Unknown => {
                let zero = nearest_zero(seen, CheckedBy::ClosedEnds, checked, self.span);
                zero.map(|zero| Ok((zero.value - checked.root.value).abs()))
            }
            same => leak(same, checked),
        }
    }
}

/// The zero nearest to the one sought, of those that earlier checks went to; none farther than a step of the sweep.
fn nearest_zero(
    seen: &[CheckedIndicator],
    by: CheckedBy,
    checked: &Checked<'_>,
    span: Span,
) -> Option<FinerZero> {
    let alike = seen.iter().filter(|one| {
        one.by == by && one.observable == checked.observable && one.kind == checked.kind
    });
    let known = alike.filter_map(|one| Some((one.value, one.indicator?, one.error)));
    let sought = checked.root.value;
    // The nearer a value to its zero, the less the slope matters, which is the one at the zero sought.
    let zeros = known.map(|(at, indicator, error)| {
        let [step, error] = [indicator, error].map(|one| one / checked.root.slope);
        let zero = FinerZero {
            value: at - step,
            error: error.abs(),
        };
        (step.abs(), zero)
    });
    let near = zeros.filter(|(_, zero)| (zero.value - sought).abs() <= span.step);
    near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|best| best.1)
}
