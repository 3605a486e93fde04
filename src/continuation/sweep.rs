//! The sweep itself: solves the given values in order, each warm-started from its neighbour, with values between
//! where neighbouring densities differ much; then narrows every change of signature.

use super::bracket::is_settled;
use super::change::{Change, changes, crossings_at_centre};
use super::dips::{self, Flanks};
use super::follow::Course;
use super::grid::CheckedIndicator;
use super::levels;
use super::live::Live;
use super::locate::label_points;
use super::root::{beyond_doubt, next_value, root};
use super::span::Span;
use super::{
    CellCheck, DensitySource, Goal, Label, LocateOptions, Observer, Point, Session, Shard,
    SourceError, SweepResult,
};
use crate::cancellation::Cancellation;
use crate::density::hellinger;
use crate::topology::Detector;

/// Evenly spaced values (at least 2), both ends exact. Weights are whole numbers and values are rounded to 15 digits,
/// so that round values between (0, or -0.01, between -0.02 and 0.01) come out as people write them.
pub fn evenly_spaced((from, to): (f64, f64), points: usize) -> Vec<f64> {
    let steps = points.max(2) - 1;
    let value = |index: usize| match index {
        0 => from,
        index if index == steps => to,
        index => {
            let value = (from * (steps - index) as f64 + to * index as f64) / steps as f64;
            format!("{value:.14e}").parse().unwrap_or(value)
        }
    };
    (0..=steps).map(value).collect()
}

/// Why a sweep ended without a result.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A parameter value that the source does not accept.
    #[error("{parameter} = {value}: {source}")]
    Source {
        /// The swept parameter.
        parameter: String,
        /// Its value.
        value: f64,
        /// What the source says.
        source: SourceError,
    },
    /// More shards than there are steps between the given values.
    #[error("a sweep of {steps} steps cannot be cut into {shards} shards")]
    Shards {
        /// The shards that were asked for.
        shards: usize,
        /// Steps between the given values.
        steps: usize,
    },
    /// The observer could not go on.
    #[error("{0}")]
    Observer(Box<dyn std::error::Error + Send + Sync>),
}

/// Sweeps a source along its path from end to end, with `points` evenly spaced values (at least 2).
///
/// Cancelled, it ends early with the points so far and [`SweepResult::interrupted`] set; an observer that wants to stop
/// cancels. Failed points are kept as data and labelled `MX`.
///
/// # Errors
/// [`SweepError`] when a value is not allowed or the observer fails.
pub fn sweep(
    source: &dyn DensitySource,
    detector: &dyn Detector,
    points: usize,
    options: &LocateOptions,
    cancellation: &Cancellation,
    observer: &mut dyn Observer,
) -> Result<SweepResult, SweepError> {
    let whole = (points, Shard::WHOLE);
    sweep_shard(source, detector, whole, options, cancellation, observer)
}

/// The same of one shard. What lies between its values is followed, narrowed and located as in the whole sweep, from
/// what the shard knows.
///
/// # Errors
/// As [`sweep`]; [`SweepError::Shards`] where there are more shards than steps.
pub(crate) fn sweep_shard(
    source: &dyn DensitySource,
    detector: &dyn Detector,
    (points, shard): (usize, Shard),
    options: &LocateOptions,
    cancellation: &Cancellation,
    observer: &mut dyn Observer,
) -> Result<SweepResult, SweepError> {
    let subject = source.subject();
    let span = Span::new(subject, points);
    let given = evenly_spaced(subject.family.ends(), points);
    let places = shard.places(given.len()).ok_or(SweepError::Shards {
        shards: shard.of(),
        steps: given.len() - 1,
    })?;
    let values = given[places].to_vec();
    observer.begin(values.len());
    let mut run = Run {
        source,
        session: source.open(cancellation),
        detector,
        span,
        options: options.goal(span.length()),
        cancellation,
        observer,
        remaining: values.len(),
        most_extra: MOST_EXTRA.max(MOST_EXTRA_A_VALUE * values.len()),
        may_fail: shard.number() > 1,
        points: Vec::new(),
        flanks: Vec::new(),
        interrupted: false,
    };
    let mut previous: Option<f64> = None;
    for value in values {
        run.remaining -= 1;
        run.solve(value)?;
        if let Some(previous) = previous {
            run.follow(previous, value, HALVINGS)?;
        }
        if run.interrupted {
            break;
        }
        previous = Some(value);
    }
    run.narrow()?;
    let (labels, checks) = run.labels();
    Ok(SweepResult {
        subject: subject.clone(),
        points: run.points,
        labels,
        checks,
        interrupted: run.interrupted,
    })
}

