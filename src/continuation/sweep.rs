//! The sweep itself: solves the given values in order, each warm-started from its neighbour, and narrows
//! every pair of neighbours whose signatures differ.

use std::time::Instant;

use super::bracket::{is_settled, signatures_differ};
use super::{
    DensitySource, LocateOptions, Observer, Point, SourceError, SweepResult, locate::label_points,
};
use crate::density::{Observable, hellinger};
use crate::topology::Detector;

/// What to sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Name of the parameter.
    pub parameter: String,
    /// First value.
    pub from: f64,
    /// Last value; may be below the first.
    pub to: f64,
    /// Number of values, both ends included; at least 2.
    pub points: usize,
    /// The observables that the source gives, in its order.
    pub observables: Vec<Observable>,
}

impl Plan {
    /// The given values, in the order in which they are solved.
    pub fn values(&self) -> Vec<f64> {
        evenly_spaced(self.from, self.to, self.points)
    }

    /// Distance between neighbouring given values.
    pub fn step(&self) -> f64 {
        (self.to - self.from).abs() / (self.points.max(2) - 1) as f64
    }
}

/// Evenly spaced values (at least 2), both ends exact. Weights are whole numbers and values are rounded to 15 digits,
/// so that round values between (0, or -0.01, between -0.02 and 0.01) come out as people write them.
pub fn evenly_spaced(from: f64, to: f64, points: usize) -> Vec<f64> {
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
    /// The observer could not go on.
    #[error("{0}")]
    Observer(Box<dyn std::error::Error + Send + Sync>),
}

/// Sweeps a source along its parameter.
///
/// An interruption (by the observer or the source) ends the sweep early with the points so far and
/// [`SweepResult::interrupted`] set; failed points are kept as data and labelled `MX`.
///
/// # Errors
/// [`SweepError`] when a value is not allowed or the observer fails.
pub fn sweep<S: DensitySource>(
    source: &S,
    detector: &dyn Detector,
    plan: &Plan,
    options: &LocateOptions,
    observer: &mut dyn Observer,
) -> Result<SweepResult, SweepError> {
    let values = plan.values();
    observer.begin(values.len());
    let mut run = Run {
        source,
        detector,
        plan,
        options,
        observer,
        remaining: values.len(),
        points: Vec::new(),
        interrupted: false,
    };
    let mut previous: Option<Solved<S::State>> = None;
    for value in values {
        let start = previous.as_ref().and_then(|solved| solved.state.as_ref());
        run.remaining -= 1;
        let Some(solved) = run.solve(value, start)? else {
            break;
        };
        if let Some(previous) = &previous {
            run.narrow(previous, &solved)?;
        }
        // A failed point leaves no state; its successor starts from the last good one.
        let last_good = previous.and_then(|before| before.state);
        previous = Some(Solved {
            point: solved.point,
            state: solved.state.or(last_good),
        });
    }
    let (mut points, interrupted) = (run.points, run.interrupted);
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    fill_distances(&mut points);
    let labels = label_points(&points, &plan.observables, options);
    Ok(SweepResult {
        parameter: plan.parameter.clone(),
        observables: plan.observables.clone(),
        points,
        labels,
        interrupted,
    })
}

/// A point's place in the list of points, and what warm-starts its neighbours.
struct Solved<State> {
    point: usize,
    state: Option<State>,
}

struct Run<'a, S: DensitySource> {
    source: &'a S,
    detector: &'a dyn Detector,
    plan: &'a Plan,
    options: &'a LocateOptions,
    observer: &'a mut dyn Observer,
    remaining: usize,
    points: Vec<Point>,
    interrupted: bool,
}

impl<S: DensitySource> Run<'_, S> {
    /// Solves one value, tells the observer and keeps the point; `None` when interrupted.
    fn solve(
        &mut self,
        value: f64,
        start: Option<&S::State>,
    ) -> Result<Option<Solved<S::State>>, SweepError> {
        if self.observer.interrupted() {
            self.interrupted = true;
            return Ok(None);
        }
        let clock = Instant::now();
        let solution = match self.source.solve(value, start) {
            Ok(solution) => solution,
            Err(SourceError::Interrupted) => {
                self.interrupted = true;
                return Ok(None);
            }
            Err(source) => {
                return Err(SweepError::Source {
                    parameter: self.plan.parameter.clone(),
                    value,
                    source,
                });
            }
        };
        let densities = solution.densities;
        let detections = densities.iter().map(|d| self.detector.detect(d)).collect();
        let point = Point {
            value,
            report: solution.report,
            moments: solution.moments,
            detections,
            densities,
            distance: None,
            seconds: clock.elapsed().as_secs_f64(),
        };
        self.points.push(point);
        let (index, point) = (self.points.len() - 1, &self.points[self.points.len() - 1]);
        self.observer
            .point(point, index + 1, self.remaining)
            .map_err(SweepError::Observer)?;
        Ok(Some(Solved {
            point: index,
            state: solution.state,
        }))
    }

    /// Bisects between two neighbours until every pair in between is settled.
    fn narrow(
        &mut self,
        left: &Solved<S::State>,
        right: &Solved<S::State>,
    ) -> Result<(), SweepError> {
        let (a, b) = (&self.points[left.point], &self.points[right.point]);
        if self.interrupted
            || !signatures_differ(a, b)
            || is_settled(a, b, self.plan.step(), self.options)
        {
            return Ok(());
        }
        let (from, to) = (a.value, b.value);
        let middle = 0.5 * (from + to);
        if middle == from || middle == to {
            return Ok(());
        }
        let start = left.state.as_ref().or(right.state.as_ref());
        if let Some(solved) = self.solve(middle, start)? {
            self.narrow(left, &solved)?;
            self.narrow(&solved, right)?;
        }
        Ok(())
    }
}

/// Largest Hellinger distance over the watched densities between each point and the one before it that has any.
pub(super) fn fill_distances(points: &mut [Point]) {
    let mut previous: Option<usize> = None;
    for index in 0..points.len() {
        if points[index].densities.is_empty() {
            continue;
        }
        if let Some(before) = previous {
            let pairs = points[before].densities.iter();
            points[index].distance = pairs
                .zip(&points[index].densities)
                .filter_map(|(a, b)| hellinger(&a.density, &b.density).ok())
                .reduce(f64::max);
        }
        previous = Some(index);
    }
}
