//! Kinks of densities on planes across which no noise acts, as where a force on the velocity jumps at a position.
//!
//! The flux across such a plane is v p, with the drift v across it; where the drift f of other axes jumps by Δf there, the stationary
//! equation asks that v ∂p/∂x jumps by -∇·(Δf p), so the slope of log p jumps by -∇·(Δf p)/(v p).
//!
//! The law is used where noise and the slope of v do not jump, and Δf is the same all over the plane. Then the jump is Δf times a
//! number that depends on the density, and is zero exactly where Δf is.

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
/// Cells with a smaller share of the largest mass beside the plane tell nothing of a slope.
const EMPTY: f64 = 1e-10;

/// Whether noise acts across a surface.
pub(super) fn is_driven(system: &dyn System, surface: SwitchingSurface) -> bool {
    let mut channels = system.noise_axes().iter();
    channels.any(|&axis| axis == surface.axis)
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

/// The kink that a surface makes in the density of the given axes, if it stands on one of them.
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
        let channels = 0..system.noise_axes().len();
        let step = BESIDE * (self.space.axes()[self.across].to() - self.at);
        self.cells.iter().all(|&cell| {
            let mut state = self.space.centre(cell);
            channels.clone().all(|channel| {
                let mut square = |side: f64| {
                    state[self.across] = self.at + side * step;
                    system.amplitude_at(channel, 0.0, &state).powi(2)
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
        // Where the drift across is zero, as much as beside.
        let beside = |cell: usize| {
            let sides = (0..self.space.dimension()).flat_map(|axis| self.beside(cell, axis));
            let known: Vec<f64> = sides.flatten().filter_map(|cell| gains[cell]).collect();
            known.iter().sum::<f64>() / known.len().max(1) as f64
        };
        (0..gains.len())
            .map(|cell| gains[cell].unwrap_or_else(|| beside(cell)))
            .collect()
    }

    /// ∇·(Δf p), times the volume of a cell: p (∂Δf + Δf ∂ log p) along every axis, by central differences. Logarithms of densities are
    /// followed farther than densities; where there is next to nothing the slope is nothing.
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
            let rise = match first > 0.0 && last > 0.0 {
                true => (last / first).ln() / apart,
                false => 0.0,
            };
            let turn = (self.jumps[high][axis] - self.jumps[low][axis]) / apart;
            masses[cell].max(0.0) * (turn + self.jumps[cell][axis] * rise)
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

    /// Distance on the plane between neighbours along an axis: the first axis is slowest, and the one across is left out.
    fn stride(&self, axis: usize) -> usize {
        let later = self.space.axes().iter().enumerate().skip(axis + 1);
        let counts = later.filter(|(other, _)| *other != self.across);
        counts.map(|(_, axis)| axis.count()).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::TypedModel;

    /// x' = y, y' = -x - a sgn x - c y + s ξ has p ∝ exp(-(2c/s²)(y²/2 + x²/2 + a |x|)): the slope of log p jumps by -4 a c/s².
    #[test]
    fn a_force_that_jumps_makes_the_kink_of_the_exact_density() {
        let (c, s, a) = (0.5, 0.7, 0.3);
        let model = TypedModel::new("bang", "A spring with a preload", ["x", "y"])
            .with_equation("x", "y")
            .with_equation("y", "-x - a sign(x) - 0.5 y")
            .with_noise("y", ["0.7"])
            .with_parameters(["a"])
            .build()
            .unwrap();
        let system = model.system_with(&[("a", a)]).unwrap();
        let surface = SwitchingSurface { axis: 0, at: 0.0 };
        let found = |count: usize| {
            let axis = |half: f64, count: usize| Axis::uniform(-half, half, count).unwrap();
            let space = CellSpace::new(vec![axis(4.0, 40), axis(3.0, count)]).unwrap();
            assert!(jumps(system.as_ref(), &space, surface));
            assert!(is_known(system.as_ref(), &space, surface));
            let density = |state: &[f64]| {
                let energy = 0.5 * (state[0].powi(2) + state[1].powi(2)) + a * state[0].abs();
                (-2.0 * c / (s * s) * energy).exp()
            };
            let cells = 0..space.n_cells();
            let masses: Vec<f64> = cells.map(|cell| density(&space.centre(cell))).collect();
            let of =
                |axes: &[usize]| kink(system.as_ref(), &space, &masses, axes, surface).unwrap();
            assert!(kink(system.as_ref(), &space, &masses, &[1], surface).is_none());
            (of(&[0]).jump_at(0), of(&[0, 1]).jump_at(count / 2))
        };
        let exact = -4.0 * a * c / (s * s);
        // Even and odd counts: with and without cells in which nothing crosses the plane.
        for counts in [[40, 80], [41, 81]] {
            let [coarse, fine] = counts.map(found);
            for (coarse, fine) in [(coarse.0, fine.0), (coarse.1, fine.1)] {
                let errors = [coarse - exact, fine - exact].map(f64::abs);
                assert!(errors[1] < 0.01, "{errors:?}");
                assert!(
                    errors[1] < 0.3 * errors[0] || errors[1] < 1e-9,
                    "{errors:?}"
                );
            }
        }
    }
    #[test]
    fn the_law_is_used_only_where_it_holds() {
        let known = |of_x: &str, force: &str, noise: &str| {
            let model = TypedModel::new("bang", "A jump", ["x", "y"])
                .with_equation("x", of_x)
                .with_equation("y", force)
                .with_noise("y", [noise])
                .build()
                .unwrap();
            let system = model.system_with(&[]).unwrap();
            let axis = |half: f64, count: usize| Axis::uniform(-half, half, count).unwrap();
            let space = CellSpace::new(vec![axis(4.0, 40), axis(3.0, 30)]).unwrap();
            let surface = SwitchingSurface { axis: 0, at: 0.0 };
            let jumps = jumps(system.as_ref(), &space, surface);
            (jumps, is_known(system.as_ref(), &space, surface))
        };
        assert_eq!(known("y", "-x - sign(x) - y", "0.7"), (true, true));
        assert_eq!(
            known("y + 0.3 sin(x)", "-x - sign(x) - y", "0.7"),
            (true, true)
        );
        assert!(!known("y", "-x - y", "0.7").0);
        // Jumps that differ from place to place, a velocity that bends, and a noise that jumps.
        for (of_x, force, noise) in [
            ("y", "-x - (1 - 0.4 y^2) sign(x) - y", "0.7"),
            ("y", "-x - sign(x) y", "0.7"),
            ("y + 0.3 abs(x)", "-x - sign(x) - y", "0.7"),
            ("y", "-x - sign(x) - y", "0.7 + 0.1 sign(x)"),
        ] {
            assert_eq!(
                known(of_x, force, noise),
                (true, false),
                "{of_x}, {force}, {noise}"
            );
        }
    }
}