/// How often a step between given values is halved at most, where densities change fast.
const HALVINGS: usize = 4;
/// Solves beyond the given values at most, for any sweep, and for each of its values.
const MOST_EXTRA: usize = 400;
const MOST_EXTRA_A_VALUE: usize = 10;

struct Run<'a> {
    source: &'a dyn DensitySource,
    session: Box<dyn Session>,
    detector: &'a dyn Detector,
    span: Span,
    options: Goal,
    cancellation: &'a Cancellation,
    observer: &'a mut dyn Observer,
    remaining: usize,
    most_extra: usize,
    /// Whether the first value may fail: where it is not the first of the sweep.
    may_fail: bool,
    /// Ascending in the parameter.
    points: Vec<Point>,
    /// One a point, in the same order.
    flanks: Vec<Flanks>,
    interrupted: bool,
}

impl Run<'_> {
    /// Solves one value, tells the observer and keeps the point.
    fn solve(&mut self, value: f64) -> Result<(), SweepError> {
        if self.interrupted || self.cancellation.is_cancelled() {
            self.interrupted = true;
            return Ok(());
        }
        let method = self.source.method();
        let solved = Point::solve(self.session.as_mut(), method, self.detector, value);
        let Some((point, refusal)) = solved else {
            self.interrupted = true;
            return Ok(());
        };
        // One value that fails takes nothing from the others; a first one that does is a mistake.
        if let Some(error) = refusal
            && !self.may_fail
            && self.points.is_empty()
        {
            return Err(SweepError::Source {
                parameter: self.source.subject().family.parameter().to_owned(),
                value,
                source: SourceError::Method(error),
            });
        }
        let densities = point.densities.iter();
        let flanks = densities.map(|d| self.detector.flanks(d)).collect();
        let place = self.points.partition_point(|point| point.value < value);
        self.flanks.insert(place, flanks);
        self.points.insert(place, point);
        fill_distances(&mut self.points, place);
        let done = self.points.len();
        self.observer
            .point(&self.points[place], done, self.remaining)
            .map_err(SweepError::Observer)
    }

    /// Whether a value is yet to be solved: asked for again, it would give nothing new.
    fn is_new(&self, value: &f64) -> bool {
        self.at(*value).is_none()
    }

    fn at(&self, value: f64) -> Option<&Point> {
        self.points.iter().find(|point| point.value == value)
    }

    /// Solves between two neighbours whose densities differ by more than wanted.
    fn follow(&mut self, from: f64, to: f64, halvings: usize) -> Result<(), SweepError> {
        let (Some(a), Some(b)) = (self.at(from), self.at(to)) else {
            return Ok(());
        };
        let distance = distance_between(a, b).unwrap_or(0.0);
        let middle = 0.5 * (from + to);
        let wide = distance > self.options.largest_distance && middle != from && middle != to;
        if halvings == 0 || self.interrupted || !wide {
            return Ok(());
        }
        self.solve(middle)?;
        self.follow(from, middle, halvings - 1)?;
        self.follow(middle, to, halvings - 1)
    }

    /// Solves further values until every change is as narrow as wanted, or as the data allow.
    fn narrow(&mut self) -> Result<(), SweepError> {
        for _ in 0..self.most_extra {
            let Some(value) = self.next() else {
                break;
            };
            self.solve(value)?;
            if self.interrupted {
                break;
            }
        }
        Ok(())
    }

    /// The value to solve next.
    fn next(&self) -> Option<f64> {
        let solved: Vec<&Point> = (self.points.iter())
            .filter(|point| !point.detections.is_empty())
            .collect();
        let tolerance = self.options.tolerance;
        let dip = dips::at_centre(&solved, tolerance).or_else(|| self.dip_on_flanks());
        let dip = dip.filter(|value| self.is_new(value));
        if let Some(value) = dip.or_else(|| self.next_at_centre(&solved)) {
            return Some(value);
        }
        let changes = changes(&solved, self.detector);
        let wanted = |change: &Change| match &change.course {
            Some(Course::Crossing(crossing)) => {
                next_value(&solved, crossing, self.detector.confidence(), tolerance)
            }
            Some(Course::Lost(at)) => {
                let (a, b) = (solved[*at].value, solved[*at + 1].value);
                let middle = 0.5 * (a + b);
                (b - a > tolerance && middle > a && middle < b).then_some(middle)
            }
            Some(Course::Sunk(_) | Course::Beyond(_)) => None,
            None => {
                let (a, b) = (solved[change.left], solved[change.left + 1]);
                let middle = 0.5 * (a.value + b.value);
                let settled = is_settled(a, b, self.span.step, &self.options);
                (!settled && middle > a.value && middle < b.value).then_some(middle)
            }
        };
        let mut changes = changes.iter();
        let value = changes.find_map(|change| wanted(change).filter(|value| self.is_new(value)));
        value.or_else(|| {
            let levels = self.source.subject().family.levels();
            let value = levels::next_value(&self.points, levels, tolerance);
            value.filter(|value| self.is_new(value))
        })
    }

    /// A value between, at which a pair of peak and valley may be there, or not be there, for a while.
    fn dip_on_flanks(&self) -> Option<f64> {
        let pairs = self.points.iter().zip(&self.flanks);
        let solved: Vec<(&Point, &Flanks)> = pairs
            .filter(|(point, _)| !point.detections.is_empty())
            .collect();
        let tolerance = self.options.tolerance;
        dips::between_flanks(&solved, tolerance)
            .or_else(|| dips::beside_centre(&solved, tolerance))
            .or_else(|| dips::on_flanks(&solved, tolerance))
    }

    /// Narrows every change of sign at a centre of symmetry, and looks at the stage between two of them.
    fn next_at_centre(&self, solved: &[&Point]) -> Option<f64> {
        let (confidence, tolerance) = (self.detector.confidence(), self.options.tolerance);
        crossings_at_centre(solved).iter().find_map(|crossings| {
            let narrower = crossings
                .iter()
                .filter_map(|crossing| next_value(solved, crossing, confidence, tolerance))
                .find(|value| self.is_new(value));
            let mut roots: Vec<f64> = (crossings.iter())
                .map(|crossing| root(solved, crossing, confidence).value)
                .collect();
            roots.sort_by(f64::total_cmp);
            let unseen = |pair: &[f64]| {
                let quarter = 0.25 * (pair[1] - pair[0]);
                let inside = pair[0] + quarter..pair[1] - quarter;
                let seen = solved.iter().any(|point| inside.contains(&point.value));
                (4.0 * quarter > tolerance && !seen).then_some(0.5 * (pair[0] + pair[1]))
            };
            let beside = || {
                let mut settled = crossings.iter();
                settled.find_map(|one| beyond_doubt(solved, one, self.detector, tolerance))
            };
            narrower
                .or_else(|| roots.windows(2).find_map(unseen))
                .or_else(|| beside().filter(|value| self.is_new(value)))
        })
    }

    /// The rows, each checked where the source can be, and what was seen in the checks.
    fn labels(&mut self) -> Labelled {
        let wanted = self.options.grid_check && !self.interrupted;
        let effort = self.options.effort * self.points.len() as f64;
        let mut checks = Live::new(
            wanted.then_some(self.source),
            self.detector,
            (self.cancellation, self.observer.known_checks()),
            (self.span, self.options.tolerance, effort),
        );
        let labels = label_points(
            &self.points,
            self.source.subject(),
            self.detector,
            &self.options,
            &mut checks,
        );
        let can_check = matches!(
            self.source.subject().cell_check,
            CellCheck::OnFinerCells { .. }
        );
        let seen = checks.seen();
        // What is not checked yet is checked by a run that goes on.
        self.interrupted |= wanted && self.cancellation.is_cancelled();
        (labels, seen.filter(|_| can_check))
    }
}

/// Rows, and what was seen in their checks.
type Labelled = (Vec<Label>, Option<Vec<CheckedIndicator>>);

/// Largest Hellinger distance over the watched densities of two points; `None` when one has none.
pub(super) fn distance_between(a: &Point, b: &Point) -> Option<f64> {
    let pairs = a.densities.iter().zip(&b.densities);
    pairs
        .filter_map(|(a, b)| hellinger(&a.density, &b.density).ok())
        .reduce(f64::max)
}

/// Fills the distances that a new point at `place` changes: its own, and that of the next one with densities.
fn fill_distances(points: &mut [Point], place: usize) {
    if points[place].densities.is_empty() {
        return;
    }
    let has = |index: &usize| !points[*index].densities.is_empty();
    let before = (0..place).rev().find(has);
    let after = (place + 1..points.len()).find(has);
    points[place].distance =
        before.and_then(|index| distance_between(&points[index], &points[place]));
    if let Some(after) = after {
        points[after].distance = distance_between(&points[place], &points[after]);
    }
}
