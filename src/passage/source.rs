//! How processes that were in the first region last come into the cells outside of both.

use super::cells::PassageCells;
use super::exits::Exits;
use super::on_way::FROM;
use super::steady::Steady;
use crate::generator::AbsorbingGenerator;
use crate::system::System;

/// Rates at which they come into the cells, of a steady state.
pub(super) fn source(
    of: (&dyn System, &Exits<'_>),
    on: (&PassageCells, &AbsorbingGenerator),
    steady: &Steady<'_>,
) -> Vec<f64> {
    let mut source = vec![0.0; on.0.space.n_cells()];
    each_source(of, on, |state, rates| {
        let value = steady.at(state);
        let rates = rates.iter();
        rates.for_each(|&(cell, rate)| source[cell] += rate * value);
    });
    source
}

/// What a change of the steady state may do to the mean time on the way, where it is at most `bound` about each place
/// on the border, of either sign. Of each cell it is known how likely a process comes to the second region from
/// there, and how long all that do are on their way. A transition that begins at a place takes its own time; only
/// what that differs by from the mean one counts, since one factor for all places changes flux and density by the
/// same share.
pub(super) fn change_of_duration(
    of: (&dyn System, &Exits<'_>),
    on: (&PassageCells, &AbsorbingGenerator),
    bound: &Steady<'_>,
    [likely, lasting]: [&[f64]; 2],
    (flux, duration): (f64, f64),
) -> f64 {
    let mut change = 0.0;
    each_source(of, on, |state, rates| {
        let own = rates.iter();
        let own = own.map(|&(cell, rate)| rate * (lasting[cell] - duration * likely[cell]));
        change += bound.at(state) * own.sum::<f64>().abs();
    });
    change / flux.abs()
}

/// Goes over the places on the border of the first region at which processes come into cells, with the rates into cells
/// of a steady state that is one there.
fn each_source(
    (system, exits): (&dyn System, &Exits<'_>),
    (found, generator): (&PassageCells, &AbsorbingGenerator),
    mut take: impl FnMut(&[f64], &[(usize, f64)]),
) {
    let (space, dimension) = (&found.space, found.space.dimension());
    for border in &generator.on_border {
        let state = &border.state[..dimension];
        if exits.part_at(state) == Some(FROM) {
            take(state, &border.rates);
        }
    }
    // What the drift carries in through ends of the cells that are borders.
    for (index, axis) in space.axes().iter().enumerate() {
        let ends = [(0, axis.from(), 1.0), (axis.count() - 1, axis.to(), -1.0)];
        let ends = ends.into_iter().zip(found.borders[index]);
        for ((last, end, inward), _) in ends.filter(|one| one.1) {
            for cell in (0..space.n_cells()).filter(|&cell| space.position(cell, index) == last) {
                let mut state = space.node(cell);
                state[index] = end;
                let drift = inward * system.drift_at(0.0, &state)[index];
                if drift > 0.0 && generator.kept[cell] && exits.part_at(&state) == Some(FROM) {
                    let others = space.axes().iter().enumerate();
                    let others = others.filter(|(other, _)| *other != index);
                    let width: f64 = others
                        .map(|(other, axis)| axis.node_stretch(space.position(cell, other)))
                        .product();
                    take(&state, &[(cell, drift * width)]);
                }
            }
        }
    }
}
