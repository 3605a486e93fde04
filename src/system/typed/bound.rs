//! A typed model with its values: drift and amplitudes run on tapes, the rest follows from the formulas.

use std::sync::{Arc, OnceLock};

use super::read::Reading;
use crate::formula::analysis::Reflection;
use crate::formula::graph::{Expression, Point};
use crate::formula::tape::{Program, Tape};
use crate::system::{Facts, LANES, Lanes, Noise, SwitchingSurface, Symmetry, System};

/// Largest distance of a bound from the mirror image of the other, as a share of the range, that is rounding.
const ROUNDING: f64 = 1e-12;

/// The system with these values, in the order of the parameters.
pub(super) fn bind(reading: &Arc<Reading>, values: &[f64]) -> Arc<dyn System> {
    let amplitudes = reading.amplitudes.iter().zip(&reading.noise_axes);
    let noise = |(program, &axis): (&Program, &usize)| match program.bind(values) {
        Ok(tape) => match tape.constant(0) {
            Some(amplitude) => Noise::constant(axis, amplitude),
            None => Noise::of_state(axis, move |time, states, lanes: &mut Lanes| {
                tape.run(time, states, std::slice::from_mut(lanes));
            }),
        },
        Err(_) => Noise::constant(axis, f64::NAN),
    };
    Arc::new(Typed {
        drift: reading.drift.bind(values).ok(),
        noises: amplitudes.map(noise).collect(),
        values: values.to_vec(),
        facts: OnceLock::new(),
        reading: Arc::clone(reading),
    })
}

/// Formulas with numbers for their parameters.
struct Typed {
    reading: Arc<Reading>,
    values: Vec<f64>,
    /// `None` where the formulas with these values need more room than a tape has: the drift is then not a number.
    drift: Option<Tape>,
    noises: Vec<Noise>,
    /// Looked for when first asked for.
    facts: OnceLock<Facts>,
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

    fn find_facts(&self) -> Facts {
        let reading = &self.reading;
        let bounds = reading.bounds.iter().enumerate();
        let bounds = bounds.filter_map(|(axis, bounds)| {
            let (lower, upper) = (*bounds)?;
            Some((axis, (self.value(lower), self.value(upper))))
        });
        let rates = reading.relaxation.iter().enumerate();
        let rates = rates.filter_map(|(axis, rate)| Some((axis, self.value((*rate)?))));
        let mut facts = Facts {
            bounds: bounds.collect(),
            relaxation_rates: rates
                .filter(|(_, rate)| *rate > 0.0 && rate.is_finite())
                .collect(),
            switching_surfaces: self.surfaces(),
            period: reading.period.map(|period| self.value(period)),
            ..Facts::default()
        };
        facts.symmetry = self.find_symmetry(&facts);
        facts
    }

    fn surfaces(&self) -> Vec<SwitchingSurface> {
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

    /// A reflection about the origin under which drift, noise and bounds stay as they are.
    fn find_symmetry(&self, facts: &Facts) -> Option<Symmetry> {
        let mut graph = self.reading.scope.graph().clone();
        let (drift, noise) = (&self.reading.drift_expressions, &self.reading.noise);
        let centre = vec![0.0; drift.len()];
        let found = graph.find_reflection(drift, noise, &centre, &self.values);
        let (Reflection { centre, reflected }, _) = found.ok().flatten()?;
        let symmetric = |(&axis, &(low, high)): (&usize, &(f64, f64))| {
            !reflected[axis] || (low + high - 2.0 * centre[axis]).abs() <= ROUNDING * (high - low)
        };
        let fits = facts.bounds.iter().all(symmetric);
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

    fn noises(&self) -> &[Noise] {
        &self.noises
    }

    fn facts(&self) -> &Facts {
        self.facts.get_or_init(|| self.find_facts())
    }
}
