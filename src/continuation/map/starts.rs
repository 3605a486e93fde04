//! From which crossings of a map the next curves are followed.

use super::crossing::Crossing;
use super::curve_line::SAME;
use crate::topology::IndicatorKind;

/// Starts of one indicator that may fail before its other crossings are not tried.
pub(super) const MOST_FAILURES: usize = 4;

/// Takes one crossing of every indicator from those that are open: the middle one, away from ends of curves where they
/// turn and meet. An indicator that crosses only where another one of the same density does waits for that one's curve,
/// which is its own then.
pub(super) fn starts(open: &mut Vec<Crossing>, failures: &[(Crossing, String)]) -> Vec<Crossing> {
    let mut kinds: Vec<(usize, IndicatorKind)> = Vec::new();
    for crossing in open.iter() {
        let key = (crossing.observable, crossing.kind);
        let failed = failures
            .iter()
            .filter(|failed| is_alike(&failed.0, crossing));
        if !kinds.contains(&key) && failed.count() < MOST_FAILURES {
            kinds.push(key);
        }
    }
    // What follows from the equations is known best, and asks for no checks.
    kinds.sort_by_key(|key| !key.1.traits().is_exact);
    let all: Vec<Vec<Crossing>> = kinds.iter().map(|&key| of_kind(open, key)).collect();
    let mut taken: Vec<usize> = Vec::new();
    for number in 0..kinds.len() {
        let is_told = |one: &Crossing| {
            let others = taken.iter().flat_map(|&other| &all[other]);
            others.into_iter().any(|other| coincide(one, other))
        };
        if !all[number].iter().all(is_told) {
            taken.push(number);
        }
    }
    let middle = |&number: &usize| {
        let places = (0..open.len()).filter(|&index| key_of(&open[index]) == kinds[number]);
        places
            .collect::<Vec<_>>()
            .get(all[number].len() / 2)
            .copied()
    };
    let mut places: Vec<usize> = taken.iter().filter_map(middle).collect();
    let starts = places.iter().map(|&place| open[place].clone()).collect();
    places.sort_unstable();
    places.into_iter().rev().for_each(|place| {
        open.remove(place);
    });
    starts
}

pub(super) fn key_of(crossing: &Crossing) -> (usize, IndicatorKind) {
    (crossing.observable, crossing.kind)
}

pub(super) fn of_kind(open: &[Crossing], key: (usize, IndicatorKind)) -> Vec<Crossing> {
    let of_it = open.iter().filter(|one| key_of(one) == key);
    of_it.cloned().collect()
}

/// Whether crossings of two indicators of one density are in one place.
pub(super) fn coincide(one: &Crossing, other: &Crossing) -> bool {
    let apart = (one.at[0] - other.at[0]).hypot(one.at[1] - other.at[1]);
    one.observable == other.observable && apart < SAME
}

pub(super) fn is_alike(a: &Crossing, b: &Crossing) -> bool {
    a.observable == b.observable && a.kind == b.kind
}

#[cfg(test)]
mod tests {
    use super::super::curve_line::CurveLine;
    use super::*;

    fn crossing(kind: IndicatorKind, x: f64, y: f64) -> Crossing {
        Crossing {
            observable: 0,
            kind,
            place: vec![0.0],
            at: [x, y],
            ends: [[x, y], [x, y + 0.1]],
        }
    }

    #[test]
    fn an_indicator_that_crosses_where_another_does_waits_for_it() {
        let [wide, exact, other] = [
            IndicatorKind::FOLD,
            IndicatorKind::KINK_SLOPE,
            IndicatorKind::CURVATURE,
        ];
        let mut open: Vec<Crossing> = (0..5)
            .flat_map(|k| {
                let y = 0.2 * f64::from(k);
                [
                    crossing(wide, 0.3 + 1e-4, y),
                    crossing(exact, 0.3, y),
                    crossing(other, 0.6, y),
                ]
            })
            .collect();
        let found = starts(&mut open, &[]);
        let kinds: Vec<IndicatorKind> = found.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [exact, other]);
        assert!(found.iter().all(|one| one.at[1] == 0.4));
        assert_eq!(open.len(), 13);
        // Both neighbours lie on the curve itself: the line between them meets it nowhere, or everywhere.
        let curve = CurveLine {
            observable: 0,
            kind: exact,
            line: vec![[0.3, 0.0], [0.3, 1.0]],
        };
        open.retain(|one| !curve.explains(one));
        assert_eq!(open.len(), 4);
        assert!(open.iter().all(|one| one.kind == other));
    }
}
