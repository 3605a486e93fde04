//! A steady state on the cells of a sweep, between their nodes, and its mass in a region.

use super::spread::add_density;
use super::start::at_state;
use super::timed::WithError;
use super::{KnownDensity, PassageError};
use crate::generator::levels;
use crate::space::CellSpace;
use crate::space::nodes::{FEWER_NODES, NODES};
use crate::system::BoundQuantity;

/// A density on the cells of a sweep, between their nodes.
pub(super) struct Steady<'a> {
    space: &'a CellSpace,
    kept: Vec<bool>,
    values: Vec<f64>,
}

impl<'a> Steady<'a> {
    pub(super) fn new(space: &'a CellSpace, unknowns: &[f64]) -> Self {
        let volumes = local_volumes(space);
        let values = unknowns.iter().zip(volumes);
        Self {
            space,
            kept: vec![true; unknowns.len()],
            values: values.map(|(unknown, volume)| unknown / volume).collect(),
        }
    }

    pub(super) fn at(&self, state: &[f64]) -> f64 {
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
    let (levels, all) = (levels(space, region)?, vec![true; space.n_cells()]);
    let mass = |unknowns: &[f64], nodes: usize| {
        let level = (|state: &[f64]| region.at(state), levels.as_slice());
        let mut spread = vec![0.0; all.len()];
        add_density((space, &all), (space, unknowns), level, nodes, &mut spread)
    };
    let own = mass(density.unknowns, NODES);
    let fewer = mass(density.unknowns, FEWER_NODES);
    let changes = density.changes.map_or(0.0, |changes| mass(changes, NODES));
    Ok((own, (own - fewer).abs() + changes.abs()))
}
