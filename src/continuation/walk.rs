//! Values of a sweep solved, each warm-started from its neighbour, with values between where neighbouring densities
//! differ much; every change of signature narrowed; and the rows that follow.

use rayon::prelude::*;

use super::beside::Beside;
use super::dips::Flanks;
use super::distances::{fill_all_distances, fill_distances};
use super::grid::CheckedIndicator;
use super::levels::asked_of;
use super::live::Live;
use super::locate::label_points;
use super::segment::{Segment, Work};
use super::solved_point::SolvedPoint;
use super::span::Span;
use super::wanted::Search;
use super::{CellCheck, DensitySource, Goal, Label, Point, SweepError};
use crate::cancellation::Cancellation;
use crate::numerics::sort_ascending;
use crate::topology::Detector;

/// Solves beyond the given values at most, for any sweep, and for each of its values.
const MOST_EXTRA: usize = 400;
const MOST_EXTRA_A_VALUE: usize = 10;
/// The same where cells are many: so many cells in all of them, but no fewer solves than these for each value. What
/// asks for more comes and goes with the cells.
const MOST_EXTRA_CELLS: usize = 8_000_000;
const LEAST_EXTRA_A_VALUE: usize = 4;
/// Guesses at least, of values between others at which something may come and go; and as many as given values. On few
/// cells readings that are not sure dip everywhere, and guesses would not end before values are as near as wanted.
const LEAST_GUESSES: usize = 60;
/// One of so many solves beyond the given values may be a guess: the others narrow what is seen.
const GUESSED: usize = 3;

/// The solved values of a stretch of a sweep.
pub(super) struct Walk<'a> {
    work: &'a Work<'a>,
    /// In the direction of the sweep.
    segments: Vec<Segment<'a>>,
    source: &'a dyn DensitySource,
    detector: &'a dyn Detector,
    span: Span,
    options: Goal,
    /// Ascending in the parameter.
    pub(super) points: Vec<Point>,
    /// One a point, in the same order.
    flanks: Vec<Flanks>,
    /// Where cells cannot tell whether a pair of peak and saddle is there: places of observables, and values.
    pub(super) unsure: Vec<(usize, f64)>,
}

impl<'a> Walk<'a> {
    /// Solves values and what lies between them, until every change is as narrow as wanted, with no more between them
    /// than `most`.
    ///
    /// # Errors
    /// [`SweepError`] when a value is not allowed or the observer fails.
    pub(super) fn along(
        work: &'a Work<'a>,
        (values, most): (&[f64], usize),
        (span, options): (Span, Goal),
    ) -> Result<Self, SweepError> {
        let mut walk = Self {
            work,
            segments: Segment::cut(work, values),
            source: work.source(),
            detector: work.detector(),
            span,
            options,
            points: Vec::new(),
            flanks: Vec::new(),
            unsure: Vec::new(),
        };
        walk.walk()?;
        walk.narrow(most.min(walk.most_extra(values.len())))?;
        // Checks are solved in sessions of their own.
        walk.segments.clear();
        Ok(walk)
    }

    /// Solves beyond so many given values at most.
    fn most_extra(&self, values: usize) -> usize {
        let by_number = MOST_EXTRA.max(MOST_EXTRA_A_VALUE * values);
        let cells = self.source.cells().unwrap_or(1).max(1);
        let by_cells = (MOST_EXTRA_CELLS / cells).max(LEAST_EXTRA_A_VALUE * values);
        by_number.min(by_cells)
    }

    /// Solves the given values, and between neighbours that differ much.
    fn walk(&mut self) -> Result<(), SweepError> {
        let segments = self.segments.par_iter_mut();
        let walked: Result<Vec<Vec<SolvedPoint>>, SweepError> =
            segments.map(Segment::walk).collect();
        let mut solved: Vec<SolvedPoint> = walked?.into_iter().flatten().collect();
        sort_ascending(&mut solved, |one| one.point.value);
        for one in solved {
            self.note_unsure(&one);
            self.points.push(one.point);
            self.flanks.push(one.flanks);
        }
        let work = self.work;
        fill_all_distances(&mut self.points, |a, b| work.distance_between(a, b));
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
        let found: Result<Vec<Vec<SolvedPoint>>, SweepError> = found.collect();
        self.keep(found?);
        Ok(())
    }

    fn keep(&mut self, found: Vec<Vec<SolvedPoint>>) {
        for one in found.into_iter().flatten() {
            self.note_unsure(&one);
            let value = one.point.value;
            let place = self.points.partition_point(|point| point.value < value);
            self.flanks.insert(place, one.flanks);
            self.points.insert(place, one.point);
            fill_distances(&mut self.points, place);
        }
    }

    fn note_unsure(&mut self, solved: &SolvedPoint) {
        let value = solved.point.value;
        self.unsure
            .extend(solved.unsure.iter().map(|&place| (place, value)));
    }

    /// Solves further values, at most so many, until every change is as narrow as wanted, or as the data allow.
    fn narrow(&mut self, most: usize) -> Result<(), SweepError> {
        let levels = asked_of(&self.source.subject().family);
        let mut left = most;
        let mut guesses = LEAST_GUESSES.max(self.points.len()).min(most / GUESSED);
        while left > 0 && !self.work.has_ended() {
            let search = Search {
                points: &self.points,
                flanks: &self.flanks,
                detector: self.detector,
                levels: &levels,
                span: self.span,
                options: &self.options,
            };
            let guess = if guesses > 0 { search.guess() } else { None };
            guesses -= usize::from(guess.is_some());
            let mut wanted = guess.map_or_else(|| search.values(), |guess| vec![guess]);
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
        let found: Result<Vec<Vec<SolvedPoint>>, SweepError> = found.collect();
        self.keep(found?);
        Ok(())
    }

    /// The rows, each checked where the source can be, what was seen in the checks, and whether there was no time for
    /// them.
    pub(super) fn labels(
        &self,
        cancellation: &Cancellation,
        mut known: Vec<CheckedIndicator>,
    ) -> Labelled {
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
pub(super) type Labelled = (Vec<Label>, Option<Vec<CheckedIndicator>>, bool);
