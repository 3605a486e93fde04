//! A range where no box holds all trajectories: it is found from where those settle that begin near the middle, and
//! then from all over a box twice as wide as what they passed. Those that go to infinity from there say nothing.
//!
//! A force that is a high power, an exponential or a quotient sends what begins far away to infinity, or takes steps
//! there that are far too short for the rest. The density knows nothing of such places.

use super::{KnownEnds, MayFind, doubled, pilot_box, widened, with_known};
use crate::cancellation::Cancellation;
use crate::sampling::{hull, settled};
use crate::system::System;

/// Boxes that are tried: in each, trajectories may settle where none did before.
const BOXES: usize = 4;

/// The ranges of one system; none where trajectories from the middle do not settle.
pub(super) fn followed(
    system: &dyn System,
    known: &[KnownEnds],
    seed: u64,
    cancellation: &Cancellation,
) -> MayFind {
    let free: Vec<usize> = (0..known.len())
        .filter(|&axis| known[axis].contains(&None))
        .collect();
    let mut start: Vec<(f64, f64)> = known.iter().copied().map(pilot_box).collect();
    for number in 0..BOXES {
        let Some(found) = settled(system, &start, &free, seed, cancellation)? else {
            return Ok(None);
        };
        let is_held = |axis: &usize| {
            let (from, to) = found.visited[*axis];
            start[*axis].0 <= from && to <= start[*axis].1
        };
        if number > 0 && free.iter().all(is_held) {
            let axes = found.visited.into_iter().zip(known);
            let visited: Vec<(f64, f64)> =
                axes.map(|(one, &known)| with_known(one, known)).collect();
            return Ok(Some(widened(system, &visited, known)));
        }
        let next = hull(&start, &found.passed);
        for &axis in &free {
            start[axis] = doubled(next[axis], known[axis]);
        }
    }
    Ok(None)
}
