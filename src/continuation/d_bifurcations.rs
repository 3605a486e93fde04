//! D-bifurcations: values at which the largest Lyapunov exponent of a fixed point passes zero.
//!
//! The exponent is a function of the parameter that costs next to nothing, so its zeros between the values of a sweep
//! are found by that function itself, and no densities are solved for them.

use super::Point;
use super::doubt::Doubt;
use super::levels::LevelCrossing;
use super::measure::EXPONENT;
use crate::exponent::{Exponent, of_family};
use crate::system::{Family, MeasureLevel};

/// Halvings of a bracket at most: more than there are digits.
const HALVINGS: usize = 200;

/// Values at which the exponent is looked at along a sweep, at least: two zeros may lie between two of its own.
const LOOKED_AT: usize = 256;

/// Share of the bracket over which the slope at a zero is taken.
const SLOPE: f64 = 1e-3;

/// Rounding of a value of the parameter, relative to it.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// All zeros along the points of a sweep, ascending and unnumbered.
pub(super) fn d_bifurcations(
    points: &[Point],
    family: &Family,
    tolerance: f64,
) -> Vec<LevelCrossing> {
    let exponent = |value: f64| of_family(family, value).and_then(Result::ok);
    let parts = LOOKED_AT.div_ceil(points.len().saturating_sub(1).max(1));
    let inside = points.windows(2).flat_map(|pair| {
        let [from, to] = [pair[0].value, pair[1].value];
        (0..parts).map(move |part| from + (to - from) * part as f64 / parts as f64)
    });
    let values = inside.chain(points.last().map(|point| point.value));
    let known = values.filter_map(|value| Some((value, exponent(value)?)));
    let known: Vec<(f64, Exponent)> = known.collect();
    let between = |pair: &[(f64, Exponent)]| {
        let [(lower, below), (upper, above)] = [pair[0], pair[1]];
        let crosses = (below.value < 0.0) != (above.value < 0.0);
        crosses.then(|| row(&exponent, (lower, upper), below.value < 0.0, tolerance))
    };
    known.windows(2).filter_map(between).collect()
}

/// The zero in a bracket.
fn row(
    exponent: &dyn Fn(f64) -> Option<Exponent>,
    (lower, upper): (f64, f64),
    rises: bool,
    tolerance: f64,
) -> LevelCrossing {
    let [mut a, mut b] = [lower, upper];
    let mut lost = false;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (a + b);
        if !(middle > a && middle < b) {
            break;
        }
        match exponent(middle) {
            Some(found) if (found.value < 0.0) == rises => a = middle,
            Some(_) => b = middle,
            None => {
                lost = true;
                break;
            }
        }
    }
    let value = 0.5 * (a + b);
    let step = SLOPE * (upper - lower);
    let ends = [value - step, value + step].map(|at| at.clamp(lower, upper));
    let slope = match ends.map(exponent) {
        [Some(below), Some(above)] => (above.value - below.value) / (ends[1] - ends[0]),
        _ => 0.0,
    };
    let own = exponent(value);
    // A jump through zero is none: beside a zero the exponent is as small as its error says.
    let off = own.map_or(f64::INFINITY, |own| own.value.abs() + own.error);
    let error = 0.5 * (b - a) + off / slope.abs() + ROUNDING * value.abs();
    let error = if error.is_finite() {
        error
    } else {
        0.5 * (upper - lower)
    };
    let doubt = match lost {
        true => Some(Doubt::IndicatorLost),
        false => (error > tolerance).then_some(Doubt::SolverError(error)),
    };
    LevelCrossing {
        label: String::new(),
        asked: MeasureLevel {
            measure: EXPONENT.word.to_owned(),
            level: 0.0,
        },
        value,
        error,
        lower: (value - error).max(lower),
        upper: (value + error).min(upper),
        rises,
        doubts: doubt.into_iter().collect(),
    }
}
