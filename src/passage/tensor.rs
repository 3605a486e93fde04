//! Interpolation on all points of a grid at once: axis by axis, each with the weights of its own nodes.

use crate::space::nodes::AxisWeights;

/// A field at the points of a grid, from its values at the nodes of another: for each axis one set of weights a point.
pub(super) fn gathered(values: &[f64], shape: &[usize], axes: &[Vec<AxisWeights>]) -> Vec<f64> {
    let mut shape = shape.to_vec();
    let mut values = values.to_vec();
    for (axis, points) in axes.iter().enumerate() {
        let (count, inner) = (shape[axis], shape[axis + 1..].iter().product::<usize>());
        let outer: usize = shape[..axis].iter().product();
        let mut next = vec![0.0; outer * points.len() * inner];
        let lines = next.chunks_exact_mut((points.len() * inner).max(1));
        for (line, nodes) in lines.zip(values.chunks_exact((count * inner).max(1))) {
            for (out, point) in line.chunks_exact_mut(inner.max(1)).zip(points) {
                for (node, weight) in point.each() {
                    let row = &nodes[node * inner..(node + 1) * inner];
                    let pairs = out.iter_mut().zip(row);
                    pairs.for_each(|(out, value)| *out += weight * value);
                }
            }
        }
        shape[axis] = points.len();
        values = next;
    }
    values
}

/// The transposed of [`gathered`]: masses at the points, over the nodes of a grid of a shape.
pub(super) fn scattered(masses: &[f64], shape: &[usize], axes: &[Vec<AxisWeights>]) -> Vec<f64> {
    let mut points: Vec<usize> = axes.iter().map(Vec::len).collect();
    let mut masses = masses.to_vec();
    for (axis, along) in axes.iter().enumerate() {
        let (count, inner) = (shape[axis], points[axis + 1..].iter().product::<usize>());
        let outer: usize = points[..axis].iter().product();
        let mut next = vec![0.0; outer * count * inner];
        let lines = next.chunks_exact_mut((count * inner).max(1));
        for (nodes, line) in lines.zip(masses.chunks_exact((along.len() * inner).max(1))) {
            for (masses, point) in line.chunks_exact(inner.max(1)).zip(along) {
                for (node, weight) in point.each() {
                    let row = &mut nodes[node * inner..(node + 1) * inner];
                    let pairs = row.iter_mut().zip(masses);
                    pairs.for_each(|(out, mass)| *out += weight * mass);
                }
            }
        }
        points[axis] = count;
        masses = next;
    }
    masses
}

/// At the points of a grid, whether all nodes that have weights there are kept.
pub(super) fn whole(kept: &[bool], shape: &[usize], axes: &[Vec<AxisWeights>]) -> Vec<bool> {
    if kept.iter().all(|&kept| kept) {
        return vec![true; axes.iter().map(Vec::len).product()];
    }
    let missing: Vec<f64> = kept
        .iter()
        .map(|&kept| f64::from(u8::from(!kept)))
        .collect();
    let ones: Vec<Vec<AxisWeights>> = axes
        .iter()
        .map(|points| points.iter().map(AxisWeights::counting).collect())
        .collect();
    let missing = gathered(&missing, shape, &ones);
    missing.into_iter().map(|missing| missing == 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::nodes::{NODES, about};
    use crate::space::{Axis, CellSpace};

    /// Two grids on one square, the second with other cells, and weights of the first's nodes at the second's.
    fn grids() -> (CellSpace, CellSpace, Vec<Vec<AxisWeights>>) {
        let axis = |count| Axis::uniform(-1.0, 1.0, count).unwrap();
        let own = CellSpace::new(vec![axis(12), axis(9)]).unwrap();
        let other = CellSpace::new(vec![axis(7), axis(10)]).unwrap();
        let pairs = own.axes().iter().zip(other.axes());
        let axes = pairs.map(|(own, other)| {
            let nodes = other.nodes().iter();
            nodes.map(|&x| about(own, x, NODES)).collect()
        });
        let axes = axes.collect();
        (own, other, axes)
    }

    #[test]
    fn polynomials_are_interpolated_to_rounding_and_masses_keep_their_averages() {
        let (own, other, axes) = grids();
        let field = |state: Vec<f64>| state[0].powi(5) * state[1].powi(3) - state[1] + 0.3;
        let values: Vec<f64> = (0..own.n_cells())
            .map(|cell| field(own.node(cell)))
            .collect();
        let found = gathered(&values, &own.shape(), &axes);
        for (cell, value) in found.iter().enumerate() {
            assert!((value - field(other.node(cell))).abs() < 1e-13);
        }
        let masses: Vec<f64> = (0..other.n_cells())
            .map(|cell| (cell as f64).sin())
            .collect();
        let spread = scattered(&masses, &own.shape(), &axes);
        let dot = crate::passage::dot;
        assert!((dot(&masses, &found) - dot(&spread, &values)).abs() < 1e-12);
    }

    #[test]
    fn points_whose_nodes_are_not_all_kept_are_told() {
        let (own, other, axes) = grids();
        let mut kept = vec![true; own.n_cells()];
        assert!(whole(&kept, &own.shape(), &axes).into_iter().all(|all| all));
        kept[0] = false;
        // The first node of either axis is read by the points at whose side it is one of the six nearest.
        let found = whole(&kept, &own.shape(), &axes);
        let reads = |axis: usize, at: usize| axes[axis][at].each().any(|(node, _)| node == 0);
        for (cell, is_whole) in found.into_iter().enumerate() {
            let [x, y] = [0, 1].map(|axis| reads(axis, other.position(cell, axis)));
            assert_eq!(is_whole, !(x && y));
        }
    }
}
