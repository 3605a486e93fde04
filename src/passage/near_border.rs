//! A start beside a border on one axis: places and rates for what happens soon.
//!
//! A process that starts a distance d from a border is likely to meet it within d²/s, s the intensity of the noise,
//! which may be thousands of times shorter than the mean time. Such times need places between the start and the
//! border, where a line has none by itself, and functions that change over d, which repeated inverses of the
//! generator hardly hold: (s + A)⁻¹ at rates s of such times does.

use crate::generator::Chain;

/// Places between start and border below which more of them are made.
const ENOUGH: usize = 16;

/// Parts into which the way is cut then; a line halves each of them.
const PARTS: usize = 8;

/// Most doublings of the distance between places behind the start.
const MOST_DOUBLINGS: usize = 60;

/// Times before the time in which noise alone crosses the way, from which on hardly any process has ended.
const HARDLY_ANY: f64 = 0.1;

/// Rate over one over the shortest time, ratio of neighbouring rates, and most of them.
const FASTER: f64 = 10.0;
const RATIO: f64 = 4.0;
const MOST_RATES: usize = 20;

/// Places that a line needs for a start beside a border, beyond those that it has; in the order in which they come.
pub(super) fn places(start: f64, borders: &[f64], places: &[f64]) -> Vec<f64> {
    let below = borders.iter().copied().filter(|border| *border < start);
    let above = borders.iter().copied().filter(|border| *border > start);
    let below = below.reduce(f64::max);
    let above = above.reduce(f64::min);
    let mut more = Vec::new();
    for (border, other) in [(below, above), (above, below)] {
        let Some(border) = border else { continue };
        let way = start - border;
        let is_between = |place: &&f64| (**place - border) * (start - **place) > 0.0;
        if places.iter().filter(is_between).count() >= ENOUGH {
            continue;
        }
        more.extend((1..PARTS).map(|part| border + way * part as f64 / PARTS as f64));
        let is_before = |place: f64| other.is_none_or(|end| (end - place) * way > 0.0);
        let (mut place, mut step) = (start, way / PARTS as f64);
        for _ in 0..MOST_DOUBLINGS {
            let next = places.partition_point(|one| *one <= place);
            if next == 0 || next == places.len() || step.abs() >= places[next] - places[next - 1] {
                break;
            }
            for _ in 0..PARTS {
                place += step;
                if is_before(place) {
                    more.push(place);
                }
            }
            step *= 2.0;
        }
    }
    more
}

/// The shortest time at which processes end that start in one place: a share of the time in which noise alone comes to
/// the nearest end. Infinite for a start that is spread.
pub(super) fn soonest(chain: &Chain, ends: &[bool], start: &[f64]) -> f64 {
    let mut starts = (0..start.len()).filter(|&place| start[place] > 0.0);
    let (Some(own), None) = (starts.next(), starts.next()) else {
        return f64::INFINITY;
    };
    let crossed = |way: &mut dyn Iterator<Item = usize>, element_of: &dyn Fn(usize) -> usize| {
        let (mut mass, mut resistance) = (0.5 * chain.masses[own], 0.0);
        for place in way {
            resistance += chain.conductances[element_of(place)].recip();
            if ends[place] {
                return mass * resistance;
            }
            mass += chain.masses[place];
        }
        f64::INFINITY
    };
    let upward = crossed(&mut (own + 1..ends.len()), &|place| place - 1);
    let downward = crossed(&mut (0..own).rev(), &|place| place);
    HARDLY_ANY * upward.min(downward)
}

/// Rates from the fastest that is known already to beyond those of the shortest time; none where that is known.
pub(super) fn rates(known: f64, shortest: f64) -> Vec<f64> {
    let fastest = FASTER / shortest;
    if !(fastest > known && known > 0.0 && fastest.is_finite()) {
        return Vec::new();
    }
    let steps = (fastest / known).ln() / RATIO.ln();
    let count = (steps.ceil() as usize).clamp(1, MOST_RATES);
    let ratio = (fastest / known).powf(1.0 / count as f64);
    (1..=count)
        .map(|step| known * ratio.powi(step as i32))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{PARTS, places, rates};

    #[test]
    fn a_start_beside_a_border_has_places_toward_it_and_behind_itself() {
        let line: Vec<f64> = (0..=100).map(|place| f64::from(place) * 0.02).collect();
        let more = places(0.999, &[0.0, 1.0], &line);
        let between = more.iter().filter(|place| **place > 0.999).count();
        assert_eq!(between, PARTS - 1);
        // Behind the start distances double up to those of the line.
        assert!(more.iter().all(|place| (0.0..1.0).contains(place)));
        let last = more.iter().copied().fold(1.0, f64::min);
        assert!(last < 0.98, "{last}");
        assert!(places(1.0, &[0.0, 2.0], &line).is_empty());
    }

    #[test]
    fn rates_reach_from_known_ones_to_those_of_the_shortest_time() {
        let all = rates(2.0, 1e-3);
        assert!((all[all.len() - 1] - 1e4).abs() < 1e-6, "{all:?}");
        assert!(all.windows(2).all(|pair| pair[1] < 4.001 * pair[0]));
        assert!(rates(2.0, 10.0).is_empty());
    }
}
