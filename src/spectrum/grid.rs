//! The generator of a system between walls, with all and with half of its dissipation.

use std::sync::Arc;

use sprs::CsMat;

use super::SpectrumError;
use crate::generator::{Dissipation, GeneratorOptions, assemble_damped};
use crate::space::{Axis, CellSpace};
use crate::system::{Enclosed, System};

/// Fewest modes of an axis that carries a series.
const LEAST_MODES: usize = 2;

/// The generator on the cells of a sweep, or on fewer of them.
pub(super) struct Grid {
    pub(super) space: CellSpace,
    /// Q, by columns, which sum to zero: what would leave the range waits at a wall.
    pub(super) full: CsMat<f64>,
    /// The same with half of the dissipation of advective fluxes.
    pub(super) half: CsMat<f64>,
}

impl Grid {
    /// With `factor` times as many cells, or modes, an axis.
    pub(super) fn new(
        system: &Arc<dyn System>,
        space: &CellSpace,
        factor: f64,
        options: &GeneratorOptions,
    ) -> Result<Self, SpectrumError> {
        let axes: Result<Vec<Axis>, _> = space
            .axes()
            .iter()
            .map(|axis| fewer(axis, factor))
            .collect();
        let space = CellSpace::new(axes?)?;
        let enclosed = Enclosed::new(Arc::clone(system), &space.ranges());
        let assemble = |dissipation| assemble_damped(&enclosed, &space, options, dissipation);
        let (full, half) = rayon::join(
            || assemble(Dissipation::Full),
            || assemble(Dissipation::Half),
        );
        let (full, half) = (full?.matrix, half?.matrix);
        Ok(Self { space, full, half })
    }
}

fn fewer(axis: &Axis, factor: f64) -> Result<Axis, SpectrumError> {
    if factor == 1.0 {
        return Ok(axis.clone());
    }
    if !axis.is_modes() {
        return Ok(axis.refined(factor));
    }
    let modes = (axis.mode_number() as f64 * factor) as usize;
    Ok(axis.with_modes(modes.max(LEAST_MODES.min(axis.mode_number())))?)
}

/// s - Q as the generator of a process that ends at the rate s everywhere: Q less s on the diagonal, and the rates.
pub(super) fn ending(matrix: &CsMat<f64>, rate: f64) -> (CsMat<f64>, Vec<f64>) {
    let mut shifted = matrix.clone();
    let mut ends = vec![rate; matrix.cols()];
    for (cell, end) in ends.iter_mut().enumerate() {
        match shifted.get_mut(cell, cell) {
            Some(own) => *own -= rate,
            // A cell that nothing leaves has no place on the diagonal.
            None => *end = 0.0,
        }
    }
    (shifted, ends)
}
