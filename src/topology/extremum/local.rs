//! The polynomial through the averages over the cells about a place.

use std::ops::Range;

use super::{LEAST, LOOKS, sign};
use crate::numerics::narrowed;
use crate::space::Axis;
use crate::topology::FeatureKind;
use crate::topology::reconstruction::{Weights, interpolating};

/// The polynomial through the averages over some cells.
pub(super) struct Local {
    /// Where it is expanded.
    origin: f64,
    /// Derivatives there over their factorials.
    coefficients: Vec<f64>,
    /// Width of the smallest cell.
    smallest: f64,
}

impl Local {
    /// The polynomial over `count` cells from `first` on, moved to lie in a smooth range; fewer where the range has
    /// fewer.
    pub(super) fn about(
        axis: &Axis,
        values: &[f64],
        smooth: &Range<usize>,
        (first, count): (usize, usize),
    ) -> Option<Self> {
        let count = count.min(smooth.len());
        if count < LEAST {
            return None;
        }
        let first = first.clamp(smooth.start, smooth.end - count);
        let cells = first..first + count;
        let widths = cells.clone().map(|cell| axis.width(cell));
        let origin = 0.5 * (axis.edges()[cells.start] + axis.edges()[cells.end]);
        let lines = interpolating(axis, cells, origin, count)?;
        let mut factorial = 1.0;
        let coefficient = |(order, line): (usize, &Weights)| {
            factorial *= order.max(1) as f64;
            line.apply(values) / factorial
        };
        Some(Self {
            origin,
            coefficients: lines.iter().enumerate().map(coefficient).collect(),
            smallest: widths.fold(f64::INFINITY, f64::min),
        })
    }

    pub(super) fn value(&self, at: f64) -> f64 {
        let u = at - self.origin;
        let coefficients = self.coefficients.iter().rev();
        coefficients.fold(0.0, |sum, coefficient| sum * u + coefficient)
    }

    pub(super) fn slope(&self, at: f64) -> f64 {
        let u = at - self.origin;
        let coefficients = self.coefficients.iter().enumerate().skip(1).rev();
        coefficients.fold(0.0, |sum, (order, coefficient)| {
            sum * u + order as f64 * coefficient
        })
    }

    /// Places in a range where the slope changes its sign as at a feature of that kind.
    pub(super) fn extrema(&self, (from, to): (f64, f64), kind: FeatureKind) -> Vec<f64> {
        let sign = sign(kind);
        let slope = |at: f64| sign * self.slope(at);
        let looks = (((to - from) / self.smallest).ceil() as usize).clamp(1, 8) * LOOKS;
        let look = |index: usize| from + (to - from) * index as f64 / looks as f64;
        let crossing = |index: usize| {
            let ends = (look(index), look(index + 1));
            // Halving ends at neighbouring numbers long before.
            (slope(ends.0) > 0.0 && slope(ends.1) <= 0.0)
                .then(|| narrowed(ends, 2000, |at| slope(at) > 0.0).1)
        };
        (0..looks).filter_map(crossing).collect()
    }
}
