//! What a scheme adds to the motion beside planes at which a force jumps or bends, where no noise acts across.
//!
//! Stencils stay on one side of such a plane and are short there, so that the schemes err alike beside it. What they
//! err is told by the scheme itself: let it act on a density whose motion is known, and what it gives too much is what
//! it adds. That density must be near the steady state, and smooth on either side: the values at the nodes themselves
//! have wiggles of the size of the error. It is the exponential of two parabolas along each line across the plane,
//! which share their value on it. Where a force is linear on either side, an equilibrium is such a density.

use nalgebra::{SMatrix, SVector};

use super::assemble::lines_by;
use super::columns::{Coordinates, LineRates};
use super::geometry::AxisGeometry;
use super::scheme::REACH;
use super::{AdvectiveScheme, GeneratorError};
use crate::space::CellSpace;
use crate::system::System;

/// Cells on either side of a plane in which what the scheme adds is looked at: those whose fluxes end at the plane, and
/// two more, as what flows from cell to cell cancels.
const CELLS: usize = 5;

/// Cells on either side through which parabolas are laid: those that the stencils of [`CELLS`] reach.
const FITTED: usize = CELLS + REACH;

/// Share of the largest density on a line beside the plane from which on cells count.
const SMALL: f64 = 1e-4;

/// The value at the plane, and slope and curvature on either side.
const PARAMETERS: usize = 5;

/// Step in which a speed along a line is differentiated, in widths of a cell.
const STEP: f64 = 1e-3;

/// By how much more mass enters each cell by a scheme than by the equations beside planes at which a force jumps or
/// bends; the sum is zero. `unknowns` are those of the steady state. `None` where there is nothing of the kind.
///
/// # Errors
/// As [`super::assemble`].
pub(crate) fn spurious_at_breaks(
    system: &dyn System,
    space: &CellSpace,
    scheme: AdvectiveScheme,
    unknowns: &[f64],
) -> Result<Option<Vec<f64>>, GeneratorError> {
    let geometry = |axis| AxisGeometry::new(system, axis, space, scheme);
    let axes: Vec<AxisGeometry> = (0..space.dimension()).map(geometry).collect();
    if axes.iter().all(|axis| axis.breaks.is_empty()) {
        return Ok(None);
    }
    // What moves along the other axes is known without what makes good the fluxes across the plane.
    let mut across = axes.clone();
    across.iter_mut().for_each(|axis| axis.breaks.clear());
    let [lines] = lines_by([axes], system, space)?;
    let [known] = lines_by([across], system, space)?;
    let mut added = vec![0.0; unknowns.len()];
    for (axis, geometry) in lines.axes.iter().enumerate() {
        let faces: Vec<usize> = geometry.breaks.iter().map(|one| one.face).collect();
        for number in 0..faces.len() {
            if let Some(window) = Window::new(axis, geometry.count(), &faces, number) {
                window.add((system, space), [&lines, &known], unknowns, &mut added);
            }
        }
    }
    let is_finite = added.iter().all(|rate| rate.is_finite());
    let size: f64 = added.iter().map(|rate| rate.abs()).sum();
    if !is_finite || size == 0.0 {
        return Ok(None);
    }
    // What enters the cells beside a plane leaves others there.
    let share = added.iter().sum::<f64>() / size;
    added
        .iter_mut()
        .for_each(|rate| *rate -= share * rate.abs());
    Ok(Some(added))
}

/// Positions along an axis beside a plane.
struct Window {
    axis: usize,
    /// The first cell above the plane.
    face: usize,
    /// Cells through which parabolas are laid.
    fitted: std::ops::Range<usize>,
    /// Cells in which what the scheme adds is looked at.
    looked_at: std::ops::Range<usize>,
}

impl Window {
    /// Of one plane of all across an axis; none where too few cells are left to lay a parabola through.
    fn new(axis: usize, count: usize, faces: &[usize], number: usize) -> Option<Self> {
        let face = *faces.get(number)?;
        let before = number.checked_sub(1).and_then(|one| faces.get(one));
        let after = faces.get(number + 1);
        let fitted = face.saturating_sub(FITTED).max(before.map_or(0, |at| *at))
            ..(face + FITTED).min(after.map_or(count, |at| *at));
        let middle = |at: &usize| (at + face) / 2;
        let looked_at = face.saturating_sub(CELLS).max(before.map_or(0, middle))
            ..(face + CELLS).min(after.map_or(count, middle));
        let is_wide = face >= fitted.start + REACH && fitted.end >= face + REACH;
        is_wide.then_some(Self {
            axis,
            face,
            fitted,
            looked_at,
        })
    }

