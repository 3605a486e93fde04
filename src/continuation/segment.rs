//! Segments of a sweep: stretches of its given values, each with a session of its own, solved side by side.
//!
//! How many there are follows from the values and the source, and what is solved in one from that one alone: results
//! are the same on any number of threads.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use super::known_points::KnownPoints;
use super::solved_point::SolvedPoint;
use super::{DensitySource, Observer, Point, Session, SourceError, SweepError};
use crate::cancellation::Cancellation;
use crate::topology::Detector;

/// How often a step between given values is halved at most, where densities change fast.
const HALVINGS: usize = 4;

/// What the segments of a sweep share.
pub(super) struct Work<'a> {
    source: &'a dyn DensitySource,
    detector: &'a dyn Detector,
    cancellation: &'a Cancellation,
    /// Between neighbours; beyond, a value between is solved too.
    largest_distance: f64,
    /// The value that the source must not refuse.
    first: Option<f64>,
    told: Mutex<Listener<'a>>,
    /// Whether values were left out because the sweep is to end.
    ended: AtomicBool,
    /// Whether it is of no use without all of its values.
    needs_all: bool,
    /// What is not to be solved again.
    known: KnownPoints,
}

/// Whom points are told.
struct Listener<'a> {
    observer: &'a mut dyn Observer,
    done: usize,
    /// Given values that are not done.
    remaining: usize,
}

impl<'a> Work<'a> {
    pub(super) fn new(
        (source, detector): (&'a dyn DensitySource, &'a dyn Detector),
        cancellation: &'a Cancellation,
        (observer, planned): (&'a mut dyn Observer, usize),
        largest_distance: f64,
        first: Option<f64>,
    ) -> Self {
        Self {
            source,
            detector,
            cancellation,
            largest_distance,
            first,
            told: Mutex::new(Listener {
                observer,
                done: 0,
                remaining: planned,
            }),
            ended: AtomicBool::new(false),
            needs_all: false,
            known: KnownPoints::default(),
        }
    }

    /// The same where some points are known.
    pub(super) fn knowing(self, known: KnownPoints) -> Self {
        Self { known, ..self }
    }

    /// The same, ended by the first value that has no steady state.
    pub(super) fn needing_all(self) -> Self {
        Self {
            needs_all: true,
            ..self
        }
    }

    pub(super) fn source(&self) -> &'a dyn DensitySource {
        self.source
    }

    pub(super) fn detector(&self) -> &'a dyn Detector {
        self.detector
    }

    /// Whether the sweep is to end, so that values are left out from now on.
    fn ends(&self) -> bool {
        if self.cancellation.is_cancelled() {
            self.ended.store(true, Ordering::Relaxed);
        }
        self.has_ended()
    }

    /// Whether values were left out because the sweep was to end.
    pub(super) fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }

    /// Solves one value and tells the observer; `before` is a neighbour. `None` where the sweep is to end.
    fn solve(
        &self,
        session: &mut dyn Session,
        (value, is_given): (f64, bool),
        before: Option<&Point>,
    ) -> Result<Option<SolvedPoint>, SweepError> {
        if self.ends() {
            return Ok(None);
        }
        if let Some(mut known) = self.known.take(value) {
            known.point.distance = self.distance_to(before, &known.point);
            self.tell(&known.point, is_given)?;
            return Ok(Some(known));
        }
        let method = self.source.method();
        let Some((mut point, refusal)) = Point::solve(session, method, self.detector, value) else {
            self.ended.store(true, Ordering::Relaxed);
            return Ok(None);
        };
        // One value that fails takes nothing from the others; a first one that does is a mistake.
        if let Some(error) = refusal.filter(|_| self.first == Some(value)) {
            self.ended.store(true, Ordering::Relaxed);
            return Err(SweepError::Source {
                parameter: self.source.subject().family.parameter().to_owned(),
                value,
                source: SourceError::Method(error),
            });
        }
        point.distance = self.distance_to(before, &point);
        if self.needs_all && !point.report.status.is_resolved() {
            self.ended.store(true, Ordering::Relaxed);
        }
        let solved = SolvedPoint::new(point, self.detector);
        self.tell(&solved.point, is_given)?;
        Ok(Some(solved))
    }

    /// Largest Hellinger distance over the watched densities of two points; `None` when one has none.
    pub(super) fn distance_between(&self, a: &Point, b: &Point) -> Option<f64> {
        self.known.distance_between(a, b)
    }

    /// The same to a neighbour, where that is below.
    fn distance_to(&self, before: Option<&Point>, point: &Point) -> Option<f64> {
        let below = before.filter(|before| before.value < point.value);
        below.and_then(|below| self.distance_between(below, point))
    }

    /// Tells the observer of a stretch that is swept again on finer cells.
    pub(super) fn tell_of_closer_look(&self, stretch: [f64; 2]) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        told.observer.closer_look(stretch);
    }

    /// Tells the observer of a point. Nothing that is done with the lock held waits for another thread.
    fn tell(&self, point: &Point, is_given: bool) -> Result<(), SweepError> {
        // A poisoned lock holds counts as whole as any other.
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        told.done += 1;
        told.remaining -= usize::from(is_given);
        let (done, remaining) = (told.done, told.remaining);
        let heard = told.observer.point(point, done, remaining);
        heard.map_err(|error| {
            self.ended.store(true, Ordering::Relaxed);
            SweepError::Observer(error)
        })
    }
}

