//! Place and height of a peak or valley of a marginal without noise, to a high order.
//!
//! The polynomial through the averages over the seven cells about the feature, or over the eight about the face that it
//! is nearest to, is smooth enough to show two peaks inside a cell: a pair is followed down to its birth by one and the
//! same reading. On a smooth density the place is off by O(h⁶). A kink is never reconstructed across: the polynomials
//! are those of either side, and an extremum of both is the kink itself.

mod local;

use std::ops::Range;

use super::FeatureKind;
use super::field::sides;
use crate::density::EstimatedDensity;
use crate::space::Axis;
use local::Local;

/// Cells on either side of a face that the polynomial goes through; about the middle of a cell one less in all.
const REACH: usize = 4;
/// Fewer cells than these say no more than a parabola.
const LEAST: usize = 5;
/// A feature within this share of a cell from a face has the face in the middle of its cells, so that what is symmetric
/// about a face stays so.
const NEAR_FACE: f64 = 0.25;
/// Places at which the slope is looked at, in each cell.
const LOOKS: usize = 8;

/// Where an extremum is, refined between cells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Vertex {
    /// One coordinate an axis.
    pub(super) position: Vec<f64>,
    /// Density there.
    pub(super) density: f64,
}

/// The peak or valley of a marginal that is nearest to `guess`, not farther than in the cells beside the feature's.
/// `None` for noisy densities, where the reconstruction is not trusted, and where there is none.
pub(super) fn extremum(
    estimated: &EstimatedDensity,
    cell: usize,
    guess: f64,
    kind: FeatureKind,
) -> Option<Vertex> {
    let axis = without_noise(estimated)?;
    let kinks = kinks(estimated, axis);
    // Of a cell that a jump cuts, the side of the guess.
    let is_cut = kinks
        .iter()
        .any(|kink| kink.below == cell && kink.above > cell);
    let about = if is_cut { guess } else { axis.centre(cell) };
    let values = &estimated.density.values;
    let edges = axis.edges();
    let near = (
        edges[cell.saturating_sub(1)],
        edges[(cell + 2).min(axis.count())],
    );
    let found = |about: f64| -> Vec<(f64, f64)> {
        let smooth = Smooth::about(axis, &kinks, about);
        let near = (near.0.max(smooth.ends.0), near.1.min(smooth.ends.1));
        let window = window(axis, cell, guess);
        let Some(local) = Local::about(axis, values, &smooth.cells, window) else {
            return Vec::new();
        };
        let places = local.extrema(near, kind).into_iter();
        places.map(|at| (at, local.value(at))).collect()
    };
    // Beyond a bend the density goes on.
    let bends = kinks
        .iter()
        .filter(|kink| kink.is_bend && near.0 < kink.at && kink.at < near.1);
    let beyond = bends.flat_map(|kink| found(if about < kink.at { kink.at } else { near.0 }));
    let mut places = found(about);
    places.extend(beyond);
    let place = places
        .into_iter()
        .min_by(|a, b| (a.0 - guess).abs().total_cmp(&(b.0 - guess).abs()))
        .or_else(|| at_kink(axis, values, &kinks, cell, kind))?;
    // A polynomial that misses the cell it is about does not describe the density.
    let above = sign(kind) * (place.1 - values[cell]);
    (above >= -1e-9 * values[cell].abs()).then(|| Vertex {
        position: vec![place.0],
        density: place.1,
    })
}

/// A marginal without noise at a place; at a kink the mean of both sides. `None` for other densities.
pub(super) fn density_at(estimated: &EstimatedDensity, at: f64) -> Option<f64> {
    let axis = without_noise(estimated)?;
    let (values, kinks) = (&estimated.density.values, kinks(estimated, axis));
    let cell = axis.find(at)?;
    match kinks.iter().find(|kink| axis.is_same_place(at, kink.at)) {
        Some(kink) => {
            let (below, above) = beside(axis, values, &kinks, kink)?;
            Some(0.5 * (below.value(at) + above.value(at)))
        }
        None => {
            let smooth = Smooth::about(axis, &kinks, at);
            let local = Local::about(axis, values, &smooth.cells, window(axis, cell, at))?;
            Some(local.value(at))
        }
    }
}

