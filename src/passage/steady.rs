//! A steady state on the cells of a sweep, between their nodes, and its mass in a region.

use super::field::greatest_beside;
use super::masses::masses_in;
use super::start::at_state;
use super::timed::WithError;
use super::{KnownDensity, PassageError};
use crate::density::Roughness;
use crate::generator::levels;
use crate::space::CellSpace;
use crate::space::nodes::{FEWER_NODES, NODES};
use crate::system::BoundQuantity;

/// A density on the cells of a sweep, between their nodes.
pub(super) struct Steady<'a> {
    space: &'a CellSpace,
    kept: Vec<bool>,
    values: Vec<f64>,
    /// Whether it is a bound, which is that of a cell everywhere in it.
    is_bound: bool,
}

impl<'a> Steady<'a> {
    pub(super) fn new(space: &'a CellSpace, unknowns: &[f64]) -> Self {
        let volumes = local_volumes(space);
        let values = unknowns.iter().zip(volumes);
        Self {
            space,
            kept: vec![true; unknowns.len()],
            values: values.map(|(unknown, volume)| unknown / volume).collect(),
            is_bound: false,
        }
    }

    /// How large changes of a steady state are about each cell: at a single place they may vanish by chance.
    pub(super) fn bound(space: &'a CellSpace, changes: &[f64]) -> Self {
        let mut sizes = Self::new(space, changes);
        sizes.values.iter_mut().for_each(|size| *size = size.abs());
        sizes.values = greatest_beside(space, &sizes.values);
        sizes.is_bound = true;
        sizes
    }

    pub(super) fn at(&self, state: &[f64]) -> f64 {
        if self.is_bound {
            let cell = self.space.find(state);
            return cell.map_or(0.0, |cell| self.values[cell]);
        }
        let cells = (self.space, self.kept.as_slice());
        at_state(cells, state, NODES, &self.values).unwrap_or(0.0)
    }
}

/// Local volumes at the nodes.
pub(super) fn local_volumes(space: &CellSpace) -> Vec<f64> {
    let of_cell = |cell: usize| {
        let axes = space.axes().iter().enumerate();
        axes.map(|(index, axis)| axis.node_stretch(space.position(cell, index)))
            .product()
    };
    (0..space.n_cells()).map(of_cell).collect()
}

/// The steady state in the first region, and its error.
pub(super) fn mass_in(
    space: &CellSpace,
    density: &KnownDensity<'_>,
    region: &BoundQuantity,
) -> Result<WithError, PassageError> {
    let ((mass, error), _) = mass_beside(space, density, region, &[])?;
    Ok((mass, error + change_by_modes(space, density, region)?))
}

/// By how much modes that are not there may change the mass in the region: what no mode but the first carries is
/// changed too, by what the others feed into it.
pub(super) fn change_by_modes(
    space: &CellSpace,
    density: &KnownDensity<'_>,
    region: &BoundQuantity,
) -> Result<f64, PassageError> {
    let Some(changes) = density.by_modes else {
        return Ok(0.0);
    };
    let level = |state: &[f64]| region.at(state);
    let levels = levels(space, region)?;
    Ok(masses_in(space, &[changes], (level, &levels), NODES)[0].abs())
}

/// The same but for what modes that are not there change, with the masses of some other unknowns in that region.
pub(super) fn mass_beside(
    space: &CellSpace,
    density: &KnownDensity<'_>,
    region: &BoundQuantity,
    others: &[Vec<f64>],
) -> Result<(WithError, Vec<f64>), PassageError> {
    let levels = levels(space, region)?;
    let masses = |all: &[&[f64]], nodes: usize| {
        let level = |state: &[f64]| region.at(state);
        masses_in(space, all, (level, &levels), nodes)
    };
    let own = [density.unknowns].into_iter();
    let more = [density.returning, density.changes].into_iter().flatten();
    let all: Vec<&[f64]> = own
        .chain(others.iter().map(Vec::as_slice))
        .chain(more)
        .collect();
    let mut known = masses(&all, NODES);
    let own = known[0];
    let fewer = masses(&all[..1], FEWER_NODES)[0];
    let changed = density.changes.map_or(0.0, |changes| {
        let change = known.pop().unwrap_or(0.0);
        // What the changes do were those of neighbouring layers of cells independent: their sum may vanish by chance.
        let of_cell = |level: &f64| f64::from(u8::from(*level < 0.0)) - own;
        let roughness = Roughness {
            space,
            weights: density.unknowns,
            differences: changes,
            planes: density.planes,
        };
        let values: Vec<f64> = levels.iter().map(of_cell).collect();
        change.abs() + roughness.of(&values)
    });
    let returning = density.returning.and_then(|_| known.pop());
    let of_ends = density.of_ends(returning.unwrap_or(0.0), own.max(1.0 - own));
    let mass = (own, (own - fewer).abs() + changed + of_ends);
    Ok((mass, known.split_off(1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::{regions, registry};
    use statrs::function::erf::erf;

    #[test]
    fn the_mass_of_a_normal_density_below_a_border_is_that_of_the_error_function() {
        let model = registry::find("bistable").unwrap();
        let region = regions(&model, &[("left", "x < -0.417")])
            .unwrap()
            .remove(0);
        let values = model.values(&[("a", 1.0), ("sigma2", 0.2)]).unwrap();
        let region = region.level().bind(&values).unwrap();
        let exact = 0.5 * (1.0 + erf(-0.417 / (0.5 * 2.0_f64.sqrt())));
        for cells in [40, 54, 80, 120] {
            let space = CellSpace::new(vec![Axis::uniform(-4.0, 4.0, cells).unwrap()]).unwrap();
            let width = 8.0 / cells as f64;
            let unknowns: Vec<f64> = (0..cells)
                .map(|cell| {
                    let x = space.node(cell)[0];
                    width * (-2.0 * x * x).exp() / (0.5 * (2.0 * std::f64::consts::PI).sqrt())
                })
                .collect();
            let density = KnownDensity {
                unknowns: &unknowns,
                changes: None,
                by_modes: None,
                returning: None,
                beyond: 0.0,
                planes: &[],
            };
            let (mass, error) = mass_in(&space, &density, &region).unwrap();
            assert!((mass - exact).abs() <= error + 1e-12);
        }
    }
}
