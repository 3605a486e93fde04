//! The indicator of a peak and a valley that are born together away from a centre of symmetry.
//!
//! At their birth slope and curvature vanish at one place. Before it, the flank has a shoulder there, where its slope
//! comes nearest to zero; after it, the slope between the two has an extremum of the other sign. Followed as one
//! extremum of p', signed so that it is positive when both are there, its value passes zero linearly.

use super::window::around;
use super::{Indicator, IndicatorKind};
use crate::density::{EstimatedDensity, Variants};
use crate::topology::reconstruction::{Line, interpolating, smoothing};

/// Cells on either side of the place, in the finer and the rougher reconstruction.
const REACH: [usize; 2] = [3, 2];
/// Cells on either side when the density is sampled: noise of slopes falls with the window to the power 3/2.
const SAMPLED_SHARE: usize = 12;

/// The extremum of the slope of a marginal nearest to `near`: a maximum of p' where the density rises from valley to
/// peak, else a minimum. `None` for joint densities and when there is none away from the ends and kinks.
pub(crate) fn shoulder(estimated: &EstimatedDensity, near: f64, rising: bool) -> Option<Indicator> {
    let [axis] = estimated.density.axes.as_slice() else {
        return None;
    };
    let sign = if rising { 1.0 } else { -1.0 };
    let slope_at = |face: usize| -> Option<f64> {
        let lines = lines(estimated, axis.edges()[face], 0)?;
        Some(sign * lines[1].apply(&estimated.density.values))
    };
    let slopes: Vec<Option<f64>> = (0..=axis.count()).map(slope_at).collect();
    let is_maximum = |&face: &usize| {
        let (Some(left), Some(here), Some(right)) =
            (slopes[face - 1], slopes[face], slopes[face + 1])
        else {
            return false;
        };
        here >= left && here > right
    };
    let distance = |face: &usize| (axis.edges()[*face] - near).abs();
    let face = (1..axis.count())
        .filter(is_maximum)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    // Vertex of the parabola through three slopes (faces at unequal distances).
    let edges = axis.edges();
    let (h, k) = (edges[face] - edges[face - 1], edges[face + 1] - edges[face]);
    let (left, here, right) = (slopes[face - 1]?, slopes[face]?, slopes[face + 1]?);
    let bend = ((right - here) / k - (here - left) / h) / (0.5 * (h + k));
    let tilt = ((right - here) / k * h + (here - left) / h * k) / (h + k);
    let place = edges[face] + (-tilt / bend).clamp(-h, k);
    let (fine, rough) = (lines(estimated, place, 0)?, lines(estimated, place, 1)?);
    let of =
        |lines: &[Line], values: &[f64]| sign * lines[1].apply(values) / lines[0].apply(values);
    Indicator::derive(
        estimated,
        IndicatorKind::Shoulder { rising },
        vec![place],
        |values| of(&fine, values),
        |values| of(&rough, values),
    )
}

/// Lines for the value and slope of a marginal at a place that has no kink within their reach.
fn lines(estimated: &EstimatedDensity, at: f64, level: usize) -> Option<Vec<Line>> {
    let axis = &estimated.density.axes[0];
    let sampled = matches!(estimated.variants, Variants::Jackknife(_));
    let reach = if sampled {
        (axis.count() / SAMPLED_SHARE).max(REACH[0])
    } else {
        REACH[level]
    };
    let cells = around(axis, at, reach)?;
    let inside = |kink: f64| {
        let face = axis.face_at(kink).or(axis.find(kink)).unwrap_or(0);
        cells.start < face && face < cells.end
    };
    if estimated.structure.kinks.iter().any(|kink| inside(kink.at)) {
        return None;
    }
    if sampled {
        smoothing(axis, cells, at, 3 + level, 2)
    } else {
        interpolating(axis, cells, at, 2)
    }
}
