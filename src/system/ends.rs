//! Ends of a range that nothing passes.

use super::System;
use crate::numerics::limit_at_zero;

/// Places along each other axis at which an end is looked at, as shares of its range.
const LOOKS: [f64; 7] = [0.03, 0.17, 0.36, 0.52, 0.68, 0.85, 0.98];

/// What is no noise, as a share of the amplitude in the middle of the range; and no drift, as a share of the range in a
/// unit of time.
const NOTHING: f64 = 1e-12;

/// The nearest distance to an end at which powers are read, as a share of the range, and that of the next one over it.
const NEAR: f64 = 1e-6;
const APART: f64 = 4.0;

/// Change between the two, as a share, from which on there is no limit.
const SETTLED: f64 = 1e-2;

/// Whether nothing passes the lower and the upper end of an axis, one of several with these ranges: they are walls
/// ([`super::Facts::walls`]), or natural ends.
pub(crate) fn closed_ends(system: &dyn System, axis: usize, ranges: &[(f64, f64)]) -> [bool; 2] {
    let walls = system.facts().walls(axis, ranges[axis]);
    let natural = natural_ends(system, axis, ranges);
    [0, 1].map(|end| walls[end] || natural[end])
}

/// Whether the lower and the upper end of an axis with noise are natural ones: there the noise along the axis dies and
/// drift does not lead out, as at zero of a population.
pub(crate) fn natural_ends(system: &dyn System, axis: usize, ranges: &[(f64, f64)]) -> [bool; 2] {
    let (from, to) = ranges[axis];
    let facts = system.facts();
    // The ends of a turn are one place.
    let is_closed = facts.turns.contains_key(&axis);
    if !system.is_noisy(axis) || is_closed || facts.period.is_some() {
        return [false; 2];
    }
    [(from, -1.0), (to, 1.0)].map(|side| is_natural(system, axis, ranges, side))
}

/// Whether what is at a natural end may stay there: alone, or while other axes are at natural ends of theirs too. Where
/// drift leads away from the end somewhere, as immigration does, nothing is absorbed.
pub(crate) fn may_stay(
    system: &dyn System,
    ranges: &[(f64, f64)],
    natural: &[[bool; 2]],
    (axis, end): (usize, usize),
) -> bool {
    let sides = |other: usize| -> Vec<Option<usize>> {
        let ends = [0, 1].into_iter().filter(|&side| natural[other][side]);
        match other == axis {
            true => vec![Some(end)],
            false => std::iter::once(None).chain(ends.map(Some)).collect(),
        }
    };
    let mut sets: Vec<Vec<Option<usize>>> = vec![Vec::new()];
    for other in 0..ranges.len() {
        let with = |set: &Vec<Option<usize>>, side| [set.clone(), vec![side]].concat();
        let wider = sets
            .iter()
            .flat_map(|set| sides(other).into_iter().map(|side| with(set, side)));
        sets = wider.collect();
    }
    sets.iter().any(|set| holds_all(system, ranges, set))
}

/// Whether drift leads none of the axes that are at an end away from it, wherever the others are.
fn holds_all(system: &dyn System, ranges: &[(f64, f64)], set: &[Option<usize>]) -> bool {
    let at = |axis: usize, end: usize| {
        if end == 1 {
            ranges[axis].1
        } else {
            ranges[axis].0
        }
    };
    let fixed = set
        .iter()
        .enumerate()
        .map(|(axis, end)| end.map(|end| at(axis, end)));
    states_at(&fixed.collect::<Vec<_>>(), ranges).all(|state| {
        let drift = system.drift_at(0.0, &state);
        let inward = |axis: usize, end: usize| if end == 1 { -drift[axis] } else { drift[axis] };
        let mut ends = set
            .iter()
            .enumerate()
            .filter_map(|(axis, end)| Some((axis, (*end)?)));
        ends.all(|(axis, end)| inward(axis, end) <= NOTHING * (ranges[axis].1 - ranges[axis].0))
    })
}

