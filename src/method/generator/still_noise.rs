//! The cells of one axis at which noise dies.
//!
//! The density goes like a power of the distance there, and derivatives of the noise may have a pole: means of these
//! are known no better than without what such cells add.

use crate::generator::at_nodes;
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Share of the noise beside it below which noise dies at a cell of one axis.
const DIES: f64 = 0.5;

/// The cells of one axis at which noise dies, and those beside them: there the density goes like a power of the
/// distance, and derivatives of the noise may have a pole.
pub(super) fn where_noise_dies(system: &dyn System, space: &CellSpace) -> Vec<usize> {
    if space.dimension() > 1 {
        return Vec::new();
    }
    let strengths = at_nodes(space, &|states| {
        let mut strength: Lanes = [0.0; LANES];
        for noise in system.noises_on(0) {
            let amplitudes = noise.amplitudes(0.0, states);
            let both = strength.iter_mut().zip(amplitudes);
            both.for_each(|(sum, amplitude)| *sum += amplitude * amplitude);
        }
        strength
    });
    let beside = |cell: usize| cell.saturating_sub(1)..=(cell + 1).min(strengths.len() - 1);
    let dies = |cell: usize| {
        let most = beside(cell).fold(0.0_f64, |most, other| most.max(strengths[other]));
        strengths[cell] < DIES * most
    };
    let cells = 0..strengths.len();
    cells.filter(|&cell| beside(cell).any(dies)).collect()
}
