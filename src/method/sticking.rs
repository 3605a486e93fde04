//! Friction that sticks: where the drift across a switching surface points toward it from both sides and no white noise
//! acts across, a part of the probability lies on the surface itself, and there is no density (P. M. Geffert and W.
//! Just, 2017).

use super::MethodError;
use crate::system::{Family, SwitchingSurface, System};

/// States of a surface that are looked at.
const STATES: usize = 256;
/// Distance from a surface at which the drift is taken, as a share of the range of its axis.
const BESIDE: f64 = 1e-7;
/// A jump of the drift, relative to its largest size on the surface, that is rounding.
const ROUNDING: f64 = 1e-9;
/// Halvings of the way between a state that is pushed up and one that is pushed down.
const HALVINGS: usize = 60;

/// Nothing, if at both ends and in the middle of a path nothing sticks to a switching surface of the domain, whose
/// ranges are one an axis.
///
/// # Errors
/// [`MethodError::Sticks`]; [`MethodError::System`] for values that are not allowed.
pub(crate) fn check_sticking(family: &Family, ranges: &[(f64, f64)]) -> Result<(), MethodError> {
    let (from, to) = family.ends();
    for value in [from, 0.5 * (from + to), to] {
        let system = family.at(value)?;
        let stuck = stuck_state(system.as_ref(), ranges);
        if let Some((surface, state)) = stuck {
            let mut words: Vec<String> = Vec::new();
            for (axis, x) in state.iter().enumerate() {
                if axis != surface.axis {
                    words.push(format!("{} = {x:.3}", family.axis(axis)));
                }
            }
            words.push(format!("{} = {value}", family.parameter()));
            return Err(MethodError::Sticks {
                axis: family.axis(surface.axis).to_owned(),
                at: surface.at,
                state: words.join(", "),
            });
        }
    }
    Ok(())
}

/// A surface on which states stay, and one of these.
fn stuck_state(system: &dyn System, ranges: &[(f64, f64)]) -> Option<(SwitchingSurface, Vec<f64>)> {
    let surfaces = system.facts().switching_surfaces.iter().copied();
    let mut inside = surfaces.filter(|surface| {
        let range = ranges.get(surface.axis);
        range.is_some_and(|(from, to)| surface.at > *from && surface.at < *to)
            && !system.is_noisy(surface.axis)
    });
    inside.find_map(|surface| Some((surface, stuck_on(system, surface, ranges)?)))
}

/// A state of the surface that the drift keeps there: below it the drift across points up and above it down. Where the
/// drift jumps down everywhere, one lies between every state that is pushed up through the surface and every one that
/// is pushed down.
fn stuck_on(
    system: &dyn System,
    surface: SwitchingSurface,
    ranges: &[(f64, f64)],
) -> Option<Vec<f64>> {
    let states: Vec<Vec<f64>> = (0..STATES).map(|index| spread(index, ranges)).collect();
    let distance = BESIDE * (ranges[surface.axis].1 - ranges[surface.axis].0);
    // Jump across the surface from below, and the mean of both sides.
    let look = |state: &[f64]| {
        let jump = surface.drift_jump(system, state, distance)[surface.axis];
        let mut beside = state.to_vec();
        let mut push = 0.0;
        for side in [-distance, distance] {
            beside[surface.axis] = surface.at + side;
            push += 0.5 * system.drift_at(0.0, &beside)[surface.axis];
        }
        (jump, push)
    };
    let seen: Vec<(f64, f64)> = states.iter().map(|state| look(state)).collect();
    let largest = seen.iter().map(|(_, push)| push.abs()).fold(0.0, f64::max);
    let holds = |(jump, push): (f64, f64)| jump < -ROUNDING * largest && push.abs() < -0.5 * jump;
    let mut jumping = seen.iter().zip(&states);
    if let Some((_, state)) = jumping.find(|(one, _)| holds(**one)) {
        return Some(state.clone());
    }
    let pushed = |up: bool| {
        let mut all = seen.iter().zip(&states);
        all.find(|((jump, push), _)| *jump < -ROUNDING * largest && (*push > 0.0) == up)
    };
    let (mut up, mut down) = (pushed(true)?.1.clone(), pushed(false)?.1.clone());
    for _ in 0..HALVINGS {
        let middle: Vec<f64> = up.iter().zip(&down).map(|(a, b)| 0.5 * (a + b)).collect();
        let found = look(&middle);
        if holds(found) {
            return Some(middle);
        }
        if found.1 > 0.0 {
            up = middle
        } else {
            down = middle
        }
    }
    None
}

/// States over a box, of no simple ratio to each other: multiples of the golden section and its like, one an axis.
fn spread(index: usize, ranges: &[(f64, f64)]) -> Vec<f64> {
    const STEPS: [f64; 4] = [
        0.618_033_988_75,
        0.754_877_666_25,
        0.569_840_290_998,
        0.438_447_187_19,
    ];
    let axes = ranges.iter().enumerate();
    axes.map(|(axis, (from, to))| {
        from + ((index + 1) as f64 * STEPS[axis % 4]).fract() * (to - from)
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Model, NoiseKind, Path, registry};

    const RANGES: [(f64, f64); 3] = [(-5.0, 5.0), (-5.0, 5.0), (-6.0, 6.0)];

    fn family(name: &str, given: &[(&str, f64)], ends: (f64, f64), coloured: bool) -> Family {
        let white = registry::find(name).unwrap();
        let mut given = given.to_vec();
        let model = if coloured {
            given.push(("tau", 0.5));
            Model::with_coloured_noise(&white, NoiseKind::OrnsteinUhlenbeck).unwrap()
        } else {
            white
        };
        Family::new(model, &given, Path::parameter("f_c", ends.0, ends.1)).unwrap()
    }

    #[test]
    fn dry_friction_sticks_without_white_noise_only() {
        let given = [("kappa", 0.1), ("mu", 10.0), ("sigma2", 0.1)];
        let check = |ends, coloured| {
            let ranges = &RANGES[..if coloured { 3 } else { 2 }];
            check_sticking(&family("coulomb", &given, ends, coloured), ranges)
        };
        assert!(check((-0.1, 0.1), false).is_ok());
        // Friction that feeds energy in throws states off the surface.
        assert!(check((-0.1, -0.2), true).is_ok());
        // However little friction there is: the force is a thousand times as large over most of the domain.
        for level in [0.5, 1e-6] {
            let refused = check((-0.1, level), true).unwrap_err().to_string();
            assert!(
                refused.contains("`y`") && refused.contains("f_c = "),
                "{refused}"
            );
        }
    }

    #[test]
    fn friction_that_remembers_does_not_stick() {
        let given = [("kappa", 0.1), ("lambda", 2.0), ("sigma2", 0.1)];
        let ranges = [RANGES[0], RANGES[1], (-0.1, 0.1), RANGES[2]];
        let dahl = family("dahl", &given, (0.1, 0.2), true);
        assert!(check_sticking(&dahl, &ranges).is_ok());
    }
}
