//! Changes of signature between neighbouring points, and the indicator that decides each.
//!
//! A signature changes where a feature passes what noise and floor allow, or where an indicator changes sign. The
//! indicator's own change of sign is the bifurcation: at a centre of symmetry, or at the place where a feature is born.
//! Several features may change between the same two points; each is a change of its own.

use super::Point;
use super::events::{self, Event, events};
use super::follow::{Course, Crossing, follow};
use super::grid::Counts;
use super::level_points::without_level;
use super::root::root;
use crate::numerics::sort_ascending;
use crate::topology::{Detector, FeatureKind, Indicator, IndicatorKind, Signature};

/// A change of one observable's signature between two neighbouring points.
#[derive(Debug, Clone)]
pub(super) struct Change {
    /// Place of the observable among those that are watched.
    pub(super) observable: usize,
    /// The point below.
    pub(super) left: usize,
    /// The point above: the next one, or the next whose signature was seen whole.
    pub(super) right: usize,
    pub(super) before: Signature,
    pub(super) after: Signature,
    /// How its indicator passes zero; `None` where only persistence tells.
    pub(super) course: Option<Course>,
    /// The feature that appears or vanishes; `None` where the change is that of a centre, or of no single feature.
    pub(super) event: Option<Event>,
}

impl Change {
    /// What may be counted beside its zero.
    pub(super) fn counts(&self) -> Counts {
        let absent = |event: &Event| if event.above { self.before } else { self.after };
        Counts {
            both: [self.before, self.after],
            absent: self.event.as_ref().map(absent),
        }
    }

    /// Whether numbers of peaks, craters and rings differ by one at most.
    pub(super) fn is_single(&self) -> bool {
        let counts = |one: &Signature| [one.peaks, one.craters, one.rings];
        let pairs = counts(&self.before).into_iter().zip(counts(&self.after));
        let mut apart = pairs.map(|(before, after)| before.abs_diff(after));
        apart.all(|apart| apart <= 1)
    }

    /// The signature that this change alone makes of another.
    pub(super) fn step(&self, before: Signature) -> Signature {
        let Some(event) = &self.event else {
            return self.after;
        };
        let moved = |count: usize| match event.above {
            true => count + 1,
            false => count.saturating_sub(1),
        };
        let mut after = before;
        if event.is_at_natural_end() {
            after.at_ends = moved(before.at_ends);
        }
        match event.feature {
            FeatureKind::Peak => after.peaks = moved(before.peaks),
            FeatureKind::Crater => after.craters = moved(before.craters),
            FeatureKind::Ring => {
                after.rings = moved(before.rings);
                after.craters = moved(before.craters);
            }
            FeatureKind::Valley => {}
        }
        if event.was_peak {
            after.peaks = match event.above {
                true => before.peaks.saturating_sub(1),
                false => before.peaks + 1,
            };
        }
        after.enclosed_peaks = match after.craters {
            0 => 0,
            _ => after.enclosed_peaks.min(after.peaks),
        };
        after
    }

    pub(super) fn crossing(&self) -> Option<&Crossing> {
        match &self.course {
            Some(Course::Crossing(crossing)) => Some(crossing),
            _ => None,
        }
    }
}

/// All changes along points that are solved, in ascending parameter.
pub(super) fn changes(points: &[&Point], detector: &dyn Detector) -> Vec<Change> {
    let observables = points.first().map_or(0, |point| point.detections.len());
    let mut found = Vec::new();
    for observable in 0..observables {
        let at = |index: usize| &points[index].detections[observable];
        // A signature of which a part was not seen is compared only where the sweep ends with it.
        let last = points.len().saturating_sub(1);
        let seen: Vec<usize> = (0..points.len())
            .filter(|&index| at(index).is_seen || index == 0 || index == last)
            .collect();
        let seen = without_level(seen, points, observable);
        for pair in seen.windows(2) {
            if at(pair[0]).signature != at(pair[1]).signature {
                found.extend(between(points, detector, observable, (pair[0], pair[1])));
            }
        }
    }
    one_change_a_zero(&mut found, points);
    found
}

/// Leaves a zero to one change alone, the first of those that are nearest to it: there one pair comes or goes. What an
/// inflection that was lost was followed to in place of it is the zero of another.
fn one_change_a_zero(changes: &mut [Change], points: &[&Point]) {
    let claim = |change: &Change| {
        let crossing = change.crossing()?;
        let event = change.event.as_ref()?;
        let zero = (change.observable, crossing.left, crossing.kind());
        Some((zero, crossing.ends[0].place.clone(), event.above))
    };
    let distance = |change: &Change| {
        let at = change.crossing().map_or(0, |crossing| crossing.left);
        change.left.saturating_sub(at) + (at + 1).saturating_sub(change.right)
    };
    let claims: Vec<_> = changes
        .iter()
        .map(|one| (claim(one), distance(one)))
        .collect();
    for (number, (change, (own, away))) in changes.iter_mut().zip(&claims).enumerate() {
        let Some((zero, place, above)) = own else {
            continue;
        };
        let axes = &points[zero.1].densities[change.observable].density.axes;
        // What leads to one zero from two sides meets it but for rounding.
        let is_same = |claim: &Option<(_, Vec<f64>, bool)>| {
            claim.as_ref().is_some_and(|other| {
                (&other.0, &other.2) == (zero, above)
                    && events::distance(&other.1, place, axes) < ONE_ZERO
            })
        };
        let is_taken = |(place, (other, nearer)): (usize, &(_, usize))| {
            is_same(other) && (*nearer, place) < (*away, number)
        };
        if claims.iter().enumerate().any(is_taken) {
            change.course = None;
        }
    }
}

