//! The checks of a located value: on a finer grid, and between ends of Ω that let nothing out.
//!
//! The indicator's zero on the finer grid is found by a secant that starts with the slope known from the coarser one.
//! The finer value is the better one and is kept, where the indicator changes its sign about it on the finer grid too.
//! With r times as many cells an axis and order p its error is 1/(rᵖ - 1) of the distance between both: what order two
//! gives is stated, and never less than the distance itself. Where that error exceeds the tolerance, still finer cells
//! are asked in the same way.

use super::doubt::{CheckedBy, Doubt};
use super::root::Root;
use super::span::Span;
use super::{CellCheck, Session, SourceError};
use crate::density::LEAK_ALLOWANCE;
use crate::topology::{Detector, IndicatorKind, Signature};

/// Error of a value on finer cells over its distance to the value on those that it checks, see above; what order one
/// gives where the order by which errors fall is not known yet.
pub(super) fn share_of_distance(check: CellCheck, is_order_known: bool) -> f64 {
    match check {
        CellCheck::OnFinerCells { ratio, .. } if !is_order_known => (ratio - 1.0).recip().max(1.0),
        CellCheck::OnFinerCells { ratio, .. } => (ratio * ratio - 1.0).recip().max(1.0),
        CellCheck::Impossible | CellCheck::Needless => 1.0,
    }
}

/// Solves on the finer grid for one value.
const MOST_SOLVES: usize = 4;
/// A step below this share of the tolerance ends the search.
const SMALL: f64 = 0.02;
/// Where beyond the zero the other sign is looked for, as a share of the tolerance: farther than the secant is off, so
/// that rounding decides nothing, and near enough for the row.
const BEYOND: f64 = 0.5;

/// How located values are checked: by solves, or by what earlier solves saw. `None` where there is nothing to check
/// with, or the sweep is to end.
pub(super) trait Checks {
    /// Where the change lies on cells that were refined so many times; `None` too where more than once costs more than
    /// [`super::LocateOptions::effort`] allows.
    fn on_finer_cells(
        &mut self,
        checked: &Checked<'_>,
        times: u8,
    ) -> Option<Result<FinerZero, Doubt>>;
    /// How far the mass that leaves Ω moves it: between closed ends nothing does.
    fn between_closed_ends(&mut self, checked: &Checked<'_>) -> Option<Result<f64, Doubt>>;
}

/// A zero of an indicator on finer cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FinerZero {
    pub(super) value: f64,
    /// What these cells themselves leave uncertain, by a second discretisation and a rougher reconstruction.
    pub(super) error: f64,
}

/// The indicator of a check at one value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Seen {
    /// Its value, and its error by a second discretisation and a rougher reconstruction.
    Value(f64, f64),
    /// There is no such indicator.
    Absent,
    /// The solve failed, for this reason.
    Failed(String),
    /// The source was asked to stop, or it is not known.
    Unknown,
}

impl Seen {
    /// What is kept of it.
    pub(super) fn record(
        &self,
        by: CheckedBy,
        checked: &Checked<'_>,
        value: f64,
    ) -> Option<CheckedIndicator> {
        let (indicator, error, failure) = match self {
            Self::Value(indicator, error) => (Some(*indicator), *error, None),
            Self::Absent => (None, 0.0, None),
            Self::Failed(reason) => (None, 0.0, Some(reason.clone())),
            Self::Unknown => return None,
        };
        Some(CheckedIndicator {
            by,
            value,
            observable: checked.observable,
            kind: checked.kind,
            place: checked.place.to_vec(),
            indicator,
            error,
            failure,
        })
    }
}

/// An indicator that was seen in a check of a located value, from which the check is repeated without solving.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedIndicator {
    /// What it was checked by.
    pub by: CheckedBy,
    /// The parameter's value.
    pub value: f64,
    /// Place of the observable in [`super::Subject::observables`].
    pub observable: usize,
    /// The indicator.
    pub kind: IndicatorKind,
    /// Where it was looked for, one coordinate an axis of the density.
    pub place: Vec<f64>,
    /// Its value; `None` if there was none.
    pub indicator: Option<f64>,
    /// Its error by a second discretisation and a rougher reconstruction; zero where that is not known.
    pub error: f64,
    /// Why the solve failed; `None` if it did not.
    pub failure: Option<String>,
}

