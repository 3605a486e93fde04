//! Changes beside a fixed point that noise leaves alone: the density goes like a power of the distance there, which no
//! cells follow, so that neither the order of a scheme nor the distance to finer cells says how far a value is off.
//!
//! The power passes zero where a density that is the same everywhere about the fixed point neither thins out nor piles
//! up ([`Linearised::thinning`](crate::system::Linearised::thinning)): until then the density is infinite there,
//! afterwards it is zero. That value follows from the equations alone, and a row says it.

use super::Point;
use super::doubt::Doubt;
use crate::density::Observable;
use crate::space::Axis;
use crate::system::Family;

/// Cells on either side of a place that what is read there depends on.
const REACH: usize = 4;

/// Halvings of a bracket at most: more than there are digits.
const HALVINGS: usize = 100;

/// Share of a bracket below which a zero in it is zero.
const NOTHING: f64 = 1e-12;

/// What speaks against a change at a place of an observable at a value: that a fixed point is within reach of what is
/// read there.
pub(super) fn beside_fixed_point(
    points: &[&Point],
    family: &Family,
    (observable, axes): (Observable, &[Axis]),
    place: &[f64],
    value: f64,
) -> Option<Doubt> {
    let of_model = &family.model().axes;
    // Where no fixed point is named, rest at zero is the one that oscillators have.
    let state = family.questions.fixed_point.clone();
    let state = state.unwrap_or_else(|| vec![0.0; of_model.len()]);
    let own = observable.axes();
    let mut pairs = own.iter().zip(place).zip(axes);
    let is_near = pairs.all(|((&axis, &at), cells)| {
        let rest = state.get(axis).and_then(|rest| cells.find(*rest));
        let both = rest.zip(cells.find(at));
        both.is_some_and(|(rest, at)| rest.abs_diff(at) <= REACH)
    });
    if !is_near {
        return None;
    }
    let thinning = |at: f64| {
        let linear = family.linearised(at, &state).ok()?;
        // Without noise about it that is a density like any other's.
        let is_moved = linear.noises.iter().flatten().flatten().any(|b| *b != 0.0);
        is_moved.then(|| linear.thinning())
    };
    thinning(value)?;
    let is_whole = own.len() == of_model.len();
    let zero = is_whole.then(|| nearest_zero(points, &thinning, value));
    Some(Doubt::AtRest(zero.flatten()))
}

/// The zero of a function of the parameter that is nearest to a value, in a sweep.
fn nearest_zero(
    points: &[&Point],
    function: &dyn Fn(f64) -> Option<f64>,
    value: f64,
) -> Option<f64> {
    let values = points.iter().map(|point| point.value);
    let known = values.filter_map(|at| Some((at, function(at)?)));
    let known: Vec<(f64, f64)> = known.collect();
    let zeros = known.windows(2).filter_map(|pair| {
        let [(mut a, below), (mut b, above)] = [pair[0], pair[1]];
        if (below < 0.0) == (above < 0.0) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (a + b);
            match (function(middle)? < 0.0) == (below < 0.0) {
                true => a = middle,
                false => b = middle,
            }
        }
        // What is left of a bracket about zero by halving is no number that one would write.
        let (zero, width) = (0.5 * (a + b), pair[1].0 - pair[0].0);
        Some(if zero.abs() < NOTHING * width {
            0.0
        } else {
            zero
        })
    });
    zeros.min_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()))
}