/// The changes between two points whose signatures differ, of which a part was not seen in between; at least one.
fn between(
    points: &[&Point],
    detector: &dyn Detector,
    observable: usize,
    (left, right): (usize, usize),
) -> Vec<Change> {
    let signature = |index: usize| points[index].detections[observable].signature;
    let change = |course: Option<Course>, event: Option<Event>| Change {
        observable,
        left,
        right,
        before: signature(left),
        after: signature(right),
        course,
        event,
    };
    let mut events = events(points[left], points[right], observable);
    let mut found = Vec::new();
    let mut centre: Vec<Crossing> = (left..right)
        .filter_map(|index| at_centre(points, observable, index))
        .collect();
    // Where rings open or merge at a state of rest, curvatures at the centre touch zero, and errors may turn their
    // signs for a moment.
    let levels = [false, true].map(IndicatorKind::level);
    let at_rest = |event: &Event| {
        let indicator = event.indicator.as_ref();
        indicator.is_some_and(|(kind, _)| levels.contains(kind))
    };
    if events.iter().any(at_rest) {
        centre.clear();
    } else if centre.is_empty() {
        centre.extend(doubtful_centre(points, detector, observable, (left, right)));
    }
    if !centre.is_empty() {
        take_those_of_centre(&mut events, &signature(left), &signature(right));
        found.extend(centre.into_iter().map(|crossing| {
            let course = Course::Crossing(Box::new(crossing));
            change(Some(course), None)
        }));
    }
    for event in events {
        let course = decisive(points, detector, observable, (left, right), &event);
        // What no indicator tells of has a row of its own: else the next one would have its change of the count too.
        if course.is_some() || event.indicator.is_none() {
            found.push(change(course, Some(event)));
        }
    }
    if found.is_empty() {
        found.push(change(None, None));
    }
    found
}

/// What follows an event. A critical point that stays, on a line of symmetry, goes before a fold, but where a force
/// bends between it and its saddle: curvatures jump there, and what passes zero is the slope. Where counts follow from
/// the equations, a change of sign at which the count stays is another event's: a peak that was born on a flank before
/// it reaches a kink. Then its inflection is followed in place of the kink. Where the slope between a peak and the
/// valley that it merges with does not change its sign, that on the peak's other side may, and the curvature where
/// peaks merge.
fn decisive(
    points: &[&Point],
    detector: &dyn Detector,
    observable: usize,
    gap: (usize, usize),
    event: &Event,
) -> Option<Course> {
    let follow = |event: &Event| follow(points, detector, observable, gap, event);
    let crossing = |event: &Event| {
        let course = follow(event);
        course.filter(|course| matches!(course, Course::Crossing(_)))
    };
    let is_across_bend = event.is_across_bend(&points[gap.0].densities[observable]);
    let across = is_across_bend.then(|| crossing(event)).flatten();
    let special = across.or_else(|| event.at_symmetry().iter().find_map(crossing));
    if special.is_some() {
        return special;
    }
    let mut first = follow(event);
    if !matches!(first, Some(Course::Crossing(_))) {
        let present = points[if event.above { gap.1 } else { gap.0 }];
        let flank = event.on_other_flank(present, observable);
        let mut others = flank
            .into_iter()
            .chain(event.at_merger(present, observable));
        first = others.find_map(|other| crossing(&other)).or(first);
    }
    let is_exact = |index: usize| {
        let density = &points[index].densities[observable];
        density.structure.profile.is_some()
    };
    match is_exact(gap.0) && is_exact(gap.1) {
        true => where_count_changes(points, detector, observable, gap, event, first),
        false => first,
    }
}

