//! Derivatives of drift and noise at a state that neither moves, from the formulas.

use super::TypedEquations;
use crate::formula::graph::{Expression, Graph, Point, Symbol};
use crate::system::linear::{FixedPointFault, Linearised};

/// Drift and amplitudes below so many times the sum of derivative times coordinate, and of one, are rounding.
const ROUNDING: f64 = 1e-13;

/// Distance from the state at which functions are held against their derivatives, relative to its coordinates or one.
const STEP: f64 = 1e-6;

/// By how much of the largest derivative a function may differ from its derivative there, relative to the distance.
const CURVATURE: f64 = 1e-3;

/// Directions in which functions are held against their derivatives, as signs and shares of the step along the axes.
const DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [-1.0, 0.0],
    [0.0, 1.0],
    [0.0, -1.0],
    [1.0, 0.6],
    [-1.0, 0.6],
    [0.7, -1.0],
    [-0.7, -1.0],
];

impl TypedEquations {
    /// The linear Itô equation about a state, with values of the parameters in their order.
    ///
    /// # Errors
    /// [`FixedPointFault`].
    pub(in crate::system) fn linearised(
        &self,
        parameters: &[f64],
        state: &[f64],
    ) -> Result<Linearised, FixedPointFault> {
        let reading = &self.reading;
        let mut at = At {
            graph: reading.scope.graph().clone(),
            parameters,
            state,
        };
        let drift = at.rows(&reading.drift_expressions)?;
        let mut noises = Vec::with_capacity(reading.noise.len());
        for process in &reading.noise {
            noises.push(at.rows(process)?);
        }
        for axis in 0..state.len() {
            let scale: f64 = 1.0 + state.iter().map(|x| x.abs()).sum::<f64>();
            let of_noise = |process: &Vec<Expression>| at.value(process[axis], state).abs();
            let noise = reading.noise.iter().map(of_noise).fold(0.0, f64::max);
            let moved = at.value(reading.drift_expressions[axis], state);
            let rounding = ROUNDING * scale * (1.0 + size(&drift).max(size_of_all(&noises)));
            if !(moved.abs() <= rounding && noise <= rounding) {
                return Err(at.most_moved(&reading.drift_expressions, &reading.noise));
            }
        }
        at.hold(&reading.drift_expressions, &drift)?;
        for (process, rows) in reading.noise.iter().zip(&noises) {
            at.hold(process, rows)?;
        }
        Ok(Linearised { drift, noises })
    }
}

/// The largest magnitude of a matrix' entries.
fn size(rows: &[Vec<f64>]) -> f64 {
    rows.iter().flatten().fold(0.0, |most, x| most.max(x.abs()))
}

fn size_of_all(matrices: &[Vec<Vec<f64>>]) -> f64 {
    matrices.iter().map(|rows| size(rows)).fold(0.0, f64::max)
}

/// Formulas at a state.
struct At<'a> {
    graph: Graph,
    parameters: &'a [f64],
    state: &'a [f64],
}

