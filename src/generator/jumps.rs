//! What fluxes through a plane at which a force jumps leave out, where no noise acts across it.
//!
//! Let f be the flux along the axis x of the plane. The difference of two fluxes is ∂f/∂x to high order where each is
//! f - h²/24 ∂²f/∂x². Through the plane one number flows, while the second derivatives on both sides differ, by Δ:
//! h/48 Δ(∂²f/∂x²) is left over in the cells on either side. By the equation ∂f/∂x is what moves along the other axes
//! of p. So Δ(∂²f/∂x²) is the jump of what moves along them of ∂p/∂x, and of the slope of the drift. The sampler makes
//! the latter good ([`LineSampler::correct`](super::sampler::LineSampler::correct)). The former is made good here, with
//! the slopes at the plane that the nodes on either side give. It couples cells across corners and keeps mass.

use super::columns::{Coordinates, LineRates};
use super::geometry::AxisGeometry;

/// One side of a plane as a cell near it sees it.
pub(super) struct Side {
    axis: usize,
    /// Position of the cells on this side of the plane, and on the other one.
    beside: [usize; 2],
    /// Weight of the cell in the slope at the plane.
    weight: f64,
}

impl LineRates {
    /// The sides of planes at which a drift jumps whose slopes a cell takes part in. There are none for nearly all
    /// cells, and two where planes are near each other. Where planes across several axes meet, those of the first one
    /// count.
    pub(super) fn sides(&self, place: &Coordinates) -> Vec<Side> {
        let along = |(axis, geometry): (usize, &AxisGeometry)| -> Vec<Side> {
            let position = place[axis];
            let sides = geometry.breaks.iter().filter_map(|at| {
                let slope = at.slope?;
                let (beside, away) = match position >= at.face {
                    true => ([at.face, at.face - 1], position - at.face),
                    false => ([at.face - 1, at.face], at.face - 1 - position),
                };
                let weight = *slope.get(away)?;
                Some(Side {
                    axis,
                    beside,
                    weight,
                })
            });
            sides.collect()
        };
        let mut all = self.axes.iter().enumerate().map(along);
        all.find(|sides| !sides.is_empty()).unwrap_or_default()
    }

    /// Number of entries that a side adds to the column of a cell: what moves along the other axes, in the cells beside
    /// the plane that are not on the cell's own lines.
    pub(super) fn entries_of_side(&self, place: &Coordinates, side: &Side) -> usize {
        let others = (0..self.axes.len()).filter(|other| *other != side.axis);
        let reached = others.map(|other| self.reached(place, other).len() - 1);
        let columns = side.beside.iter().filter(|at| **at != place[side.axis]);
        columns.count() * reached.sum::<usize>()
    }

    /// Tells the rates that a side adds to the column of a cell. Their sum is zero.
    pub(super) fn each_of_side(
        &self,
        cell: usize,
        place: &Coordinates,
        side: &Side,
        mut tell: impl FnMut(usize, f64),
    ) {
        let (geometry, stride) = (&self.axes[side.axis], self.strides[side.axis]);
        let position = place[side.axis];
        let face = side.beside[0].max(side.beside[1]);
        // The slope below has the signs of that above the other way round, and enters the jump with a minus.
        let slope = side.weight * geometry.face_widths[face] / geometry.widths[position];
        let share = -slope / 48.0;
        let mut plane = *place;
        plane[side.axis] = side.beside[0];
        for other in (0..self.axes.len()).filter(|other| *other != side.axis) {
            let (step, own) = (self.strides[other], place[other]);
            let mut kept = 0.0;
            let reached = self.reached(place, other);
            self.each_rate(&plane, other, reached, |to, rate| {
                let rate = match to == own {
                    true => 0.0,
                    false => share * rate,
                };
                kept += rate;
                for beside in side.beside {
                    tell(
                        cell + to * step + beside * stride - own * step - position * stride,
                        rate,
                    );
                }
            });
            // What enters no other cell stays.
            for beside in side.beside {
                tell(cell + beside * stride - position * stride, -kept);
            }
        }
    }
}
