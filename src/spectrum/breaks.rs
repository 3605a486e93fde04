//! Observables that jump or bend inside the range along an axis without noise, as the sign of a position does.
//!
//! What is fast in such an observable is the moment at which states pass the place. In the resolvent it is a wave
//! behind that place, |y|/ω long for a speed y, which is summed over the nodes of cells with the values of the
//! observable. A sum over nodes is no integral where a factor jumps: it is off by a square of the width of a cell over
//! the length of the wave, which is all of it at high frequencies. Other values of the observable at the four nodes
//! about the place make the sum the integral for cubic polynomials (after Euler and Maclaurin).

use nalgebra::{Matrix4, Vector4};

use crate::space::{Axis, CellSpace};

/// A function of the state.
type Observable<'a> = &'a (dyn Fn(&[f64]) -> f64 + Sync);

/// A second difference of an observable over nodes from this share of the largest difference beside it on may be a
/// break; of what is smooth it is a small share.
const SHARP: f64 = 0.1;

/// How often the interval between two nodes is divided to find a place in it, and where: places that formulas name are
/// often halfway between nodes, and a bend between both parts is in neither.
const DIVISIONS: usize = 20;
const PART: f64 = 0.4871;

/// A second difference below this share of the largest difference between nodes beside it is rounding.
const ROUNDING: f64 = 1e-9;

/// Distance from a place, in intervals between nodes, at which values on either side are taken.
const ASIDE: f64 = 1e-4;

/// Values are taken at this share of that distance besides. Jump and bend of what is not smooth differ by less than the
/// other share then; of what is smooth and steep they differ by more.
const NEARER: f64 = 0.25;
const SHARPER: f64 = 0.1;

/// Shares of the largest difference between nodes beside it from which on an observable jumps, or a change of its
/// difference over a cell is a bend.
const JUMPS: f64 = 1e-3;
const BENDS: f64 = 1e-2;

/// A node nearer to a place than this, in widths of a cell, is on it.
const SAME: f64 = 1e-5;

/// Nodes on either side of a place whose values are changed.
const BESIDE: usize = 2;

/// A place on a line at which an observable is not smooth.
struct Discontinuity {
    /// Its cell coordinate.
    at: f64,
    /// Whether the observable jumps there: by how much it does, and its slope by the cell coordinate.
    jumps: bool,
    jump: f64,
    bend: f64,
    /// The observable on its upper side.
    above: f64,
}

/// An observable that jumps or bends.
#[derive(Debug, PartialEq)]
pub(super) struct Sharp {
    /// Its values in cells, for sums that stand for integrals.
    pub(super) values: Vec<f64>,
    /// Whether it jumps.
    pub(super) jumps: bool,
}

/// The values of an observable in cells, for sums that stand for integrals where it jumps or bends along one of some
/// axes; `None` where it does not.
pub(super) fn summable(
    space: &CellSpace,
    still: &[usize],
    observable: Observable<'_>,
    values: &[f64],
) -> Option<Sharp> {
    let mut sharp: Option<Sharp> = None;
    for &number in still {
        let axis = &space.axes()[number];
        if axis.count() < 2 * BESIDE {
            continue;
        }
        let stride: usize = space.shape()[number + 1..].iter().product();
        let starts = space.positions(number).enumerate();
        for (first, _) in starts.filter(|(_, position)| *position == 0) {
            let cell = |position: usize| first + position * stride;
            let line: Vec<f64> = (0..axis.count()).map(|at| values[cell(at)]).collect();
            let mut state = space.place(first);
            let mut at = |x: f64| {
                state[number] = x;
                observable(&state)
            };
            for found in breaks(axis, &line, &mut at) {
                let sharp = sharp.get_or_insert_with(|| Sharp {
                    values: values.to_vec(),
                    jumps: false,
                });
                sharp.jumps |= found.jumps;
                for (position, change) in changes(&found, &line) {
                    sharp.values[cell(position)] += change;
                }
            }
        }
    }
    sharp
}