    /// Adds what the scheme adds: of its lines, and of those along which all axes but the window's are known.
    fn add(
        &self,
        (system, space): (&dyn System, &CellSpace),
        [lines, known]: [&LineRates; 2],
        unknowns: &[f64],
        added: &mut [f64],
    ) {
        let geometry = &lines.axes[self.axis];
        let stride = lines.strides[self.axis];
        let mut smooth = unknowns.to_vec();
        let mut motion = vec![0.0; unknowns.len()];
        let mut is_known = vec![false; unknowns.len()];
        let starts = space.positions(self.axis).enumerate();
        for (first, _) in starts.filter(|(_, position)| *position == self.fitted.start) {
            let cell = |position: usize| first + (position - self.fitted.start) * stride;
            let densities = self
                .fitted
                .clone()
                .map(|position| unknowns[cell(position)] / geometry.widths[position]);
            let densities: Vec<f64> = densities.collect();
            let Some(line) = Parabolas::through(&densities, self.face - self.fitted.start) else {
                continue;
            };
            let values = line.values();
            let largest = values.iter().copied().fold(0.0, f64::max);
            for (position, value) in self.fitted.clone().zip(values) {
                let cell = cell(position);
                let width = geometry.widths[position];
                smooth[cell] = value * width;
                if self.looked_at.contains(&position) && value > SMALL * largest {
                    let slope = line.slope(position - self.fitted.start);
                    let [speed, change] = speed(system, space, cell, (self.axis, width));
                    motion[cell] = value * (speed * slope + change * width);
                    is_known[cell] = true;
                }
            }
        }
        let is_near = |place: &Coordinates| self.fitted.contains(&place[self.axis]);
        let moved = lines.product_of(&smooth, is_near);
        let others = known.product_across(&smooth, self.axis, is_near);
        for (cell, rate) in added
            .iter_mut()
            .enumerate()
            .filter(|(cell, _)| is_known[*cell])
        {
            *rate += moved[cell] - others[cell] + motion[cell];
        }
    }
}

/// The drift along an axis in a cell of a width, and its derivative.
fn speed(
    system: &dyn System,
    space: &CellSpace,
    cell: usize,
    (axis, width): (usize, f64),
) -> [f64; 2] {
    let mut state = space.node(cell);
    let (node, step) = (state[axis], STEP * width);
    let [here, below, above] = [0.0, -step, step].map(|aside| {
        state[axis] = node + aside;
        system.drift_at(0.0, &state)[axis]
    });
    [here, (above - below) / (2.0 * step)]
}

/// The logarithm of a density along a line as two parabolas that share their value at a plane.
struct Parabolas {
    /// Numbers of all cells, and of those below the plane.
    cells: usize,
    below: usize,
    parameters: SVector<f64, PARAMETERS>,
    /// Cells that the parabolas were laid through; they are no larger elsewhere than the least of what counts.
    used: std::ops::Range<usize>,
    least: f64,
}

impl Parabolas {
    /// Through the densities of cells, of which some are below the plane. `None` where too few of them count.
    fn through(densities: &[f64], below: usize) -> Option<Self> {
        let largest = densities.iter().copied().fold(0.0, f64::max);
        let least = SMALL * largest;
        let counts = |density: &&f64| **density > least;
        let used_below = densities[..below].iter().rev().take_while(counts).count();
        let used_above = densities[below..].iter().take_while(counts).count();
        if used_below < REACH || used_above < REACH {
            return None;
        }
        let used = below - used_below..below + used_above;
        let mut matrix = SMatrix::<f64, PARAMETERS, PARAMETERS>::zeros();
        let mut right = SVector::<f64, PARAMETERS>::zeros();
        for cell in used.clone() {
            let place = place(cell, below);
            let [basis, _] = basis(place);
            let weight = (-2.0 * place * place).exp();
            matrix += weight * basis * basis.transpose();
            right += weight * densities[cell].ln() * basis;
        }
        Some(Self {
            cells: densities.len(),
            below,
            parameters: matrix.lu().solve(&right)?,
            used,
            least,
        })
    }

    /// The density in all cells.
    fn values(&self) -> Vec<f64> {
        let value = |cell: usize| {
            let [basis, _] = basis(place(cell, self.below));
            let value = self.parameters.dot(&basis).exp();
            match self.used.contains(&cell) {
                true => value,
                false => value.min(self.least),
            }
        };
        (0..self.cells).map(value).collect()
    }

    /// The slope of its logarithm in a cell, by the cell coordinate.
    fn slope(&self, cell: usize) -> f64 {
        let [_, slopes] = basis(place(cell, self.below));
        self.parameters.dot(&slopes)
    }
}

/// The distance of a cell from the plane, as a share of those that are fitted.
fn place(cell: usize, below: usize) -> f64 {
    (cell as f64 + 0.5 - below as f64) / FITTED as f64
}

/// What the parameters make of the logarithm of a density at a place, and of its slope by the cell coordinate.
fn basis(place: f64) -> [SVector<f64, PARAMETERS>; 2] {
    let first = if place < 0.0 { 1 } else { 3 };
    let (mut values, mut slopes) = (SVector::zeros(), SVector::zeros());
    values[0] = 1.0;
    (values[first], values[first + 1]) = (place, place * place);
    let unit = 1.0 / FITTED as f64;
    (slopes[first], slopes[first + 1]) = (unit, 2.0 * place * unit);
    [values, slopes]
}
