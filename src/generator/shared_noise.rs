//! A noise that moves an axis of cells and an angle at once: the mixed derivative ∂²(c p)/∂x∂φ of the Fokker-Planck
//! equation, c the product of its two amplitudes.
//!
//! Along the angle the derivative is that of trigonometric polynomials, whose rows and columns sum to zero: nothing is
//! fed to or taken from the density of the other axes. Along x it is a central difference of fourth order in the cell
//! coordinate; beyond the ends of the range there is nothing.

use sprs::{CsMat, TriMat};

use super::Generator;
use crate::space::CellSpace;
use crate::system::{LANES, Lanes};

/// Weights of the cells one and two further on; those before have the opposite sign.
const WEIGHTS: [f64; 2] = [2.0 / 3.0, -1.0 / 12.0];

/// Adds to a generator on a space whose last axis is an angle with harmonics what a noise does to it and another axis
/// at once, by the product of both amplitudes.
pub(crate) fn add_shared_noise(
    generator: &mut Generator,
    space: &CellSpace,
    axis: usize,
    product: &dyn Fn(&[Lanes]) -> Lanes,
) {
    let (cells, axes) = (space.n_cells(), space.axes());
    let Some((angle, others)) = axes.split_last() else {
        return;
    };
    let (count, slopes) = (angle.count(), angle.differentiation());
    let stride: usize = count
        * others[axis + 1..]
            .iter()
            .map(|one| one.count())
            .product::<usize>();
    let along = &axes[axis];
    let products = at_nodes(space, product);
    let mut mixed = TriMat::with_capacity((cells, cells), 4 * count * cells);
    for (from, product) in products.into_iter().enumerate() {
        let (position, node) = (space.position(from, axis), from % count);
        let rate = product / along.node_stretch(position);
        for (step, weight) in WEIGHTS.iter().enumerate() {
            // Of a cell after this one this is one before.
            for (to, sign) in [
                (position.checked_sub(step + 1), 1.0),
                (Some(position + step + 1), -1.0),
            ] {
                let Some(to) = to.filter(|&to| to < along.count()) else {
                    continue;
                };
                let first = from - node + to * stride - position * stride;
                for (other, slope) in slopes[node * count..][..count].iter().enumerate() {
                    mixed.add_triplet(first + other, from, -sign * weight * rate * slope);
                }
            }
        }
    }
    let mixed: CsMat<f64> = mixed.to_csc();
    generator.matrix = &generator.matrix + &mixed;
}

/// A function of batches of states at the nodes of all cells.
pub(crate) fn at_nodes(space: &CellSpace, function: &dyn Fn(&[Lanes]) -> Lanes) -> Vec<f64> {
    let mut values = Vec::with_capacity(space.n_cells());
    let mut states = vec![[0.0; LANES]; space.dimension()];
    for first in (0..space.n_cells()).step_by(LANES) {
        let some = first..(first + LANES).min(space.n_cells());
        for cell in some.clone() {
            for (states, node) in states.iter_mut().zip(space.node(cell)) {
                states[cell - first] = node;
            }
        }
        values.extend_from_slice(&function(&states)[..some.len()]);
    }
    values
}
