//! Rates between two states from the slowest mode.
//!
//! Where two states exchange probability much more slowly than each settles, the slowest mode is that exchange: its
//! decay rate λ is the sum of the rates there and back, and its left vector is flat in each state, at l_A and l_B.
//! With Σ l p = 0 the shares of the states are π_A = -l_B/(l_A - l_B) and π_B = 1 - π_A; the rate from A to B is λ
//! π_B. No border between the states has a part in that, and paths that come to one and turn round at once count for
//! nothing.

use super::{SlowModes, dot};
use crate::space::CellSpace;

/// Largest variance of the left vector inside the states, over the square of their distance, up to which there are two.
const TWO_STATES: f64 = 0.1;

/// By how much more of the distance cells half-way between the two heights shift the average of a state than they add
/// to its variance over the square of that distance.
const HALF_WAY: f64 = 2.0;

/// Rates between two states, per unit of time, each with its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Switching {
    /// From the first to the second.
    pub there: (f64, f64),
    /// Back.
    pub back: (f64, f64),
}

/// Average and variance of the left vector in a state.
struct Plateau {
    height: f64,
    variance: f64,
}

impl Plateau {
    fn new(left: &[f64], unknowns: &[f64], inside: &[f64]) -> Option<Self> {
        let sum = |power: i32, about: f64| -> f64 {
            let cells = left.iter().zip(unknowns).zip(inside);
            let terms = cells.map(|((left, mass), part)| part * mass * (left - about).powi(power));
            terms.sum()
        };
        let mass = sum(0, 0.0);
        let height = sum(1, 0.0) / mass;
        let variance = sum(2, height) / mass;
        (mass > 0.0 && height.is_finite()).then_some(Self {
            height,
            variance: variance.max(0.0),
        })
    }
}

/// The rates between two states, regions with these levels (negative inside) at the cells, from the modes and the
/// unknowns of the steady state, with what those of a second discretisation differ by. `None` where the slowest mode
/// is no exchange between them: it oscillates, or its left vector is not flat in each, or has one height in both.
///
/// The error holds that of the decay rate, what the second discretisation changes of the shares, what whole cells at
/// the borders of the regions change in place of parts of them, and the variance of the left vector inside over the
/// square of the distance of its heights: a state of which so large a part belongs to the other one shifts the shares
/// of both by about as much, however small the smaller one is.
pub fn switching(
    modes: &SlowModes,
    space: &CellSpace,
    (unknowns, changes): (&[f64], Option<&[f64]>),
    [first, second]: [&[f64]; 2],
) -> Option<Switching> {
    let (slowest, left) = (modes.modes.first()?, modes.left.as_slice());
    if left.len() != unknowns.len() {
        return None;
    }
    let plateaus = |inside: fn(&CellSpace, &[f64]) -> Vec<f64>| {
        let plateau = |levels| Plateau::new(left, unknowns, &inside(space, levels));
        Some((plateau(first)?, plateau(second)?))
    };
    let (one, other) = plateaus(parts_inside)?;
    let (whole_one, whole_other) = plateaus(cells_inside)?;
    let distance = one.height - other.height;
    let spread = (one.variance + other.variance) / (distance * distance);
    let whole: f64 = unknowns.iter().sum();
    let mean = dot(left, unknowns) / whole;
    let share = (mean - other.height) / distance;
    // What is outside of both may be anywhere between.
    if !(spread <= TWO_STATES && (0.0..=1.0).contains(&share)) {
        return None;
    }
    let by_cells = (mean - whole_other.height) / (whole_one.height - whole_other.height);
    let change = (by_cells - share).abs()
        + changes.map_or(0.0, |changes| {
            let about: Vec<f64> = left.iter().map(|value| value - mean).collect();
            (dot(&about, changes) / whole / distance).abs()
        });
    let (decay, error) = slowest.decay;
    let rate = |share: f64| {
        (
            decay * share,
            error * share + decay * (change + HALF_WAY * spread),
        )
    };
    Some(Switching {
        there: rate(1.0 - share),
        back: rate(share),
    })
}

/// One for cells whose node is inside, zero for others.
fn cells_inside(_: &CellSpace, levels: &[f64]) -> Vec<f64> {
    let one = |level: &f64| f64::from(u8::from(*level < 0.0));
    levels.iter().map(one).collect()
}

/// How much of each cell is inside, were its level to change evenly over it.
fn parts_inside(space: &CellSpace, levels: &[f64]) -> Vec<f64> {
    let shape = space.shape();
    let one = |cell: usize| {
        let change = |axis: usize| {
            let stride: usize = shape[axis + 1..].iter().product();
            let position = space.position(cell, axis);
            let low = cell - stride * usize::from(position > 0);
            let high = cell + stride * usize::from(position + 1 < shape[axis]);
            let steps = ((high - low) / stride).max(1);
            (levels[high] - levels[low]).abs() / steps as f64
        };
        let over_a_cell: f64 = (0..shape.len()).map(change).sum();
        (0.5 - levels[cell] / over_a_cell.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    };
    (0..levels.len()).map(one).collect()
}
