//! The check of a located value on a finer grid.
//!
//! The indicator's zero on the finer grid is found by a secant that starts with the slope known from the coarser one. The
//! finer value is the better one and is kept. With r times as many cells an axis and order p its error is 1/(rᵖ - 1) of the
//! distance between both; a bound for all r from 1.25 and p from 2 on is stated.

use super::root::Root;
use super::span::Span;
use super::{Session, SourceError};
use crate::topology::{Detector, IndicatorKind};

/// Error of the finer value over its distance to the coarser one: 1/(1.25² - 1).
pub(super) const SHARE_OF_DISTANCE: f64 = 1.0 / (1.25 * 1.25 - 1.0);
/// Solves on the finer grid for one value.
const MOST_SOLVES: usize = 4;
/// A step below this share of the tolerance ends the search.
const SMALL: f64 = 0.02;

/// What a finer grid says of a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum GridCheck {
    /// The change lies here.
    Confirmed(f64),
    /// There is none near.
    Unconfirmed,
}

/// The indicator on the finer grid at one value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Seen {
    /// Its value.
    Value(f64),
    /// There is no such indicator, or no density.
    Absent,
    /// The source was asked to stop, or it is not known.
    Unknown,
}

impl Seen {
    /// What is kept of it.
    pub(super) fn record(self, checked: &Checked<'_>, value: f64) -> Option<FinerIndicator> {
        let indicator = match self {
            Self::Value(indicator) => Some(indicator),
            Self::Absent => None,
            Self::Unknown => return None,
        };
        Some(FinerIndicator {
            value,
            observable: checked.observable,
            kind: checked.kind.name().to_owned(),
            place: checked.place.to_vec(),
            indicator,
        })
    }
}

/// An indicator that was seen on the finer grid, from which the check is repeated without solving.
#[derive(Debug, Clone, PartialEq)]
pub struct FinerIndicator {
    /// The parameter's value.
    pub value: f64,
    /// Place of the observable in [`super::Subject::observables`].
    pub observable: usize,
    /// Name of the indicator.
    pub kind: String,
    /// Where it was looked for, one coordinate an axis of the density.
    pub place: Vec<f64>,
    /// Its value; `None` if there was none.
    pub indicator: Option<f64>,
}

/// What is checked.
pub(super) struct Checked<'a> {
    /// Place of the observable among those that are watched.
    pub(super) observable: usize,
    pub(super) kind: IndicatorKind,
    pub(super) place: &'a [f64],
    pub(super) root: Root,
}

/// What was seen of an indicator at a value before. Several rows may ask for the same, and a solve from another start differs
/// by rounding.
pub(super) fn known(seen: &[FinerIndicator], checked: &Checked<'_>, value: f64) -> Seen {
    let found = seen.iter().find(|one| {
        one.value == value
            && one.observable == checked.observable
            && one.kind == checked.kind.name()
            && one.place == checked.place
    });
    found.map_or(Seen::Unknown, |one| {
        one.indicator.map_or(Seen::Absent, Seen::Value)
    })
}

/// Solves on the finer grid.
pub(super) fn solve(
    finer: &mut dyn Session,
    detector: &dyn Detector,
    checked: &Checked<'_>,
    value: f64,
) -> Seen {
    let solution = match finer.solve(value) {
        Ok(solution) => solution,
        Err(SourceError::Interrupted) => return Seen::Unknown,
        Err(SourceError::Method(_)) => return Seen::Absent,
    };
    let density = solution.densities.get(checked.observable);
    let indicator =
        density.and_then(|density| detector.indicator(density, checked.kind, checked.place));
    indicator.map_or(Seen::Absent, |indicator| Seen::Value(indicator.value))
}

/// Looks for the zero on the finer grid, within the range of the sweep. `None` when asked to stop.
pub(super) fn check(
    evaluate: &mut dyn FnMut(f64) -> Seen,
    checked: &Checked<'_>,
    span: Span,
    tolerance: f64,
) -> Option<GridCheck> {
    let mut value = checked.root.value;
    let mut slope = checked.root.slope;
    let mut last: Option<(f64, f64)> = None;
    for _ in 0..MOST_SOLVES {
        let indicator = match evaluate(value) {
            Seen::Value(indicator) => indicator,
            Seen::Absent => return Some(GridCheck::Unconfirmed),
            Seen::Unknown => return None,
        };
        if let Some((before, then)) = last {
            slope = (indicator - then) / (value - before);
        }
        let step = -indicator / slope;
        let next = value + step;
        if !span.contains(next) {
            return Some(GridCheck::Unconfirmed);
        }
        if step.abs() <= SMALL * tolerance {
            return Some(GridCheck::Confirmed(next));
        }
        last = Some((value, indicator));
        value = next;
    }
    Some(GridCheck::Unconfirmed)
}