/// The axis of a marginal whose neighbouring cells do not err independently of each other.
fn without_noise(estimated: &EstimatedDensity) -> Option<&Axis> {
    match estimated.density.axes.as_slice() {
        [axis] if !estimated.is_noisy() => Some(axis),
        _ => None,
    }
}

/// A place where the derivative of a marginal jumps or bends.
struct SlopeBreak {
    at: f64,
    /// Where the cells wholly below it end, and where those wholly above it begin.
    below: usize,
    above: usize,
    is_bend: bool,
}

fn kinks(estimated: &EstimatedDensity, axis: &Axis) -> Vec<SlopeBreak> {
    let kinks = estimated.structure.kinks.iter();
    let found = kinks.filter_map(|kink| {
        let (below, above) = sides(axis, kink.at)?;
        Some(SlopeBreak {
            at: kink.at,
            below,
            above,
            is_bend: kink.is_bend(),
        })
    });
    found.collect()
}

/// Where a marginal is smooth.
struct Smooth {
    /// The cells wholly in it.
    cells: Range<usize>,
    ends: (f64, f64),
}

impl Smooth {
    /// From one kink to the next about a place; what is on a kink counts with the side above.
    fn about(axis: &Axis, kinks: &[SlopeBreak], at: f64) -> Self {
        let mut smooth = Self {
            cells: 0..axis.count(),
            ends: (axis.from(), axis.to()),
        };
        for kink in kinks {
            if at >= kink.at {
                smooth.cells.start = smooth.cells.start.max(kink.above);
                smooth.ends.0 = smooth.ends.0.max(kink.at);
            } else {
                smooth.cells.end = smooth.cells.end.min(kink.below);
                smooth.ends.1 = smooth.ends.1.min(kink.at);
            }
        }
        smooth
    }
}

/// The cells about a place: first, and how many.
fn window(axis: &Axis, cell: usize, guess: f64) -> (usize, usize) {
    let near = |face: usize| (axis.edges()[face] - guess).abs() <= NEAR_FACE * axis.width(cell);
    match [cell, cell + 1].into_iter().find(|&face| near(face)) {
        Some(face) => (face.saturating_sub(REACH), 2 * REACH),
        None => (cell.saturating_sub(REACH - 1), 2 * REACH - 1),
    }
}

/// A kink in or beside the cell at which the density turns: it rises toward a peak on both sides, and falls toward a
/// valley.
fn at_kink(
    axis: &Axis,
    values: &[f64],
    kinks: &[SlopeBreak],
    cell: usize,
    kind: FeatureKind,
) -> Option<(f64, f64)> {
    let is_near = |kink: &&SlopeBreak| kink.below <= cell + 1 && kink.above >= cell;
    let kink = kinks.iter().find(is_near)?;
    let (below, above) = beside(axis, values, kinks, kink)?;
    let sign = sign(kind);
    let turns = sign * below.slope(kink.at) >= 0.0 && sign * above.slope(kink.at) <= 0.0;
    turns.then(|| {
        let height = 0.5 * (below.value(kink.at) + above.value(kink.at));
        (kink.at, height)
    })
}

/// 1 for what is highest, -1 for what is lowest.
fn sign(kind: FeatureKind) -> f64 {
    match kind {
        FeatureKind::Peak | FeatureKind::Ring => 1.0,
        FeatureKind::Valley | FeatureKind::Crater => -1.0,
    }
}