impl At<'_> {
    fn value(&self, expression: Expression, states: &[f64]) -> f64 {
        let point = Point {
            states,
            parameters: self.parameters,
            time: f64::NAN,
        };
        self.graph.evaluate(expression, &point)
    }

    /// Derivatives of a vector of expressions, one an axis.
    fn rows(&mut self, of: &[Expression]) -> Result<Vec<Vec<f64>>, FixedPointFault> {
        let mut rows = Vec::with_capacity(of.len());
        for (axis, &expression) in of.iter().enumerate() {
            let mut row = Vec::with_capacity(self.state.len());
            for by in 0..self.state.len() {
                let slope = self.graph.derivative(expression, Symbol::State(by));
                let slope = slope.map_err(|_| FixedPointFault::Rough { axis })?;
                row.push(self.value(slope.value, self.state));
            }
            rows.push(row);
        }
        Ok(rows)
    }

    /// The axis along which the state moves most.
    fn most_moved(&self, drift: &[Expression], noise: &[Vec<Expression>]) -> FixedPointFault {
        let of_axis = |axis: usize| {
            let amplitudes = noise.iter().map(|process| process[axis]);
            let amplitudes = amplitudes.map(|one| self.value(one, self.state).abs());
            // The sum makes a zero of either sign the same.
            let moved = self.value(drift[axis], self.state) + 0.0;
            (axis, moved, amplitudes.fold(0.0, f64::max))
        };
        // What is not a number is more than any number.
        let most = (0..drift.len()).map(of_axis).max_by(|a, b| {
            let size = |one: &(usize, f64, f64)| one.1.abs() + one.2;
            size(a).total_cmp(&size(b))
        });
        let (axis, drift, noise) = most.unwrap_or((0, f64::NAN, f64::NAN));
        FixedPointFault::Moves { axis, drift, noise }
    }

    /// Nothing, if functions that vanish at the state are what their derivatives say beside it: at a kink or a jump
    /// they are not.
    fn hold(&self, of: &[Expression], rows: &[Vec<f64>]) -> Result<(), FixedPointFault> {
        let most = size(rows);
        for (axis, (&expression, row)) in of.iter().zip(rows).enumerate() {
            let rough = FixedPointFault::Rough { axis };
            if row.iter().any(|slope| !slope.is_finite()) {
                return Err(rough);
            }
            let about = self.value(expression, self.state);
            for direction in DIRECTIONS {
                let step = |axis: usize| {
                    let along = direction.get(axis % 2).copied().unwrap_or(0.0);
                    along * STEP * self.state[axis].abs().max(1.0)
                };
                let beside = (0..self.state.len()).map(|axis| self.state[axis] + step(axis));
                let value = self.value(expression, &beside.collect::<Vec<_>>());
                // A function that ends at the state, as a square root does, has one side alone.
                let linear: f64 = (0..row.len()).map(|axis| row[axis] * step(axis)).sum();
                let off = (value - about - linear).abs();
                if off > CURVATURE * STEP * most.max(1.0) {
                    return Err(rough);
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Family, Interpretation, ParameterDescription, Path, TypedModel};

    /// Of x' = y, y' = the text, with a noise on y, at a = 0.5.
    fn about(drift: &str, noise: &str, state: [f64; 2]) -> Result<Linearised, FixedPointFault> {
        let model = TypedModel::new("own", "own", ["x", "y"])
            .with_equation("x", "y")
            .with_equation("y", drift)
            .with_noise("y", [noise])
            .with_interpretation(Interpretation::Stratonovich)
            .with_parameters([ParameterDescription::from("a")])
            .build();
        let path = Path::parameter("a", 0.0, 1.0);
        let family = Family::new(model.unwrap(), &[], path).unwrap();
        family.linearised(0.5, &state)
    }

    #[test]
    fn derivatives_are_those_of_the_ito_drift() {
        let found = about("-sin(x) - a y^3 - y", "0.4 y + 0.3 x", [0.0, 0.0]).unwrap();
        // Stratonovich's reading adds ½ b ∂b/∂y = 0.2 (0.4 y + 0.3 x).
        let expected = [[0.0, 1.0], [-1.0 + 0.06, -1.0 + 0.08]];
        for (row, expected) in found.drift.iter().zip(expected) {
            for (entry, expected) in row.iter().zip(expected) {
                assert!((entry - expected).abs() < 1e-15, "{found:?}");
            }
        }
        assert_eq!(found.noises, [[[0.0, 0.0], [0.3, 0.4]]]);
        // Elsewhere than at the origin: x³ = a x at x = ±√a.
        let root = 0.5f64.sqrt();
        let found = about("a x - x^3 - y", "x^2 - a", [root, 0.0]).unwrap();
        assert!((found.drift[1][0] + 1.0).abs() < 1e-14);
        assert!((found.noises[0][1][0] - 2.0 * root).abs() < 1e-14);
    }

    #[test]
    fn states_that_move_are_refused_with_how_fast() {
        let moves = about("-x - y + 0.25", "x", [0.0, 0.0]);
        let (axis, drift, noise) = (1, 0.25, 0.0);
        assert_eq!(moves, Err(FixedPointFault::Moves { axis, drift, noise }));
        let moves = about("-x - y", "x + 2 a", [0.0, 0.0]);
        let (drift, noise) = (0.0, 1.0);
        assert_eq!(moves, Err(FixedPointFault::Moves { axis, drift, noise }));
        let moves = about("-x - sin(y)/y + 1", "x", [0.0, 0.0]);
        assert!(
            matches!(moves, Err(FixedPointFault::Moves { .. })),
            "{moves:?}"
        );
    }

    #[test]
    fn kinks_and_jumps_at_the_state_are_refused_and_what_is_smooth_in_spite_of_a_magnitude_is_not()
    {
        for drift in [
            "-x - abs(y)",
            "-x - sign(y) sqrt(abs(y))",
            "-x - sign(y)",
            "-min(x, 2 x)",
        ] {
            let found = about(drift, "x", [0.0, 0.0]);
            assert_eq!(found, Err(FixedPointFault::Rough { axis: 1 }), "{drift}");
        }
        let noise = about("-x - y", "abs(x)", [0.0, 0.0]);
        assert_eq!(noise, Err(FixedPointFault::Rough { axis: 1 }));
        for drift in ["-x - y abs(y)", "-x - y - abs(x - 1) + 1 - x"] {
            assert!(about(drift, "x", [0.0, 0.0]).is_ok(), "{drift}");
        }
    }
}
