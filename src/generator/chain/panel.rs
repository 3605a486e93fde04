//! Integrals over intervals of an axis by eight points: the exponent of the density, the speed measure and the scale.

use crate::generator::one_axis::{NODES, Rule, look};
use crate::system::{LANES, System};

/// An interval with its points, and what is integrated over it.
pub(super) struct Panel {
    pub(super) points: [f64; NODES],
    /// ∫ 2a/b² over the interval, and that of its magnitude.
    pub(super) rise: f64,
    pub(super) variation: f64,
    /// ∫ dx/b: the width in units in which noise is the same everywhere.
    pub(super) spread: f64,
    /// Weights of ∫ (1/b²) exp ∫ 2a/b² at the points, the inner integral from the start of the interval.
    pub(super) masses: [f64; NODES],
    /// ∫ exp(-∫ 2a/b²) up to each point, and over the whole.
    pub(super) scales: [f64; NODES],
    pub(super) scale: f64,
    /// ln b² at the first and the last point.
    pub(super) log_noise: [f64; 2],
}

impl Panel {
    fn new(
        rule: &Rule,
        (from, to): (f64, f64),
        points: [f64; NODES],
        (drift, intensity): (&[f64], &[f64]),
    ) -> Option<Self> {
        let width = to - from;
        let mut rates = [0.0; NODES];
        for node in 0..NODES {
            let usable = drift[node].is_finite() && intensity[node].is_finite();
            if !(usable && intensity[node] > 0.0) {
                return None;
            }
            rates[node] = 2.0 * drift[node] / intensity[node];
        }
        let over = |weights: &[f64; NODES], values: &[f64; NODES]| -> f64 {
            let terms = weights.iter().zip(values);
            width * terms.map(|(weight, value)| weight * value).sum::<f64>()
        };
        let here = rule.integrals.map(|to_node| over(&to_node, &rates));
        let falls = here.map(|exponent| (-exponent).exp());
        let mut masses = [0.0; NODES];
        for node in 0..NODES {
            masses[node] = rule.weights[node] * width * here[node].exp() / intensity[node];
        }
        let mut amplitudes = [0.0; NODES];
        for (slot, one) in amplitudes.iter_mut().zip(intensity) {
            *slot = one.sqrt().recip();
        }
        Some(Self {
            points,
            rise: over(&rule.weights, &rates),
            variation: over(&rule.weights, &rates.map(f64::abs)),
            spread: over(&rule.weights, &amplitudes),
            masses,
            scales: rule.integrals.map(|to_node| over(&to_node, &falls)),
            scale: over(&rule.weights, &falls),
            log_noise: [intensity[0].ln(), intensity[NODES - 1].ln()],
        })
    }
}

/// The panels of intervals, as many at once as a batch holds; `None` where drift or noise are not finite, or there is
/// no noise.
pub(super) fn panels(
    system: &dyn System,
    rule: &Rule,
    intervals: &[(f64, f64)],
) -> Option<Vec<Panel>> {
    let mut all = Vec::with_capacity(intervals.len());
    for batch in intervals.chunks(LANES / NODES) {
        let mut places = [batch[0].0 + 0.5 * (batch[0].1 - batch[0].0); LANES];
        for (number, &(from, to)) in batch.iter().enumerate() {
            for (node, point) in rule.points.iter().enumerate() {
                places[number * NODES + node] = from + (to - from) * point;
            }
        }
        let (drift, intensity) = look(system, &places);
        for (number, &ends) in batch.iter().enumerate() {
            let lanes = number * NODES..(number + 1) * NODES;
            let mut points = [0.0; NODES];
            points.copy_from_slice(&places[lanes.clone()]);
            let values = (&drift[lanes.clone()], &intensity[lanes]);
            all.push(Panel::new(rule, ends, points, values)?);
        }
    }
    Some(all)
}
