//! A damped particle in a potential, found in the formulas: x' = y, y' = F(x) - g y and a constant noise on y.

use super::TypedEquations;
use crate::formula::graph::{Expression, Graph, Point, Symbol};

/// x' = y, y' = F(x) - g y + s ξ(t), with values of the parameters: a particle in the potential of F whose friction and
/// noise belong to the temperature s²/(2 g).
#[derive(Debug, Clone)]
pub struct DampedParticle {
    /// Axis of the position x.
    pub position: usize,
    /// Damping g, in 1/t.
    pub damping: f64,
    /// Temperature s²/(2 g), an energy per unit of mass.
    pub temperature: f64,
    graph: Graph,
    force: Expression,
    slope: Expression,
    parameters: Vec<f64>,
}

impl DampedParticle {
    /// The force F at a position.
    pub fn force(&self, position: f64) -> f64 {
        self.at(self.force, position)
    }

    /// Curvature of the potential at a position: -F'.
    pub fn curvature(&self, position: f64) -> f64 {
        -self.at(self.slope, position)
    }

    fn at(&self, expression: Expression, position: f64) -> f64 {
        let mut states = [0.0; 2];
        states[self.position] = position;
        let point = Point {
            states: &states,
            parameters: &self.parameters,
            time: f64::NAN,
        };
        self.graph.evaluate(expression, &point)
    }
}

impl TypedEquations {
    /// The particle that the form of the formulas shows, with values of the parameters in their order; `None` where it
    /// shows none, or where nothing damps it or drives it.
    pub(in crate::system) fn particle(&self, parameters: &[f64]) -> Option<DampedParticle> {
        let drift = &self.reading.drift_expressions;
        let axes = if drift.len() == 2 { 0..2 } else { 0..0 };
        let mut found = axes.filter_map(|position| self.particle_along(position, parameters));
        found.next()
    }

    fn particle_along(&self, position: usize, parameters: &[f64]) -> Option<DampedParticle> {
        let reading = &self.reading;
        let mut graph = reading.scope.graph().clone();
        let velocity = 1 - position;
        let by_velocity = Symbol::State(velocity);
        let moved = graph.affine(reading.drift_expressions[position], by_velocity);
        let moved = moved.ok().flatten()?;
        let is_velocity = graph.as_constant(moved.constant) == Some(0.0)
            && graph.as_constant(moved.slope) == Some(1.0);
        let pushed = graph.affine(reading.drift_expressions[velocity], by_velocity);
        let pushed = pushed.ok().flatten().filter(|_| is_velocity)?;
        let is_fixed = |graph: &Graph, expression: Expression| {
            let dependence = graph.dependence(expression);
            !dependence.time && dependence.states.is_empty()
        };
        if graph.dependence(pushed.constant).time || !is_fixed(&graph, pushed.slope) {
            return None;
        }
        let amplitudes = reading.noise.iter().flatten();
        if !amplitudes.into_iter().all(|&one| is_fixed(&graph, one)) {
            return None;
        }
        let slope = graph.derivative(pushed.constant, Symbol::State(position));
        let slope = slope.ok()?.value;
        let point = Point {
            states: &[0.0; 2],
            parameters,
            time: f64::NAN,
        };
        let square = |axis: usize| -> f64 {
            let processes = reading.noise.iter().filter_map(|process| process.get(axis));
            processes
                .map(|&one| graph.evaluate(one, &point).powi(2))
                .sum()
        };
        let damping = -graph.evaluate(pushed.slope, &point);
        let temperature = square(velocity) / (2.0 * damping);
        let is_one = square(position) == 0.0 && damping > 0.0 && temperature > 0.0;
        (is_one && temperature.is_finite()).then(|| DampedParticle {
            position,
            damping,
            temperature,
            force: pushed.constant,
            slope,
            parameters: parameters.to_vec(),
            graph,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{ParameterDescription, TypedModel};

    /// Of x' and y' as text with noises of both, at g = 0.5.
    fn particle(drift: [&str; 2], noise: [&str; 2]) -> Option<DampedParticle> {
        let model = TypedModel::new("own", "own", ["x", "y"])
            .with_equation("x", drift[0])
            .with_equation("y", drift[1])
            .with_noise("x", [noise[0]])
            .with_noise("y", [noise[1]])
            .with_parameters([ParameterDescription::from("g")]);
        let model = model.build().unwrap();
        model.formulas().unwrap().particle(&[0.5])
    }

    #[test]
    fn a_damped_particle_is_known_by_its_form_alone() {
        let found = particle(["y", "x - x^3 - g y"], ["0", "sqrt(0.2 g)"]).unwrap();
        assert_eq!((found.position, found.damping), (0, 0.5));
        assert!((found.temperature - 0.1).abs() < 1e-15);
        assert!((found.force(2.0) + 6.0).abs() < 1e-14);
        assert!((found.curvature(2.0) - 11.0).abs() < 1e-14);
        let turned = particle(["-sin(y) - 2*g*x", "x"], ["0.3", "0"]).unwrap();
        assert_eq!((turned.position, turned.damping), (1, 1.0));
        for (drift, noise) in [
            (["y", "x - g y^3"], ["0", "1"]),
            (["y", "x - g x y"], ["0", "1"]),
            (["2 y", "x - g y"], ["0", "1"]),
            (["y - x", "x - g y"], ["0", "1"]),
            (["y", "x + g y"], ["0", "1"]),
            (["y", "x - g y"], ["0.1", "1"]),
            (["y", "x - g y"], ["0", "1 + x"]),
            (["y", "x - g y"], ["0", "0"]),
        ] {
            assert!(particle(drift, noise).is_none(), "{drift:?} {noise:?}");
        }
    }
}
