//! Whether the grid is fine enough for the noise, judged where the mass is.

use super::geometry::surface_faces;
use crate::space::CellSpace;
use crate::system::{LANES, SwitchingSurface, System, natural_ends};

/// Share of the heaviest mass density below which a cell does not count.
const WEIGHT: f64 = 1e-4;

/// Distance from a surface, as a share of a cell, at which the drift on its two sides is taken.
const BESIDE: f64 = 1e-6;

/// Cells beside an end at which the noise dies that are not judged.
const BESIDE_NATURAL_END: usize = 4;

/// Jump of the drift across a surface, as a share of the drift, below which no layer is looked for.
const NO_JUMP: f64 = 1e-3;

/// How well the cells along one noisy axis resolve drift against diffusion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Resolution {
    /// The axis.
    pub axis: usize,
    /// Largest cell Péclet number |a| h/(2D) of the whole drift. Above 1 the drift is carried by the advective
    /// scheme, which is accurate as long as the density itself is smooth on the grid.
    pub peclet: f64,
    /// The same of the drift less its mean along the grid line: damping and friction, which shape the density
    /// along this axis; of the whole drift where noise dies at an end of the axis, but for the cells beside it. Above 1
    /// the density changes by more than e² from cell to cell.
    pub fitted_peclet: f64,
    /// Mass-weighted root mean square of |a| h/D in the cells beside switching surfaces: cell width over the
    /// thickness of the layer that holds the kink. `None` without a surface, on a face of the axis, across which the
    /// drift jumps.
    pub layer: Option<f64>,
    /// Switching surfaces inside the range that no face falls on.
    pub surfaces_off_faces: Vec<f64>,
    /// Those of them across which the drift along the axis jumps: the kink of the density lies inside cells, where
    /// nothing tells it from a slope.
    pub jumps_off_faces: Vec<f64>,
}

/// Judges every noisy axis of a cell space, given the masses of its cells (length `n_cells`).
pub(crate) fn resolution(
    system: &dyn System,
    space: &CellSpace,
    masses: &[f64],
) -> Vec<Resolution> {
    if system.dimension() != space.dimension() || masses.len() != space.n_cells() {
        return Vec::new();
    }
    let mut axes: Vec<usize> = system.noises().iter().map(|noise| noise.axis).collect();
    axes.sort_unstable();
    axes.dedup();
    axes.retain(|&axis| axis < space.dimension() && !space.axes()[axis].is_modes());
    axes.iter()
        .map(|&axis| judge(system, space, masses, axis))
        .collect()
}

fn judge(system: &dyn System, space: &CellSpace, masses: &[f64], index: usize) -> Resolution {
    let axis = &space.axes()[index];
    let densities = masses.iter().zip(space.volumes());
    let densities: Vec<f64> = densities.map(|(mass, volume)| mass / volume).collect();
    let lightest = WEIGHT * densities.iter().copied().fold(0.0, f64::max);
    let counts = |cell: usize| densities[cell] > lightest;
    let stride: usize = space.shape()[index + 1..].iter().product();
    let ranges = space.ranges();
    let mut seen = LineSurvey {
        system,
        space,
        index,
        faces: surface_faces(system, index, axis),
        natural: natural_ends(system, index, &ranges),
        peclet: 0.0,
        fitted_peclet: 0.0,
        layer: 0.0,
        weight: 0.0,
    };
    let firsts = space.positions(index).enumerate();
    for (first, _) in firsts.filter(|(_, position)| *position == 0) {
        let line = (0..axis.count()).map(|position| first + position * stride);
        if line.clone().any(counts) {
            let cells: Vec<usize> = line.collect();
            let masses: Vec<Option<f64>> = cells
                .iter()
                .map(|&cell| counts(cell).then_some(masses[cell]))
                .collect();
            seen.look_at(&cells, &masses);
        }
    }
    let surfaces = system.facts().surfaces_on(index);
    let off_faces: Vec<f64> = surfaces.filter(|&at| axis.is_inside_cell(at)).collect();
    let counting: Vec<usize> = (0..masses.len()).filter(|&cell| counts(cell)).collect();
    let jumps = off_faces.iter().copied();
    let jumps = jumps.filter(|&at| jumps_inside_cells(system, space, &counting, (index, at)));
    Resolution {
        axis: index,
        peclet: seen.peclet,
        fitted_peclet: seen.fitted_peclet,
        layer: (seen.weight > 0.0).then(|| (seen.layer / seen.weight).sqrt()),
        jumps_off_faces: jumps.collect(),
        surfaces_off_faces: off_faces,
    }
}

