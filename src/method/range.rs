//! A range that holds the density, found by free trajectories: the box is doubled until they stay in it, shrunk while
//! they fill only a corner of it, and given a margin. An end that is given stays where it is. Where no box holds them,
//! as many that begin far from the density go to infinity, trajectories are followed from where they begin.

use std::sync::Arc;

use super::swap::swaps;
use crate::cancellation::Cancellation;
use crate::sampling::{hull, pilot};
use crate::space::{Axis, CellSpace};
use crate::system::{Enclosed, System};

mod followed;
mod turns;
use followed::followed;
pub(crate) use turns::repeats_along;

/// Where trajectories start along an axis of which nothing is known.
const PILOT_BOX: (f64, f64) = (-1.0, 1.0);
/// Cells an axis of the box in which visits are counted.
const CELLS: usize = 64;
/// Share of the recorded states that must lie in the box.
const INSIDE: f64 = 0.9995;
/// Share of an axis that must have been visited, else the box is shrunk to look more closely.
const FILLED: f64 = 0.2;
/// What visits reach is widened by this factor: some 1e5 states show a normal density to 4.3 standard deviations. With
/// 5.4 of them 1e-7 of the mass is outside, and what leaks away moves located values by more than cells do; with 6.5 it
/// is 1e-10.
const MARGIN: f64 = 1.5;
/// Most times that the box is changed.
const MOST_CHANGES: usize = 40;
/// Most times that the box is shrunk toward an end that is given, or a point, by 32 each time where all visits are in
/// one cell.
const MOST_SHRUNK: usize = 12;
/// A box this short, against the distance from zero, is a point.
const TINY: f64 = 1e-11;
/// Length, two turns, of a box along an axis along which the system repeats itself: those that leave it leave any.
const TWO_TURNS: f64 = 4.0 * std::f64::consts::PI;
/// Most steps of each trajectory in all boxes together: those of ten that take the most that one box may.
const MOST_STEPS: usize = 2_000_000;

/// Why no ranges were found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum RangeError {
    /// However wide the box, trajectories leave it.
    #[error("no range holds the density: free trajectories leave every")]
    RunsAway {
        /// Number of the system among those that were given.
        system: usize,
        /// The axis along which most of them do.
        axis: usize,
    },
    /// Trajectories turn on and on along an axis along which the system is the same a turn further.
    #[error("no range holds the density: free trajectories leave every")]
    Turns {
        /// Number of the system among those that were given.
        system: usize,
        /// The axis.
        axis: usize,
    },
    /// The effort that ranges are worth was spent.
    #[error("no range was found within {steps} steps of each free trajectory")]
    TooLong {
        /// Number of the system among those that were given.
        system: usize,
        /// The axis along which most trajectories left the last box.
        axis: usize,
        /// Steps that were taken.
        steps: usize,
        /// The last box that was looked at, along that axis.
        last: (f64, f64),
    },
    /// The box got too large or too small for numbers.
    #[error(transparent)]
    Space(#[from] crate::space::SpaceError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] crate::cancellation::Cancelled),
}

/// The ranges that one way of looking for them finds, if any.
type MayFind = Result<Option<Vec<(f64, f64)>>, RangeError>;

/// The lower and the upper end of an axis, as far as they are known.
pub(crate) type KnownEnds = [Option<f64>; 2];

/// Where trajectories start along an axis: as long as the box of an axis of which nothing is known, unless both ends
/// are.
pub(crate) fn pilot_box(known: KnownEnds) -> (f64, f64) {
    let length = PILOT_BOX.1 - PILOT_BOX.0;
    match known {
        [Some(from), Some(to)] => (from, to),
        [Some(from), None] => (from, from + length),
        [None, Some(to)] => (to - length, to),
        [None, None] => PILOT_BOX,
    }
}

/// A range with the ends that are known.
fn with_known((from, to): (f64, f64), known: KnownEnds) -> (f64, f64) {
    (known[0].unwrap_or(from), known[1].unwrap_or(to))
}

/// A range twice as long, about its middle, or away from the end that is known.
fn doubled((from, to): (f64, f64), known: KnownEnds) -> (f64, f64) {
    let length = to - from;
    match known {
        [None, None] => (from - 0.5 * length, to + 0.5 * length),
        _ => with_known((from - length, to + length), known),
    }
}

