//! A friction law by itself, as a test bench shows it: the force on a body that is pulled along a given path.
//!
//! The path is given, so that only the internal states of the law have to be integrated: by the classical Runge-Kutta
//! method, with steps that are halved until the states no longer change.

use std::f64::consts::TAU;

use crate::system::{FIRST_INTERNAL_STATE, Model, ParameterValues, System, SystemError};

/// Places of a cycle whose states are given; a multiple of four, so that the path turns at one of them.
const PLACES: usize = 400;
/// Cycles after which a state that has not come back to itself never will.
pub(crate) const MOST_CYCLES: usize = 60;
/// Pieces in which a body is pulled in one direction until it slides steadily, over so many yielding distances.
const PIECES: usize = 200;
const FAR: f64 = 40.0;
/// Relative change of the states with half the step, or from cycle to cycle, that is none.
const SAME: f64 = 1e-7;
/// Share of the largest force of a cycle that is no gap between its ends.
const CLOSED: f64 = 1e-4;
/// Halvings of a step, at most.
const MOST_HALVINGS: u32 = 12;

/// Values that show the shape of a law, of parameters without a default; of all others 1 does.
const SHOWN: [(&str, f64); 6] = [
    ("f_s", 1.5),
    ("f_m", 0.6),
    ("v_s", 0.5),
    ("v_m", 0.5),
    ("f_2", 0.5),
    ("rho", 0.4),
];

/// Values that show the shape of a model's friction law: those that are given, else defaults, else numbers about 1.
///
/// # Errors
/// As [`Model::values`].
pub(crate) fn shown_values(
    model: &Model,
    given: &[(&str, f64)],
) -> Result<ParameterValues, SystemError> {
    let free = model.parameters.iter().filter(|one| one.default.is_none());
    let shown = |name: &str| {
        let known = SHOWN.iter().find(|(one, _)| *one == name);
        known.map_or(1.0, |&(_, value)| value)
    };
    let mut values: Vec<(&str, f64)> = free
        .map(|one| (one.name.as_str(), shown(&one.name)))
        .collect();
    values.extend(given);
    model.values(&values)
}

/// Whether a system has a friction law that exerts a force.
pub(crate) fn has_friction(system: &dyn System) -> bool {
    system
        .friction_force(&vec![0.0; system.dimension()])
        .is_some()
}

/// One place of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pulled {
    /// Displacement x.
    pub displacement: f64,
    /// Velocity x'.
    pub velocity: f64,
    /// Friction force per unit mass, without its viscous part.
    pub force: f64,
}

/// Distance over which a law's contact yields: the largest of what its internal states may be over the rate at which
/// they grow from zero, a unit of distance. `None` without bounded internal states.
pub(crate) fn yielding_distance(system: &dyn System) -> Option<f64> {
    let mut moving = vec![0.0; system.dimension()];
    *moving.get_mut(1)? = 1.0;
    let rates = system.drift_at(0.0, &moving);
    let distance = |axis: usize| {
        let (low, high) = system.facts().bounds(axis)?;
        Some(0.5 * (high - low) / rates[axis].abs())
    };
    let distances = (FIRST_INTERNAL_STATE..system.dimension()).filter_map(distance);
    distances.filter(|one| one.is_finite()).reduce(f64::max)
}

/// Friction force at a velocity that has been kept for long. `None` where the system has no friction law, or its states
/// do not settle.
pub(crate) fn steady_sliding(system: &dyn System, velocity: f64) -> Option<f64> {
    if !has_friction(system) {
        return None;
    }
    let mut states = vec![0.0; system.dimension().saturating_sub(FIRST_INTERNAL_STATE)];
    if !states.is_empty() && velocity != 0.0 {
        let time = FAR * yielding_distance(system)? / velocity.abs();
        let path = |time: f64| [velocity * time, velocity];
        let piece = time / PIECES as f64;
        for index in 0..PIECES {
            if !advance(system, &path, index as f64 * piece, piece, &mut states) {
                return None;
            }
        }
        let before = states.clone();
        let goes_on = advance(system, &path, time, time / FAR, &mut states);
        if !goes_on || !is_same(system, &before, &states, 10.0 * SAME) {
            return None;
        }
    }
    force(system, [0.0, velocity], &states)
}

