//! Where the cells of an axis are cut: at places where drift or noise are not smooth, and closer and closer toward an
//! end at which the noise dies.

use super::rule::look;
use crate::space::Axis;
use crate::system::{LANES, System};

/// Halvings of a cell toward a natural end.
const HALVINGS: usize = 40;
/// Share of an end's coordinate below which distances to it have lost their digits.
const LOST: f64 = 1e-7;
/// Rise of the logarithm of the density from half a distance to a natural end to that distance, about, from which on
/// nothing is nearer.
const STEEPEST: f64 = 1e4;

/// The places at which the cell next to a natural end is cut, by their distance from it, the nearest first: what is
/// nearer is a power of the distance, or nothing where the density falls faster than any.
fn toward(system: &dyn System, (end, exponent): (f64, f64), cut: f64) -> Vec<f64> {
    let width = (cut - end).abs();
    let distances = (1..=HALVINGS).rev();
    let distances = distances.map(|halvings| (halvings, width * 0.5_f64.powi(halvings as i32)));
    // The first halving stands whatever its digits, so that no cell loses all its cuts.
    let distances = distances
        .filter(|(halvings, distance)| *halvings == 1 || *distance > LOST * end.abs())
        .map(|(_, distance)| distance);
    let mut distances: Vec<f64> = distances.collect();
    if exponent == f64::INFINITY {
        let is_empty = |distance: &&f64| {
            let inward = (cut - end).signum();
            let (drift, intensity) = look(system, &[end + inward * **distance; LANES]);
            2.0 * inward * drift[0] / intensity[0] * **distance > STEEPEST
        };
        let empty = distances.iter().take_while(is_empty).count();
        // The farthest of them is where what there is begins.
        distances.drain(..empty.saturating_sub(1));
    }
    distances
}

/// [`cuts`], and those toward natural ends, of which the exponents are given; the cell's part next to such an end is
/// left out.
pub(super) fn cuts_toward(
    system: &dyn System,
    axis: &Axis,
    cell: usize,
    surfaces: &[f64],
    ends: [Option<f64>; 2],
) -> Vec<f64> {
    let mut cuts = cuts(axis, cell, surfaces);
    if let (Some(exponent), 0) = (ends[0], cell) {
        let more = toward(system, (cuts[0], exponent), cuts[1])
            .into_iter()
            .map(|distance| axis.from() + distance);
        cuts.splice(0..1, more);
    }
    if let (Some(exponent), true) = (ends[1], cell + 1 == axis.count()) {
        let last = cuts.len() - 1;
        let more = toward(system, (cuts[last], exponent), cuts[last - 1]);
        let more = more.into_iter().rev();
        cuts.splice(last.., more.map(|distance| axis.to() - distance));
    }
    cuts
}

/// Where drift or noise are not smooth, ascending.
pub(in crate::generator) fn surfaces(system: &dyn System) -> Vec<f64> {
    let mut surfaces: Vec<f64> = system.facts().surfaces_on(0).collect();
    surfaces.sort_by(f64::total_cmp);
    surfaces
}

/// Coordinates at which a cell is cut: its edges, and where the drift is not smooth.
fn cuts(axis: &Axis, cell: usize, surfaces: &[f64]) -> Vec<f64> {
    let (from, to) = (axis.edges()[cell], axis.edges()[cell + 1]);
    let mut cuts = vec![from];
    for &at in surfaces.iter().filter(|&&at| from < at && at < to) {
        let known = cuts[cuts.len() - 1];
        let is_same = |other: f64| axis.is_same_place(at, other);
        cuts.extend((!is_same(known) && !is_same(to)).then_some(at));
    }
    cuts.push(to);
    cuts
}
