//! Kinks of densities on planes across which no noise acts, as where a force on the velocity jumps at a position.
//!
//! The flux across such a plane is v p, with the drift v across it; where the drift f of other axes jumps by Δf there,
//! the stationary equation asks that v ∂p/∂x jumps by -∇·(Δf p), so the slope of log p jumps by -∇·(Δf p)/(v p).
//!
//! The law is used where noise and the slope of v do not jump, and Δf is the same all over the plane. Then the jump is
//! Δf times a number that depends on the density. Where that number has one sign all over the plane, the jump is zero
//! exactly where Δf is, whatever the cells; elsewhere the kink is not known.

use super::kink::BESIDE;
use super::smoothness::{Break, break_at};
use crate::density::Kink;
use crate::space::CellSpace;
use crate::system::{SwitchingSurface, System};

/// A drift across the plane that is a smaller share of the largest is zero.
const STANDS: f64 = 1e-9;
/// A jump, or difference of jumps, that is a smaller share of the drift is rounding.
const ROUNDING: f64 = 1e-6;
/// A bend, over the range, that is a smaller share of the drift is its curvature.
const CURVED: f64 = 1e-3;
/// Times [`BESIDE`], for slopes of the drift.
const FAR: f64 = 100.0;
/// Cells with a larger share of the largest mass beside the plane must agree on the sign of a kink.
const HEAVY: f64 = 1e-3;
/// Cells with a smaller share of the largest mass beside the plane tell nothing of a slope.
const EMPTY: f64 = 1e-10;

/// Whether noise acts across a surface.
pub(super) fn is_driven(system: &dyn System, surface: SwitchingSurface) -> bool {
    system.is_noisy(surface.axis)
}

/// Whether something jumps at a surface across which no noise acts.
pub(super) fn jumps(system: &dyn System, space: &CellSpace, surface: SwitchingSurface) -> bool {
    !is_driven(system, surface) && break_at(system, space, surface) == Break::Jump
}

/// Whether the law tells what such a jump makes of the density, on axes of cells.
pub(super) fn is_known(system: &dyn System, space: &CellSpace, surface: SwitchingSurface) -> bool {
    let by_modes = space.axes().iter().any(|axis| axis.is_modes());
    let beside = space.axes()[surface.axis].cells_beside(surface.at);
    let Some([_, above]) = beside.filter(|_| !by_modes) else {
        return false;
    };
    let plane = Plane::new(system, space, surface, above);
    plane.is_some_and(|plane| plane.is_crossed() && plane.is_even() && plane.has_even_noise(system))
}

/// The kink that a surface makes in the density of the given axes, if it stands on one of them and its sign follows
/// from the equations.
pub(super) fn kink(
    system: &dyn System,
    space: &CellSpace,
    masses: &[f64],
    axes: &[usize],
    surface: SwitchingSurface,
) -> Option<Kink> {
    let place = axes.iter().position(|&axis| axis == surface.axis)?;
    let [below, above] = space.axes()[surface.axis].cells_beside(surface.at)?;
    let plane = Plane::new(system, space, surface, above)?;
    let on_plane: Vec<f64> = (0..plane.cells.len())
        .map(|cell| 0.5 * (masses[plane.at(cell, below)] + masses[plane.at(cell, above)]))
        .collect();
    let gains = plane.gains(&on_plane);
    let heavy = HEAVY * on_plane.iter().copied().fold(0.0, f64::max);
    let heavy = gains
        .iter()
        .zip(&on_plane)
        .filter(|(_, mass)| **mass > heavy);
    let (mut rises, mut falls) = (false, false);
    heavy.for_each(|(gain, _)| {
        rises |= *gain > 0.0;
        falls |= *gain < 0.0;
    });
    if rises && falls {
        return None;
    }
    let other = axes.iter().copied().find(|&axis| axis != surface.axis);
    let bins = other.map_or(1, |axis| space.axes()[axis].count());
    let (mut sums, mut weights) = (vec![0.0; bins], vec![0.0; bins]);
    for (cell, gain) in gains.into_iter().enumerate() {
        let bin = other.map_or(0, |axis| space.position(plane.cells[cell], axis));
        sums[bin] += gain;
        weights[bin] += on_plane[cell].max(0.0);
    }
    let largest = weights.iter().copied().fold(0.0, f64::max);
    let slope = |(sum, &weight): (f64, &f64)| match weight > EMPTY * largest {
        true => sum / weight,
        false => 0.0,
    };
    let jump: Vec<f64> = sums.into_iter().zip(&weights).map(slope).collect();
    let is_finite = jump.iter().all(|jump| jump.is_finite());
    is_finite.then_some(Kink {
        axis: place,
        at: surface.at,
        jump,
    })
}

