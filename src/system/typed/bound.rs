//! A typed model with its values: drift and amplitudes run on tapes, the rest follows from the formulas.

use std::sync::{Arc, OnceLock};

use super::read::Reading;
use crate::formula::analysis::Reflection;
use crate::formula::graph::{Expression, Point};
use crate::formula::tape::Tape;
use crate::system::{LANES, Lanes, SwitchingSurface, Symmetry, System};

/// Largest distance of a bound from the mirror image of the other, as a share of the range, that is rounding.
const ROUNDING: f64 = 1e-12;

/// The system with these values, in the order of the parameters.
pub(super) fn bind(reading: &Arc<Reading>, values: &[f64]) -> Arc<dyn System> {
    let amplitudes = reading.amplitudes.iter().map(|one| one.bind(values).ok());
    Arc::new(Typed {
        drift: reading.drift.bind(values).ok(),
        amplitudes: amplitudes.collect(),
        values: values.to_vec(),
        symmetry: OnceLock::new(),
        reading: Arc::clone(reading),
    })
}

/// Formulas with numbers for their parameters.
struct Typed {
    reading: Arc<Reading>,
    values: Vec<f64>,
    /// `None` where the formulas with these values need more room than a tape has: the drift is then not a number.
    drift: Option<Tape>,
    amplitudes: Vec<Option<Tape>>,
    /// Looked for when first asked for.
    symmetry: OnceLock<Option<Symmetry>>,
}

impl Typed {
    /// The value of an expression of parameters.
    fn value(&self, expression: Expression) -> f64 {
        let point = Point {
            states: &[],
            parameters: &self.values,
            time: f64::NAN,
        };
        self.reading.scope.graph().evaluate(expression, &point)
    }

    /// A reflection about the origin under which drift, noise and bounds stay as they are.
    fn find_symmetry(&self) -> Option<Symmetry> {
        let mut graph = self.reading.scope.graph().clone();
        let (drift, noise) = (&self.reading.drift_expressions, &self.reading.noise);
        let centre = vec![0.0; drift.len()];
        let found = graph.find_reflection(drift, noise, &centre, &self.values);
        let (Reflection { centre, reflected }, _) = found.ok().flatten()?;
        let symmetric = |axis: usize| {
            self.bounds(axis).is_none_or(|(low, high)| {
                (low + high - 2.0 * centre[axis]).abs() <= ROUNDING * (high - low)
            })
        };
        let mut axes = 0..reflected.len();
        let fits = axes.all(|axis| !reflected[axis] || symmetric(axis));
        fits.then_some(Symmetry { centre, reflected })
    }
}

impl System for Typed {
    fn dimension(&self) -> usize {
        self.reading.drift_expressions.len()
    }

    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        match &self.drift {
            Some(tape) => tape.run(time, states, drift),
            None => drift.fill([f64::NAN; LANES]),
        }
    }

    fn noise_axes(&self) -> &[usize] {
        &self.reading.noise_axes
    }

    fn additive_amplitude(&self, channel: usize) -> Option<f64> {
        self.amplitudes.get(channel)?.as_ref()?.constant(0)
    }

    fn amplitude(&self, channel: usize, time: f64, states: &[Lanes], amplitude: &mut Lanes) {
        match self.amplitudes.get(channel) {
            Some(Some(tape)) => tape.run(time, states, std::slice::from_mut(amplitude)),
            _ => amplitude.fill(f64::NAN),
        }
    }

    fn period(&self) -> Option<f64> {
        self.reading.period.map(|period| self.value(period))
    }

    fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        let (lower, upper) = self.reading.bounds.get(axis).copied().flatten()?;
        Some((self.value(lower), self.value(upper)))
    }

    fn relaxation_rate(&self, axis: usize) -> Option<f64> {
        let rate = self.reading.relaxation.get(axis).copied().flatten()?;
        Some(self.value(rate)).filter(|rate| *rate > 0.0 && rate.is_finite())
    }

    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        let mut surfaces: Vec<SwitchingSurface> = Vec::new();
        for &(axis, at) in &self.reading.surfaces {
            // The sum makes a zero of either sign the same plane.
            let at = self.value(at) + 0.0;
            let surface = SwitchingSurface { axis, at };
            if at.is_finite() && !surfaces.contains(&surface) {
                surfaces.push(surface);
            }
        }
        surfaces
    }

    fn symmetry(&self) -> Option<Symmetry> {
        self.symmetry.get_or_init(|| self.find_symmetry()).clone()
    }
}
