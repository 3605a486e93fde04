//! Which values to solve next, so that every change is as narrow as wanted, or as the data allow.

use super::bracket::is_settled;
use super::change::{Change, changes, crossings_at_centre};
use super::dips::{self, Flanks};
use super::follow::{Course, Crossing};
use super::root::{beyond_doubt, next_value, root};
use super::span::Span;
use super::{Goal, Point, levels};
use crate::system::MeasureLevel;
use crate::topology::{Detector, Signature};

/// Steps of the sweep over which an indicator is followed that is lost elsewhere than where the count changes.
const FOLLOWED: f64 = 0.125 * (1.0 + 1e-9);

/// What is known of a sweep when it is asked where to solve next.
pub(super) struct Search<'a> {
    /// Ascending in the parameter.
    pub(super) points: &'a [Point],
    /// One a point, in the same order.
    pub(super) flanks: &'a [Flanks],
    pub(super) detector: &'a dyn Detector,
    pub(super) levels: &'a [MeasureLevel],
    pub(super) span: Span,
    pub(super) options: &'a Goal,
}

impl Search<'_> {
    /// The values to solve next, which may be solved side by side: one a gap at most, since what is found there decides
    /// on the others. None where nothing is wanted any more.
    pub(super) fn values(&self) -> Vec<f64> {
        let solved: Vec<&Point> = (self.points.iter())
            .filter(|point| !point.detections.is_empty())
            .collect();
        let tolerance = self.options.tolerance;
        let at_centre = self.at_centre(&solved);
        let wanted = match at_centre.is_empty() {
            true => self.in_changes(&solved),
            false => at_centre,
        };
        if wanted.is_empty() {
            let level = levels::next_value(self.points, self.levels, tolerance);
            return level
                .filter(|value| self.is_new(value))
                .into_iter()
                .collect();
        }
        self.one_a_gap(wanted)
    }

    /// A value at which two changes may lie between two values that show neither.
    pub(super) fn guess(&self) -> Option<f64> {
        let solved: Vec<&Point> = (self.points.iter())
            .filter(|point| !point.detections.is_empty())
            .collect();
        let dip = dips::at_centre(&solved, self.options.tolerance);
        dip.or_else(|| self.dip_on_flanks())
            .filter(|value| self.is_new(value))
    }

    /// Whether a value is yet to be solved: asked for again, it would give nothing new.
    fn is_new(&self, value: &f64) -> bool {
        self.points.iter().all(|point| point.value != *value)
    }

    /// The first of the values between every two neighbouring points.
    fn one_a_gap(&self, values: Vec<f64>) -> Vec<f64> {
        let mut taken = Vec::new();
        let mut is_free = |value: &f64| {
            let gap = self.points.partition_point(|point| point.value < *value);
            let is_free = !taken.contains(&gap);
            taken.push(gap);
            is_free
        };
        let values = values.into_iter();
        values.filter(|value| is_free(value)).collect()
    }

    /// What narrows the changes of signature.
    fn in_changes(&self, solved: &[&Point]) -> Vec<f64> {
        let tolerance = self.options.tolerance;
        let wanted = |change: &Change| match &change.course {
            Some(course) if self.may_be_another(solved, change, course) => {
                middle_of(solved[change.left], solved[change.left + 1])
            }
            Some(Course::Crossing(crossing)) => {
                next_value(solved, crossing, self.detector.confidence(), tolerance)
            }
            Some(Course::Lost(at, _)) => {
                let (a, b) = (solved[*at], solved[*at + 1]);
                middle_of(a, b).filter(|_| b.value - a.value > tolerance)
            }
            Some(Course::Sunk(_) | Course::Beyond(_)) => None,
            None => {
                let (a, b) = (solved[change.left], solved[change.left + 1]);
                let settled = is_settled(a, b, self.span.step, self.options);
                middle_of(a, b).filter(|_| !settled)
            }
        };
        let changes = changes(solved, self.detector);
        let values = changes.iter().filter_map(wanted);
        values.filter(|value| self.is_new(value)).collect()
    }

    /// Whether an indicator that is lost elsewhere than where the count changes may be another feature's: the count
    /// changes between values so far apart that its place cannot be followed from one to the other.
    fn may_be_another(&self, solved: &[&Point], change: &Change, course: &Course) -> bool {
        let Course::Lost(last, _) = course else {
            return false;
        };
        let is_there = (change.left..change.right).contains(last);
        // On rings and moats cells count what is theirs.
        let is_plain = |one: &Signature| one.craters == 0 && one.rings == 0;
        let is_plain = is_plain(&change.before) && is_plain(&change.after);
        let width = solved[change.right].value - solved[change.left].value;
        let is_wide = width > FOLLOWED * self.span.step && width > self.options.tolerance;
        is_plain && !is_there && change.right == change.left + 1 && is_wide
    }

    /// A value between, at which a pair of peak and valley may be there, or not be there, for a while.
    fn dip_on_flanks(&self) -> Option<f64> {
        let pairs = self.points.iter().zip(self.flanks);
        let solved: Vec<(&Point, &Flanks)> = pairs
            .filter(|(point, _)| !point.detections.is_empty())
            .collect();
        let tolerance = self.options.tolerance;
        dips::between_flanks(&solved, tolerance)
            .or_else(|| dips::between_leaps(&solved, tolerance))
            .or_else(|| dips::beside_centre(&solved, tolerance))
            .or_else(|| dips::on_flanks(&solved, tolerance))
    }

    /// What narrows the changes of sign at centres of symmetry, and shows the stage between two of them.
    fn at_centre(&self, solved: &[&Point]) -> Vec<f64> {
        let of_all = crossings_at_centre(solved);
        let wanted = of_all
            .iter()
            .flat_map(|crossings| self.of_centre(solved, crossings));
        wanted.collect()
    }

    /// The same of the centre of one observable.
    fn of_centre(&self, solved: &[&Point], crossings: &[Crossing]) -> Vec<f64> {
        let (confidence, tolerance) = (self.detector.confidence(), self.options.tolerance);
        let narrower = crossings
            .iter()
            .filter_map(|crossing| next_value(solved, crossing, confidence, tolerance));
        let narrower: Vec<f64> = narrower.filter(|value| self.is_new(value)).collect();
        if !narrower.is_empty() {
            return narrower;
        }
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
        let unseen: Vec<f64> = roots.windows(2).filter_map(unseen).collect();
        if !unseen.is_empty() {
            return unseen;
        }
        let mut settled = crossings.iter();
        let beside = settled.find_map(|one| beyond_doubt(solved, one, self.detector, tolerance));
        beside
            .filter(|value| self.is_new(value))
            .into_iter()
            .collect()
    }
}

/// The value in the middle of two points, if there is one between them.
fn middle_of(a: &Point, b: &Point) -> Option<f64> {
    let middle = 0.5 * (a.value + b.value);
    (a.value < middle && middle < b.value).then_some(middle)
}
