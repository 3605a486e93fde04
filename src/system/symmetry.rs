//! Reflections that a system has, found and proved by trial: drift and noise at states and at their images.

use super::ends::closed_ends;
use super::{LANES, Lanes, Symmetry, System};
use crate::numerics::bisected;

/// Relative difference of drift or noise at a state and its image that is rounding.
const ROUNDING: f64 = 1e-9;

/// Batches of states that are tried.
const BATCHES: usize = 2;

/// The reflection of a system on a box with the given ends, one pair an axis: the one it declares, where that holds, or
/// else one about the origin or the middle of the box that is found by trial, with the most axes reflected. Trial
/// cannot tell a symmetry that fails only in a part of the box that no tried state lies in.
pub(crate) fn proved_symmetry(system: &dyn System, ends: &[(f64, f64)]) -> Option<Symmetry> {
    symmetry(system, ends, None)
}

/// As [`proved_symmetry`], of densities over a whole period of a forcing: the reflection may need half a period, as x →
/// -x of x' = f(x) + cos(ω t) with an odd f does.
pub(crate) fn symmetry_over_a_period(system: &dyn System, ends: &[(f64, f64)]) -> Option<Symmetry> {
    let at_any_phase = proved_symmetry(system, ends);
    at_any_phase.or_else(|| symmetry(system, ends, Some(system.facts().phase?)))
}

/// The reflection, together with half a turn of an axis where one is given.
fn symmetry(system: &dyn System, ends: &[(f64, f64)], shifted: Option<usize>) -> Option<Symmetry> {
    if let Some(declared) = system.facts().symmetry.clone() {
        let is_there = holds(system, &declared, ends, shifted) && fits(system, &declared, ends);
        return is_there.then_some(declared);
    }
    let axes = system.dimension();
    let middle: Vec<f64> = ends.iter().map(|(from, to)| 0.5 * (from + to)).collect();
    let mut found: Vec<Symmetry> = Vec::new();
    let mut centres = vec![vec![0.0; axes], middle];
    centres.extend(on_turns(system, &centres));
    for centre in centres {
        for subset in 1..1_usize << axes {
            let candidate = Symmetry {
                centre: centre.clone(),
                reflected: (0..axes).map(|axis| subset >> axis & 1 == 1).collect(),
            };
            if holds(system, &candidate, ends, shifted) && fits(system, &candidate, ends) {
                found.push(candidate);
            }
        }
    }
    let reflected = |one: &Symmetry| one.reflected.iter().filter(|&&is| is).count();
    // The first of those with the most axes: about the origin where both serve.
    let most = found.iter().map(reflected).max()?;
    found.into_iter().find(|one| reflected(one) == most)
}

/// Whether ends that nothing passes are mirror images of each other: on one side of zero alone, where no path crosses
/// it, a density is no image of itself, though the equations are.
fn fits(system: &dyn System, symmetry: &Symmetry, ends: &[(f64, f64)]) -> bool {
    let turns = &system.facts().turns;
    let mut reflected = (0..ends.len()).filter(|axis| symmetry.reflected[*axis]);
    reflected.all(|axis| {
        let (from, to) = ends[axis];
        let is_middle =
            || (0.5 * (from + to) - symmetry.centre[axis]).abs() <= ROUNDING * (to - from);
        turns.contains_key(&axis)
            || match closed_ends(system, axis, ends) {
                [false, false] => true,
                [low, high] => low && high && is_middle(),
            }
    })
}

/// Places along a turn at which the drift along an axis is looked at for a change of its sign.
const LOOKS: usize = 64;
/// Share of half a turn that is rounding.
const SAME_PLACE: f64 = 1e-9;
/// Halvings of the interval that holds a zero: to the last bit.
const HALVINGS: usize = 60;