/// What follows an event where counts follow from the equations: what was followed first, if the count changes with it,
/// or the inflection beside the kink. A pair exists as long as the density rises anywhere between its peak and its
/// valley, at the kink or beside it: where the count changes with both between the same two points, the one that keeps
/// the pair longer decides. (Farther apart they belong to two pairs.)
fn where_count_changes(
    points: &[&Point],
    detector: &dyn Detector,
    observable: usize,
    gap: (usize, usize),
    event: &Event,
    first: Option<Course>,
) -> Option<Course> {
    let holds = |found: &Option<Course>| match found {
        Some(Course::Crossing(crossing)) => separates(points, crossing, event.above),
        _ => false,
    };
    let is_held = holds(&first);
    let Some(other) = event.at_inflection() else {
        return first.filter(|_| is_held);
    };
    let second = follow(points, detector, observable, gap, &other);
    match (is_held, holds(&second), first, second) {
        (true, true, Some(Course::Crossing(kink)), Some(Course::Crossing(inflection)))
            if kink.left == inflection.left =>
        {
            let at = |one: &Crossing| root(points, one, detector.confidence()).value;
            let is_longer = (at(&inflection) < at(&kink)) == event.above;
            Some(Course::Crossing(if is_longer { inflection } else { kink }))
        }
        (true, _, first, _) => first,
        (false, true, _, second) => second,
        (false, false, Some(Course::Crossing(_)), _) => None,
        (false, false, first, _) => first,
    }
}

/// Whether the count changes where an indicator does. So near to its zero that its peak is lower than rounding, the
/// count may come a point late.
fn separates(points: &[&Point], crossing: &Crossing, above: bool) -> bool {
    let signature = |index: usize| {
        let detection = points.get(index)?.detections.get(crossing.observable)?;
        Some(detection.signature)
    };
    let (left, right) = (crossing.left, crossing.left + 1);
    let late = match above {
        true => Some(right + 1),
        false => left.checked_sub(1),
    };
    let [low, high] = crossing.ends.each_ref().map(|end| end.value.abs());
    let is_near = if above {
        high < NEAR_ZERO * low
    } else {
        low < NEAR_ZERO * high
    };
    let next = late.and_then(signature);
    signature(left) != signature(right) || (is_near && next.is_some() && next != signature(left))
}

/// Distance in units of the ranges within which places of an indicator are one.
const ONE_ZERO: f64 = 1e-4;

/// Share of its value at the other end of a bracket from which on an indicator is next to zero.
const NEAR_ZERO: f64 = 1e-2;

/// Takes away the events that a change at the centre explains: it makes one peak two, or closes one crater. Counts that
/// change by more have other causes beside it.
fn take_those_of_centre(events: &mut Vec<Event>, before: &Signature, after: &Signature) {
    let others = before.peaks.abs_diff(after.peaks) > 1
        || before.craters.abs_diff(after.craters) > 1
        || before.rings.abs_diff(after.rings) > 1;
    if !others {
        events.clear();
        return;
    }
    sort_ascending(events, |one| one.from_centre);
    let explained = events.len().min(2);
    events.drain(..explained);
}

/// An indicator of the centre that changes sign between two neighbours. A value of zero counts with the side below.
fn at_centre(points: &[&Point], observable: usize, left: usize) -> Option<Crossing> {
    let (a, b) = (points.get(left)?, points.get(left + 1)?);
    let pairs = a.detections[observable].indicators.iter();
    pairs
        .zip(&b.detections[observable].indicators)
        .find(|(a, b)| a.kind == b.kind && changes_sign(a, b))
        .map(|(a, b)| Crossing {
            observable,
            left,
            ends: [a.clone(), b.clone()],
        })
}

fn changes_sign(a: &Indicator, b: &Indicator) -> bool {
    (a.value <= 0.0) != (b.value <= 0.0)
}

/// The nearest change of sign at the centre, when all points on the way to it leave the sign in doubt.
fn doubtful_centre(
    points: &[&Point],
    detector: &dyn Detector,
    observable: usize,
    (left, right): (usize, usize),
) -> Option<Crossing> {
    let doubtful = |index: usize| {
        let indicators = &points[index].detections[observable].indicators;
        let unsure = |one: &Indicator| one.sign(detector.doubt()).is_none();
        indicators.iter().any(unsure)
    };
    let below = (0..=left).rev().take_while(|&index| doubtful(index));
    let above = (right..points.len()).take_while(|&index| doubtful(index));
    let below = below.filter_map(|index| at_centre(points, observable, index.checked_sub(1)?));
    let above = above.filter_map(|index| at_centre(points, observable, index));
    below
        .chain(above)
        .min_by_key(|found| found.left.abs_diff(left))
}

/// Every change of sign of an indicator at a centre between neighbours, of densities without sampling errors: by
/// observable, ascending. (Noise changes signs often; there signatures say which of them matter.)
pub(super) fn crossings_at_centre(points: &[&Point]) -> Vec<Vec<Crossing>> {
    let observables = points.first().map_or(0, |point| point.detections.len());
    let of = |observable: usize| {
        let pairs = (0..points.len().saturating_sub(1)).flat_map(move |left| {
            let [a, b] = [left, left + 1].map(|at| &points[at].detections[observable].indicators);
            a.iter().zip(b).map(move |(a, b)| (left, a, b))
        });
        pairs
            .filter(|(_, a, b)| a.kind == b.kind && changes_sign(a, b))
            .filter(|(_, a, b)| a.sampling_error == 0.0 && b.sampling_error == 0.0)
            .map(|(left, a, b)| Crossing {
                observable,
                left,
                ends: [a.clone(), b.clone()],
            })
            .collect()
    };
    (0..observables).map(of).collect()
}
