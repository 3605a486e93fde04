//! Slopes of a density inside its cells, from the masses of neighbouring cells.

use crate::MAX_DIMENSION;
use crate::space::{Axis, CellSpace};

/// Largest Σ |s_a|: the density at the lowest corner of a cell stays at 5 % of the mean or above.
const STEEPEST: f64 = 1.9;

/// Relative slopes of the density in some cells: inside cell j it is p_j/V (1 + Σ_a s_a u_a), u_a from -½ to ½ across
/// the cell.
///
/// Slopes are differences over both neighbours, which errs by O(h²); at an end of the range over the one that is
/// there; along an angle the first cell follows the last. Where the density would fall below zero in a corner the
/// slopes are shortened together. `mass` has one value a cell of the space. An empty cell is flat, and so is every
/// cell along the phase of a forcing.
pub(super) fn cell_slopes(
    space: &CellSpace,
    cells: &[usize],
    mass: &[f64],
    phase: Option<usize>,
) -> Vec<[f64; MAX_DIMENSION]> {
    let strides = strides(space);
    let of_cell = |&cell: &usize| {
        let mut slopes = [0.0; MAX_DIMENSION];
        if mass[cell] > 0.0 {
            let axes = strides.iter().enumerate();
            for (axis, &stride) in axes.filter(|(axis, _)| phase != Some(*axis)) {
                slopes[axis] = slope(space, cell, axis, stride, mass);
            }
        }
        let steepness: f64 = slopes.iter().map(|slope| slope.abs()).sum();
        if steepness > STEEPEST {
            slopes
                .iter_mut()
                .for_each(|slope| *slope *= STEEPEST / steepness);
        }
        slopes
    };
    cells.iter().map(of_cell).collect()
}

/// Positions along an axis of the cells whose masses make the slope at a position.
fn neighbours(edges: &Axis, position: usize) -> (usize, usize) {
    let last = edges.count() - 1;
    match edges.is_closed() {
        true => ((position + last) % (last + 1), (position + 1) % (last + 1)),
        false => (position.saturating_sub(1), (position + 1).min(last)),
    }
}

/// The slope of a cell along an axis times its mass, which is linear in masses where slopes are not shortened: cells
/// above and below, and by how much their masses add to it and take from it.
pub(super) fn slope_of_masses(
    space: &CellSpace,
    cell: usize,
    axis: usize,
    stride: usize,
) -> [(usize, f64); 2] {
    let edges = &space.axes()[axis];
    let position = space.position(cell, axis);
    let (below, above) = neighbours(edges, position);
    let distance = edges.apart(edges.centre(above), edges.centre(below));
    let scale = edges.width(position).powi(2) / distance;
    let cell_at = |at: usize| cell + at * stride - position * stride;
    [
        (cell_at(above), scale / edges.width(above)),
        (cell_at(below), -scale / edges.width(below)),
    ]
}

/// Whether the slopes of a cell were shortened.
pub(super) fn are_shortened(slopes: &[f64; MAX_DIMENSION]) -> bool {
    slopes.iter().map(|slope| slope.abs()).sum::<f64>() > STEEPEST * (1.0 - 1e-9)
}

/// The distance in cell numbers from one position to the next, an axis.
pub(super) fn strides(space: &CellSpace) -> Vec<usize> {
    let dimension = space.dimension();
    let mut strides = vec![1; dimension];
    for axis in (1..dimension).rev() {
        strides[axis - 1] = strides[axis] * space.axes()[axis].count();
    }
    strides
}

/// Relative slope along one axis.
fn slope(space: &CellSpace, cell: usize, axis: usize, stride: usize, mass: &[f64]) -> f64 {
    let edges = &space.axes()[axis];
    let position = space.position(cell, axis);
    let (below, above) = neighbours(edges, position);
    // Cells of one line share their extent along the other axes.
    let density = |at: usize| mass[cell + at * stride - position * stride] / edges.width(at);
    let difference = density(above) - density(below);
    let distance = edges.apart(edges.centre(above), edges.centre(below));
    edges.width(position) * difference / distance / density(position)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grading;

    #[test]
    fn a_linear_density_has_its_slopes_on_any_cells() {
        let grading = Grading {
            at: vec![0.3],
            smallest: 0.02,
        };
        let x = Axis::graded(0.0, 1.0, 20, &grading).unwrap();
        let y = Axis::uniform(-1.0, 1.0, 10).unwrap();
        let space = CellSpace::new(vec![x, y]).unwrap();
        // Cell means of a linear density are its values at the centres.
        let density = |at: &[f64]| 3.0 + at[0] - 0.5 * at[1];
        let mass: Vec<f64> = (0..space.n_cells())
            .map(|cell| density(&space.centre(cell)) * space.volume(cell))
            .collect();
        let cells: Vec<usize> = (0..space.n_cells()).collect();
        for (&cell, slopes) in cells.iter().zip(cell_slopes(&space, &cells, &mass, None)) {
            let middle = density(&space.centre(cell));
            let width = |axis: usize| space.axes()[axis].width(space.position(cell, axis));
            assert!((slopes[0] - width(0) / middle).abs() < 1e-12);
            assert!((slopes[1] + 0.5 * width(1) / middle).abs() < 1e-12);
        }
    }

    #[test]
    fn a_wave_on_a_circle_has_its_slopes_across_the_seam() {
        let axis = Axis::turn(0.0, 1.0, 200).unwrap();
        let space = CellSpace::new(vec![axis.clone()]).unwrap();
        let angle = |cell: usize| std::f64::consts::TAU * axis.centre(cell);
        let mass: Vec<f64> = (0..200).map(|cell| 2.0 + angle(cell).sin()).collect();
        let cells: Vec<usize> = (0..200).collect();
        for (cell, slopes) in cells.iter().zip(cell_slopes(&space, &cells, &mass, None)) {
            let exact = std::f64::consts::TAU / 200.0 * angle(*cell).cos() / mass[*cell];
            // Differences over two cells of a two-hundredth of a turn: 1 - (2π/200)²/6.
            assert!((slopes[0] - exact).abs() < 2e-4 * exact.abs(), "{cell}");
        }
    }

    #[test]
    fn no_corner_is_negative_and_empty_cells_are_flat() {
        let axis = Axis::uniform(0.0, 1.0, 4).unwrap();
        let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
        let mut mass = vec![1.0; 16];
        (mass[5], mass[6], mass[9]) = (1e-6, 1e3, 0.0);
        let cells: Vec<usize> = (0..16).collect();
        let slopes = cell_slopes(&space, &cells, &mass, None);
        for slopes in &slopes {
            let lowest = 1.0 - 0.5 * slopes.iter().map(|s| s.abs()).sum::<f64>();
            assert!(lowest >= 0.05 - 1e-12, "{slopes:?}");
        }
        assert_eq!(slopes[9], [0.0; MAX_DIMENSION]);
    }
}
