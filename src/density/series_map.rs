//! Densities along axes of modes: the series integrated over bins, in place of sums over nodes.

use crate::space::{Axis, CellSpace};

use super::Observable;

/// Bins along an axis of modes.
const BINS: usize = 60;

/// Bins over one turn of an axis that closes on itself: two a wave of the highest harmonic that there may be.
pub(crate) const BINS_OF_A_TURN: usize = 120;

/// Modes that the coarser map leaves out: one of each parity, so that symmetric densities tell their error too.
const LEFT_OUT: usize = 2;

/// The axis along which a density is laid out: the axis itself, or bins of equal width over an axis of modes, the same
/// whatever their number but for finer axes, on which what is read off bins is checked too.
pub(crate) fn layout_axis(axis: &Axis) -> Axis {
    let (from, to) = axis.series_range();
    if axis.is_modes() && axis.is_closed() {
        Axis::turn(from, to, axis.laid_out(BINS_OF_A_TURN)).unwrap_or_else(|_| axis.clone())
    } else if axis.is_modes() {
        Axis::uniform(from, to, axis.laid_out(BINS)).unwrap_or_else(|_| axis.clone())
    } else {
        axis.clone()
    }
}

/// Modes of an axis that a map uses: all of them, or, of the coarser one, some less.
pub(super) fn used_modes(axis: &Axis, is_coarse: bool) -> usize {
    let left_out = if is_coarse { LEFT_OUT } else { 0 };
    axis.count().saturating_sub(left_out).max(1)
}

/// From masses at the nodes of series to masses of bins, along one or two axes of an observable.
#[derive(Debug, Clone)]
pub(super) struct SeriesMap {
    steps: Vec<Step>,
}

/// Along one axis: `to × from` weights, for values that are `stride` apart along it.
#[derive(Debug, Clone)]
struct Step {
    from: usize,
    to: usize,
    /// Distance of neighbours along the axis; what is before it has been laid out already.
    stride: usize,
    weights: Vec<f64>,
}

impl SeriesMap {
    /// For an observable of axes of a space, `None` where none of them has modes; the coarser map leaves the last modes
    /// out.
    pub(super) fn new(space: &CellSpace, observable: Observable, is_coarse: bool) -> Option<Self> {
        let axes: Vec<&Axis> = observable
            .axes()
            .iter()
            .map(|&axis| &space.axes()[axis])
            .collect();
        let mut steps = Vec::new();
        for (place, axis) in axes.iter().enumerate().filter(|(_, axis)| axis.is_modes()) {
            let bins = layout_axis(axis);
            steps.push(Step {
                from: axis.count(),
                to: bins.count(),
                stride: axes[place + 1..].iter().map(|axis| axis.count()).product(),
                weights: axis.series_weights(bins.edges(), used_modes(axis, is_coarse)),
            });
        }
        (!steps.is_empty()).then_some(Self { steps })
    }