/// By how much an exponent that is found from drift and noise beside an end may be off.
const LEFT_OF_EXPONENT: f64 = 1e-9;

/// Whether a density that goes like this power of the distance from an end has no integral: all mass ends there. An
/// exponent that cannot be told from -1 counts as -1: half of the mass would be nearer to the end than any number is.
pub(crate) fn absorbs(exponent: f64) -> bool {
    exponent <= -1.0 + LEFT_OF_EXPONENT
}

/// The largest exponent, wherever the other coordinates are, of the power of the distance that the density along an
/// axis goes like beside a natural end; `None` where there is none. Where it is -1 or less ([`absorbs`]) all mass ends
/// there: the exponent that counts is a mean of those of all places.
pub(crate) fn largest_power(
    system: &dyn System,
    axis: usize,
    ranges: &[(f64, f64)],
    is_upper: bool,
) -> Option<f64> {
    let (from, to) = ranges[axis];
    let (at, inward) = if is_upper { (to, -1.0) } else { (from, 1.0) };
    let nearest = NEAR * (to - from);
    let power_at = |state: Vec<f64>| {
        let look = |distance: f64| {
            let mut state = state.clone();
            state[axis] = at + inward * distance;
            let intensity = system.intensity_at(axis, 0.0, &state);
            let drift = inward * system.drift_at(0.0, &state)[axis];
            (2.0 * drift * distance / intensity, intensity)
        };
        let seen = [0, 1, 2, 3].map(|place| look(nearest * APART.powi(place)));
        let order = |place: usize| (seen[place + 1].1 / seen[place].1).ln() / APART.ln();
        // Both terms are off by multiples of the distance and of its square, the first where it has a limit.
        let has_limit = (seen[0].0 - seen[1].0).abs() <= (1.0 + seen[1].0.abs()) * SETTLED;
        let power = |place: usize| seen[place].0 - order(place);
        let limit = limit_at_zero([0, 1, 2].map(power), APART);
        Some(limit).filter(|power| has_limit && power.is_finite())
    };
    let powers: Option<Vec<f64>> = states_at(&only(axis, at, ranges.len()), ranges)
        .map(power_at)
        .collect();
    powers?.into_iter().reduce(f64::max)
}

/// States with some coordinates fixed, wherever the others are.
fn states_at(fixed: &[Option<f64>], ranges: &[(f64, f64)]) -> impl Iterator<Item = Vec<f64>> {
    let free = fixed.iter().filter(|one| one.is_none()).count();
    let others = u32::try_from(free).unwrap_or(0);
    (0..LOOKS.len().pow(others)).map(move |place| {
        let mut rest = place;
        let place_of = |(known, &(low, high)): (&Option<f64>, &(f64, f64))| {
            known.unwrap_or_else(|| {
                let share = LOOKS[rest % LOOKS.len()];
                rest /= LOOKS.len();
                low + share * (high - low)
            })
        };
        fixed.iter().zip(ranges).map(place_of).collect()
    })
}

/// One coordinate fixed, the others free.
fn only(axis: usize, at: f64, count: usize) -> Vec<Option<f64>> {
    (0..count)
        .map(|other| (other == axis).then_some(at))
        .collect()
}