/// Whether the drift along an axis jumps across a plane inside cells, at any of some cells that hold the plane.
fn jumps_inside_cells(
    system: &dyn System,
    space: &CellSpace,
    cells: &[usize],
    (axis, at): (usize, f64),
) -> bool {
    let Some(position) = space.axes()[axis].find(at) else {
        return false;
    };
    let distance = BESIDE * space.axes()[axis].width(position);
    let mut holding = (cells.iter()).filter(|&&cell| space.position(cell, axis) == position);
    holding.any(|&cell| {
        let surface = SwitchingSurface { axis, at };
        let state = space.centre(cell);
        let jump = surface.drift_jump(system, &state, distance)[axis];
        jump.abs() > NO_JUMP * system.drift_at(0.0, &state)[axis].abs()
    })
}

/// What the grid lines along an axis have shown.
struct LineSurvey<'a> {
    system: &'a dyn System,
    space: &'a CellSpace,
    index: usize,
    /// Faces of the axis on switching surfaces.
    faces: Vec<usize>,
    /// Ends at which the noise along the axis dies.
    natural: [bool; 2],
    peclet: f64,
    fitted_peclet: f64,
    /// Σ of mass × (|a| h/D)² and of mass in the cells beside jumps.
    layer: f64,
    weight: f64,
}

impl LineSurvey<'_> {
    /// Adds a grid line: its cells, and the masses of those that count.
    fn look_at(&mut self, cells: &[usize], masses: &[Option<f64>]) {
        let axis = &self.space.axes()[self.index];
        let drifts = self.drifts(cells);
        let weighted = drifts.iter().enumerate();
        let weighted = weighted.map(|(position, drift)| drift * axis.width(position));
        // Where noise dies toward an end, a mean drift would be endlessly strong against it there.
        let mean = match self.natural {
            [false, false] => weighted.sum::<f64>() / (axis.to() - axis.from()),
            _ => 0.0,
        };
        for (position, (&cell, mass)) in cells.iter().zip(masses).enumerate() {
            let Some(mass) = mass else { continue };
            let diffusion = diffusion_at(self.system, self.space, self.index, cell);
            let (drift, scale) = (drifts[position], axis.width(position) / diffusion);
            self.peclet = self.peclet.max(0.5 * drift.abs() * scale);
            if !self.is_beside_natural_end(position) {
                let fitted = 0.5 * (drift - mean).abs() * scale;
                self.fitted_peclet = self.fitted_peclet.max(fitted);
            }
            if self.is_beside_jump(cell, position, drift) {
                self.layer += mass * (drift * scale).powi(2);
                self.weight += mass;
            }
        }
    }

    /// Whether a cell lies so near to an end at which the noise dies that the density goes like a power of the distance
    /// there, whose changes from cell to cell say nothing of the width of cells.
    fn is_beside_natural_end(&self, position: usize) -> bool {
        let beyond = self.space.axes()[self.index].count() - 1 - position;
        let [lower, upper] = self.natural;
        (lower && position < BESIDE_NATURAL_END) || (upper && beyond < BESIDE_NATURAL_END)
    }

    /// The drift along the axis in the middle of cells.
    fn drifts(&self, cells: &[usize]) -> Vec<f64> {
        let dimension = self.space.dimension();
        let (mut states, mut drift) =
            (vec![[0.0; LANES]; dimension], vec![[0.0; LANES]; dimension]);
        let mut found = Vec::with_capacity(cells.len());
        for batch in cells.chunks(LANES) {
            for (lane, &cell) in batch.iter().enumerate() {
                let centre = self.space.centre(cell).into_iter();
                states
                    .iter_mut()
                    .zip(centre)
                    .for_each(|(lanes, value)| lanes[lane] = value);
            }
            self.system.drift(0.0, &states, &mut drift);
            found.extend_from_slice(&drift[self.index][..batch.len()]);
        }
        found
    }

    /// Whether the drift jumps across a face of the cell. Dahl's friction bends other components with the sign of the
    /// velocity: no jump across, no layer.
    fn is_beside_jump(&self, cell: usize, position: usize, drift: f64) -> bool {
        let axis = &self.space.axes()[self.index];
        let beside = |face: &&usize| position == **face || position + 1 == **face;
        let jumps = |&face: &usize| {
            let surface = SwitchingSurface {
                axis: self.index,
                at: axis.edges()[face],
            };
            let distance = BESIDE * axis.width(position);
            let jump = surface.drift_jump(self.system, &self.space.centre(cell), distance);
            jump[self.index].abs() > NO_JUMP * drift.abs()
        };
        self.faces.iter().find(beside).is_some_and(jumps)
    }
}