/// Neighbouring given values and the session that solves them, and whatever lies between.
pub(super) struct Segment<'a> {
    work: &'a Work<'a>,
    session: Box<dyn Session>,
    /// In the direction of the sweep; at least one.
    given: Vec<f64>,
    /// Whether the sweep begins with it.
    is_first: bool,
}

impl<'a> Segment<'a> {
    /// Cuts given values into as many segments as the source says.
    pub(super) fn cut(work: &'a Work<'a>, values: &[f64]) -> Vec<Self> {
        let segments = work
            .source
            .segments(values.len())
            .clamp(1, values.len().max(1));
        let border = |number: usize| number * values.len() / segments;
        let segment = |number: usize| Self {
            work,
            session: work.source.open(work.cancellation),
            given: values[border(number)..border(number + 1)].to_vec(),
            is_first: number == 0,
        };
        (0..segments).map(segment).collect()
    }

    /// First and last of its given values, in the direction of the sweep.
    pub(super) fn ends(&self) -> Option<[f64; 2]> {
        Some([*self.given.first()?, *self.given.last()?])
    }

    /// How far from its given values another one is.
    pub(super) fn distance_to(&self, value: f64) -> f64 {
        self.ends().map_or(f64::INFINITY, |[a, b]| {
            (value - value.clamp(a.min(b), a.max(b))).abs()
        })
    }

    /// Solves its given values from the middle outward, so that what is left of the first solve serves both halves, and
    /// between neighbours that differ much. The first segment is walked from where the sweep begins: a sweep that
    /// cannot begin is told early.
    pub(super) fn walk(&mut self) -> Result<Vec<SolvedPoint>, SweepError> {
        let start = match self.is_first {
            true => 0,
            false => self.given.len() / 2,
        };
        let mut solved: Vec<SolvedPoint> = Vec::with_capacity(self.given.len());
        let forward = (start..self.given.len()).enumerate();
        let forward = forward.map(|(step, place)| (place, step > 0));
        let backward = (0..start).rev().map(|place| (place, true));
        let mut last = 0;
        for (place, has_neighbour) in forward.chain(backward) {
            // The walk goes back to where it began.
            if place + 1 == start {
                last = 0;
            }
            let neighbour = solved.get(last).filter(|_| has_neighbour);
            let before = neighbour.map(|one| &one.point);
            let given = (self.given[place], true);
            let Some(found) = self.work.solve(self.session.as_mut(), given, before)? else {
                break;
            };
            let between = match before {
                Some(before) => between(
                    self.work,
                    self.session.as_mut(),
                    [before, &found.point],
                    HALVINGS,
                )?,
                None => Vec::new(),
            };
            last = solved.len();
            solved.push(found);
            solved.extend(between);
        }
        Ok(solved)
    }

    /// Solves between two neighbours, as far as their densities differ much.
    pub(super) fn follow(&mut self, ends: [&Point; 2]) -> Result<Vec<SolvedPoint>, SweepError> {
        between(self.work, self.session.as_mut(), ends, HALVINGS)
    }

    /// Solves further values, one after the other.
    pub(super) fn solve(&mut self, values: &[f64]) -> Result<Vec<SolvedPoint>, SweepError> {
        let solve = |&value| {
            let solved = self.work.solve(self.session.as_mut(), (value, false), None);
            solved.transpose()
        };
        values.iter().filter_map(solve).collect()
    }
}

/// Solves between two neighbours whose densities differ by more than wanted.
fn between(
    work: &Work<'_>,
    session: &mut dyn Session,
    [a, b]: [&Point; 2],
    halvings: usize,
) -> Result<Vec<SolvedPoint>, SweepError> {
    let distance = work.distance_between(a, b).unwrap_or(0.0);
    let middle = 0.5 * (a.value + b.value);
    let is_wide = distance > work.largest_distance && middle != a.value && middle != b.value;
    if halvings == 0 || !is_wide {
        return Ok(Vec::new());
    }
    let below = if a.value < b.value { a } else { b };
    let Some(found) = work.solve(session, (middle, false), Some(below))? else {
        return Ok(Vec::new());
    };
    let mut solved = between(work, session, [a, &found.point], halvings - 1)?;
    solved.extend(between(work, session, [&found.point, b], halvings - 1)?);
    solved.push(found);
    Ok(solved)
}
