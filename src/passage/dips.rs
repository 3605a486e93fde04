//! Where a level that has one sign at both ends of an interval has the other one between them: a region, or a gap of
//! one, that is narrower than a cell.

/// Steps by which the lowest place of a dip is narrowed, to 1e-12 of the interval.
const STEPS: usize = 60;

/// The golden section of an interval.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Places at which slopes at the ends of an interval are seen, as a share of it.
const BESIDE: f64 = 1e-3;

/// How much steeper than a line to zero within the next interval a level may stay away from it, where cells are graded.
const ALLOWANCE: f64 = 1.5;

/// Whether the level between two neighbouring places may have another sign than at both of them, from the levels there
/// and, where there are any, at the places before and after: a level that curves away from zero lies beyond the lines
/// through two places on either side.
pub(super) fn may_dip(before: Option<f64>, [low, high]: [f64; 2], after: Option<f64>) -> bool {
    let falls = |beside: Option<f64>, at: f64| {
        beside.is_none_or(|beside| ALLOWANCE * at.abs() < beside.abs() || beside * at < 0.0)
    };
    (low < 0.0) == (high < 0.0) && falls(before, low) && falls(after, high)
}

/// A place between two ends at which the level has not the sign that it has at both of them: where it goes toward zero
/// from either end, on the way to the place in between at which it is closest to zero or beyond.
pub(super) fn dip(level: &mut impl FnMut(f64) -> f64, [from, to]: [(f64, f64); 2]) -> Option<f64> {
    let sign = if from.1 < 0.0 { -1.0 } else { 1.0 };
    let is_beyond = |size: f64| if sign < 0.0 { size <= 0.0 } else { size < 0.0 };
    let (mut low, mut high) = (from.0, to.0);
    let mut size = |x: f64| sign * level(x);
    let beside = BESIDE * (high - low);
    if size(low + beside) >= sign * from.1 || size(high - beside) >= sign * to.1 {
        return None;
    }
    let mut places = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let mut sizes = places.map(&mut size);
    for _ in 0..STEPS {
        if let Some(found) = (0..2).find(|&one| is_beyond(sizes[one])) {
            return Some(places[found]);
        }
        if sizes[0] < sizes[1] {
            high = places[1];
            places = [high - GOLDEN * (high - low), places[0]];
            sizes = [size(places[0]), sizes[0]];
        } else {
            low = places[0];
            places = [places[1], low + GOLDEN * (high - low)];
            sizes = [sizes[1], size(places[1])];
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_thinner_than_an_interval_is_found_and_none_where_there_is_none() {
        for width in [0.3, 1e-3, 1e-7] {
            for middle in [0.21, 0.5, 0.77] {
                let mut band = |x: f64| (x - middle).abs() - 0.5 * width;
                let ends = [0.0, 1.0].map(|x| (x, band(x)));
                let found = dip(&mut band, ends).unwrap();
                assert!(band(found) < 0.0);
                let mut gap = |x: f64| 0.5 * width - (x - middle).abs();
                let ends = [0.0, 1.0].map(|x| (x, gap(x)));
                let found = dip(&mut gap, ends).unwrap();
                assert!(gap(found) >= 0.0);
                let mut above = |x: f64| (x - middle).abs() + 1e-9;
                let ends = [0.0, 1.0].map(|x| (x, above(x)));
                assert_eq!(dip(&mut above, ends), None);
            }
        }
        let at = |x: f64| (x - 0.4).powi(2) - 0.01;
        assert!(may_dip(Some(at(-1.0)), [at(0.0), at(1.0)], Some(at(2.0))));
        assert!(!may_dip(Some(3.0), [2.0, 1.5], Some(1.0)));
    }
}
