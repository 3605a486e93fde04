//! An indicator away from any centre, followed from the point where its feature is present to where it changes sign.

use super::Point;
use super::events::Event;
use super::flank::is_between_counted;
use crate::topology::{Detector, Indicator, IndicatorKind, is_clear};

/// Places of an indicator at neighbouring points farther apart than this, in ranges, are not one place that moved.
const ONE_PLACE: f64 = 0.1;

/// Times its error that a density must be where an indicator that is lost tells that there is none.
pub(super) const WELL: f64 = 10.0;

/// A change of sign of an indicator between two neighbouring points.
#[derive(Debug, Clone)]
pub(super) struct Crossing {
    /// Place of the observable among those that are watched.
    pub(super) observable: usize,
    /// The point below; the next one is the point above.
    pub(super) left: usize,
    /// The indicator at both.
    pub(super) ends: [Indicator; 2],
}

impl Crossing {
    pub(super) fn kind(&self) -> IndicatorKind {
        self.ends[0].kind
    }
}

/// How an indicator goes that is followed from where its feature is present.
#[derive(Debug, Clone)]
pub(super) enum Course {
    /// It changes sign between two neighbours.
    Crossing(Box<Crossing>),
    /// It is lost between the point with this index and the next one, before it changes sign.
    Lost(usize),
    /// From the point with this index or the next one on the density there is no clear multiple of its error, before
    /// the indicator changes sign: nothing tells how far it keeps its sign.
    Sunk(usize),
    /// It keeps its sign up to the end of the sweep, the point with this index or the next one.
    Beyond(usize),
}

/// Follows the indicator of an event between two points toward the side where the feature is absent; `None` where the
/// event has none.
pub(super) fn follow(
    points: &[&Point],
    detector: &dyn Detector,
    observable: usize,
    (left, right): (usize, usize),
    event: &Event,
) -> Option<Course> {
    let (kind, near) = event.indicator.as_ref()?;
    let at = |index: usize, near: &[f64]| {
        let density = &points[index].densities[observable];
        detector.indicator(density, *kind, near)
    };
    // From the side where the feature is, outward.
    let (present, absent) = if event.above {
        (right, left)
    } else {
        (left, right)
    };
    let signature = |index: usize| &points[index].detections[observable].signature;
    let outward: Vec<usize> = if event.above {
        (0..right).rev().collect()
    } else {
        (left + 1..points.len()).collect()
    };
    let Some(mut last) = at(present, near) else {
        let is_clear = is_clear(&points[present].densities[observable], near, WELL);
        return (!is_clear).then_some(Course::Sunk(left));
    };
    let mut last_index = present;
    if last.value <= 0.0 {
        return deeper(points, &at, last, present, event.above, observable);
    }
    for index in outward {
        let gap = index.min(last_index);
        let Some(next) =
            at(index, &last.place).filter(|next| is_one_place(points, observable, &last, next))
        else {
            let is_clear = is_clear(&points[index].densities[observable], &last.place, WELL);
            return Some(if is_clear {
                Course::Lost(gap)
            } else {
                Course::Sunk(gap)
            });
        };
        // As long as the feature is not counted, what is counted has a shoulder of its own.
        let is_absent = signature(index) == signature(absent);
        if next.value > 0.0 && is_absent && is_between_counted(points[index], observable, &next) {
            return Some(Course::Lost(gap));
        }
        if next.value <= 0.0 {
            let ends = if event.above {
                [next, last]
            } else {
                [last, next]
            };
            return Some(Course::Crossing(Box::new(Crossing {
                observable,
                left: gap,
                ends,
            })));
        }
        last = next;
        last_index = index;
    }
    let certain = last.sign(detector.doubt()) == Some(true);
    let end = if event.above {
        0
    } else {
        points.len().checked_sub(2)?
    };
    certain.then_some(Course::Beyond(end))
}

/// The zero lies on the side where the feature was seen: noise of the cells showed it too early.
fn deeper(
    points: &[&Point],
    at: &dyn Fn(usize, &[f64]) -> Option<Indicator>,
    first: Indicator,
    present: usize,
    above: bool,
    observable: usize,
) -> Option<Course> {
    let inward: Vec<usize> = if above {
        (present + 1..points.len()).collect()
    } else {
        (0..present).rev().collect()
    };
    let (mut last, mut last_index) = (first, present);
    for index in inward {
        let next =
            at(index, &last.place).filter(|next| is_one_place(points, observable, &last, next))?;
        if next.value > 0.0 {
            let ends = if above { [last, next] } else { [next, last] };
            return Some(Course::Crossing(Box::new(Crossing {
                observable,
                left: index.min(last_index),
                ends,
            })));
        }
        last = next;
        last_index = index;
    }
    None
}

/// Whether two readings at neighbouring points may be of one place that moved.
fn is_one_place(points: &[&Point], observable: usize, a: &Indicator, b: &Indicator) -> bool {
    let axes = &points[0].densities[observable].density.axes;
    let moved = a.place.iter().zip(&b.place).zip(axes);
    let apart = moved.map(|((&a, &b), axis)| (axis.apart(a, b) / (axis.to() - axis.from())).abs());
    apart.fold(0.0, f64::max) <= ONE_PLACE
}