/// Some centres with another place on an axis that closes on itself, which has no middle: at a centre the drift along
/// what is reflected vanishes, and so it is one of the zeros along the turn.
fn on_turns(system: &dyn System, centres: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let facts = system.facts();
    let turns = facts.turns.iter();
    let turns = turns.filter(|(axis, _)| facts.phase != Some(**axis));
    let mut found = Vec::new();
    for ((&turn, &(from, to)), centre) in
        turns.flat_map(|turn| centres.iter().map(move |c| (turn, c)))
    {
        let at = |x: f64| {
            let mut state = centre.clone();
            state[turn] = x;
            state
        };
        for axis in 0..system.dimension() {
            let drift = |x: f64| system.drift_at(0.0, &at(x))[axis];
            // Off a round place, so that none of these is a zero itself.
            let place = |k: usize| from + (to - from) * (k as f64 + 0.37) / LOOKS as f64;
            let values: Vec<f64> = (0..=LOOKS).map(|k| drift(place(k))).collect();
            // Of the two places that a reflection holds the one in the middle half of the turn, whichever is found:
            // it must not change along a sweep.
            let middle = 0.5 * (from + to);
            let half = 0.5 * (to - from);
            let chosen = |x: f64| x - half * ((x - middle) / half - SAME_PLACE).round();
            let crossed = (0..LOOKS).filter(|&k| values[k] * values[k + 1] < 0.0);
            let zero = |k: usize| {
                let ends = (place(k), place(k + 1));
                bisected(ends, HALVINGS, |x| drift(x) * values[k] > 0.0)
            };
            found.extend(crossed.map(|k| at(chosen(zero(k)))));
        }
    }
    found
}

/// Whether drift and noise at the images of states are the images of those at the states.
fn holds(
    system: &dyn System,
    symmetry: &Symmetry,
    ends: &[(f64, f64)],
    shifted: Option<usize>,
) -> bool {
    let axes = system.dimension();
    if symmetry.centre.len() != axes || symmetry.reflected.len() != axes || ends.len() != axes {
        return false;
    }
    (0..BATCHES).all(|batch| {
        let states: Vec<Lanes> = (0..axes)
            .map(|axis| spread(batch, axis, ends[axis]))
            .collect();
        let images: Vec<Lanes> = (0..axes)
            .map(|axis| {
                let moves = shifted == Some(axis);
                let half_a_turn = if moves {
                    0.5 * (ends[axis].1 - ends[axis].0)
                } else {
                    0.0
                };
                states[axis].map(|value| symmetry.image(axis, value) + half_a_turn)
            })
            .collect();
        drifts_agree(system, symmetry, &states, &images) && noise_agrees(system, &states, &images)
    })
}

/// States over an interval, of no simple ratio to each other: multiples of the golden section and its like, one an
/// axis.
fn spread(batch: usize, axis: usize, (from, to): (f64, f64)) -> Lanes {
    const STEPS: [f64; 4] = [
        0.618_033_988_75,
        0.754_877_666_25,
        0.569_840_290_998,
        0.438_447_187_19,
    ];
    let mut lanes = [0.0; LANES];
    for (lane, value) in lanes.iter_mut().enumerate() {
        let share = ((batch * LANES + lane + 1) as f64 * STEPS[axis % 4]).fract();
        *value = from + share * (to - from);
    }
    lanes
}

fn drifts_agree(
    system: &dyn System,
    symmetry: &Symmetry,
    states: &[Lanes],
    images: &[Lanes],
) -> bool {
    let at = |states: &[Lanes]| {
        let mut drift = vec![[0.0; LANES]; states.len()];
        system.drift(0.0, states, &mut drift);
        drift
    };
    let (here, there) = (at(states), at(images));
    (0..states.len()).all(|axis| {
        let sign = if symmetry.reflected[axis] { -1.0 } else { 1.0 };
        let image = here[axis].map(|value| sign * value);
        agree(&image, &there[axis])
    })
}

/// The sign of an amplitude does not matter: a Wiener process has none.
fn noise_agrees(system: &dyn System, states: &[Lanes], images: &[Lanes]) -> bool {
    system.noises().iter().all(|noise| {
        let at = |states: &[Lanes]| noise.amplitudes(0.0, states).map(f64::abs);
        agree(&at(states), &at(images))
    })
}

