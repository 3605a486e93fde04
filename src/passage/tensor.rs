//! Interpolation on all points of a grid at once: axis by axis, each with the weights of its own nodes.

use super::start::AxisWeights;

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
