//! A typed model with its values: drift and amplitudes run on tapes, the rest follows from the formulas.

use std::sync::{Arc, OnceLock};

use super::Compiled;
use super::hysteresis;
use super::read::Reading;
use crate::formula::analysis::Reflection;
use crate::formula::graph::{Expression, Point};
use crate::formula::tape::Program;
use crate::system::{
    CompiledSteps, Facts, LANES, Lanes, Noise, SwitchingSurface, Symmetry, System,
};

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
        compiled: compiled(reading, values),
        noises: amplitudes.map(noise).collect(),
        values: values.to_vec(),
        facts: OnceLock::new(),
        reading: Arc::clone(reading),
    })
}

/// What is compiled in, else the drift of the formulas.
fn compiled(reading: &Reading, values: &[f64]) -> Compiled {
    if let Some(bind) = &reading.extras.compiled {
        return bind(values);
    }
    Compiled {
        drift: match reading.drift.bind(values) {
            Ok(tape) => Box::new(move |time, states, drift| tape.run(time, states, drift)),
            // The formulas with these values need more room than a tape has.
            Err(_) => Box::new(|_, _, drift| drift.fill([f64::NAN; LANES])),
        },
        steps: None,
    }
}

/// Formulas with numbers for their parameters.
struct Typed {
    reading: Arc<Reading>,
    values: Vec<f64>,
    compiled: Compiled,
    noises: Vec<Noise>,
    /// Looked for when first asked for.
    facts: OnceLock<Facts>,
}

impl Typed {
    /// The value of an expression of parameters.
    fn value(&self, expression: Expression) -> f64 {
        self.value_at(expression, &[])
    }

    fn value_at(&self, expression: Expression, states: &[f64]) -> f64 {
        let point = Point {
            states,
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
            turns: reading.turns.of_axes.clone(),
            phase: reading.turns.phase,
            switching_surfaces: self.surfaces(),
            period: reading.period.map(|period| self.value(period)),
            ..Facts::default()
        };
        for (axis, &path) in reading.paths.iter().enumerate() {
            let unknown = path.filter(|_| !facts.bounds.contains_key(&axis));
            let found = unknown.and_then(|path| self.hysteresis(axis, path));
            facts.bounds.extend(found.map(|found| (axis, found)));
        }
        if let Some(mend) = reading.extras.facts {
            mend(&self.values, &mut facts);
        }
        facts.symmetry = self.find_symmetry(&facts);
        facts
    }

    /// Values between which a state stays that has hysteresis along the path of another one.
    fn hysteresis(&self, axis: usize, path: usize) -> Option<(f64, f64)> {
        let dimension = self.dimension();
        hysteresis::bounds(|v, z| {
            let mut states = vec![[0.0; LANES]; dimension];
            (states[path], states[axis]) = ([v; LANES], [z; LANES]);
            let mut drift = vec![[0.0; LANES]; dimension];
            self.drift(0.0, &states, &mut drift);
            drift[axis][0]
        })
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
        (self.compiled.drift)(time, states, drift);
    }

    fn compiled_steps(&self) -> Option<&dyn CompiledSteps> {
        self.compiled.steps.as_deref()
    }

    fn noises(&self) -> &[Noise] {
        &self.noises
    }

    fn facts(&self) -> &Facts {
        self.facts.get_or_init(|| self.find_facts())
    }

    /// Friction whose level is zero is none: the density is then known exactly.
    fn friction_force(&self, state: &[f64]) -> Option<f64> {
        let force = self.reading.friction?;
        let exact = self.exact_log_density(state);
        exact.is_none().then(|| self.value_at(force, state))
    }

    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        self.reading
            .extras
            .log_density
            .and_then(|density| density(&self.values, state))
    }
}