/// Whether noise dies at an end, and drift does not lead out, wherever the other coordinates are.
fn is_natural(
    system: &dyn System,
    axis: usize,
    ranges: &[(f64, f64)],
    (at, outward): (f64, f64),
) -> bool {
    let (from, to) = ranges[axis];
    states_at(&only(axis, at, ranges.len()), ranges).all(|mut state| {
        let drift = outward * system.drift_at(0.0, &state)[axis];
        let noises = || system.noises().iter().filter(|noise| noise.axis == axis);
        let amplitude =
            |state: &[f64]| -> f64 { noises().map(|noise| noise.at(0.0, state).abs()).sum() };
        let own = amplitude(&state);
        state[axis] = 0.5 * (from + to);
        own <= NOTHING * amplitude(&state) && drift <= NOTHING * (to - from)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::TypedModel;

    fn ends(noise: &str) -> [bool; 2] {
        let typed = TypedModel::new("typed", "A typed system", ["x", "y"])
            .with_equation("x", "x (1 - x) - 0.3 x y")
            .with_equation("y", "x - y")
            .with_noise("x", [noise])
            .with_noise("y", ["0.2"])
            .with_interpretation(crate::system::Interpretation::Ito);
        let system = typed.build().unwrap().system_with(&[]).unwrap();
        let ranges = [(0.0, 3.0), (-1.0, 2.0)];
        assert_eq!(closed_ends(&*system, 1, &ranges), [false; 2]);
        closed_ends(&*system, 0, &ranges)
    }

    #[test]
    fn what_dies_out_on_several_axes_together_may_stay_there() {
        let patches = |immigration: &str| {
            let typed = TypedModel::new("typed", "Two patches", ["x", "y"])
                .with_equation("x", format!("{immigration} + 0.1 x - x^2 + 0.3 (y - x)"))
                .with_equation("y", "0.1 y - y^2 + 0.3 (x - y)")
                .with_noise("x", ["0.6 x"])
                .with_noise("y", ["0.6 y"])
                .with_interpretation(crate::system::Interpretation::Ito);
            let system = typed.build().unwrap().system_with(&[]).unwrap();
            let ranges = [(0.0, 3.0); 2];
            let natural = [0, 1].map(|axis| natural_ends(&*system, axis, &ranges));
            assert_eq!(natural, [[true, false]; 2]);
            [0, 1].map(|axis| may_stay(&*system, &ranges, &natural, (axis, 0)))
        };
        // Neither dies out alone, as the other one sends some.
        assert_eq!(patches("0"), [true; 2]);
        assert_eq!(patches("0.01"), [false; 2]);
    }

    #[test]
    fn the_largest_power_beside_an_end_is_that_of_the_best_place() {
        let power = |drift: &str, noise: &str| {
            let typed = TypedModel::new("typed", "A typed system", ["x", "y"])
                .with_equation("x", drift)
                .with_equation("y", "x - y")
                .with_noise("x", [noise])
                .with_noise("y", ["0.2"])
                .with_interpretation(crate::system::Interpretation::Ito);
            let system = typed.build().unwrap().system_with(&[]).unwrap();
            largest_power(&*system, 0, &[(0.0, 3.0), (-1.0, 2.0)], false)
        };
        // x^(2a/s² - 2), and with the noise of a square root x^(2a/s² - 1).
        assert!((power("-0.2 x - x^2", "0.5 x").unwrap() + 3.6).abs() < 1e-6);
        assert!((power("0.3 - x", "0.5 sqrt(x)").unwrap() - 1.4).abs() < 1e-5);
        // Of places y from -1 to 2 the one at 0.98 of the way has the largest.
        let best = 2.0 * (0.1 * (-1.0 + 3.0 * 0.98)) / 0.25 - 2.0;
        assert!((power("0.1 y x - x^2", "0.5 x").unwrap() - best).abs() < 1e-6);
        // A drift that leads in makes the density fall faster than any power.
        assert_eq!(power("0.1 - x", "0.5 x"), None);
    }

    #[test]
    fn an_end_at_which_noise_dies_and_drift_does_not_lead_out_is_closed() {
        assert_eq!(ends("0.3 x"), [true, false]);
        assert_eq!(ends("0.3 sqrt(x)"), [true, false]);
        assert_eq!(ends("0.3 x (3 - x)"), [true, true]);
        assert_eq!(ends("0.3"), [false, false]);
        assert_eq!(ends("0.3 (x + 0.01)"), [false, false]);
    }
}
