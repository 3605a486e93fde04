//! Ends of a range that nothing passes.

use super::System;

/// Places along each other axis at which an end is looked at, as shares of its range.
const LOOKS: [f64; 7] = [0.03, 0.17, 0.36, 0.52, 0.68, 0.85, 0.98];

/// What is no noise, as a share of the amplitude in the middle of the range; and no drift, as a share of the range in a
/// unit of time.
const NOTHING: f64 = 1e-12;

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

/// Whether drift leads away from an end somewhere along it: nothing then stays there, though noise dies.
pub(crate) fn is_left(
    system: &dyn System,
    axis: usize,
    ranges: &[(f64, f64)],
    is_upper: bool,
) -> bool {
    let (from, to) = ranges[axis];
    let (at, outward) = if is_upper { (to, 1.0) } else { (from, -1.0) };
    let least = NOTHING * (to - from);
    let mut states = states_at(axis, ranges, at);
    states.any(|state| outward * system.drift_at(0.0, &state)[axis] < -least)
}

/// States at a place of an axis, wherever the other coordinates are.
fn states_at(axis: usize, ranges: &[(f64, f64)], at: f64) -> impl Iterator<Item = Vec<f64>> {
    let others = u32::try_from(ranges.len() - 1).unwrap_or(0);
    (0..LOOKS.len().pow(others)).map(move |place| {
        let mut rest = place;
        let place_of = |(other, &(low, high)): (usize, &(f64, f64))| {
            if other == axis {
                return at;
            }
            let share = LOOKS[rest % LOOKS.len()];
            rest /= LOOKS.len();
            low + share * (high - low)
        };
        ranges.iter().enumerate().map(place_of).collect()
    })
}

/// Whether noise dies at an end, and drift does not lead out, wherever the other coordinates are.
fn is_natural(
    system: &dyn System,
    axis: usize,
    ranges: &[(f64, f64)],
    (at, outward): (f64, f64),
) -> bool {
    let (from, to) = ranges[axis];
    states_at(axis, ranges, at).all(|mut state| {
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
    fn an_end_at_which_noise_dies_and_drift_does_not_lead_out_is_closed() {
        assert_eq!(ends("0.3 x"), [true, false]);
        assert_eq!(ends("0.3 sqrt(x)"), [true, false]);
        assert_eq!(ends("0.3 x (3 - x)"), [true, true]);
        assert_eq!(ends("0.3"), [false, false]);
        assert_eq!(ends("0.3 (x + 0.01)"), [false, false]);
    }
}