/// What is checked.
pub(super) struct Checked<'a> {
    /// Place of the observable among those that are watched.
    pub(super) observable: usize,
    pub(super) kind: IndicatorKind,
    pub(super) place: &'a [f64],
    pub(super) root: Root,
    /// What may be counted beside the zero, where the sweep's own cells cannot be trusted with it.
    pub(super) counts: Option<Counts>,
}

/// What may be counted beside a zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Counts {
    /// Below and above it.
    pub(super) both: [Signature; 2],
    /// Where the indicator says that its feature is absent, which cannot be by the feature being low; `None` for the
    /// indicators of centres.
    pub(super) absent: Option<Signature>,
}

impl Counts {
    /// Whether what is counted fits to an indicator.
    fn allow(&self, counted: &Signature, indicator: f64) -> bool {
        match self.absent.filter(|_| indicator <= 0.0) {
            Some(absent) => *counted == absent,
            None => self.both.contains(counted),
        }
    }
}

/// What was seen of an indicator at a value before. Several rows may ask for the same, and a solve from another start
/// differs by rounding.
pub(super) fn known(
    seen: &[CheckedIndicator],
    by: CheckedBy,
    checked: &Checked<'_>,
    value: f64,
) -> Seen {
    let found = seen.iter().find(|one| {
        one.by == by
            && one.value == value
            && one.observable == checked.observable
            && one.kind == checked.kind
            && one.place == checked.place
    });
    let Some(one) = found else {
        return Seen::Unknown;
    };
    match (&one.failure, one.indicator) {
        (Some(reason), _) => Seen::Failed(reason.clone()),
        (None, Some(indicator)) => Seen::Value(indicator, one.error),
        (None, None) => Seen::Absent,
    }
}

/// Solves in the session of a check.
pub(super) fn solve(
    session: &mut dyn Session,
    detector: &dyn Detector,
    checked: &Checked<'_>,
    value: f64,
) -> Seen {
    let solution = match session.solve(value) {
        Ok(solution) => solution,
        Err(SourceError::Interrupted) => return Seen::Unknown,
        Err(SourceError::Method(error)) => return Seen::Failed(error.to_string()),
    };
    let status = solution.report.status;
    if !status.is_resolved() {
        return Seen::Failed(status.word().to_owned());
    }
    let density = solution.densities.get(checked.observable);
    let indicator = density.and_then(|density| {
        let found = detector.indicator(density, checked.kind, checked.place)?;
        let is_counted =
            |counts: &Counts| counts.allow(&detector.detect(density).signature, found.value);
        checked
            .counts
            .as_ref()
            .is_none_or(is_counted)
            .then_some(found)
    });
    indicator.map_or(Seen::Absent, |one| {
        Seen::Value(one.value, one.systematic_error)
    })
}

/// How far the mass that leaves Ω may move a value, from the indicator at the zero when nothing leaves, over its
/// slope.
pub(super) fn leak(seen: Seen, checked: &Checked<'_>) -> Option<Result<f64, Doubt>> {
    match seen {
        Seen::Value(indicator, _) => {
            Some(Ok(LEAK_ALLOWANCE * (indicator / checked.root.slope).abs()))
        }
        Seen::Absent => Some(Err(Doubt::NotBetweenClosedEnds)),
        Seen::Failed(reason) => Some(Err(Doubt::CheckFailed(CheckedBy::ClosedEnds, reason))),
        Seen::Unknown => None,
    }
}

/// Looks for the zero on the finer grid, within the range of the sweep. `None` when asked to stop.
///
/// A small step of the secant is not enough: beside a pole the indicator is steep without being small. The indicator
/// must change its sign about the zero, between values that are near it.
pub(super) fn check(
    evaluate: &mut dyn FnMut(f64) -> Seen,
    checked: &Checked<'_>,
    span: Span,
    tolerance: f64,
) -> Option<Result<FinerZero, Doubt>> {
    let mut value = checked.root.value;
    let mut slope = checked.root.slope;
    let mut seen: Vec<(f64, f64)> = Vec::new();
    for _ in 0..MOST_SOLVES {
        let (indicator, error) = match indicator_at(evaluate, value) {
            Ok(seen) => seen,
            Err(ended) => return ended.map(Err),
        };
        if let Some((before, then)) = seen.last() {
            slope = (indicator - then) / (value - before);
        }
        let step = -indicator / slope;
        let next = value + step;
        if !span.contains(next) {
            return Some(Err(Doubt::NotOnFinerCells));
        }
        seen.push((value, indicator));
        if step.abs() <= SMALL * tolerance {
            let zero = FinerZero {
                value: next,
                error: (error / slope).abs(),
            };
            return changes_sign(evaluate, &seen, zero, span, tolerance);
        }
        value = next;
    }
    Some(Err(Doubt::NotOnFinerCells))
}

