//! The sweep itself: solves the given values, each warm-started from its neighbour, with values between where
//! neighbouring densities differ much; then narrows every change of signature. What does not depend on each other is
//! solved side by side.

use rayon::prelude::*;

use super::beside::Beside;
use super::dips::Flanks;
use super::distances::{fill_all_distances, fill_distances};
use super::grid::CheckedIndicator;
use super::levels::asked_of;
use super::live::Live;
use super::locate::label_points;
use super::segment::{Segment, Solved, Work};
use super::span::Span;
use super::wanted::Search;
use super::{
    CellCheck, DensitySource, Goal, Label, LocateOptions, Observer, Point, Shard, SweepError,
    SweepResult,
};
use crate::cancellation::Cancellation;
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
    let values = &given[places];
    observer.begin(values.len());
    let known = observer.known_checks();
    let options = options.goal(span.length());
    let work = Work::new(
        (source, detector),
        cancellation,
        (observer, values.len()),
        options.largest_distance,
        // Where it is not the first of the sweep, the first value may fail.
        values.first().copied().filter(|_| shard.number() == 1),
    );
    let mut run = Run {
        work: &work,
        segments: Segment::cut(&work, values),
        source,
        detector,
        span,
        options,
        points: Vec::new(),
        flanks: Vec::new(),
    };
    run.walk()?;
    run.narrow(MOST_EXTRA.max(MOST_EXTRA_A_VALUE * values.len()))?;
    // Checks are solved in sessions of their own.
    run.segments.clear();
    let (labels, checks, unchecked) = run.labels(cancellation, known);
    Ok(SweepResult {
        subject: subject.clone(),
        points: run.points,
        labels,
        checks,
        interrupted: work.has_ended() || unchecked,
    })
}

/// Solves beyond the given values at most, for any sweep, and for each of its values.
const MOST_EXTRA: usize = 400;
const MOST_EXTRA_A_VALUE: usize = 10;

struct Run<'a> {
    work: &'a Work<'a>,
    /// In the direction of the sweep.
    segments: Vec<Segment<'a>>,
    source: &'a dyn DensitySource,
    detector: &'a dyn Detector,
    span: Span,
    options: Goal,
    /// Ascending in the parameter.
    points: Vec<Point>,
    /// One a point, in the same order.
    flanks: Vec<Flanks>,
}

impl Run<'_> {
    /// Solves the given values, and between neighbours that differ much.
    fn walk(&mut self) -> Result<(), SweepError> {
        let segments = self.segments.par_iter_mut();
        let walked: Result<Vec<Vec<Solved>>, SweepError> = segments.map(Segment::walk).collect();
        let mut solved: Vec<Solved> = walked?.into_iter().flatten().collect();
        solved.sort_by(|a, b| a.point.value.total_cmp(&b.point.value));
        for one in solved {
            self.points.push(one.point);
            self.flanks.push(one.flanks);
        }
        fill_all_distances(&mut self.points);
        self.follow_across_borders()
    }

    /// Solves between the last value of each segment and the first of the next one.
    fn follow_across_borders(&mut self) -> Result<(), SweepError> {
        let ends: Vec<Option<[f64; 2]>> = self.segments.iter().map(Segment::ends).collect();
        let points = &self.points;
        let at = |value: f64| points.iter().find(|point| point.value == value);
        let borders = ends.windows(2).map(|pair| {
            let ([_, last], [first, _]) = (pair[0]?, pair[1]?);
            Some([at(last)?, at(first)?])
        });
        let borders: Vec<Option<[&Point; 2]>> = borders.collect();
        let pairs = self.segments.par_iter_mut().zip(borders);
        let found = pairs.map(|(segment, border)| match border {
            Some(ends) => segment.follow(ends),
            None => Ok(Vec::new()),
        });
        let found: Result<Vec<Vec<Solved>>, SweepError> = found.collect();
        self.keep(found?);
        Ok(())
    }

    fn keep(&mut self, found: Vec<Vec<Solved>>) {
        for one in found.into_iter().flatten() {
            let value = one.point.value;
            let place = self.points.partition_point(|point| point.value < value);
            self.flanks.insert(place, one.flanks);
            self.points.insert(place, one.point);
            fill_distances(&mut self.points, place);
        }
    }

    /// Solves further values, at most so many, until every change is as narrow as wanted, or as the data allow.
    fn narrow(&mut self, most: usize) -> Result<(), SweepError> {
        let levels = asked_of(&self.source.subject().family);
        let mut left = most;
        while left > 0 && !self.work.has_ended() {
            let mut wanted = Search {
                points: &self.points,
                flanks: &self.flanks,
                detector: self.detector,
                levels: &levels,
                span: self.span,
                options: &self.options,
            }
            .values();
            if wanted.is_empty() {
                break;
            }
            wanted.truncate(left);
            left -= wanted.len();
            self.solve(&wanted)?;
        }
        Ok(())
    }

    /// Solves further values, each in the segment that is nearest to it.
    fn solve(&mut self, values: &[f64]) -> Result<(), SweepError> {
        let mut lists = vec![Vec::new(); self.segments.len()];
        for &value in values {
            let distances = self.segments.iter().map(|one| one.distance_to(value));
            let nearest = distances.zip(&mut lists).min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((_, list)) = nearest {
                list.push(value);
            }
        }
        let pairs = self.segments.par_iter_mut().zip(&lists);
        let found = pairs.map(|(segment, values)| segment.solve(values));
        let found: Result<Vec<Vec<Solved>>, SweepError> = found.collect();
        self.keep(found?);
        Ok(())
    }

    /// The rows, each checked where the source can be, what was seen in the checks, and whether there was no time for
    /// them.
    fn labels(&self, cancellation: &Cancellation, mut known: Vec<CheckedIndicator>) -> Labelled {
        let wanted = self.options.grid_check && !self.work.has_ended();
        if wanted {
            let solved = self.points.iter();
            let solved: Vec<&Point> = solved.filter(|one| !one.detections.is_empty()).collect();
            let beside = Beside {
                points: &solved,
                source: self.source,
                detector: self.detector,
                options: &self.options,
                span: self.span,
                cancellation,
                known: &known,
            };
            known.extend(beside.seen());
        }
        let effort = self.options.effort * self.points.len() as f64;
        let mut checks = Live::new(
            wanted.then_some(self.source),
            self.detector,
            (cancellation, known),
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
        let unchecked = wanted && cancellation.is_cancelled();
        (labels, seen.filter(|_| can_check), unchecked)
    }
}

/// Rows, what was seen in their checks, and whether there was no time for them.
type Labelled = (Vec<Label>, Option<Vec<CheckedIndicator>>, bool);