/// D = Σ b²/2 over the processes that drive the axis.
fn diffusion_at(system: &dyn System, space: &CellSpace, axis: usize, cell: usize) -> f64 {
    0.5 * system.intensity_at(axis, 0.0, &space.centre(cell))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Axis, Grading};
    use crate::system::test_families::built_in;

    fn judged(y: Axis) -> Resolution {
        let values = [("kappa", 0.05), ("f_c", 0.01), ("sigma2", 0.1)];
        let coulomb = built_in("coulomb", &values);
        let x = Axis::uniform(-2.0, 2.0, 20).unwrap();
        let space = CellSpace::new(vec![x, y]).unwrap();
        let masses: Vec<f64> = (0..space.n_cells())
            .map(|cell| space.volume(cell))
            .collect();
        resolution(&*coulomb, &space, &masses).remove(0)
    }

    #[test]
    fn numbers_follow_from_drift_width_and_diffusion() {
        let uniform = judged(Axis::uniform(-2.0, 2.0, 20).unwrap());
        // At x = y = 1.9 with h = 0.2, D = 0.05: drift -(0.095 + 0.01 + 1.9), of which 0.105 is fitted.
        assert!((uniform.peclet - 2.005 * 2.0).abs() < 1e-12, "{uniform:?}");
        assert!(
            (uniform.fitted_peclet - 0.105 * 2.0).abs() < 1e-12,
            "{uniform:?}"
        );
        // Mean square of x is 1.33 at the nodes, of the friction and damping beside it 0.015².
        let expected = (1.33_f64 + 0.015 * 0.015).sqrt() * 4.0;
        assert!(
            (uniform.layer.unwrap() - expected).abs() < 1e-12,
            "{uniform:?}"
        );
    }

    #[test]
    fn a_surface_without_a_jump_across_it_makes_no_layer() {
        let values = [
            ("kappa", 0.02),
            ("lambda", 0.06),
            ("f_c", 0.05),
            ("sigma2", 0.02),
        ];
        let dahl = built_in("dahl", &values);
        let axis = || Axis::uniform(-2.0, 2.0, 20).unwrap();
        let z = Axis::uniform(-0.8, 0.8, 4).unwrap();
        let space = CellSpace::new(vec![axis(), axis(), z]).unwrap();
        let masses = vec![1.0; space.n_cells()];
        assert_eq!(resolution(&*dahl, &space, &masses)[0].layer, None);
    }

    #[test]
    fn grading_resolves_the_layer_and_odd_counts_miss_the_surface() {
        let grading = Grading {
            at: vec![0.0],
            smallest: 0.02,
        };
        let graded = judged(Axis::graded(-2.0, 2.0, 40, &grading).unwrap());
        assert!(graded.fitted_peclet <= 1.0 && graded.layer.unwrap() <= 1.0);
        assert!(graded.surfaces_off_faces.is_empty() && graded.jumps_off_faces.is_empty());
        let odd = judged(Axis::uniform(-2.0, 2.0, 21).unwrap());
        assert_eq!(odd.surfaces_off_faces, vec![0.0]);
        assert_eq!(odd.jumps_off_faces, vec![0.0]);
        assert_eq!(odd.layer, None);
    }
}