/// The indicator at a value and its error, or how the check ends without one.
fn indicator_at(
    evaluate: &mut dyn FnMut(f64) -> Seen,
    value: f64,
) -> Result<(f64, f64), Option<Doubt>> {
    match evaluate(value) {
        Seen::Value(indicator, error) => Ok((indicator, error)),
        Seen::Absent => Err(Some(Doubt::NotOnFinerCells)),
        Seen::Failed(reason) => Err(Some(Doubt::CheckFailed(CheckedBy::FinerCells(1), reason))),
        Seen::Unknown => Err(None),
    }
}

/// The zero, if the indicator has different signs on both sides of it: by what was seen, or by one more solve on the
/// side that was not seen, or not so near. Where the indicator is zero, either sign will do.
fn changes_sign(
    evaluate: &mut dyn FnMut(f64) -> Seen,
    seen: &[(f64, f64)],
    zero: FinerZero,
    span: Span,
    tolerance: f64,
) -> Option<Result<FinerZero, Doubt>> {
    let confirmed = Some(Ok(zero));
    let zero = zero.value;
    let Some(&(last, indicator)) = seen.last().filter(|(_, indicator)| *indicator != 0.0) else {
        return confirmed;
    };
    let is_other = |one: f64| one * indicator <= 0.0;
    let is_seen = |&(value, one): &(f64, f64)| (value - zero).abs() <= tolerance && is_other(one);
    if seen.iter().any(is_seen) {
        return confirmed;
    }
    let beyond = zero + (zero - last).signum() * BEYOND * tolerance;
    match indicator_at(evaluate, span.nearest(beyond)) {
        Ok((one, _)) if is_other(one) => confirmed,
        Ok(_) => Some(Err(Doubt::NotOnFinerCells)),
        Err(ended) => ended.map(Err),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::{ErrorParts, Subject};
    use crate::system::test_families::bistable;

    /// What the check says of a function whose zero the coarser grid saw at 0.5 with a slope, and the values asked for.
    fn checked_by(
        function: impl Fn(f64) -> f64,
        slope: f64,
    ) -> (Option<Result<FinerZero, Doubt>>, usize) {
        let root = Root {
            value: 0.5,
            slope,
            error: ErrorParts::default(),
        };
        let checked = Checked {
            observable: 0,
            kind: IndicatorKind::CURVATURE,
            place: &[0.0],
            root,
            counts: None,
        };
        let mut solves = 0;
        let mut evaluate = |value: f64| {
            solves += 1;
            Seen::Value(function(value), 0.0)
        };
        let subject = Subject {
            family: bistable(0.0, 1.0),
            observables: Vec::new(),
            measures: Vec::new(),
            cell_check: CellCheck::OnFinerCells {
                ratio: 1.25,
                follows: None,
            },
        };
        let span = Span::new(&subject, 2);
        let found = check(&mut evaluate, &checked, span, 1e-4);
        (found, solves)
    }

    #[test]
    fn a_zero_is_confirmed_by_a_change_of_sign() {
        // The secant of a straight line is exact; its last value lies on the zero but for rounding, or before it.
        for (zero, most) in [(0.5 + 1e-7, 2), (0.51, 3), (0.4, 3)] {
            let (found, solves) = checked_by(|value| 3.0 * (value - zero), 3.0);
            let Some(Ok(FinerZero { value, .. })) = found else {
                panic!("{found:?}");
            };
            assert!(
                (value - zero).abs() < 1e-6 && solves <= most,
                "{value} {solves}"
            );
        }
    }

    #[test]
    fn a_pole_is_not_confirmed_however_steep_the_indicator_was() {
        // On the coarser grid p passes zero, and p'/p with it through infinity: a slope of 10⁷ makes 12 a small step.
        let (found, _) = checked_by(|_| 12.0, 1e7);
        assert_eq!(found, Some(Err(Doubt::NotOnFinerCells)));
        let touching = |value: f64| 1e-9 + (value - 0.5).powi(2);
        let (found, _) = checked_by(touching, 1.0);
        assert_eq!(found, Some(Err(Doubt::NotOnFinerCells)));
    }
}
