//! The slope of the logarithm of a density over one axis, in parts on each of which it is a polynomial to ten digits.
//!
//! A part that ten digits need smaller is halved; cells are cut where drift and noise are not smooth.

use super::cuts::{cuts_toward, surfaces};
use super::rule::{NODES, Rule, look};
use super::series::Series;
use crate::space::Axis;
use crate::system::{LANES, System};

/// Last coefficients of a series, relative to the whole, from which on a part is halved.
const ROUGH: f64 = 1e-10;
/// Most times that a part is halved.
const MOST_HALVINGS: usize = 10;
/// Rounding of a logarithm of the noise.
const OF_LOGARITHM: f64 = 1e-15;
/// First and second derivative of the last Legendre polynomial at an end of [-1, 1]: what rounding grows by.
pub(super) const STEEPEST: [f64; 2] = [28.0, 378.0];
/// Steps in which an extremum of the slope is looked for on a part.
const LOOKS: usize = 16;

/// A stretch of the axis on which the slope of log p is one polynomial.
pub(super) struct Part {
    /// 2a/b².
    pub(super) rate: Series,
    /// ln b² less its level.
    pub(super) log_noise: Series,
    pub(super) level: f64,
    /// Rounding of its values.
    pub(super) log_rounding: f64,
    /// (log p)'.
    pub(super) slope: Series,
    /// ∫ 2a/b² from the lower end of the axis to that of the part.
    pub(super) exponent: f64,
    /// Error of the slope, and that of log p gathered up to the part.
    pub(super) error: f64,
    pub(super) gathered: f64,
    /// Magnitude of what the slope is the difference of.
    pub(super) size: f64,
}

/// The axis in parts.
pub(super) struct Partition {
    pub(super) parts: Vec<Part>,
    /// Those of the axis; the parts end a little before natural ones.
    pub(super) ends: (f64, f64),
}

/// The slope at a place, the first of equal ones being on the lower side.
#[derive(Clone, Copy)]
pub(super) struct SlopeAt {
    pub(super) place: f64,
    pub(super) slope: f64,
    pub(super) error: f64,
    pub(super) size: f64,
}

impl Partition {
    /// All of an axis with these `exponents` at natural ends, where the noise dies; `None` where drift or noise are not
    /// finite, or the noise vanishes elsewhere.
    pub(super) fn new(
        system: &dyn System,
        axis: &Axis,
        exponents: [Option<f64>; 2],
    ) -> Option<Self> {
        let rule = Rule::new();
        let surfaces = surfaces(system);
        let mut line = Self {
            parts: Vec::new(),
            ends: (axis.from(), axis.to()),
        };
        let least = 1.0 / (axis.to() - axis.from());
        for cell in 0..axis.count() {
            for ends in cuts_toward(system, axis, cell, &surfaces, exponents).windows(2) {
                line.add(system, &rule, (ends[0], ends[1]), least, MOST_HALVINGS)?;
            }
        }
        Some(line)
    }

    /// Adds a part from one place to another. `least` is the size below which slopes are next to nothing.
    fn add(
        &mut self,
        system: &dyn System,
        rule: &Rule,
        (from, to): (f64, f64),
        least: f64,
        halvings: usize,
    ) -> Option<()> {
        let mut places = [from; LANES];
        for (place, point) in places.iter_mut().zip(&rule.points) {
            *place = from + (to - from) * point;
        }
        let (drift, intensity) = look(system, &places);
        let (mut rates, mut logs) = ([0.0; NODES], [0.0; NODES]);
        for node in 0..NODES {
            rates[node] = 2.0 * drift[node] / intensity[node];
            logs[node] = intensity[node].ln();
            if !(rates[node].is_finite() && logs[node].is_finite()) {
                return None;
            }
        }
        let rate = Series::through(rule, (from, to), &rates);
        // What is constant must not leave its rounding in the derivative.
        let level = logs[0];
        let log_noise = Series::through(rule, (from, to), &logs.map(|one| one - level));
        let of_noise = log_noise.derivative();
        let tail = rate.tail() + of_noise.tail();
        let size = (rate.size() + of_noise.size()).max(least);
        let middle = 0.5 * (from + to);
        let is_divisible = halvings > 0 && from < middle && middle < to;
        // A place has so few digits that noise which dies beside it is known to no more.
        let digits = f64::EPSILON * from.abs().max(to.abs());
        // The logarithm of a noise that is the same everywhere is no part of the slope.
        let log_rounding = if log_noise.size() > 0.0 {
            OF_LOGARITHM + digits * of_noise.size()
        } else {
            0.0
        };
        let rounding =
            digits * rate.derivative().size() + log_rounding * STEEPEST[0] * 2.0 / (to - from);
        if tail > ROUGH * size + rounding && is_divisible {
            self.add(system, rule, (from, middle), least, halvings - 1)?;
            return self.add(system, rule, (middle, to), least, halvings - 1);
        }
        let error = tail + rounding;
        let last = self.parts.last();
        let exponent = last.map_or(0.0, |part| part.exponent + part.rate.integral_to(from));
        let gathered = last.map_or(0.0, |part| {
            part.gathered + part.error * (part.slope.to - part.slope.from)
        });
        self.parts.push(Part {
            slope: rate.plus(-1.0, &of_noise),
            rate,
            log_noise,
            log_rounding,
            level,
            exponent,
            error,
            gathered,
            size,
        });
        Some(())
    }

    /// The part that holds a place, the upper one of two.
    pub(super) fn part(&self, place: f64) -> Option<&Part> {
        let above = self.parts.partition_point(|part| part.slope.from <= place);
        self.parts.get(above.saturating_sub(1))
    }

    /// Slopes at the ends of all parts and at the extrema on them, in ascending place: between two the slope is
    /// monotone.
    pub(super) fn samples(&self) -> Vec<SlopeAt> {
        let mut samples = Vec::with_capacity(2 * self.parts.len());
        for part in &self.parts {
            let (from, to) = (part.slope.from, part.slope.to);
            let bend = part.slope.derivative();
            let place = |step: usize| from + (to - from) * step as f64 / LOOKS as f64;
            let steps = (0..LOOKS).map(|step| (place(step), place(step + 1)));
            let turning = steps.filter(|(a, b)| bend.at(*a) * bend.at(*b) < 0.0);
            let turns = turning.map(|(a, b)| zero(|x| bend.at(x), (a, b), bend.at(b) > 0.0));
            for place in [from].into_iter().chain(turns).chain([to]) {
                samples.push(SlopeAt {
                    place,
                    slope: part.slope.at(place),
                    error: part.error,
                    size: part.size,
                });
            }
        }
        samples
    }
}

/// A zero between two places at which a function has different signs, by halving; `rises` tells whether it is positive
/// at the upper one.
pub(super) fn zero(of: impl Fn(f64) -> f64, (mut low, mut high): (f64, f64), rises: bool) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if (of(middle) > 0.0) == rises {
            high = middle
        } else {
            low = middle
        }
    }
}
