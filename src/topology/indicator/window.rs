//! Which cells around a point the reconstruction takes in.
//!
//! A density without noise is reconstructed from the eight cells (seven, where the point lies inside one) about the
//! point, with an order that its smoothness allows; six (five) give its error. At a kink, four cells on each side.

use std::ops::Range;

use crate::density::{EstimatedDensity, Kink};
use crate::space::Axis;
use crate::topology::field::sides;
use crate::topology::reconstruction::{Weights, interpolating};

/// Cells on either side of a point, in the finer and the rougher reconstruction.
const REACH: [usize; 2] = [4, 3];
/// The same on one side of a kink.
const BESIDE: [usize; 2] = [4, 3];
/// The same on one side of a bend, where curvatures are asked for.
const BENT: [usize; 2] = [6, 5];
/// Lines for the value and derivatives at a point, by the better and by a rougher reconstruction.
pub(super) struct Lines {
    pub(super) fine: Vec<Weights>,
    pub(super) rough: Vec<Weights>,
}

impl Lines {
    /// Both, for one function of them.
    pub(super) fn both(&self) -> [&[Weights]; 2] {
        [&self.fine, &self.rough]
    }
}

/// Lines for p, p', p'' along axis `k` at `at`, no jump of the slope near.
pub(super) fn about(estimated: &EstimatedDensity, k: usize, at: f64) -> Option<Lines> {
    derivatives(estimated, k, at, 3)
}

/// Lines for the value and derivatives, `orders` in all (five at most), along axis `k` at `at`, no kink near.
pub(super) fn derivatives(
    estimated: &EstimatedDensity,
    k: usize,
    at: f64,
    orders: usize,
) -> Option<Lines> {
    let axis = &estimated.density.axes[k];
    let mut kinks = estimated.structure.kinks.iter();
    let is_bent = |kink: &Kink| kink.axis == k && kink.is_bend() && axis.is_same_place(at, kink.at);
    if kinks.any(is_bent) {
        return beside(axis, at, orders);
    }
    let line = |reach: usize| interpolating(axis, around(axis, at, reach)?, at, orders);
    Some(Lines {
        fine: line(REACH[0])?,
        rough: line(REACH[1])?,
    })
}

/// The same at a place across which no polynomial follows the density, though its slope is one: the mean of both sides.
fn beside(axis: &Axis, at: f64, orders: usize) -> Option<Lines> {
    let (below, above) = sides(axis, at)?;
    let line = |reach: usize| -> Option<Vec<Weights>> {
        let below = interpolating(axis, below.checked_sub(reach)?..below, at, orders)?;
        let above = interpolating(axis, above..above + reach, at, orders)?;
        let pairs = below.iter().zip(&above);
        Some(pairs.map(|(below, above)| below.mean(above)).collect())
    };
    Some(Lines {
        fine: line(BENT[0])?,
        rough: line(BENT[1])?,
    })
}

/// Lines for p, p', p'' at a place, of the cells on one side of it.
pub(super) fn one_sided(axis: &Axis, at: f64, above: bool) -> Option<Lines> {
    let (below, from) = sides(axis, at)?;
    let line = |reach: usize| {
        let cells = if above {
            from..from + reach
        } else {
            below.checked_sub(reach)?..below
        };
        let fits = cells.end <= axis.count();
        fits.then(|| interpolating(axis, cells, at, 3))?
    };
    Some(Lines {
        fine: line(BENT[0])?,
        rough: line(BENT[1])?,
    })
}

/// Lines for the value of the density on a plane where its derivative jumps: the mean of both sides.
pub(super) fn on_kink(estimated: &EstimatedDensity, k: usize, at: f64) -> Option<Lines> {
    let axis = &estimated.density.axes[k];
    let face = axis.face_at(at)?;
    let sides = |below: Range<usize>,
                 above: Range<usize>,
                 line: &dyn Fn(Range<usize>) -> Option<Vec<Weights>>| {
        let (below, above) = (line(below)?, line(above)?);
        Some(vec![below.first()?.mean(above.first()?)])
    };
    let line = |reach: usize| {
        let fit = |cells: Range<usize>| interpolating(axis, cells, at, 1);
        sides(face.checked_sub(reach)?..face, face..face + reach, &fit)
    };
    Some(Lines {
        fine: line(BESIDE[0])?,
        rough: line(BESIDE[1])?,
    })
}

/// `reach` cells on either side of a face, or one less beside the cell that holds the point.
pub(super) fn around(axis: &Axis, at: f64, reach: usize) -> Option<Range<usize>> {
    let cells = match axis.face_at(at) {
        Some(face) => face.checked_sub(reach)?..face + reach,
        None => {
            let cell = axis.find(at)?;
            cell.checked_sub(reach - 1)?..cell + reach
        }
    };
    (cells.end <= axis.count()).then_some(cells)
}