/// The system with walls at ends that are given alone: what crosses them tells nothing of the other end.
fn between_given_ends(system: &Arc<dyn System>, known: &[KnownEnds]) -> Arc<dyn System> {
    let mut walls = system.facts().reflecting.clone();
    for (axis, ends) in known.iter().enumerate() {
        let wall = match ends {
            [Some(from), None] => (*from, f64::INFINITY),
            [None, Some(to)] => (f64::NEG_INFINITY, *to),
            _ => continue,
        };
        walls.insert(axis, wall);
    }
    Arc::new(Enclosed::reflecting(Arc::clone(system), &walls))
}

/// Ranges, one an axis, that hold the densities of all the systems, with the ends that are known.
///
/// # Errors
/// [`RangeError`].
pub(crate) fn automatic_ranges(
    systems: &[Arc<dyn System>],
    known: &[KnownEnds],
    seed: u64,
    cancellation: &Cancellation,
) -> Result<Vec<(f64, f64)>, RangeError> {
    let mut all: Option<Vec<(f64, f64)>> = None;
    for (number, system) in systems.iter().enumerate() {
        let system = between_given_ends(system, known);
        let found = range_of((number, system.as_ref()), known, seed, cancellation)?;
        all = Some(match all {
            None => found,
            Some(all) => hull(&all, &found),
        });
    }
    if let Some(all) = &mut all {
        // A point of all the systems has no length of its own.
        let length = PILOT_BOX.1 - PILOT_BOX.0;
        for range in all.iter_mut().filter(|range| range.0 == range.1) {
            *range = (range.0 - 0.5 * length, range.1 + 0.5 * length);
        }
        alike(systems, known, all);
    }
    let rounded = all.iter().flatten().zip(known);
    Ok(rounded
        .map(|(&found, &known)| with_known(outward(found), known))
        .collect())
}

/// Gives axes that may be exchanged in all the systems one range, where as much is known of both.
fn alike(systems: &[Arc<dyn System>], known: &[KnownEnds], hull: &mut [(f64, f64)]) {
    let Some((first, others)) = systems.split_first() else {
        return;
    };
    for pair in swaps(first.as_ref(), hull) {
        let (a, b) = pair;
        let is_free = known[a] == known[b];
        let is_always = || {
            others
                .iter()
                .all(|one| swaps(one.as_ref(), hull).contains(&pair))
        };
        if is_free && is_always() {
            let both = (hull[a].0.min(hull[b].0), hull[a].1.max(hull[b].1));
            (hull[a], hull[b]) = (both, both);
        }
    }
}

/// The ranges of one system, by boxes, or by following trajectories where these go to infinity from the ends of boxes,
/// or take steps there that are too short to settle.
fn range_of(
    (number, system): (usize, &dyn System),
    known: &[KnownEnds],
    seed: u64,
    cancellation: &Cancellation,
) -> Result<Vec<(f64, f64)>, RangeError> {
    let follow = || followed(system, known, seed, cancellation);
    let mut is_new = true;
    let found = ranges_of((number, system), known, (seed, cancellation), &mut || {
        is_new = false;
        follow()
    });
    match found {
        Err(error @ (RangeError::RunsAway { .. } | RangeError::TooLong { .. })) if is_new => {
            follow()?.ok_or(error)
        }
        found => found,
    }
}

