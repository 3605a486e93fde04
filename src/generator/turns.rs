//! Whether drifts bend or jump at a face of an axis.

use crate::space::CellSpace;
use crate::system::System;

/// Distance from a face at which slopes on either side are taken, in widths of its cell, and the change of a drift over
/// a cell that is a smaller share of it is smooth.
const ASIDE: f64 = 1e-4;
const SMOOTH: f64 = 1e-2;

/// What a drift does at a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Turn {
    Smooth,
    Bend,
    Jump,
}

/// What the drifts along an axis and along the others do at one of its faces.
pub(super) struct Turning {
    pub(super) own: Turn,
    pub(super) others: Turn,
    /// By how much those along others change their slope, in changes over a cell; a jump counts for more.
    pub(super) sharpness: f64,
}

/// What drifts do at a face of an axis, at the middle of the other axes and at two places aside.
pub(super) fn turn_at(
    system: &dyn System,
    (index, face): (usize, usize),
    space: &CellSpace,
) -> Turning {
    let axis = &space.axes()[index];
    let step = ASIDE * axis.width(face);
    let mut found = Turning {
        own: Turn::Smooth,
        others: Turn::Smooth,
        sharpness: 0.0,
    };
    for share in [0.31, 0.5, 0.73] {
        let ends = space.axes().iter();
        let mut state: Vec<f64> = ends
            .map(|one| one.from() + share * (one.to() - one.from()))
            .collect();
        let [far_below, below, above, far_above] = [-2.0, -1.0, 1.0, 2.0].map(|steps| {
            state[index] = axis.edges()[face] + steps * step;
            system.drift_at(0.0, &state)
        });
        for component in 0..below.len() {
            let of = |values: &[f64]| values[component];
            let slopes = [of(&below) - of(&far_below), of(&far_above) - of(&above)];
            let jump = 2.0 * (of(&above) - of(&below)) - (of(&far_above) - of(&far_below));
            let change = ((slopes[1] - slopes[0]).abs() + jump.abs()) / ASIDE;
            let size = of(&below).abs() + (slopes[0].abs() + slopes[1].abs()) / ASIDE;
            if change > SMOOTH * size {
                let turn = match jump.abs() > SMOOTH * size {
                    true => Turn::Jump,
                    false => Turn::Bend,
                };
                if component == index {
                    found.own = found.own.max(turn);
                } else {
                    found.others = found.others.max(turn);
                    found.sharpness = found.sharpness.max(change);
                }
            }
        }
    }
    found
}
