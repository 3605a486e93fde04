//! Going along a curve: each point is expected along the tangent and the bend seen so far, and steps are as long as the
//! curve allows. How a point is met is the matter of those who follow curves of one kind or another.

use super::walked::{apart, within};
use super::{CurveOptions, EndReason};
use crate::numerics::narrowed;

/// A place nearer to the curve than this is on it; nothing is left of the box where less than this is.
pub(super) const CLOSE: f64 = 1e-4;
/// Shortest step, over the longest.
const SHORTEST: f64 = 1.0 / 256.0;
/// Cosine of the angle between neighbouring tangents above which steps grow.
const GENTLE: f64 = 0.99;
const GROWTH: f64 = 1.6;
/// Fewest points of a closed curve.
const FEWEST_CLOSED: usize = 6;

/// A point of a curve that is followed. Places and lengths are those of the box with sides of length one.
pub(super) trait CurveNode: Clone {
    /// Where it is.
    fn foot(&self) -> [f64; 2];
    /// Direction of the curve there, in which it is followed, of length one.
    fn tangent(&self) -> [f64; 2];
    /// Length of the curve up to it.
    fn arclength(&self) -> f64;
    /// The same at another length of the curve.
    fn at_arclength(&self, arclength: f64) -> Self;
}

/// Where the next point is expected.
#[derive(Clone, Copy)]
pub(super) struct Expected {
    pub(super) at: [f64; 2],
    /// The side of the box at whose end it lies, if the step leads out.
    pub(super) border: Option<usize>,
    /// Length of the step.
    pub(super) step: f64,
}

/// Meets the point that is expected after those that there are, and says whether that was easy.
pub(super) type Meet<'a, N> = dyn FnMut(&[N], Expected) -> Result<(N, bool), EndReason> + 'a;

/// The points after the start, in the direction of its tangent, and why there are no more. Of a curve that
/// `bends` its bend is used. `seen` is told each point as it is met, and may end the curve with it.
pub(super) fn steps<N: CurveNode>(
    start: &N,
    (options, bends): (&CurveOptions, bool),
    next: &mut Meet<'_, N>,
    seen: &mut dyn FnMut(&N) -> Option<EndReason>,
) -> (Vec<N>, EndReason) {
    let mut nodes: Vec<N> = Vec::new();
    let mut bend = [0.0; 2];
    let longest = options.largest_step;
    let mut step = 0.5 * longest;
    loop {
        let here = nodes.last().unwrap_or(start);
        if nodes.len() >= options.most_points {
            return (nodes, EndReason::TooManyPoints);
        }
        let (from, tangent) = (here.foot(), here.tangent());
        let Some((at, border)) = predict((from, tangent), bend, step) else {
            return (nodes, EndReason::Border(nearest_side(from)));
        };
        match next(&nodes, Expected { at, border, step }) {
            Ok((node, is_easy)) => {
                let (foot, onward) = (node.foot(), node.tangent());
                if bends {
                    bend = [0, 1].map(|k| (onward[k] - tangent[k]) / apart(foot, from));
                }
                if is_easy && dot(onward, tangent) > GENTLE {
                    step = (GROWTH * step).min(longest);
                }
                let ended = seen(&node);
                if nodes.len() >= FEWEST_CLOSED && passes(from, foot, start.foot()) {
                    let arclength = here.arclength() + apart(from, start.foot());
                    nodes.push(start.at_arclength(arclength));
                    return (nodes, EndReason::Closed);
                }
                nodes.push(node);
                if let Some(reason) = ended.or(border.map(EndReason::Border)) {
                    return (nodes, reason);
                }
            }
            Err(EndReason::Interrupted) => return (nodes, EndReason::Interrupted),
            Err(reason) => {
                step *= 0.5;
                if step < SHORTEST * longest {
                    return (nodes, reason);
                }
            }
        }
    }
}

/// Where the next point is expected, and the side of the box at whose end it lies, if the step leads out; `None` where
/// nothing of the box is left in this direction.
fn predict(
    (foot, tangent): ([f64; 2], [f64; 2]),
    bend: [f64; 2],
    step: f64,
) -> Option<([f64; 2], Option<usize>)> {
    let at = |step: f64| [0, 1].map(|k| foot[k] + step * tangent[k] + 0.5 * step * step * bend[k]);
    if within(at(step)) {
        return Some((at(step), None));
    }
    let (low, high) = narrowed((0.0, step), 60, |middle| within(at(middle)));
    if low < CLOSE {
        return None;
    }
    let mut place = at(low);
    let beyond = at(high);
    let side = (0..2).find(|&k| !(0.0..=1.0).contains(&beyond[k]))?;
    place[side] = if beyond[side] < 0.5 { 0.0 } else { 1.0 };
    Some((place, Some(side)))
}

/// The side of the box to whose ends a place is nearest.
fn nearest_side(place: [f64; 2]) -> usize {
    let gap = |k: usize| place[k].min(1.0 - place[k]);
    usize::from(gap(1) < gap(0))
}

/// Whether the line between two points passes by a third.
fn passes(from: [f64; 2], to: [f64; 2], by: [f64; 2]) -> bool {
    let onward = [to[0] - from[0], to[1] - from[1]];
    let gap = [by[0] - from[0], by[1] - from[1]];
    let length = dot(onward, onward);
    let share = dot(gap, onward) / length;
    let across = (gap[0] * onward[1] - gap[1] * onward[0]) / length;
    (0.0..=1.0).contains(&share) && across.abs() < 0.25
}

/// The inner product.
pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
