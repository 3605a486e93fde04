//! A density that lasts, from one grid to another: where the rate is looked for from.

use crate::MAX_DIMENSION;
use crate::space::CellSpace;
use crate::space::nodes::place_of;

/// A density at the nodes of a grid, zero inside the target.
pub(super) struct Lasting {
    space: CellSpace,
    density: Vec<f64>,
    /// Whether the equations of the grid can be solved in single precision as well.
    pub(super) is_far_from_singular: bool,
}

impl Lasting {
    /// From the unknowns of cells, density times local volume.
    pub(super) fn new(space: CellSpace, unknowns: Vec<f64>, is_far_from_singular: bool) -> Self {
        let mut density = unknowns;
        for (cell, value) in density.iter_mut().enumerate() {
            *value /= space.volume(cell);
        }
        Self {
            space,
            density,
            is_far_from_singular,
        }
    }

    /// The unknowns of the kept cells of another grid, linear between nodes.
    pub(super) fn on(&self, other: &CellSpace, kept: &[bool]) -> Vec<f64> {
        let (shape, dimension) = (self.space.shape(), other.dimension());
        let along = self.space.axes().iter().zip(other.axes());
        // Along each axis, for each of its nodes, the lower of two nodes here and the share of the upper one.
        let places: Vec<Vec<(usize, f64)>> = along
            .map(|(own, other)| {
                let last = own.count() - 1;
                let one = |&x: &f64| {
                    let place = (place_of(own, x) - 0.5).clamp(0.0, last as f64);
                    let lower = (place as usize).min(last.saturating_sub(1));
                    (lower, place - lower as f64)
                };
                other.nodes().iter().map(one).collect()
            })
            .collect();
        let mut unknowns = vec![0.0; other.n_cells()];
        for (cell, value) in unknowns.iter_mut().enumerate() {
            if !kept[cell] {
                continue;
            }
            let mut at = [(0, 0.0); MAX_DIMENSION];
            for (axis, (at, places)) in at.iter_mut().zip(&places).enumerate() {
                *at = places[other.position(cell, axis)];
            }
            for corner in 0..1_usize << dimension {
                let (mut number, mut weight) = (0, 1.0);
                for (axis, (&count, &(lower, share))) in shape.iter().zip(&at).enumerate() {
                    let upper = corner >> axis & 1;
                    number = number * count + (lower + upper).min(count - 1);
                    weight *= if upper == 1 { share } else { 1.0 - share };
                }
                *value += weight * self.density[number];
            }
            *value *= other.volume(cell);
        }
        unknowns
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;

    #[test]
    fn on_its_own_grid_a_density_is_what_it_was_and_on_another_it_has_its_mass() {
        let axis = |count| Axis::uniform(-4.0, 4.0, count).unwrap();
        let space = CellSpace::new(vec![axis(40), axis(30)]).unwrap();
        let density = |state: &[f64]| (-state[0].powi(2) - state[1].powi(2)).exp();
        let one = |cell: usize| density(&space.node(cell)) * space.volume(cell);
        let unknowns: Vec<f64> = (0..space.n_cells()).map(one).collect();
        let kept = vec![true; space.n_cells()];
        let lasting = Lasting::new(space.clone(), unknowns.clone(), true);
        for (found, own) in lasting.on(&space, &kept).iter().zip(&unknowns) {
            assert!((found - own).abs() < 1e-14);
        }
        let other = CellSpace::new(vec![axis(52), axis(44)]).unwrap();
        let kept = vec![true; other.n_cells()];
        let mass: f64 = lasting.on(&other, &kept).iter().sum();
        // Linear interpolation between nodes a fifth apart: h²/12 of the mean curvature, which is zero, and edges.
        assert!((mass - std::f64::consts::PI).abs() < 1e-2, "{mass}");
    }
}
