//! The current of processes on their way from one region to another, at the nodes of a grid.
//!
//! With f the unknowns of those that were in the first region last, φ = f/V their density and q the probability to come
//! to the second region next, the current along an axis with drift b and noise intensity s = Σ σ² is
//! q (b φ - ∂(s φ)/2) + s φ ∂q/2 (E and Vanden-Eijnden, Annu. Rev. Phys. Chem. 61, 391 (2010)).

use crate::generator::lagrange_slopes;
use crate::space::CellSpace;
use crate::system::System;

/// Nodes through which a polynomial has its slope.
const NODES: usize = 5;

/// Drift and noise at the nodes of a grid, of which some cells are kept.
pub(super) struct Flow<'a> {
    space: &'a CellSpace,
    kept: &'a [bool],
    /// Per axis, drift and noise intensity a node; no intensities where no noise is on the axis.
    axes: Vec<(Vec<f64>, Option<Vec<f64>>)>,
}

impl<'a> Flow<'a> {
    pub(super) fn new(system: &dyn System, space: &'a CellSpace, kept: &'a [bool]) -> Self {
        let of_axis = |axis: usize| {
            let is_noisy = system.is_noisy(axis);
            let mut both = (vec![0.0; kept.len()], vec![0.0; kept.len()]);
            for cell in (0..kept.len()).filter(|&cell| kept[cell]) {
                let state = space.node(cell);
                both.0[cell] = system.drift_at(0.0, &state)[axis];
                both.1[cell] = system.intensity_at(axis, 0.0, &state);
            }
            (both.0, is_noisy.then_some(both.1))
        };
        let axes = (0..space.dimension()).map(of_axis).collect();
        Self { space, kept, axes }
    }

    /// The current along an axis of a density φ with probabilities q, both a number a node. It is linear in each.
    pub(super) fn current(&self, axis: usize, density: &[f64], committor: &[f64]) -> Vec<f64> {
        let (drift, intensity) = &self.axes[axis];
        let carried = drift.iter().zip(density).zip(committor);
        let mut current: Vec<f64> = carried.map(|((b, p), q)| b * p * q).collect();
        if let Some(intensity) = intensity {
            let spread: Vec<f64> = intensity.iter().zip(density).map(|(s, p)| s * p).collect();
            let slopes = [&spread, committor].map(|field| self.slopes(axis, field));
            for (cell, flux) in current.iter_mut().enumerate() {
                *flux += 0.5 * (spread[cell] * slopes[1][cell] - committor[cell] * slopes[0][cell]);
            }
        }
        current
    }

    /// The slope of a field along an axis at the kept nodes, by the polynomial through the nearest of its stretch.
    fn slopes(&self, index: usize, field: &[f64]) -> Vec<f64> {
        let axis = &self.space.axes()[index];
        let (count, nodes) = (axis.count(), axis.nodes());
        let stride: usize = self.space.shape()[index + 1..].iter().product();
        let mut slopes = vec![0.0; field.len()];
        for line in 0..field.len() / count {
            let first = line / stride * stride * count + line % stride;
            let at = |position: usize| first + position * stride;
            let mut from = 0;
            while from < count {
                let to = (from..count).find(|&position| !self.kept[at(position)]);
                let to = to.unwrap_or(count);
                for position in from..to {
                    let used = NODES.min(to - from);
                    let low = position.saturating_sub(used / 2).clamp(from, to - used);
                    let weights = lagrange_slopes(&nodes[low..low + used], position - low);
                    let terms = weights.iter().enumerate();
                    slopes[at(position)] = terms.map(|(k, w)| w * field[at(low + k)]).sum();
                }
                from = to.max(from) + 1;
            }
        }
        slopes
    }
}