    /// Masses of the bins. Later axes first: what is before an axis then still has its nodes, which no stride counts.
    pub(super) fn masses(&self, nodes: Vec<f64>) -> Vec<f64> {
        let mut values = nodes;
        for (index, step) in self.steps.iter().enumerate().rev() {
            // Axes after this one that have modes are bins by now.
            let stride = self.steps[index + 1..]
                .iter()
                .fold(step.stride, |stride, later| stride / later.from * later.to);
            let mut laid = vec![0.0; values.len() / step.from * step.to];
            let blocks = values.chunks_exact(step.from * stride);
            for (block, laid) in blocks.zip(laid.chunks_exact_mut(step.to * stride)) {
                for (bin, weights) in step.weights.chunks_exact(step.from).enumerate() {
                    for (node, weight) in weights.iter().enumerate() {
                        for inner in 0..stride {
                            laid[bin * stride + inner] += weight * block[node * stride + inner];
                        }
                    }
                }
            }
            values = laid;
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use crate::density::{Observable, Projection};
    use crate::space::{Axis, CellSpace};

    #[test]
    fn polynomials_are_laid_out_exactly_and_the_coarser_map_tells_what_it_lacks() {
        // p(x, z) = (1 + x z + z³/2)/4 on [-1, 1]², with x in two cells; modes of z hold degree 3.
        let x = Axis::uniform(-1.0, 1.0, 2).unwrap();
        let z = Axis::modes(-1.0, 1.0, 4).unwrap();
        let space = CellSpace::new(vec![x, z.clone()]).unwrap();
        let p = |sign: f64, z: f64| (1.0 + 0.5 * sign * z + 0.5 * z.powi(3)) / 4.0;
        let mass: Vec<f64> = [-1.0, 1.0]
            .iter()
            .flat_map(|&sign| {
                let nodes = z.nodes().iter().enumerate();
                nodes.map(move |(node, &at)| (sign, node, at))
            })
            .map(|(sign, node, at)| p(sign, at) * z.width(node))
            .collect();
        for (observable, swapped) in [
            (Observable::Joint(0, 1), false),
            (Observable::Joint(1, 0), true),
        ] {
            let [fine, coarse] = [false, true].map(|is_coarse| {
                let map = Projection::of_series(&space, observable, is_coarse).unwrap();
                map.density(&mass).unwrap()
            });
            let bins = &fine.axes[usize::from(!swapped)];
            let count = bins.count();
            let mut largest: f64 = 0.0;
            for bin in 0..count {
                // The mean of z³ over a bin.
                let (a, b) = (bins.edges()[bin], bins.edges()[bin + 1]);
                let cube = (b.powi(4) - a.powi(4)) / (4.0 * (b - a));
                for (cell, sign) in [(0, -1.0), (1, 1.0)] {
                    let at = if swapped {
                        bin * 2 + cell
                    } else {
                        cell * count + bin
                    };
                    let exact = (1.0 + 0.5 * sign * 0.5 * (a + b) + 0.5 * cube) / 4.0;
                    assert!((fine.values[at] - exact).abs() < 1e-14, "{bin} {cell}");
                    largest = largest.max((coarse.values[at] - exact).abs());
                }
            }
            // z³ = (3 P_1 + 2 P_3)/5: P_3 is left out, and P_2, which is none.
            assert!((largest - 0.5 * 0.4 / 4.0).abs() < 0.01, "{largest}");
        }
    }

    /// Weights of Gauss's rule for a normal density: those that give its polynomials their exact means.
    fn normal_weights(axis: &Axis) -> Vec<f64> {
        let count = axis.count();
        let lagrange = |node: usize| {
            let at = axis.nodes()[node];
            let others = axis.nodes().iter().filter(move |&&other| other != at);
            move |x: f64| {
                others
                    .clone()
                    .map(|other| (x - other) / (at - other))
                    .product::<f64>()
            }
        };
        (0..count)
            .map(|node| {
                let polynomial = lagrange(node);
                // Trapezoids over ten deviations are exact to rounding for a polynomial times a normal density.
                let steps = 400;
                let terms = (0..=steps).map(|step| {
                    let s = -10.0 + 20.0 * f64::from(step) / f64::from(steps);
                    polynomial(0.5 + 2.0 * s) * (-0.5 * s * s).exp()
                });
                terms.sum::<f64>() * (20.0 / f64::from(steps)) / (2.0 * std::f64::consts::PI).sqrt()
            })
            .collect()
    }

    #[test]
    fn the_normal_density_of_filtered_noise_is_exact_with_any_number_of_modes() {
        for modes in [3, 6, 11] {
            let axis = Axis::hermite(0.5, 2.0, modes).unwrap();
            let space =
                CellSpace::new(vec![Axis::uniform(0.0, 1.0, 2).unwrap(), axis.clone()]).unwrap();
            // Weights of the rule as masses: a_0 alone.
            let rule = normal_weights(&axis);
            let mass: Vec<f64> = rule
                .iter()
                .chain(&rule)
                .map(|weight| 0.5 * weight)
                .collect();
            let map = Projection::of_series(&space, Observable::Marginal(1), false).unwrap();
            let density = map.density(&mass).unwrap();
            for (bin, value) in density.values.iter().enumerate() {
                let s = 0.5 * (density.axes[0].centre(bin) - 0.5);
                let exact = (-0.5 * s * s).exp() / (2.0 * (2.0 * std::f64::consts::PI).sqrt());
                // The mean over a bin of width 0.2 deviations.
                assert!(
                    (value - exact).abs() < 4e-4,
                    "{modes} {bin}: {value} {exact}"
                );
            }
        }
    }
}