/// The places of a line at which an observable is not smooth; its values are those at the nodes.
fn breaks(
    axis: &Axis,
    values: &[f64],
    observable: &mut impl FnMut(f64) -> f64,
) -> Vec<Discontinuity> {
    let difference = |k: usize| values[k + 1] - values[k];
    let second = |k: usize| match k > 0 && k + 1 < values.len() {
        true => difference(k) - difference(k - 1),
        false => 0.0,
    };
    let last = values.len() - 2;
    let candidates = (0..=last).filter_map(|k| {
        let beside = k.saturating_sub(1)..=(k + 1).min(last);
        let size = beside.map(|k| difference(k).abs()).fold(0.0, f64::max);
        let sharpest = second(k).abs().max(second(k + 1).abs());
        (sharpest > SHARP * size).then_some((k, size))
    });
    let candidates: Vec<(usize, f64)> = candidates.collect();
    let found = candidates.into_iter().filter_map(|(k, size)| {
        let [from, to] = [k, k + 1].map(|node| axis.nodes()[node]);
        break_between(axis, [from, to], size, observable)
    });
    let mut all: Vec<Discontinuity> = found.collect();
    // What is on a node is found from both sides.
    all.dedup_by(|next, one| next.at - one.at < SAME);
    all
}

/// The place between two nodes at which an observable jumps or bends, if it does.
fn break_between(
    axis: &Axis,
    [from, to]: [f64; 2],
    size: f64,
    observable: &mut impl FnMut(f64) -> f64,
) -> Option<Discontinuity> {
    let (mut low, mut high) = (from, to);
    for _ in 0..DIVISIONS {
        let middle = low + PART * (high - low);
        let quarters = [0.5 * (low + middle), 0.5 * (middle + high)];
        let [a, b, c, d, e] = [low, quarters[0], middle, quarters[1], high].map(&mut *observable);
        // A bend on the lower node is found from below it.
        let [lower, upper] = [a - 2.0 * b + c, c - 2.0 * d + e].map(f64::abs);
        match lower > upper + ROUNDING * size {
            true => high = middle,
            false => low = middle,
        }
    }
    let place = 0.5 * (low + high);
    let stretch = axis.stretch_at(place)?;
    let mut sides = |step: f64| {
        let [far_below, below, above, far_above] =
            [-2.0, -1.0, 1.0, 2.0].map(|steps| observable(place + steps * step));
        let upper = 2.0 * above - far_above;
        Discontinuity {
            at: axis.coordinate(place),
            jumps: false,
            jump: upper - (2.0 * below - far_below),
            bend: ((far_above - above) - (below - far_below)) / step * stretch,
            above: upper,
        }
    };
    let step = ASIDE * (to - from);
    let (found, nearer) = (sides(step), sides(NEARER * step));
    let jumps = found.jump.abs() > JUMPS * size;
    let is_break = jumps || found.bend.abs() > BENDS * size;
    if !(is_break && found.jump.is_finite() && found.bend.is_finite()) {
        return None;
    }
    let changed = (found.jump - nearer.jump).abs() + (found.bend - nearer.bend).abs();
    let is_sharp = changed <= SHARPER * (found.jump.abs() + found.bend.abs());
    Some(match is_sharp {
        true => Discontinuity { jumps, ..found },
        // What is smooth and steep is left as it is, and its sums are as doubtful as those of a jump.
        false => Discontinuity {
            jumps: true,
            jump: 0.0,
            bend: 0.0,
            above: observable(place),
            ..found
        },
    })
}

/// By how much values at nodes change for a place, with their positions; nothing too near an end.
fn changes(found: &Discontinuity, values: &[f64]) -> Vec<(usize, f64)> {
    // The node of a cell is half a cell above its lower edge.
    let first_above = (found.at - 0.5 - SAME).ceil().max(0.0) as usize;
    let Some(start) = first_above.checked_sub(BESIDE) else {
        return Vec::new();
    };
    if first_above + BESIDE > values.len() {
        return Vec::new();
    }
    let distance = first_above as f64 + 0.5 - found.at;
    let (Some(steps), Some(ramps)) = (weights(distance, 0), weights(distance, 1)) else {
        return Vec::new();
    };
    let all = (0..2 * BESIDE).map(|k| {
        let on_node = match start + k == first_above && distance < SAME {
            true => found.above - values[first_above],
            false => 0.0,
        };
        (
            start + k,
            found.jump * steps[k] + found.bend * ramps[k] + on_node,
        )
    });
    all.collect()
}