/// The cells above a plane, with what the equations say on it.
struct Plane<'a> {
    space: &'a CellSpace,
    across: usize,
    /// Of the whole space.
    cells: Vec<usize>,
    /// Drift across the plane, one value a cell.
    speeds: Vec<f64>,
    /// Jumps of the drift along all axes, as many.
    jumps: Vec<Vec<f64>>,
    /// Jumps of the slope of the drift across the plane, as many.
    bends: Vec<f64>,
    /// Where it is.
    at: f64,
}

impl<'a> Plane<'a> {
    fn new(
        system: &dyn System,
        space: &'a CellSpace,
        surface: SwitchingSurface,
        above: usize,
    ) -> Option<Self> {
        let across = surface.axis;
        let step = BESIDE * space.axes()[across].width(above);
        // Slopes are differences over more, so that rounding stays out of them.
        let far = FAR * step;
        let cells = (0..space.n_cells()).filter(|&cell| space.position(cell, across) == above);
        let cells: Vec<usize> = cells.collect();
        let mut speeds = Vec::with_capacity(cells.len());
        let mut jumps = Vec::with_capacity(cells.len());
        let mut bends = Vec::with_capacity(cells.len());
        for &cell in &cells {
            let mut state = space.centre(cell);
            state[across] = surface.at + step;
            speeds.push(system.drift_at(0.0, &state)[across]);
            let mut speed = |offset: f64| {
                state[across] = surface.at + offset;
                system.drift_at(0.0, &state)[across]
            };
            let (above, below) = (
                speed(2.0 * far) - speed(far),
                speed(-far) - speed(-2.0 * far),
            );
            bends.push((above - below) / far);
            jumps.push(surface.drift_jump(system, &state, step));
        }
        let numbers = speeds.iter().chain(&bends).chain(jumps.iter().flatten());
        let is_finite = numbers.into_iter().all(|number| number.is_finite());
        is_finite.then_some(Self {
            space,
            across,
            cells,
            speeds,
            jumps,
            bends,
            at: surface.at,
        })
    }

    /// The number in the whole space of the cell that has another position across the plane.
    fn at(&self, cell: usize, position: usize) -> usize {
        let mut positions: Vec<usize> = (0..self.space.dimension())
            .map(|axis| self.space.position(self.cells[cell], axis))
            .collect();
        positions[self.across] = position;
        self.space.number(&positions)
    }

    /// Whether states move across it, and their drift neither jumps nor bends there.
    fn is_crossed(&self) -> bool {
        let fastest = self.fastest();
        let jumps = self.jumps.iter().map(|jump| jump[self.across].abs());
        let width = self.space.axes()[self.across].to() - self.space.axes()[self.across].from();
        let bends = self.bends.iter().map(|bend| bend.abs() * width);
        let (jump, bend) = (jumps.fold(0.0, f64::max), bends.fold(0.0, f64::max));
        fastest > 0.0 && jump <= ROUNDING * fastest && bend <= CURVED * fastest
    }

    /// Whether the drift jumps by as much everywhere.
    fn is_even(&self) -> bool {
        let sizes = self.jumps.iter().flatten().map(|jump| jump.abs());
        let largest = sizes.fold(0.0, f64::max);
        let first = self.jumps.first();
        let same = |jump: &Vec<f64>| {
            let pairs = jump.iter().zip(first.into_iter().flatten());
            pairs
                .into_iter()
                .all(|(one, other)| (one - other).abs() <= ROUNDING * largest)
        };
        self.jumps.iter().all(same)
    }