/// The polynomials on both sides of a kink.
fn beside(
    axis: &Axis,
    values: &[f64],
    kinks: &[SlopeBreak],
    kink: &SlopeBreak,
) -> Option<(Local, Local)> {
    let count = 2 * REACH - 1;
    let side = |cell: usize, first: usize| {
        let smooth =
            (cell < axis.count()).then(|| Smooth::about(axis, kinks, axis.centre(cell)))?;
        Local::about(axis, values, &smooth.cells, (first, count))
    };
    let below = side(kink.below.checked_sub(1)?, kink.below.saturating_sub(count))?;
    Some((below, side(kink.above, kink.above)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::{Kink, Variants};
    use crate::space::Grading;
    use crate::topology::analytic_tests::averages;

    /// The peak about the cell that holds `near`.
    fn peak(estimated: &EstimatedDensity, near: f64) -> Option<Vertex> {
        let cell = estimated.density.axes[0].find(near).unwrap();
        extremum(estimated, cell, near, FeatureKind::Peak)
    }

    #[test]
    fn place_and_height_converge_with_order_six() {
        // p = cos(2u) + 0.3 u³ with u = x - 0.21: peak at 0.21, height 1, no symmetry there.
        let primitive = |x: f64| {
            let u = x - 0.21;
            0.5 * (2.0 * u).sin() + 0.075 * u.powi(4)
        };
        let errors = |count: usize| {
            let grading = Grading {
                at: vec![0.0],
                smallest: 1.0 / count as f64,
            };
            let axis = Axis::graded(-1.0, 1.0, count, &grading).unwrap();
            let place = peak(&averages(&axis, primitive), 0.21).unwrap();
            (
                (place.position[0] - 0.21).abs(),
                (place.density - 1.0).abs(),
            )
        };
        let (coarse, fine) = (errors(12), errors(24));
        assert!(coarse.0 < 1e-5 && coarse.1 < 1e-6, "{coarse:?}");
        assert!(fine.0 < coarse.0 / 40.0 + 1e-12, "{coarse:?} {fine:?}");
        assert!(fine.1 < coarse.1 / 40.0 + 1e-12, "{coarse:?} {fine:?}");
    }

    #[test]
    fn kinks_are_not_reconstructed_across() {
        // Rises with slope 1 up to a kink at 0.2, then falls as a parabola: the kink is the peak; without it 0.1 is
        // off.
        let primitive = |x: f64| match x < 0.2 {
            true => 0.5 * (x - 0.2).powi(2) + 2.0 * (x - 0.2),
            false => 2.0 * (x - 0.2) - (x - 0.2).powi(3) - 0.25 * (x - 0.2).powi(2),
        };
        let grading = Grading {
            at: vec![0.2],
            smallest: 0.05,
        };
        let axis = Axis::graded(-1.0, 1.0, 30, &grading).unwrap();
        let mut estimated = averages(&axis, primitive);
        estimated.structure.kinks = vec![Kink {
            axis: 0,
            at: 0.2,
            jump: vec![-1.5],
        }];
        for near in [0.199, 0.201] {
            let place = peak(&estimated, near).unwrap();
            assert_eq!(place.position, [0.2]);
            assert!((place.density - 2.0).abs() < 1e-12, "{place:?}");
        }
        assert!((density_at(&estimated, 0.2).unwrap() - 2.0).abs() < 1e-12);
        // The valley's side has no peak.
        assert_eq!(peak(&estimated, -0.5), None);
    }

    #[test]
    fn noisy_joint_and_coarse_densities_are_left_to_the_parabola() {
        let axis = Axis::uniform(-1.0, 1.0, 20).unwrap();
        let mut estimated = averages(&axis, |x| x - x.powi(3) / 3.0);
        assert!(peak(&estimated, 0.01).unwrap().position[0].abs() < 1e-12);
        estimated.standard_error[3] = 1e-3;
        estimated.variants = Variants::Scheme(estimated.density.values.clone());
        assert!(peak(&estimated, 0.01).is_some());
        estimated.variants = Variants::None;
        assert_eq!(peak(&estimated, 0.01), None);
        assert_eq!(density_at(&estimated, 0.0), None);
        let coarse = averages(&Axis::uniform(-1.0, 1.0, 4).unwrap(), |x| {
            x - x.powi(3) / 3.0
        });
        assert_eq!(peak(&coarse, 0.01), None);
    }
}
