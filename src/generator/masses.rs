//! From the generator's unknowns, point values times local cell volume, to the masses of the cells.

use std::borrow::Cow;

use rayon::prelude::*;

use super::geometry::surface_faces;
use crate::space::{Axis, CellSpace};
use crate::system::System;

/// Points of the polynomial that is integrated over a cell.
const POINTS: usize = 5;

/// What the cells at a wall count more than one in sums: -f'/24 + 7 f'''/5760 there, of the cubic polynomial through
/// them.
const AT_WALL: [f64; 4] = {
    let third = 223.0 / 5760.0;
    [
        1.0 / 12.0 + third,
        -1.0 / 8.0 - 3.0 * third,
        1.0 / 24.0 + 3.0 * third,
        -third,
    ]
};

/// Masses of the cells, Σ = 1, from a null vector of the generator (or any of its states).
///
/// The unknown of a cell is p(node) times the local volume Π dx/du. A cell's mass is the integral of p over
/// the cell, which differs in second order of its width: along every axis the polynomial of fourth degree
/// through the densities at the nearest nodes is integrated, all of them on the cell's side of any switching
/// surface, where p has a kink. Along an axis of modes the unknowns are Gauss's rule already, and stay. `unknowns` has
/// length `n_cells`; if the masses sum to nothing they are not normalised.
pub fn cell_masses(system: &dyn System, space: &CellSpace, unknowns: &[f64]) -> Vec<f64> {
    let mut masses = unknowns.to_vec();
    let shape = space.shape();
    let axes = space.axes().iter().enumerate();
    for (index, axis) in axes.filter(|(_, axis)| !axis.is_modes()) {
        let mut cuts = vec![0, axis.count()];
        cuts.extend(surface_faces(system, index, axis));
        cuts.sort_unstable();
        cuts.dedup();
        let weights = integration_weights(axis, &cuts);
        let stride: usize = shape[index + 1..].iter().product();
        masses
            .par_chunks_mut(stride * shape[index])
            .for_each(|block| integrate(block, stride, &weights));
    }
    let total: f64 = masses.iter().sum();
    if total.is_finite() && total != 0.0 {
        masses.iter_mut().for_each(|mass| *mass /= total);
    }
    masses
}

/// Mean and variance along each axis from a null vector of the generator.
///
/// The unknowns are values of p at the nodes times local widths, so their sums are trapezoidal sums in the cell
/// coordinate: for a density that is smooth and vanishes at the ends they have no error of second order in the
/// width, where moments of the cells' masses are high by h²/6.
pub fn unknown_moments(space: &CellSpace, unknowns: &[f64]) -> Vec<(f64, f64)> {
    let total: f64 = unknowns.iter().sum();
    let axes = space.axes().iter().enumerate();
    axes.map(|(index, axis)| {
        let average = |value: &dyn Fn(f64) -> f64| -> f64 {
            let nodes: Vec<f64> = axis.nodes().iter().map(|&node| value(node)).collect();
            let cells = unknowns.iter().zip(space.positions(index));
            cells.map(|(u, position)| u * nodes[position]).sum::<f64>() / total
        };
        let mean = average(&|x| x);
        (mean, average(&|x| (x - mean).powi(2)))
    })
    .collect()
}

/// Unknowns whose sums end at walls that reflect. The density is not zero there: the midpoint rule in the cell
/// coordinate misses a twenty-fourth of the slope at the wall (Euler and Maclaurin), which weights of the last cells
/// make good to fourth order.
pub(crate) fn summed_to_walls<'a>(
    system: &dyn System,
    space: &CellSpace,
    unknowns: &'a [f64],
) -> Cow<'a, [f64]> {
    let mut summed = Cow::Borrowed(unknowns);
    let facts = system.facts();
    for (index, axis) in space.axes().iter().enumerate() {
        if axis.count() < AT_WALL.len() || !facts.reflecting.contains_key(&index) {
            continue;
        }
        let [lower, upper] = facts.walls(index, (axis.from(), axis.to()));
        let values = summed.to_mut().iter_mut().zip(space.positions(index));
        for (value, position) in values {
            let from_ends = [(lower, position), (upper, axis.count() - 1 - position)];
            for (_, place) in from_ends.into_iter().filter(|(is_wall, _)| *is_wall) {
                *value *= 1.0 + AT_WALL.get(place).copied().unwrap_or(0.0);
            }
        }
    }
    summed
}

