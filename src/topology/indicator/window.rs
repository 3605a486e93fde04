//! Which cells around a point the reconstruction takes in.
//!
//! A density without noise is reconstructed from the eight cells (seven, where the point lies inside one) about the
//! point, with an order that its smoothness allows; six (five) give its error. A sampled one is smoothed over
//! the stretch on which it changes by a share of its largest value: wide enough to average noise, narrow enough for a
//! polynomial of degree four.

use std::ops::Range;

use crate::density::{EstimatedDensity, Variants};
use crate::space::Axis;
use crate::topology::reconstruction::{Line, interpolating, smoothing};

/// Cells on either side of a point, in the finer and the rougher reconstruction.
const REACH: [usize; 2] = [4, 3];
/// The same on one side of a kink.
const BESIDE: [usize; 2] = [4, 3];
/// Degree of the smoothing polynomials, and the higher one that shows what the lower misses.
const DEGREE: [usize; 2] = [4, 6];
/// The same on one side of a kink.
const DEGREE_BESIDE: [usize; 2] = [2, 3];
/// Change of a sampled density, as a share of its maximum, over half a window.
const CHANGE: f64 = 0.35;
/// Least cells on either side of a smoothing window.
const LEAST: usize = 4;
/// Largest share of an axis on either side of a smoothing window.
const LARGEST_SHARE: usize = 3;
/// Cells of the other axis (one over this share of it on either side) over which a profile is averaged.
const PROFILE: usize = 16;

/// Lines for the value and derivatives at a point, by the better and by a rougher reconstruction.
pub(super) struct Lines {
    pub(super) fine: Vec<Line>,
    pub(super) rough: Vec<Line>,
}

impl Lines {
    /// Both, for one function of them.
    pub(super) fn both(&self) -> [&[Line]; 2] {
        [&self.fine, &self.rough]
    }
}

/// Lines for p, p', p'' along axis `k` at `at`, no kink near.
pub(super) fn about(estimated: &EstimatedDensity, k: usize, at: f64) -> Option<Lines> {
    let axis = &estimated.density.axes[k];
    if matches!(estimated.variants, Variants::Jackknife(_)) {
        let cells = smoothing_window(estimated, k, at)?;
        let line = |degree| smoothing(axis, cells.clone(), at, degree, 3);
        return Some(Lines {
            fine: line(DEGREE[0])?,
            rough: line(DEGREE[1])?,
        });
    }
    let line = |reach: usize| interpolating(axis, around(axis, at, reach)?, at, 3);
    Some(Lines {
        fine: line(REACH[0])?,
        rough: line(REACH[1])?,
    })
}

/// Lines for the value of the density on a plane where its derivative jumps: the mean of both sides.
pub(super) fn on_kink(estimated: &EstimatedDensity, k: usize, at: f64) -> Option<Lines> {
    let axis = &estimated.density.axes[k];
    let face = face_at(axis, at)?;
    let sides = |below: Range<usize>,
                 above: Range<usize>,
                 line: &dyn Fn(Range<usize>) -> Option<Vec<Line>>| {
        let (below, above) = (line(below)?, line(above)?);
        Some(vec![below.first()?.mean(above.first()?)])
    };
    if matches!(estimated.variants, Variants::Jackknife(_)) {
        let window = smoothing_window(estimated, k, at)?;
        let line = |degree: usize| {
            let fit = |cells: Range<usize>| smoothing(axis, cells, at, degree, 1);
            sides(window.start..face, face..window.end, &fit)
        };
        return Some(Lines {
            fine: line(DEGREE_BESIDE[0])?,
            rough: line(DEGREE_BESIDE[1])?,
        });
    }
    let line = |reach: usize| {
        let fit = |cells: Range<usize>| interpolating(axis, cells, at, 1);
        sides(face.checked_sub(reach)?..face, face..face + reach, &fit)
    };
    Some(Lines {
        fine: line(BESIDE[0])?,
        rough: line(BESIDE[1])?,
    })
}

/// `reach` cells on either side of a face, or one less beside the cell that holds the point.
pub(super) fn around(axis: &Axis, at: f64, reach: usize) -> Option<Range<usize>> {
    let cells = match face_at(axis, at) {
        Some(face) => face.checked_sub(reach)?..face + reach,
        None => {
            let cell = axis.find(at)?;
            cell.checked_sub(reach - 1)?..cell + reach
        }
    };
    (cells.end <= axis.count()).then_some(cells)
}

/// The edge that lies at `at`, to a millionth of a cell.
pub(super) fn face_at(axis: &Axis, at: f64) -> Option<usize> {
    let cell = axis.find(at)?;
    let near = |edge: usize| (axis.edges()[edge] - at).abs() <= 1e-6 * axis.width(cell);
    [cell, cell + 1].into_iter().find(|&edge| near(edge))
}

/// Cells over which a sampled density is smoothed about a point, equally many on both sides of it.
fn smoothing_window(estimated: &EstimatedDensity, k: usize, at: f64) -> Option<Range<usize>> {
    let axis = &estimated.density.axes[k];
    let profile = profile(estimated, k);
    let middle = face_at(axis, at);
    let (below, above) = match middle {
        Some(face) => (face, face),
        None => (axis.find(at)?, axis.find(at)? + 1),
    };
    let largest = profile.iter().copied().fold(0.0, f64::max);
    let most = below
        .min(axis.count() - above)
        .min(axis.count() / LARGEST_SHARE);
    let pair = |reach: usize| 0.5 * (profile[below - reach] + profile[above + reach - 1]);
    if most < LEAST {
        return None;
    }
    let centre = (1..=LEAST).map(pair).sum::<f64>() / LEAST as f64;
    let stays = |&reach: &usize| (pair(reach) - centre).abs() <= CHANGE * largest;
    let reach = (1..=most).take_while(stays).last().unwrap_or(0).max(LEAST);
    Some(below - reach..above + reach)
}

/// A marginal's values; of a joint density those along axis `k`, averaged over the middle cells of the other axis.
fn profile(estimated: &EstimatedDensity, k: usize) -> Vec<f64> {
    let values = &estimated.density.values;
    let [first, second] = estimated.density.axes.as_slice() else {
        return values.clone();
    };
    let other = if k == 0 { second } else { first };
    let middle = match &estimated.structure.centre {
        Some(centre) => other.find(centre[1 - k]).unwrap_or(other.count() / 2),
        None => other.count() / 2,
    };
    let spread = (other.count() / PROFILE).max(1);
    let band = middle.saturating_sub(spread)..(middle + spread).min(other.count());
    let columns = second.count();
    let count = if k == 0 { first.count() } else { columns };
    let value = |cell: usize, across: usize| match k {
        0 => values[cell * columns + across],
        _ => values[across * columns + cell],
    };
    (0..count)
        .map(|cell| band.clone().map(|across| value(cell, across)).sum::<f64>() / band.len() as f64)
        .collect()
}