fn agree(a: &Lanes, b: &Lanes) -> bool {
    let size = a
        .iter()
        .chain(b)
        .map(|value| value.abs())
        .fold(0.0, f64::max);
    let pairs = a.iter().zip(b);
    size.is_finite()
        && pairs
            .into_iter()
            .all(|(a, b)| (a - b).abs() <= ROUNDING * size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Facts, Noise};

    #[test]
    fn on_one_side_of_a_zero_that_no_path_crosses_nothing_is_its_own_image() {
        let typed = crate::system::TypedModel::new("typed", "A typed system", ["x", "y"])
            .with_equation("x", "0.25 x - x^3")
            .with_equation("y", "x - y")
            .with_noise("x", ["0.3 x"])
            .with_noise("y", ["0.2"])
            .with_interpretation(crate::system::Interpretation::Ito);
        let system = typed.build().unwrap().system_with(&[]).unwrap();
        let reflected = |from: f64| {
            let found = proved_symmetry(&*system, &[(from, 2.0), (-3.0, 3.0)]);
            found.map(|one| one.reflected)
        };
        assert_eq!(reflected(-2.0), Some(vec![true; 2]));
        assert_eq!(reflected(-1.9), Some(vec![true; 2]));
        assert_eq!(reflected(0.0), None);
    }

    /// x' = y, y' = -y - x³ + lean + noise, which declares whatever it is told to.
    struct Leaning {
        lean: f64,
        noise: [Noise; 1],
        facts: Facts,
    }

    impl System for Leaning {
        fn dimension(&self) -> usize {
            2
        }
        fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
            for lane in 0..LANES {
                let (x, y) = (states[0][lane], states[1][lane]);
                drift[0][lane] = y;
                drift[1][lane] = -y - x.powi(3) + self.lean;
            }
        }
        fn noises(&self) -> &[Noise] {
            &self.noise
        }
        fn facts(&self) -> &Facts {
            &self.facts
        }
    }

    fn leaning(lean: f64, symmetry: Option<Symmetry>) -> Leaning {
        Leaning {
            lean,
            noise: [Noise::constant(1, 0.3)],
            facts: Facts {
                symmetry,
                ..Facts::default()
            },
        }
    }

    #[test]
    fn a_symmetry_is_found_where_nobody_declared_one() {
        let system = leaning(0.0, None);
        for ends in [[(-2.0, 2.0), (-2.0, 2.0)], [(-2.0, 3.0), (-1.0, 2.0)]] {
            assert_eq!(
                proved_symmetry(&system, &ends),
                Some(Symmetry::about_origin(2))
            );
        }
    }

    #[test]
    fn a_circle_is_mirrored_about_places_that_are_found() {
        let model = crate::system::TypedModel::new("circle", "Circle", ["x"])
            .with_equation("x", "w - sin(x - 1.2) - 0.3 sin(2 x - 2.4)")
            .with_noise("x", ["1 + 0.2 cos(x - 1.2)"])
            .with_interpretation(crate::system::Interpretation::Ito)
            .with_angle("x", std::f64::consts::TAU)
            .with_parameters(["w"])
            .build()
            .unwrap();
        let found = |w: f64| {
            let system = model.system_with(&[("w", w)]).unwrap();
            proved_symmetry(system.as_ref(), &[system.facts().turns[&0]])
        };
        let centre = found(0.0).unwrap().centre[0];
        let pi = std::f64::consts::PI;
        let off = [1.2, 1.2 - pi].map(|one| (centre - one).abs());
        assert!(off[0].min(off[1]) < 1e-12, "{centre}");
        assert_eq!(found(0.1), None);
    }

    #[test]
    fn a_declared_symmetry_that_fails_is_none() {
        let ends = [(-2.0, 2.0), (-2.0, 2.0)];
        for declared in [None, Some(Symmetry::about_origin(2))] {
            let system = leaning(1e-3, declared);
            assert_eq!(proved_symmetry(&system, &ends), None);
        }
    }
}
