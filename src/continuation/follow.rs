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
    /// It is lost between the point with this index and the next one, before it changes sign, which its last two
    /// readings say that it does before this value.
    Lost(usize, f64),
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
    let within = inward(points, present, event.above).next();
    let within = within.and_then(|index| Some((index, at(index, &last.place)?)));
    let mut before = within.filter(|(_, one)| is_one_place(points, observable, &last, one));
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
                Course::Lost(gap, leads_to(points, (last_index, &last), before.as_ref()))
            } else {
                Course::Sunk(gap)
            });
        };
        // As long as the feature is not counted, what is counted has a shoulder of its own.
        let is_absent = signature(index) == signature(absent);
        if next.value > 0.0 && is_absent && is_between_counted(points[index], observable, &next) {
            return Some(Course::Lost(
                gap,
                leads_to(points, (last_index, &last), before.as_ref()),
            ));
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
        before = Some((last_index, std::mem::replace(&mut last, next)));
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
    let (mut last, mut last_index) = (first, present);
    for index in inward(points, present, above) {
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

/// The points from one where a feature is present away from its change, nearest first.
fn inward(points: &[&Point], present: usize, above: bool) -> impl Iterator<Item = usize> {
    let count = if above {
        points.len() - 1 - present
    } else {
        present
    };
    (1..=count).map(move |steps| {
        if above {
            present + steps
        } else {
            present - steps
        }
    })
}

/// The value before which an indicator passes zero, from its last reading and the one before. The error of the last
/// reading, which the one before shares, is on the far side. Where it does not fall, it leads nowhere.
fn leads_to(
    points: &[&Point],
    (last, reading): (usize, &Indicator),
    before: Option<&(usize, Indicator)>,
) -> f64 {
    let value = points[last].value;
    let error = reading.systematic_error + 2.0 * reading.sampling_error;
    let zero = before.and_then(|(index, one)| {
        let readings = [(value, reading.value), (points[*index].value, one.value)];
        zero_of_power(readings.map(|(at, value)| (at, value + error)))
    });
    zero.unwrap_or(value)
}

/// Where the line through the powers 2/3 of two readings meets zero, the last reading first; `None` where they do not
/// fall. Beside a symmetric split off the axis an indicator goes like the power 3/2 of the distance, and its zero is
/// there; beside a fold it goes like the distance, and its zero is nearer.
fn zero_of_power([last, before]: [(f64, f64); 2]) -> Option<f64> {
    let [low, high] = [last.1, before.1].map(|value| value.max(0.0).powf(2.0 / 3.0));
    (low < high).then(|| last.0 - low * (before.0 - last.0) / (high - low))
}

/// Whether two readings at neighbouring points may be of one place that moved.
fn is_one_place(points: &[&Point], observable: usize, a: &Indicator, b: &Indicator) -> bool {
    let axes = &points[0].densities[observable].density.axes;
    let moved = a.place.iter().zip(&b.place).zip(axes);
    let apart = moved.map(|((&a, &b), axis)| (axis.apart(a, b) / (axis.to() - axis.from())).abs());
    apart.fold(0.0, f64::max) <= ONE_PLACE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_powers_meets_the_zero_of_a_split_and_passes_that_of_a_fold() {
        // Both vanish at 0.25, and were read above it, or below it.
        for side in [1.0, -1.0] {
            let read =
                |distance: f64, power: f64| (0.25 + side * distance, 7.0 * distance.powf(power));
            let zero = |power: f64| zero_of_power([read(0.01, power), read(0.04, power)]).unwrap();
            assert!((zero(1.5) - 0.25).abs() < 1e-14);
            assert!((zero(1.0) - 0.25) * side < -0.005);
            assert!(zero_of_power([read(0.04, 1.0), read(0.01, 1.0)]).is_none());
        }
    }
}
