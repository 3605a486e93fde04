//! Parts of a region that lie between nodes: a disc narrower than a cell, or a strip between two rows of nodes.
//!
//! A generator on cells knows of a region what its nodes know. A part without a node is never entered there, on no
//! number of schemes, so that the numbers of all grids may agree on a time that is wrong by factors. The level of a
//! region is negative inside of it, so that such a part has a lowest level between nodes outside, and the nodes beside
//! that lowest place are lower than all that surround them: from these nodes the level is followed downward.

use crate::generator::{GeneratorError, levels};
use crate::space::CellSpace;
use crate::system::BoundQuantity;

/// First step of the way downward from a node, over the distance to the next one, and the step at which it ends.
const FIRST_STEP: f64 = 0.5;
const LAST_STEP: f64 = 1e-3;

/// Distance that the way keeps from an end of the range, over the distance between nodes: a border on the end itself is
/// no part of a region.
const OFF_THE_END: f64 = 1e-6;

/// Whether a region has a part without a node of some cells, in their range.
///
/// # Errors
/// Those of the level.
pub(super) fn has_pocket(space: &CellSpace, level: &BoundQuantity) -> Result<bool, GeneratorError> {
    let levels = levels(space, level)?;
    let moving: Vec<usize> = (0..space.dimension())
        .filter(|&axis| !space.axes()[axis].is_modes())
        .collect();
    let shape = space.shape();
    let directions = directions(moving.len());
    let strides: Vec<usize> = moving
        .iter()
        .map(|&axis| shape[axis + 1..].iter().product())
        .collect();
    let is_lowest = |cell: usize| {
        directions.iter().all(|direction| {
            let mut other = cell as isize;
            for ((&axis, &stride), &step) in moving.iter().zip(&strides).zip(direction) {
                let position = space.position(cell, axis) as isize + step;
                if position < 0 || position >= shape[axis] as isize {
                    return true;
                }
                other += step * stride as isize;
            }
            levels[cell] <= levels[other as usize]
        })
    };
    let outside = (0..levels.len()).filter(|&cell| levels[cell] >= 0.0);
    let mut lowest = outside.filter(|&cell| is_lowest(cell));
    Ok(lowest.any(|cell| {
        let mut boxes = vec![(0.0, 0.0); space.dimension()];
        let mut state = vec![0.0; space.dimension()];
        for (axis, own) in space.axes().iter().enumerate() {
            let (nodes, at) = (own.nodes(), space.position(cell, axis));
            state[axis] = nodes[at];
            boxes[axis] = match own.is_modes() {
                true => (nodes[at], nodes[at]),
                false => around(nodes, at, (own.from(), own.to())),
            };
        }
        downward(|state| level.at(state), state, &boxes, &directions, &moving).is_some()
    }))
}

/// Places inside a region between places of a line that are all outside of it.
pub(super) fn pockets_on_line(places: &[f64], level: &BoundQuantity) -> Vec<f64> {
    let levels: Vec<f64> = places.iter().map(|&place| level.at(&[place])).collect();
    let (Some(&from), Some(&to)) = (places.first(), places.last()) else {
        return Vec::new();
    };
    let lowest = (0..places.len()).filter(|&at| {
        let is_below = |other: Option<&f64>| other.is_none_or(|other| levels[at] <= *other);
        levels[at] >= 0.0
            && is_below(at.checked_sub(1).and_then(|other| levels.get(other)))
            && is_below(levels.get(at + 1))
    });
    let directions = directions(1);
    let found = lowest.filter_map(|at| {
        let boxes = [around(places, at, (from, to))];
        let state = vec![places[at]];
        downward(|state| level.at(state), state, &boxes, &directions, &[0])
    });
    found.flatten().collect()
}

/// From the node before to the one after, within the range.
fn around(nodes: &[f64], at: usize, (from, to): (f64, f64)) -> (f64, f64) {
    let before = at.checked_sub(1).map(|other| nodes[other]);
    let after = nodes.get(at + 1).copied();
    let off = |end: f64| OFF_THE_END * (nodes[at] - end);
    (
        before.unwrap_or(from + off(from)),
        after.unwrap_or(to + off(to)),
    )
}

/// All ways to the neighbours of a node along so many axes.
fn directions(axes: usize) -> Vec<Vec<isize>> {
    let all = (0..3usize.pow(axes as u32)).map(|number| {
        let steps = (0..axes).map(|axis| (number / 3usize.pow(axis as u32) % 3) as isize - 1);
        steps.collect::<Vec<isize>>()
    });
    all.filter(|steps| steps.iter().any(|&step| step != 0))
        .collect()
}

/// A state in a box at which a level is negative, if the way downward from a state comes to one.
fn downward(
    level: impl Fn(&[f64]) -> f64,
    mut state: Vec<f64>,
    boxes: &[(f64, f64)],
    directions: &[Vec<isize>],
    moving: &[usize],
) -> Option<Vec<f64>> {
    let mut own = level(&state);
    let mut step = FIRST_STEP;
    while step >= LAST_STEP {
        let mut lower: Option<(f64, Vec<f64>)> = None;
        for direction in directions {
            let mut tried = state.clone();
            for (&axis, &sign) in moving.iter().zip(direction) {
                let (from, to) = boxes[axis];
                let way = 0.5 * step * (to - from);
                tried[axis] = (tried[axis] + sign as f64 * way).clamp(from, to);
            }
            let found = level(&tried);
            if found < lower.as_ref().map_or(own, |(level, _)| *level) {
                lower = Some((found, tried));
            }
        }
        match lower {
            Some((found, tried)) if found < 0.0 => return Some(tried),
            Some((found, tried)) => (own, state) = (found, tried),
            None => step *= 0.5,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{directions, downward};

    #[test]
    fn the_way_downward_comes_to_small_discs_and_thin_strips() {
        let boxes = [(-1.0, 1.0), (-1.0, 1.0)];
        let from_node = |level: &dyn Fn(&[f64]) -> f64| {
            downward(level, vec![0.0, 0.0], &boxes, &directions(2), &[0, 1])
        };
        let disc = |at: [f64; 2], radius: f64| {
            move |state: &[f64]| {
                (state[0] - at[0]).powi(2) + (state[1] - at[1]).powi(2) - radius * radius
            }
        };
        assert!(from_node(&disc([0.43, 0.37], 0.01)).is_some());
        assert!(from_node(&disc([1.3, 0.0], 0.1)).is_none());
        let strip = |state: &[f64]| (0.3 - state[0]).max(state[0] - 0.31);
        assert!(from_node(&strip).is_some());
        assert!(from_node(&|state: &[f64]| 0.1 + state[0].powi(2)).is_none());
    }
}
