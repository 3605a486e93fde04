//! Rows of a sweep beside each other: in which order they come, and which of them are one because nothing tells them
//! apart.

use super::change::Change;
use super::doubt::Doubt;
use super::label::Located;
use super::{BifurcationStatus, Point};
use crate::density::Observable;
use crate::numerics::sort_ascending;
use crate::topology::IndicatorKind;

/// So many rows in a row that are not located are one.
const FLICKER: usize = 3;

/// The rows of changes between the same two points, ascending, each from the signature that the one before leaves;
/// those whose values cannot be told apart are one.
pub(super) fn in_order(mut found: Vec<(Located, &Change)>) -> Vec<Located> {
    sort_ascending(&mut found, |one| one.0.value);
    let Some(last) = found.last().map(|one| one.1.after) else {
        return Vec::new();
    };
    let mut rows: Vec<Located> = Vec::new();
    for (mut row, change) in found {
        row.before = rows.last().map_or(change.before, |row| row.after);
        row.after = change.step(row.before);
        match rows.last_mut() {
            Some(last) if row.value - last.value <= last.error + row.error => merge(last, &row),
            _ => rows.push(row),
        }
    }
    if let Some(row) = rows.last_mut() {
        row.after = last;
    }
    rows
}

/// Where features come and go from point to point, one row says from where to where, instead of one a point. What has a
/// place of its own keeps its row, however wide its error. Rows that are made so may overlap, and are one then.
pub(super) fn without_flicker(mut rows: Vec<Located>) -> Vec<Located> {
    loop {
        let count = rows.len();
        rows = merged(&rows);
        if rows.len() == count {
            return rows;
        }
    }
}

/// Rows with one in place of each run of several that cannot be kept apart.
fn merged(rows: &[Located]) -> Vec<Located> {
    let mut kept = Vec::new();
    for run in rows.chunk_by(is_one_doubt) {
        let (first, last) = (&run[0], &run[run.len() - 1]);
        let is_too_low = run.iter().any(|row| row.doubts.contains(&Doubt::TooLow));
        let returns = run.len() > 1 && first.before == last.after;
        let is_of_several =
            |row: &Located| matches!(row.doubts.first(), Some(Doubt::Flicker | Doubt::Stages));
        let are_many = run.len() >= FLICKER || returns || run.iter().any(is_of_several);
        if run.len() == 1 || !are_many {
            kept.extend_from_slice(run);
            continue;
        }
        let lower = run
            .iter()
            .map(|row| row.lower)
            .fold(f64::INFINITY, f64::min);
        let upper = run
            .iter()
            .map(|row| row.upper)
            .fold(f64::NEG_INFINITY, f64::max);
        kept.push(Located {
            value: 0.5 * (lower + upper),
            error: 0.5 * (upper - lower),
            lower,
            upper,
            after: last.after,
            zero: None,
            is_several: false,
            doubts: vec![if is_too_low {
                Doubt::TooLow
            } else if returns {
                Doubt::Flicker
            } else {
                Doubt::Stages
            }],
            ..first.clone()
        });
    }
    kept
}

/// Whether two rows that follow each other are not located and cannot be kept apart: their intervals overlap, or, where
/// one of them is no zero of an indicator, the stage between them is no wider than they are.
fn is_one_doubt(first: &Located, second: &Located) -> bool {
    let in_doubt = |row: &Located| row.status() != BifurcationStatus::Located;
    let is_zero =
        |row: &Located| row.zero.is_some() && row.status() != BifurcationStatus::Unconfirmed;
    // What holds beside a fixed point follows from the equations, whatever comes and goes on the cells.
    let is_at_rest = |row: &Located| matches!(row.doubts.first(), Some(Doubt::AtRest(_)));
    if is_at_rest(first) || is_at_rest(second) {
        return false;
    }
    let between = second.lower - first.upper;
    // What lies between two bands that reach to the ends of the sweep was seen.
    let reaches_out = |row: &Located| row.doubts.contains(&Doubt::TooLow);
    let keeps = |row: &Located| is_zero(row) || reaches_out(row);
    let width = if keeps(first) && keeps(second) {
        0.0
    } else {
        (first.upper - first.lower).max(second.upper - second.lower)
    };
    first.observable == second.observable && in_doubt(first) && in_doubt(second) && between <= width
}

