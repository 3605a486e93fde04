//! Rows that no zero of an indicator tells the value of: they lie in a band.

use super::change::Change;
use super::doubt::Doubt;
use super::follow::Course;
use super::label::Located;
use super::{Point, persistence};
use crate::density::Observable;
use crate::numerics::ends_of;
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

/// The row of a change of which no indicator changes its sign between two points.
pub(super) fn without_zero(
    points: &[&Point],
    observables: &[Observable],
    change: &Change,
    detector: &dyn Detector,
) -> Located {
    let by = |lost, reach, doubt| by_bracket(points, observables, change, (lost, reach), doubt);
    match &change.course {
        Some(Course::Lost(at, reach)) => by([*at; 2], Some(*reach), Doubt::IndicatorLost),
        Some(Course::Sunk(at)) => {
            let is_above = change.event.as_ref().is_some_and(|event| event.above);
            let last = points.len().saturating_sub(2);
            let end = if is_above { 0 } else { last };
            by([*at, end], None, Doubt::TooLow)
        }
        Some(Course::Beyond(at)) => by([*at; 2], None, Doubt::BornBeyond),
        Some(Course::Crossing(_)) | None => by_persistence(points, observables, change, detector),
    }
}

/// An indicator was lost between two points, or between one of two pairs of neighbours and the other: its zero lies
/// there, or between there and where the signature changes, or up to where its readings lead, within the sweep. `lost`
/// has the lower point of each pair.
fn by_bracket(
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
    let (lower, upper) = ends_of(values);
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
fn by_persistence(
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

/// Widens a band by the one that fewer cells gave: nothing but the next grid tells how far it is off. It holds that
/// band, and where an end has left it by d, errors that fall by the ratio r of the cells leave d / (r - 1) more. The
/// ends of the stretch are certain.
pub(super) fn widen(row: &mut Located, coarse: [f64; 2], ratio: f64, stretch: [f64; 2]) {
    let [lower, upper] = coarse;
    let left = |distance: f64| distance.max(0.0) / (ratio - 1.0);
    let ends = [
        row.lower.min(lower) - left(lower - row.lower),
        row.upper.max(upper) + left(row.upper - upper),
    ];
    let ends = ends.map(|end| end.clamp(stretch[0], stretch[1]));
    if ends != [row.lower, row.upper] {
        [row.lower, row.upper] = ends;
        row.value = 0.5 * (row.lower + row.upper);
        row.error = 0.5 * (row.upper - row.lower);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::Signature;

    #[test]
    fn a_band_on_finer_cells_holds_that_of_fewer_and_what_it_has_left_may_be_as_far_off_again() {
        let of = |lower: f64, upper: f64| Located {
            label: String::new(),
            value: lower,
            error: upper - lower,
            lower,
            upper,
            observable: Observable::Marginal(0),
            before: Signature::default(),
            after: Signature::default(),
            zero: None,
            is_several: false,
            doubts: vec![Doubt::IndicatorLost],
        };
        let widened = |own: [f64; 2], coarse: [f64; 2]| {
            let mut row = of(own[0], own[1]);
            widen(&mut row, coarse, 1.5, [-8.0, 8.0]);
            [row.lower, row.value, row.upper]
        };
        // Inside: the band of fewer cells.
        assert_eq!(widened([1.0, 2.0], [0.0, 4.0]), [0.0, 2.0, 4.0]);
        // One below: twice what it has left by more; two below: up to the end of the stretch.
        assert_eq!(widened([1.0, 2.0], [2.0, 3.0]), [-1.0, 1.0, 3.0]);
        assert_eq!(widened([-4.0, 2.0], [0.0, 3.0]), [-8.0, -2.5, 3.0]);
        // What is not widened keeps its value.
        assert_eq!(widened([0.0, 4.0], [0.0, 4.0]), [0.0, 0.0, 4.0]);
    }
}
