//! Fields beside the border of a target. The transposed of a scheme is not of its order in the cells next to a border:
//! averages over a start are, single values are off by a share of a cell's width. There a field is the polynomial
//! through what it is on the border and through cells farther inside, along the axis with noise on which the border is
//! nearest.

use super::crossing::crossing;
use crate::generator::lagrange;
use crate::space::CellSpace;
use crate::system::{BoundQuantity, System};

/// Cells beside a border that are replaced, and cells farther inside of which the polynomial is.
const RIM: usize = 3;
const INNER: usize = 4;

/// A cell beside a border, with the weights of what replaces its value.
pub(super) struct RimCell {
    cell: usize,
    /// The state on the border, and its weight.
    border: (Vec<f64>, f64),
    inner: Vec<(usize, f64)>,
}

/// The cells beside the border of a region that is entered where `level` becomes negative.
pub(super) fn rim(
    system: &dyn System,
    (space, kept): (&CellSpace, &[bool]),
    level: &BoundQuantity,
) -> Vec<RimCell> {
    let noisy: Vec<usize> = (0..space.dimension())
        .filter(|&axis| system.is_noisy(axis) && !space.axes()[axis].is_modes())
        .collect();
    let sides = || noisy.iter().flat_map(|&axis| [(axis, 1), (axis, -1)]);
    let nearest = |cell: usize| {
        let found = sides().filter_map(|side| beside(space, kept, level, cell, side));
        found.min_by(|one, other| one.0.total_cmp(&other.0))
    };
    let cells = (0..kept.len()).filter(|&cell| kept[cell]);
    cells
        .filter_map(|cell| nearest(cell).map(|(_, found)| found))
        .collect()
}

/// What replaces the value of a cell, and how many cells away the border is along a side of an axis; `None` where it is
/// far, or too few cells are between it and another border.
fn beside(
    space: &CellSpace,
    kept: &[bool],
    level: &BoundQuantity,
    cell: usize,
    (index, side): (usize, isize),
) -> Option<(f64, RimCell)> {
    let axis = &space.axes()[index];
    let stride: usize = space.shape()[index + 1..].iter().product();
    let (place, node) = (space.position(cell, index) as isize, space.node(cell));
    let at = |steps: isize| {
        let steps = side * steps;
        let position = usize::try_from(place + steps)
            .ok()
            .filter(|&at| at < axis.count())?;
        let number = cell as isize + steps * stride as isize;
        Some((number as usize, axis.nodes()[position]))
    };
    let is_inside = |steps: &isize| at(*steps).is_some_and(|(cell, _)| !kept[cell]);
    let outer = (1..=RIM as isize).find(is_inside)?;
    let first = outer - RIM as isize - 1;
    let inner: Vec<(usize, f64)> = (0..INNER as isize)
        .map(|back| at(first - back).filter(|(cell, _)| kept[*cell]))
        .collect::<Option<_>>()?;
    let (last, beyond) = (at(outer - 1)?.1, at(outer)?.1);
    let (border, share) = border_between((level, &node, index), (last, beyond));
    let places: Vec<f64> = inner
        .iter()
        .map(|one| one.1)
        .chain([border[index]])
        .collect();
    let weights = lagrange(&places, node[index]);
    let replaced = RimCell {
        cell,
        border: (border, weights[INNER]),
        inner: inner.iter().map(|one| one.0).zip(weights).collect(),
    };
    Some((outer as f64 - 1.0 + share, replaced))
}

/// The state in which a line along an axis through a state crosses a border, between two coordinates, and its share of
/// the way.
fn border_between(
    (level, state, axis): (&BoundQuantity, &[f64], usize),
    (from, to): (f64, f64),
) -> (Vec<f64>, f64) {
    let at = |share: f64| {
        let mut state = state.to_vec();
        state[axis] = from + share * (to - from);
        state
    };
    let of = |share: f64| level.at(&at(share));
    let share = crossing(&of, [(0.0, of(0.0)), (1.0, of(1.0))]);
    (at(share), share)
}

/// A field at a state beside a border, through what it is on the border and what `field` says of it farther inside,
/// along the axis with noise on which the border is nearest; `None` where it is far along all of these.
pub(super) fn beside_border(
    system: &dyn System,
    (space, level): (&CellSpace, &BoundQuantity),
    state: &[f64],
    field: impl Fn(&[f64]) -> Option<f64>,
    on_border: impl Fn(&[f64]) -> f64,
) -> Option<f64> {
    let cell = space.find(state)?;
    let axes = (0..state.len()).filter(|&axis| system.is_noisy(axis));
    let sides = axes.flat_map(|axis| [(axis, 1.0), (axis, -1.0)]);
    let found = sides.filter_map(|(axis, side)| {
        let width = side * space.axes()[axis].width(space.position(cell, axis));
        let at = |steps: f64| {
            let mut moved = state.to_vec();
            moved[axis] += steps * width;
            moved
        };
        let outer = (1..=RIM + 1).find(|&steps| level.at(&at(steps as f64)) < 0.0)? as f64;
        let ends = (at(outer - 1.0)[axis], at(outer)[axis]);
        let (border, share) = border_between((level, state, axis), ends);
        Some((outer - 1.0 + share, (axis, width, border)))
    });
    let nearest = found.min_by(|one, other| one.0.total_cmp(&other.0));
    let (_, (axis, width, border)) = nearest?;
    let (mut places, mut values) = (vec![border[axis]], vec![on_border(&border)]);
    for back in 0..INNER {
        let mut inner = state.to_vec();
        inner[axis] = border[axis] - width * (back + 2) as f64;
        places.push(inner[axis]);
        values.push(field(&inner)?);
    }
    let weights = lagrange(&places, state[axis]);
    Some(super::dot(&weights, &values))
}

/// Replaces the values of a field beside a border, on which it is what `on_border` says.
pub(super) fn mend(field: &mut [f64], rim: &[RimCell], on_border: impl Fn(&[f64]) -> f64) {
    let before = field.to_vec();
    for one in rim {
        let inner: f64 = one
            .inner
            .iter()
            .map(|&(cell, weight)| weight * before[cell])
            .sum();
        let (state, weight) = &one.border;
        field[one.cell] = inner + weight * on_border(state);
    }
}