/// Doubts rows that contradict each other: what is counted after one row must be what is counted before the next one of
/// its observable, and at the ends of the sweep what is counted there.
pub(super) fn doubt_what_does_not_continue(
    rows: &mut [Located],
    points: &[&Point],
    observables: &[Observable],
) {
    for (place, observable) in observables.iter().enumerate() {
        let signature = |point: &&Point| Some(point.detections.get(place)?.signature);
        let mut own: Vec<usize> = (0..rows.len())
            .filter(|&row| rows[row].observable == *observable)
            .collect();
        sort_ascending(&mut own, |&place| rows[place].value);
        let mut last = points.first().and_then(signature);
        let mut contradicting = Vec::new();
        for (number, &row) in own.iter().enumerate() {
            if Some(rows[row].before) != last {
                contradicting.extend(number.checked_sub(1).map(|before| own[before]));
                contradicting.push(row);
            }
            last = Some(rows[row].after);
        }
        if last != points.last().and_then(signature) {
            contradicting.extend(own.last());
        }
        for row in contradicting {
            let doubts = &mut rows[row].doubts;
            if doubts.is_empty() {
                doubts.push(Doubt::DoesNotContinue);
            }
        }
    }
}

/// Whether two changes of one observable follow each other so closely that the stage between them is not certain.
pub(super) fn inseparable(first: &Located, second: &Located) -> bool {
    let both = first.zero.is_some() && second.zero.is_some();
    let apart = (second.value - first.value).abs();
    both && first.observable == second.observable
        && first.after == second.before
        && first.before != second.after
        && apart <= first.error + second.error
}

/// Makes one row of two that cannot be told apart.
pub(super) fn merge(first: &mut Located, second: &Located) {
    first.lower = first.lower.min(second.lower);
    first.upper = first.upper.max(second.upper);
    let value = 0.5 * (first.value + second.value);
    let half = 0.5 * (second.value - first.value).abs();
    first.error = first.error.max(second.error) + half;
    if let Some(zero) = &mut first.zero {
        zero.parts.grid += half;
    }
    first.value = value;
    first.after = second.after;
    first.doubts.extend_from_slice(&second.doubts);
    let of_flank = |row: &Located| {
        let is_one =
            |kind: IndicatorKind| kind.traits().rising.is_some() || kind == IndicatorKind::FOLD;
        row.indicator().is_some_and(is_one)
    };
    let is_one = first.indicator() == second.indicator() || (of_flank(first) && of_flank(second));
    first.is_several |= second.is_several || !is_one;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::Signature;

    #[test]
    fn rows_that_overlap_once_they_are_merged_are_one() {
        let counted = |peaks: usize| Signature {
            peaks,
            ..Signature::default()
        };
        let row = |value: f64, error: f64, peaks: [usize; 2]| Located {
            label: String::new(),
            value,
            error,
            lower: value - error,
            upper: value + error,
            observable: Observable::Marginal(0),
            before: counted(peaks[0]),
            after: counted(peaks[1]),
            zero: None,
            is_several: false,
            doubts: vec![Doubt::IndicatorLost],
        };
        // Neither of the first two is as wide as what lies between them; what is made of the others holds both.
        let apart = [row(-9.0, 0.1, [1, 2]), row(-8.0, 0.1, [2, 3])];
        assert_eq!(without_flicker(apart.to_vec()), apart);
        let wide = [[3, 4], [4, 5], [5, 6]].map(|peaks| row(0.0, 10.0, peaks));
        let [first, second] = apart;
        let rows = without_flicker([first, second].into_iter().chain(wide).collect());
        let [one] = rows.as_slice() else {
            panic!("{rows:?}")
        };
        assert_eq!((one.before, one.after), (counted(1), counted(6)));
        assert_eq!([one.lower, one.upper], [-10.0, 10.0]);
    }
}