/// What four nodes, two on either side of a place, count more in sums of a cubic polynomial times a step there (or a
/// ramp, of degree one); the first one above is so many cells from it. Sums of (j + d)^m over all j from zero on stand
/// for -B_{m+1}(d)/(m+1) more than the integral does, with Bernoulli's polynomials.
fn weights(distance: f64, degree: usize) -> Option<Vector4<f64>> {
    let place = |k: usize| distance + k as f64 - BESIDE as f64;
    let matrix = Matrix4::from_fn(|power, k| place(k).powi(power as i32));
    let right = Vector4::from_fn(|power, _| {
        let order = power + degree + 1;
        bernoulli(order, distance) / order as f64
    });
    matrix.lu().solve(&right)
}

/// Bernoulli's polynomials of degree one to five.
fn bernoulli(degree: usize, x: f64) -> f64 {
    match degree {
        1 => x - 0.5,
        2 => x * (x - 1.0) + 1.0 / 6.0,
        3 => x * (x - 0.5) * (x - 1.0),
        4 => (x * (x - 1.0)).powi(2) - 1.0 / 30.0,
        _ => x * (x - 0.5) * (x - 1.0) * (x * (x - 1.0) - 1.0 / 3.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_a_step_and_a_ramp_times_a_polynomial_are_its_integrals() {
        let axis = Axis::uniform(-2.0, 2.0, 16).unwrap();
        let space = CellSpace::new(vec![axis.clone()]).unwrap();
        for place in [0.0, 0.1, -0.125, 0.625, 0.3437] {
            let step = |state: &[f64]| f64::from(u8::from(state[0] > place));
            let ramp = |state: &[f64]| (state[0] - place).max(0.0);
            let both: [Observable<'_>; 2] = [&step, &ramp];
            for observable in both {
                let at = |cell| observable(&space.place(cell));
                let values: Vec<f64> = (0..16).map(at).collect();
                let found = summable(&space, &[0], observable, &values).unwrap();
                let smooth = |x: f64| (4.0 - x * x).powi(4) * (1.0 + 0.3 * x);
                let sum = |values: &[f64]| -> f64 {
                    let products = values.iter().zip(axis.nodes());
                    products.map(|(value, &x)| 0.25 * value * smooth(x)).sum()
                };
                let fine = (0..400_000).map(|k| (f64::from(k) + 0.5) * 1e-5 - 2.0);
                let exact: f64 = fine.map(|x| 1e-5 * observable(&[x]) * smooth(x)).sum();
                let (own, off) = (sum(&values) - exact, sum(&found.values) - exact);
                assert!(off.abs() < 2e-3 * exact, "{place}: {own} {off} {exact}");
            }
        }
    }

    #[test]
    fn what_is_smooth_stays_as_it_is() {
        let axis = Axis::uniform(-3.0, 3.0, 20).unwrap();
        let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
        let smooth = |state: &[f64]| (2.0 * state[0]).sin() + state[0] * state[0] * state[1];
        let values: Vec<f64> = (0..400).map(|cell| smooth(&space.place(cell))).collect();
        assert_eq!(summable(&space, &[0, 1], &smooth, &values), None);
    }

    #[test]
    fn a_steep_smooth_step_is_left_as_it_is_and_in_doubt() {
        for (from, width) in [(-2.0, 0.25), (-2.03, 0.25), (-2.07, 0.25)] {
            let axis = Axis::uniform(from, from + 4.0, 16).unwrap();
            let space = CellSpace::new(vec![axis]).unwrap();
            for share in [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1] {
                let step = |state: &[f64]| (state[0] / (share * width)).tanh();
                let values: Vec<f64> = (0..16).map(|cell| step(&space.place(cell))).collect();
                let Some(found) = summable(&space, &[0], &step, &values) else {
                    continue;
                };
                assert!(found.jumps, "{from}, {share}");
                for (own, before) in found.values.iter().zip(&values) {
                    assert!(
                        (own - before).abs() <= 1.0,
                        "{from}, {share}: {own} of {before}"
                    );
                }
            }
        }
    }
}
