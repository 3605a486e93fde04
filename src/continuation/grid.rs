//! The check of a located value on a finer grid.
//!
//! The indicator's zero on the finer grid is found by a secant that starts with the slope known from the coarser one. The
//! finer value is the better one and is kept; the distance between both bounds its error, for any order of
//! convergence above one.

use super::root::Root;
use super::{DensitySource, SourceError};
use crate::topology::{Detector, Indicator, IndicatorKind};

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

/// What is checked.
pub(super) struct Checked<'a> {
    /// Place of the observable among those that are watched.
    pub(super) observable: usize,
    pub(super) kind: IndicatorKind,
    pub(super) place: &'a [f64],
    pub(super) root: Root,
}

/// Looks for the zero on the finer grid, within the range of the sweep. `None` when asked to stop.
pub(super) fn check<S: DensitySource>(
    finer: &S,
    detector: &dyn Detector,
    checked: &Checked<'_>,
    range: (f64, f64),
    tolerance: f64,
) -> Option<GridCheck> {
    let mut value = checked.root.value;
    let mut slope = checked.root.slope;
    let mut state: Option<S::State> = None;
    let mut last: Option<(f64, f64)> = None;
    for _ in 0..MOST_SOLVES {
        let solution = match finer.solve(value, state.as_ref()) {
            Ok(solution) => solution,
            Err(SourceError::Interrupted) => return None,
            Err(SourceError::Method(_)) => return Some(GridCheck::Unconfirmed),
        };
        let indicator: Option<Indicator> = solution
            .densities
            .get(checked.observable)
            .and_then(|density| detector.indicator(density, checked.kind, checked.place));
        let Some(indicator) = indicator else {
            return Some(GridCheck::Unconfirmed);
        };
        if let Some((before, then)) = last {
            slope = (indicator.value - then) / (value - before);
        }
        let step = -indicator.value / slope;
        let next = value + step;
        if !next.is_finite() || next < range.0 || next > range.1 {
            return Some(GridCheck::Unconfirmed);
        }
        if step.abs() <= SMALL * tolerance {
            return Some(GridCheck::Confirmed(next));
        }
        last = Some((value, indicator.value));
        value = next;
        state = solution.state.or(state);
    }
    Some(GridCheck::Unconfirmed)
}