/// The ranges of one system. An axis along which all trajectories end in one point has both ends there, and the others
/// hold what was visited; the solve tells that there is no density. Where trajectories may not settle in a box,
/// `follow` is asked once.
fn ranges_of(
    (number, system): (usize, &dyn System),
    known: &[KnownEnds],
    (seed, cancellation): (u64, &Cancellation),
    follow: &mut dyn FnMut() -> MayFind,
) -> Result<Vec<(f64, f64)>, RangeError> {
    let (mut steps, mut leaving) = (0, 0);
    let mut may_settle = true;
    let mut shrunk = vec![0; known.len()];
    let mut ranges: Vec<(f64, f64)> = known.iter().copied().map(pilot_box).collect();
    for _ in 0..MOST_CHANGES {
        let axes: Result<Vec<Axis>, _> = ranges
            .iter()
            .map(|&(from, to)| Axis::uniform(from, to, CELLS))
            .collect();
        let space = CellSpace::new(axes?)?;
        let free = || (0..ranges.len()).filter(|&axis| known[axis].contains(&None));
        if steps >= MOST_STEPS {
            return Err(RangeError::TooLong {
                system: number,
                axis: leaving,
                steps,
                last: ranges[leaving],
            });
        }
        let seen = pilot(system, &space, seed, cancellation)?;
        steps += seen.steps;
        if may_settle && !seen.may_settle {
            may_settle = false;
            if let Some(found) = follow()? {
                return Ok(found);
            }
        }
        leaving = free()
            .rev()
            .max_by_key(|&axis| seen.outside[axis])
            .unwrap_or(0);
        if seen.share_inside < INSIDE {
            let length = ranges[leaving].1 - ranges[leaving].0;
            if length >= TWO_TURNS && repeats_along(system, leaving) {
                return Err(RangeError::Turns {
                    system: number,
                    axis: leaving,
                });
            }
            for axis in free().collect::<Vec<_>>() {
                ranges[axis] = doubled(ranges[axis], known[axis]);
            }
            continue;
        }
        let visited = extents(&space, &seen.cells);
        let visited: Vec<(f64, f64)> = visited
            .into_iter()
            .zip(known)
            .map(|(range, &known)| with_known(range, known))
            .collect();
        let narrow: Vec<usize> = free()
            .filter(|&axis| {
                let length = ranges[axis].1 - ranges[axis].0;
                let is_narrow = visited[axis].1 - visited[axis].0 < FILLED * length;
                is_narrow && !ends_there(known[axis], shrunk[axis])
            })
            .collect();
        if narrow.is_empty() {
            let mut found = widened(system, &visited, known);
            for axis in free().filter(|&axis| ends_there(known[axis], shrunk[axis])) {
                found[axis] = pilot_box(known[axis]);
            }
            return Ok(found);
        }
        let is_point = |axis: usize| {
            let (from, to) = ranges[axis];
            let is_tiny =
                shrunk[axis] >= MOST_SHRUNK || to - from <= TINY * from.abs().max(to.abs());
            known[axis] == [None; 2] && is_tiny
        };
        let points: Vec<usize> = narrow
            .iter()
            .copied()
            .filter(|&axis| is_point(axis))
            .collect();
        if !points.is_empty() {
            let mut found = widened(system, &visited, known);
            for axis in points {
                let middle = 0.5 * (visited[axis].0 + visited[axis].1);
                found[axis] = (middle, middle);
            }
            return Ok(found);
        }
        for axis in narrow {
            ranges[axis] = doubled(visited[axis], known[axis]);
            shrunk[axis] += 1;
        }
    }
    Err(RangeError::RunsAway {
        system: number,
        axis: leaving,
    })
}

/// Whether trajectories end where an end was given alone: however near to it one looks, they are nearer. Such a system
/// says nothing of the other end, and the solve tells that there is no density.
fn ends_there(known: KnownEnds, shrunk: usize) -> bool {
    known.contains(&None) && known != [None; 2] && shrunk >= MOST_SHRUNK
}

/// What some cells span along each axis.
fn extents(space: &CellSpace, cells: &[usize]) -> Vec<(f64, f64)> {
    let axes = space.axes().iter().enumerate();
    axes.map(|(index, axis)| {
        let places = || cells.iter().map(|&cell| space.position(cell, index));
        let first = places().min().unwrap_or(0);
        let last = places().max().unwrap_or(0);
        (axis.edges()[first], axis.edges()[last + 1])
    })
    .collect()
}

/// Extents with a margin, and alike on both sides of a centre of symmetry. From an end that is known the margin is as
/// wide as from the middle of a range.
fn widened(system: &dyn System, visited: &[(f64, f64)], known: &[KnownEnds]) -> Vec<(f64, f64)> {
    let symmetry = &system.facts().symmetry;
    let axes = visited.iter().zip(known).enumerate();
    axes.map(|(axis, (&(from, to), known))| {
        let wider = MARGIN * (to - from);
        match *known {
            [None, None] => {}
            [Some(from), _] => return with_known((from, from + wider), *known),
            [None, Some(to)] => return (to - wider, to),
        }
        let reflected = symmetry.as_ref().filter(|s| s.reflected[axis]);
        let (centre, half) = match reflected {
            Some(symmetry) => {
                let centre = symmetry.centre[axis];
                (centre, (centre - from).max(to - centre))
            }
            None => (0.5 * (from + to), 0.5 * (to - from)),
        };
        (centre - MARGIN * half, centre + MARGIN * half)
    })
    .collect()
}

/// A range with ends rounded outward to two digits of its length.
fn outward((from, to): (f64, f64)) -> (f64, f64) {
    let unit = 10_f64.powf((to - from).log10().floor() - 1.0);
    let ends = ((from / unit).floor() * unit, (to / unit).ceil() * unit);
    // Multiples of a tenth that is not a binary number are printed as people write them.
    let plain = |value: f64| format!("{value:.12e}").parse().unwrap_or(value);
    (plain(ends.0), plain(ends.1))
}

#[cfg(test)]
mod tests;
