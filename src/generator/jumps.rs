//! What fluxes through a plane leave out: one at which a force jumps, where no noise acts across it, and a wall that
//! reflects.
//!
//! Let f be the flux along the axis x of the plane. The difference of two fluxes is ∂f/∂x to high order where each is
//! f - h²/24 ∂²f/∂x².
//!
//! *Through a plane at which a force jumps* one number flows, while the second derivatives on both sides differ, by Δ:
//! h/48 Δ(∂²f/∂x²) is left over in the cells on either side. By the equation ∂f/∂x is what moves along the other axes
//! of p. So Δ(∂²f/∂x²) is the jump of what moves along them of ∂p/∂x, and of the slope of the drift. The sampler makes
//! the latter good ([`LineSampler::correct`](super::sampler::LineSampler::correct)). The former is made good here, with
//! the slopes at the plane that the nodes on either side give. It couples cells across corners and keeps mass.
//!
//! *Through a wall* nothing flows, and h/24 ∂²f/∂x² is left over in the cell at it. By the equation that is the slope
//! at the wall of what moves along the other axes, which the three cells from the wall on give: nothing in a
//! potential, and of second order where probability circulates. With it the rates of those three cells along the
//! other axes are summed with the weights of an integral that ends at the wall, as `masses` sums unknowns. That holds
//! of a steady state: of what changes in time, ∂f/∂x is another one (`assemble_damped` does without).

use std::ops::Range;

use super::columns::{Coordinates, LineRates};
use super::geometry::{AxisGeometry, Break};

/// What rates of a cell along other axes are added to elsewhere.
pub(super) struct Side {
    axis: usize,
    /// Positions of the cells that rates are added to.
    beside: Range<usize>,
    /// Position of the lines along the other axes whose rates are added.
    line: usize,
    /// The share of them that is added.
    share: f64,
}

impl LineRates {
    /// The sides of planes at which a drift jumps whose slopes a cell takes part in, and the walls that it is beside.
    /// There are none for nearly all cells, and two where planes are near each other. Where planes across several axes
    /// meet at which drifts jump, those of the first one count.
    pub(super) fn sides(&self, place: &Coordinates) -> Vec<Side> {
        if !self.has_sides {
            return Vec::new();
        }
        let at_jumps = |(axis, geometry): (usize, &AxisGeometry)| -> Vec<Side> {
            let breaks = geometry.breaks.iter();
            let sides = breaks.filter_map(|at| side_of_jump(geometry, at, (axis, place[axis])));
            sides.collect()
        };
        let mut all = self.axes.iter().enumerate().map(at_jumps);
        let mut sides = all.find(|sides| !sides.is_empty()).unwrap_or_default();
        for (axis, geometry) in self.axes.iter().enumerate() {
            sides.extend(sides_at_walls(geometry, (axis, place[axis])));
        }
        sides
    }

    /// Number of entries that sides add to the column of a cell: what moves along the other axes, in the cells beside
    /// the plane that are not on the cell's own lines. Sides of several axes may share some.
    pub(super) fn entries_of_sides(&self, place: &Coordinates, sides: &[Side]) -> usize {
        let entries = sides.iter().flat_map(|side| {
            let others = (0..self.axes.len()).filter(|other| *other != side.axis);
            let beside = side.beside.clone().filter(|at| *at != place[side.axis]);
            beside.flat_map(move |at| {
                let across = self.strides[side.axis] * at;
                others.clone().flat_map(move |other| {
                    let own = place[other];
                    let reached = self.reached(place, other).filter(move |to| *to != own);
                    // The cell's number, less what all entries share.
                    let rest = |axis: usize| self.strides[axis] * place[axis];
                    let rest: usize = (0..self.axes.len())
                        .filter(|axis| ![side.axis, other].contains(axis))
                        .map(rest)
                        .sum();
                    reached.map(move |to| rest + across + self.strides[other] * to)
                })
            })
        });
        if let [] | [_] = sides {
            return entries.count();
        }
        let mut all: Vec<usize> = entries.collect();
        all.sort_unstable();
        all.dedup();
        all.len()
    }

    /// Tells the rates that a side adds to the column of a cell. Their sum is zero.
    pub(super) fn each_of_side(
        &self,
        cell: usize,
        place: &Coordinates,
        side: &Side,
        mut tell: impl FnMut(usize, f64),
    ) {
        let (stride, position) = (self.strides[side.axis], place[side.axis]);
        let mut plane = *place;
        plane[side.axis] = side.line;
        for other in (0..self.axes.len()).filter(|other| *other != side.axis) {
            let (step, own) = (self.strides[other], place[other]);
            let mut kept = 0.0;
            let reached = self.reached(place, other);
            self.each_rate(&plane, other, reached, |to, rate| {
                let rate = match to == own {
                    true => 0.0,
                    false => side.share * rate,
                };
                kept += rate;
                for beside in side.beside.clone() {
                    tell(
                        cell + to * step + beside * stride - own * step - position * stride,
                        rate,
                    );
                }
            });
            // What enters no other cell stays.
            for beside in side.beside.clone() {
                tell(cell + beside * stride - position * stride, -kept);
            }
        }
    }
}

/// The side of a plane at which a drift jumps on which a cell lies, if its slope takes the cell.
fn side_of_jump(
    geometry: &AxisGeometry,
    at: &Break,
    (axis, position): (usize, usize),
) -> Option<Side> {
    let slope = at.slope?;
    let (line, away) = match position >= at.face {
        true => (at.face, position - at.face),
        false => (at.face - 1, at.face - 1 - position),
    };
    // The slope below has the signs of that above the other way round, and enters the jump with a minus.
    let slope = slope.get(away)? * geometry.face_widths[at.face] / geometry.widths[position];
    Some(Side {
        axis,
        beside: at.face - 1..at.face + 1,
        line,
        share: -slope / 48.0,
    })
}

/// The walls that a cell is beside.
fn sides_at_walls(
    geometry: &AxisGeometry,
    (axis, position): (usize, usize),
) -> impl Iterator<Item = Side> {
    let last = geometry.count() - 1;
    let walls = geometry.along_walls.into_iter().zip([0, last]);
    walls.filter_map(move |(along, wall)| {
        let share = *along?.get(position.abs_diff(wall))?;
        Some(Side {
            axis,
            beside: wall..wall + 1,
            line: position,
            share,
        })
    })
}
