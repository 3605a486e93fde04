//! The zero of an indicator between two points, with the parts of its error.
//!
//! An error δg of the indicator moves its zero by δg/|g'|. Sampling is judged by the replicates' own zeros: with common
//! random numbers their noise is the same at both points, and the jackknife sees what that does to the zero.

use super::Point;
use super::follow::Crossing;
use crate::numerics::jackknife;
use crate::topology::{Detector, Indicator, two_sided_limit};

/// The parts of the error of a P-bifurcation's value, in units of the parameter; each bounds its part at the
/// confidence of detection.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ErrorParts {
    /// Solver, and the straight line between the two points.
    pub solver: f64,
    /// Cells, order of the scheme and of the reconstruction.
    pub grid: f64,
    /// Sampling.
    pub sampling: f64,
    /// Mass that leaves Ω: how far the value moves when nothing leaves.
    pub leak: f64,
}

impl ErrorParts {
    /// The error: the sum of the parts.
    pub fn total(&self) -> f64 {
        self.solver + self.grid + self.sampling + self.leak
    }
}

/// A zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Root {
    pub(super) value: f64,
    /// Change of the indicator per unit of the parameter.
    pub(super) slope: f64,
    pub(super) error: ErrorParts,
}

/// The zero between the two points of a crossing.
pub(super) fn root(points: &[&Point], crossing: &Crossing, confidence: f64) -> Root {
    let (a, b) = (points[crossing.left], points[crossing.left + 1]);
    let [low, high] = &crossing.ends;
    let value = between((a.value, low.value), (b.value, high.value));
    let slope = slope(points, crossing);
    let share = (value - a.value) / (b.value - a.value);
    let mix = |of: fn(&Indicator) -> f64| (1.0 - share) * of(low) + share * of(high);
    let solver = a.report.solver_error.max(b.report.solver_error)
        * mix(|indicator| indicator.sensitivity)
        / slope.abs();
    let error = ErrorParts {
        solver: solver + interpolation(points, crossing, value),
        grid: mix(|indicator| indicator.systematic_error) / slope.abs(),
        sampling: sampling(a.value, b.value, crossing, value, slope, confidence),
        leak: 0.0,
    };
    Root {
        value,
        slope,
        error,
    }
}

/// Steps of the sweep on either side of a crossing over which the slope of a sampled indicator is looked at.
const STEPS_BESIDE: usize = 3;

/// Times as steep as the gentlest slope nearby from which on it is a jump.
const JUMP: f64 = 10.0;

/// Change of the indicator per unit of the parameter. A sampled one is read by a fit whose window and weights change
/// with the parameter: where they do, the indicator jumps, and across a jump it is as steep as the bracket is narrow.
/// There the gentlest slope in the neighbourhood is what an error of the indicator moves its zero by.
fn slope(points: &[&Point], crossing: &Crossing) -> f64 {
    let [low, high] = &crossing.ends;
    let at = |index: usize| points[index].value;
    let local = (high.value - low.value) / (at(crossing.left + 1) - at(crossing.left));
    if low.sampling_error == 0.0 && high.sampling_error == 0.0 {
        return local;
    }
    let value = |index: usize| {
        let indicators = &points[index]
            .detections
            .get(crossing.observable)?
            .indicators;
        indicators
            .iter()
            .find(|one| one.kind == low.kind)
            .map(|one| one.value)
    };
    // Values of one bracket lie close to each other: places are counted in steps of the sweep.
    let reach = STEPS_BESIDE as f64 * typical_step(points);
    let (from, to) = (at(crossing.left) - reach, at(crossing.left + 1) + reach);
    let below = (0..=crossing.left).rev().filter(|&index| at(index) >= from);
    let slopes = below.flat_map(|left| {
        let above = (crossing.left + 1..points.len()).filter(|&index| at(index) <= to);
        above.filter_map(move |right| Some((value(right)? - value(left)?) / (at(right) - at(left))))
    });
    // One of the other sign belongs to another zero.
    let gentlest = slopes
        .filter(|one| one.signum() == local.signum() && *one != 0.0)
        .fold(
            local,
            |least, one| {
                if one.abs() < least.abs() { one } else { least }
            },
        );
    if local.abs() > JUMP * gentlest.abs() {
        gentlest
    } else {
        local
    }
}

/// The median distance of neighbouring points would be that of brackets; the mean is that of the sweep.
fn typical_step(points: &[&Point]) -> f64 {
    let (first, last) = (points[0].value, points[points.len() - 1].value);
    (last - first) / (points.len() - 1).max(1) as f64
}

/// Share of a bracket that stands for the error of the straight line where no third point shows its curvature.
const UNKNOWN_CURVATURE: f64 = 0.25;