    /// Whether no noise jumps there.
    fn has_even_noise(&self, system: &dyn System) -> bool {
        let step = BESIDE * (self.space.axes()[self.across].to() - self.at);
        self.cells.iter().all(|&cell| {
            let mut state = self.space.centre(cell);
            system.noises().iter().all(|noise| {
                let mut square = |side: f64| {
                    state[self.across] = self.at + side * step;
                    noise.at(0.0, &state).powi(2)
                };
                let (below, above) = (square(-1.0), square(1.0));
                (above - below).abs() <= 10.0 * BESIDE * above.abs().max(below.abs())
            })
        })
    }

    fn fastest(&self) -> f64 {
        let speeds = self.speeds.iter();
        speeds.fold(0.0, |most, speed| most.max(speed.abs()))
    }

    /// Jump of the slope of p across the plane, in units of the masses of its cells.
    fn gains(&self, masses: &[f64]) -> Vec<f64> {
        let standing = STANDS * self.fastest();
        let gain = |cell: usize| -> Option<f64> {
            let moves = self.speeds[cell].abs() > standing;
            moves.then(|| -self.divergence(masses, cell) / self.speeds[cell])
        };
        let gains: Vec<Option<f64>> = (0..self.cells.len()).map(gain).collect();
        // Where the drift across is zero, in proportion to the mass as much as beside.
        let beside = |cell: usize| {
            let sides = (0..self.space.dimension()).flat_map(|axis| self.beside(cell, axis));
            let known = sides.flatten().filter(|&beside| masses[beside] > 0.0);
            let shares: Vec<f64> = known
                .filter_map(|beside| Some(gains[beside]? / masses[beside]))
                .collect();
            masses[cell] * shares.iter().sum::<f64>() / shares.len().max(1) as f64
        };
        (0..gains.len())
            .map(|cell| gains[cell].unwrap_or_else(|| beside(cell)))
            .collect()
    }

    /// ∇·(Δf p) of an even jump, times the volume of a cell: p Δf ∂ log p along every axis, by central differences.
    /// Logarithms of densities are followed farther than densities; where there is next to nothing the slope is
    /// nothing.
    fn divergence(&self, masses: &[f64], cell: usize) -> f64 {
        let along = (0..self.space.dimension()).filter(|&axis| axis != self.across);
        let of = |axis: usize| {
            let cells = &self.space.axes()[axis];
            let position = self.space.position(self.cells[cell], axis);
            let [below, above] = self.beside(cell, axis);
            let (low, high) = (below.unwrap_or(cell), above.unwrap_or(cell));
            let (from, to) = (
                position - usize::from(below.is_some()),
                position + usize::from(above.is_some()),
            );
            let apart = cells.centre(to) - cells.centre(from);
            let (first, last) = (
                masses[low] / cells.width(from),
                masses[high] / cells.width(to),
            );
            let rise = if first > 0.0 && last > 0.0 && apart > 0.0 {
                (last / first).ln() / apart
            } else {
                0.0
            };
            masses[cell].max(0.0) * self.jumps[cell][axis] * rise
        };
        along.map(of).sum()
    }

    /// The cells beside one along an axis, as they are numbered on the plane.
    fn beside(&self, cell: usize, axis: usize) -> [Option<usize>; 2] {
        if axis == self.across {
            return [None; 2];
        }
        let position = self.space.position(self.cells[cell], axis);
        let stride = self.stride(axis);
        let above = position + 1 < self.space.axes()[axis].count();
        [
            (position > 0).then(|| cell - stride),
            above.then(|| cell + stride),
        ]
    }

    /// Distance on the plane between neighbours along an axis: the first axis is slowest, and the one across is left
    /// out.
    fn stride(&self, axis: usize) -> usize {
        let later = self.space.axes().iter().enumerate().skip(axis + 1);
        let counts = later.filter(|(other, _)| *other != self.across);
        counts.map(|(_, axis)| axis.count()).product()
    }
}

#[cfg(test)]
mod tests;