/// One cycle of a body that is pulled to and fro, x = `amplitude` sin(ωt) with a largest velocity of `fastest`, from
/// the middle upward and back to it, after as many cycles as the states need to come back to themselves, at most
/// [`MOST_CYCLES`]: see [`closes`]. Empty where the system has no friction law, or amplitude or velocity is not
/// positive, and where its states run away.
pub(crate) fn cycle(system: &dyn System, amplitude: f64, fastest: f64) -> Vec<Pulled> {
    let is_path = amplitude > 0.0 && fastest > 0.0 && (amplitude + fastest).is_finite();
    if !is_path || !has_friction(system) {
        return Vec::new();
    }
    let period = TAU * amplitude / fastest;
    let path = |time: f64| {
        let phase = TAU * time / period;
        [amplitude * phase.sin(), fastest * phase.cos()]
    };
    let mut states = vec![0.0; system.dimension().saturating_sub(FIRST_INTERNAL_STATE)];
    let piece = period / PLACES as f64;
    let mut found = Vec::new();
    for _ in 0..MOST_CYCLES {
        let before = states.clone();
        found.clear();
        for place in 0..=PLACES {
            let time = place as f64 * piece;
            let [displacement, velocity] = path(time);
            found.extend(
                force(system, [displacement, velocity], &states).map(|force| Pulled {
                    displacement,
                    velocity,
                    force,
                }),
            );
            if place < PLACES && !advance(system, &path, time, piece, &mut states) {
                return Vec::new();
            }
        }
        if is_same(system, &before, &states, SAME) {
            break;
        }
    }
    found
}

/// Whether a cycle ends with the force that it began with; it does not where the states never come back to themselves.
pub(crate) fn closes(cycle: &[Pulled]) -> bool {
    let sizes = cycle.iter().map(|one| one.force.abs());
    let largest = sizes.fold(0.0, f64::max);
    match (cycle.first(), cycle.last()) {
        (Some(first), Some(last)) => (last.force - first.force).abs() <= CLOSED * largest,
        _ => false,
    }
}

fn force(system: &dyn System, motion: [f64; 2], states: &[f64]) -> Option<f64> {
    let force = system.friction_force(&[&motion[..], states].concat())?;
    force.is_finite().then_some(force)
}

/// Whether internal states are the same, measured in what they may be.
fn is_same(system: &dyn System, one: &[f64], other: &[f64], share: f64) -> bool {
    let pairs = one.iter().zip(other).enumerate();
    pairs.into_iter().all(|(index, (a, b))| {
        let bounds = system.facts().bounds(FIRST_INTERNAL_STATE + index);
        let size = bounds.map_or(a.abs().max(b.abs()), |(low, high)| 0.5 * (high - low));
        (a - b).abs() <= share * size
    })
}

/// Brings the internal states on over a piece of the path, with so many steps that half as many give the same; false
/// where they run away.
fn advance(
    system: &dyn System,
    path: &dyn Fn(f64) -> [f64; 2],
    from: f64,
    length: f64,
    states: &mut Vec<f64>,
) -> bool {
    if states.is_empty() {
        return true;
    }
    let mut coarse = integrate(system, path, (from, length, 1), states);
    for halvings in 1..=MOST_HALVINGS {
        let fine = integrate(system, path, (from, length, 1 << halvings), states);
        let done = is_same(system, &coarse, &fine, 0.01 * SAME);
        coarse = fine;
        if done {
            break;
        }
    }
    *states = coarse;
    states.iter().all(|state| state.is_finite())
}

fn integrate(
    system: &dyn System,
    path: &dyn Fn(f64) -> [f64; 2],
    (from, length, steps): (f64, f64, u32),
    states: &[f64],
) -> Vec<f64> {
    let rates = |time: f64, states: &[f64]| -> Vec<f64> {
        let state = [&path(time)[..], states].concat();
        system.drift_at(0.0, &state).split_off(FIRST_INTERNAL_STATE)
    };
    let along = |states: &[f64], step: f64, rates: &[f64]| -> Vec<f64> {
        let pairs = states.iter().zip(rates);
        pairs.map(|(state, rate)| state + step * rate).collect()
    };
    let step = length / f64::from(steps);
    let mut states = states.to_vec();
    for index in 0..steps {
        let time = from + f64::from(index) * step;
        let first = rates(time, &states);
        let second = rates(time + 0.5 * step, &along(&states, 0.5 * step, &first));
        let third = rates(time + 0.5 * step, &along(&states, 0.5 * step, &second));
        let fourth = rates(time + step, &along(&states, step, &third));
        for (index, state) in states.iter_mut().enumerate() {
            let middle = second[index] + third[index];
            *state += step / 6.0 * (first[index] + 2.0 * middle + fourth[index]);
        }
    }
    states
}

#[cfg(test)]
mod tests;