/// Error of the straight line through both ends: how far the zero of the parabola through the nearest third point lies
/// from it, at most the bracket.
fn interpolation(points: &[&Point], crossing: &Crossing, value: f64) -> f64 {
    let (a, b) = (points[crossing.left].value, points[crossing.left + 1].value);
    let [low, high] = &crossing.ends;
    if low.value == 0.0 || high.value == 0.0 {
        return 0.0;
    }
    let third = |index: usize| {
        let point = points.get(index)?;
        let indicators = &point.detections.get(crossing.observable)?.indicators;
        let same = indicators.iter().find(|one| one.kind == low.kind)?;
        Some((point.value, same.value))
    };
    let below = crossing.left.checked_sub(1).and_then(third);
    let above = third(crossing.left + 2);
    let nearest = match (below, above) {
        (Some(below), Some(above)) if a - below.0 <= above.0 - b => Some(below),
        (below, above) => above.or(below),
    };
    let Some((x, y)) = nearest else {
        return UNKNOWN_CURVATURE * (b - a);
    };
    let slope = (high.value - low.value) / (b - a);
    let bend = ((y - high.value) / (x - b) - slope) / (x - a);
    // The parabola at the line's zero, over the slope there.
    let local = slope + bend * (2.0 * value - a - b);
    let step = bend * (value - a) * (value - b) / local;
    if step.is_finite() {
        step.abs().min(b - a)
    } else {
        b - a
    }
}

/// Zero of the straight line through two points.
pub(super) fn between(a: (f64, f64), b: (f64, f64)) -> f64 {
    let root = a.0 - a.1 * (b.0 - a.0) / (b.1 - a.1);
    root.clamp(a.0.min(b.0), a.0.max(b.0))
}

/// Half-width of the confidence interval of the zero, from the jackknife's zeros.
fn sampling(a: f64, b: f64, crossing: &Crossing, value: f64, slope: f64, confidence: f64) -> f64 {
    let [low, high] = &crossing.ends;
    let limit = two_sided_limit(1.0 - confidence, low.degrees_of_freedom);
    let groups = low.replicates.len();
    if groups < 2 || high.replicates.len() != groups {
        return limit_or_zero(limit, low.sampling_error.max(high.sampling_error)) / slope.abs();
    }
    // Linearised about the zero: a replicate's own slope would add noise of second order.
    let share = (value - a) / (b - a);
    let zeros: Vec<f64> = (low.replicates.iter().zip(&high.replicates))
        .map(|(low, high)| -((1.0 - share) * low + share * high) / slope)
        .collect();
    limit * jackknife(zeros.iter().copied())
}

fn limit_or_zero(limit: f64, error: f64) -> f64 {
    if error > 0.0 { limit * error } else { 0.0 }
}

/// A value beside a zero that is narrowed, where the sign of its indicator is beyond doubt, on a side that has none so
/// near: what is there just before and just after the change shows only so, and pairs that are born shortly before it.
pub(super) fn beyond_doubt(
    points: &[&Point],
    crossing: &Crossing,
    detector: &dyn Detector,
    tolerance: f64,
) -> Option<f64> {
    let root = root(points, crossing, detector.confidence());
    let away = (0.5 * tolerance).max(2.0 * root.error.total());
    let is_sure = |index: usize| {
        let indicators = &points[index].detections[crossing.observable].indicators;
        let same = indicators.iter().find(|one| one.kind == crossing.kind());
        same.is_some_and(|one| one.sign(detector.doubt()).is_some())
    };
    // A value that was solved there and is in doubt all the same would not be mended by another.
    let is_near = |index: usize| {
        let distance = (points[index].value - root.value).abs();
        distance <= 2.5 * away && (is_sure(index) || distance >= 0.9 * away)
    };
    let below = (0..=crossing.left).any(is_near);
    let above = (crossing.left + 1..points.len()).any(is_near);
    let (from, to) = (points[0].value, points[points.len() - 1].value);
    let inside = |value: f64| (from < value && value < to).then_some(value);
    let lower = if below {
        None
    } else {
        inside(root.value - away)
    };
    lower.or(if above {
        None
    } else {
        inside(root.value + away)
    })
}

/// Where to solve next to narrow the bracket of a crossing to `tolerance`; `None` when it is that narrow, or when the
/// data cannot tell more.
pub(super) fn next_value(
    points: &[&Point],
    crossing: &Crossing,
    confidence: f64,
    tolerance: f64,
) -> Option<f64> {
    let (a, b) = (points[crossing.left].value, points[crossing.left + 1].value);
    let width = b - a;
    // Rounding must not ask for one more step.
    if width <= tolerance * (1.0 + 1e-9) {
        return None;
    }
    let root = root(points, crossing, confidence);
    if root.error.sampling > 0.5 * width {
        return None;
    }
    let half = 0.5 * tolerance;
    // An end that is on the zero already: the other end is brought as near.
    let proposal = if root.value - a <= half {
        a.max(root.value) + half
    } else if b - root.value <= half {
        b.min(root.value) - half
    } else {
        root.value
    };
    (proposal > a && proposal < b).then_some(proposal)
}
