//! Fields beside the border of a target. The transposed of a scheme is not of its order in the cells next to a border:
//! averages over a start are, single values are off by a share of a cell's width. There a field is the polynomial
//! through what it is on the border and through cells farther inside, along the axis with noise on which the border is
//! nearest.

use super::spread::crossing;
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
    cells.filter_map(|cell| nearest(cell).map(|(_, found)| found)).collect()
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
    let own = space.position(cell, index) as isize;
    let position = |steps: isize| Some(own + side * steps).filter(|at| (0..axis.count() as isize).contains(at));
    let at = |steps: isize| {
        let position = position(steps)?;
        let number = cell as isize + (position - own) * stride as isize;
        Some((number as usize, axis.nodes()[position as usize]))
    };
    let is_inside = |steps: &isize| at(*steps).is_some_and(|(cell, _)| !kept[cell]);
    let outer = (1..=RIM as isize).find(is_inside)?;
    let first = outer - RIM as isize - 1;
    let inner: Vec<(usize, f64)> = (0..INNER as isize)
        .map(|back| at(first - back).filter(|(cell, _)| kept[*cell]))
        .collect::<Option<_>>()?;
    let (last, beyond) = (at(outer - 1)?.1, at(outer)?.1);
    let state = |x: f64| {
        let mut state = space.node(cell);
        state[index] = x;
        state
    };
    let of = |x: f64| level.at(&state(x));
    let border = last + (beyond - last) * {
        let share = |share: f64| of(last + share * (beyond - last));
        crossing(&share, [(0.0, share(0.0)), (1.0, share(1.0))])
    };
    let own = space.node(cell)[index];
    let places: Vec<f64> = inner.iter().map(|one| one.1).chain([border]).collect();
    let weight = |index: usize| {
        let others = places.iter().enumerate().filter(|(other, _)| *other != index);
        others.fold(1.0, |product, (_, place)| {
            product * (own - place) / (places[index] - place)
        })
    };
    let away = outer as f64 - 1.0 + (border - last) / (beyond - last);
    let replaced = RimCell {
        cell,
        border: (state(border), weight(INNER)),
        inner: inner.iter().enumerate().map(|(at, one)| (one.0, weight(at))).collect(),
    };
    Some((away, replaced))
}

/// Replaces the values of a field beside a border, on which it is what `on_border` says.
pub(super) fn mend(field: &mut [f64], rim: &[RimCell], on_border: impl Fn(&[f64]) -> f64) {
    let before = field.to_vec();
    for one in rim {
        let inner: f64 = one.inner.iter().map(|&(cell, weight)| weight * before[cell]).sum();
        let (state, weight) = &one.border;
        field[one.cell] = inner + weight * on_border(state);
    }
}
