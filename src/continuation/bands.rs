//! Rows that no zero of an indicator tells the value of: they lie in a band.

use super::change::Change;
use super::doubt::Doubt;
use super::label::Located;
use super::{Point, persistence};
use crate::density::Observable;
use crate::topology::Detector;

/// A row that no indicator tells the value of.
pub(super) fn band(
    observables: &[Observable],
    change: &Change,
    (lower, value, upper): (f64, f64, f64),
    doubt: Option<Doubt>,
) -> Located {
    Located {
        label: String::new(),
        value,
        error: (value - lower).max(upper - value),
        lower,
        upper,
        observable: observables[change.observable],
        before: change.before,
        after: change.after,
        zero: None,
        is_several: false,
        doubts: doubt.into_iter().collect(),
    }
}

/// An indicator was lost between two points, or between one of two pairs of neighbours and the other: its zero lies
/// there, or between there and where the signature changes, or up to where its readings lead, within the sweep. `lost`
/// has the lower point of each pair.
pub(super) fn by_bracket(
    points: &[&Point],
    observables: &[Observable],
    change: &Change,
    (lost, reach): ([usize; 2], Option<f64>),
    doubt: Doubt,
) -> Located {
    let around = lost.iter().flat_map(|&at| [at, at + 1]);
    let places = around.chain([change.left, change.right]);
    let ends = [0, points.len() - 1].map(|place| points[place].value);
    let reach = reach.map(|value| value.clamp(ends[0], ends[1]));
    let values = places.map(|place| points[place].value).chain(reach);
    let (lower, upper) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    Located {
        error: 0.5 * (upper - lower),
        ..band(
            observables,
            change,
            (lower, 0.5 * (lower + upper), upper),
            Some(doubt),
        )
    }
}

/// A change that counting alone tells of.
pub(super) fn by_persistence(
    points: &[&Point],
    observables: &[Observable],
    change: &Change,
    detector: &dyn Detector,
) -> Located {
    // Counting follows what cells or samples show, and nothing says how far that is from the truth.
    let found = persistence::band(points, change.observable, change.left, detector.doubt());
    // Signatures that were not seen whole say nothing of where in between.
    let upper = if change.right == change.left + 1 {
        found.upper
    } else {
        found.upper.max(points[change.right].value)
    };
    let doubt = if found.sinks {
        Doubt::TooLow
    } else if found.resolved_by_cells {
        Doubt::NoIndicator
    } else {
        Doubt::FewCellsApart
    };
    let place = (found.lower, found.value, upper);
    band(observables, change, place, Some(doubt))
}
