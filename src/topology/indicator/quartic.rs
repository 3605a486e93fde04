//! The fourth derivative at a centre of symmetry, which tells where two peaks are born when one splits: at the centre,
//! or away from it.
//!
//! Where the curvature along a direction vanishes, the density along it is p(0) + p'''' s⁴/24 + …, odd terms being none
//! by symmetry. With p'''' < 0 peaks leave the centre as it splits; with p'''' > 0 they stand away from it already, and
//! were born in folds before. Between lies a point of codimension two in the plane of two parameters.

use super::kind::Traits;
use super::window::{self, Lines};
use super::{Indicator, IndicatorKind};
use crate::density::{EstimatedDensity, Variants};
use crate::topology::reconstruction::Weights;

/// Lines for the value and four derivatives.
const ORDERS: usize = 5;
/// 4 over k.
const BINOMIAL: [f64; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];

impl IndicatorKind {
    /// A test function: p''''/p at the centre, along the flattest direction of a joint density; negative where peaks
    /// are born at the centre as it splits, positive where they are born away from it.
    pub(crate) const QUARTIC: Self = Self(&QUARTIC);
}

const QUARTIC: Traits = Traits {
    is_bifurcation: false,
    is_at_centre: true,
    ..Traits::new("fourth derivative at the centre", |density, _| {
        quartic(density)
    })
};

/// p''''/p at the centre of a marginal; of a joint density along the direction in which its curvature is nearest to
/// zero, axes scaled to their ranges. `None` without a centre, on a kink, and for sampled densities, whose noise it
/// drowns in.
fn quartic(estimated: &EstimatedDensity) -> Option<Indicator> {
    let centre = estimated.structure.centre.as_ref()?;
    let axes = &estimated.density.axes;
    let on_kink = estimated.structure.kinks.iter().any(|kink| {
        let place = axes.get(kink.axis).zip(centre.get(kink.axis));
        place.is_some_and(|(axis, &at)| axis.is_same_place(at, kink.at))
    });
    if on_kink || matches!(estimated.variants, Variants::Jackknife(_)) {
        return None;
    }
    let lines = |k: usize| window::derivatives(estimated, k, centre[k], ORDERS);
    let kind = IndicatorKind::QUARTIC;
    if let [_] = centre.as_slice() {
        let lines = lines(0)?;
        let of =
            |lines: &[Weights], values: &[f64]| lines[4].apply(values) / lines[0].apply(values);
        let [fine, rough] = lines.both();
        let (fine, rough) = (
            |values: &[f64]| of(fine, values),
            |values: &[f64]| of(rough, values),
        );
        return Indicator::derive(estimated, kind, centre.clone(), fine, rough);
    }
    let [first, second] = axes.as_slice() else {
        return None;
    };
    let joint = Joint {
        lines: [lines(0)?, lines(1)?],
        units: [first, second].map(|axis| axis.to() - axis.from()),
        columns: second.count(),
    };
    let direction = joint.flattest(&estimated.density.values);
    let fine = |values: &[f64]| joint.along(direction, values, 0);
    let rough = |values: &[f64]| joint.along(direction, values, 1);
    Indicator::derive(estimated, kind, centre.clone(), fine, rough)
}

/// Derivatives of a joint density at its centre.
struct Joint {
    lines: [Lines; 2],
    units: [f64; 2],
    columns: usize,
}

impl Joint {
    /// A mixed derivative in units of the ranges; level 1 is the rougher one.
    fn derivative(&self, [i, j]: [usize; 2], values: &[f64], level: usize) -> f64 {
        let [rows, lines] = self.lines.each_ref().map(|lines| lines.both()[level]);
        let scale = self.units[0].powi(i as i32) * self.units[1].powi(j as i32);
        scale * rows[i].apply_with(&lines[j], self.columns, values)
    }

    /// The direction of the eigenvalue of the Hessian that is nearest to zero.
    fn flattest(&self, values: &[f64]) -> [f64; 2] {
        let [xx, xy, yy] = [[2, 0], [1, 1], [0, 2]].map(|order| self.derivative(order, values, 0));
        let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        let eigenvalue = if mean > 0.0 { mean - half } else { mean + half };
        // The longer of two vectors across the rows of the matrix without its eigenvalue.
        let both = [[xy, eigenvalue - xx], [eigenvalue - yy, xy]];
        let lengths = both.map(|[x, y]| x.hypot(y));
        let longer = usize::from(lengths[1] > lengths[0]);
        if lengths[longer] > 0.0 {
            both[longer].map(|part| part / lengths[longer])
        } else {
            [1.0, 0.0]
        }
    }

    fn along(&self, [x, y]: [f64; 2], values: &[f64], level: usize) -> f64 {
        let terms = (0..ORDERS).map(|j| {
            let i = ORDERS - 1 - j;
            let share = BINOMIAL[j] * x.powi(i as i32) * y.powi(j as i32);
            share * self.derivative([i, j], values, level)
        });
        terms.sum::<f64>() / self.derivative([0, 0], values, level)
    }
}