/// Unknowns of a density whose integral is one, and the share by which they were changed for it: where there are walls
/// that reflect, the integral is not their own sum.
pub(crate) fn normalised_to_walls<'a>(
    system: &dyn System,
    space: &CellSpace,
    unknowns: &'a [f64],
) -> (Cow<'a, [f64]>, f64) {
    match summed_to_walls(system, space, unknowns) {
        Cow::Borrowed(_) => (Cow::Borrowed(unknowns), 0.0),
        Cow::Owned(summed) => {
            let whole: f64 = summed.iter().sum();
            let normalised = unknowns.iter().map(|one| one / whole).collect();
            (Cow::Owned(normalised), (whole - 1.0).abs())
        }
    }
}

/// Replaces unknowns by masses along all lines of a block, whose cells are `stride` apart.
fn integrate(block: &mut [f64], stride: usize, weights: &[(usize, Vec<f64>)]) {
    let mut line = vec![0.0; weights.len()];
    for inner in 0..stride {
        let cells = block.iter().skip(inner).step_by(stride);
        for (value, cell) in line.iter_mut().zip(cells) {
            *value = *cell;
        }
        let cells = block.iter_mut().skip(inner).step_by(stride);
        for (cell, (first, weights)) in cells.zip(weights) {
            let terms = weights.iter().zip(&line[*first..]);
            *cell = terms.map(|(weight, value)| weight * value).sum();
        }
    }
}

/// For each cell the first cell of its stencil, and the weights of the unknowns from there on.
fn integration_weights(axis: &Axis, cuts: &[usize]) -> Vec<(usize, Vec<f64>)> {
    let mut weights = Vec::with_capacity(axis.count());
    for piece in cuts.windows(2) {
        let points = POINTS.min(piece[1] - piece[0]);
        for cell in piece[0]..piece[1] {
            let first = cell
                .saturating_sub(points / 2)
                .clamp(piece[0], piece[1] - points);
            let nodes = &axis.nodes()[first..first + points];
            let stretched = lagrange_integrals(nodes, axis.edges()[cell], axis.edges()[cell + 1])
                .into_iter()
                .enumerate()
                .map(|(offset, weight)| weight / axis.node_stretch(first + offset))
                .collect();
            weights.push((first, stretched));
        }
    }
    weights
}

/// Integrals from `from` to `to` of the Lagrange polynomials of the nodes: three Gauss points, exact up to degree 5.
fn lagrange_integrals(nodes: &[f64], from: f64, to: f64) -> Vec<f64> {
    let offset = 0.6_f64.sqrt();
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let gauss = [(-offset, 5.0 / 9.0), (0.0, 8.0 / 9.0), (offset, 5.0 / 9.0)];
    let polynomial = |index: usize, x: f64| -> f64 {
        let others = nodes
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index);
        others
            .map(|(_, node)| (x - node) / (nodes[index] - node))
            .product()
    };
    (0..nodes.len())
        .map(|index| {
            let values =
                gauss.map(|(place, weight)| weight * polynomial(index, middle + half * place));
            half * values.iter().sum::<f64>()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grading;

    #[test]
    fn moments_of_a_smooth_density_have_no_error_of_second_order() {
        let grading = Grading {
            at: vec![0.5],
            smallest: 0.2,
        };
        let axes = [
            Axis::uniform(-6.0, 7.0, 24).unwrap(),
            Axis::graded(-6.0, 7.0, 40, &grading).unwrap(),
        ];
        for axis in axes {
            let space = CellSpace::new(vec![axis.clone()]).unwrap();
            let unknown = |(cell, x): (usize, &f64)| {
                axis.node_stretch(cell) * (-0.5 * (x - 0.3) * (x - 0.3)).exp()
            };
            let unknowns: Vec<f64> = axis.nodes().iter().enumerate().map(unknown).collect();
            let (mean, variance) = unknown_moments(&space, &unknowns)[0];
            // h²/6 would be 0.05 on the uniform axis.
            assert!(
                (mean - 0.3).abs() < 1e-3 && (variance - 1.0).abs() < 2e-3,
                "{mean} {variance}"
            );
        }
    }
}
