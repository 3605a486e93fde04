//! Derivative of the generator by a parameter, or by the coordinate of a path.

use super::assemble::assemble_within;
use super::{Generator, GeneratorError, GeneratorOptions};
use crate::space::CellSpace;
use std::sync::Arc;

use crate::system::{System, SystemError};

/// First step, relative to the parameter (to `LEAST` where that is smaller).
const FIRST_STEP: f64 = 0.05;
/// Size below which a parameter is not taken as its own scale.
const LEAST: f64 = 1e-2;
/// Ratio of one step to the next, and the most steps that are tried.
const SHRINK: f64 = 0.25;
const STEPS: usize = 8;
/// Change between two steps, relative in the 1-norm, at which the derivative is accepted.
const ACCEPTED: f64 = 1e-11;

/// dQ/dθ at `value` and the derivative of the escape rates, for systems that depend on one number, with the pattern of
/// Q, Ω and its walls held.
///
/// Q is linear in some parameters and analytic in the rest, so a fourth-order central difference with a step
/// that shrinks until two steps agree reaches nine digits or more; it is exact to rounding where Q is linear.
///
/// # Errors
/// Any [`GeneratorError`]; [`GeneratorError::System`] where there are no systems on both sides of the value.
pub fn assemble_derivative(
    system_at: impl Fn(f64) -> Result<Arc<dyn System>, SystemError>,
    value: f64,
    space: &CellSpace,
    options: &GeneratorOptions,
) -> Result<Generator, GeneratorError> {
    let walls = system_at(value)?;
    let at = |value: f64| assemble_within(&*walls, &*system_at(value)?, space, options);
    let difference = |step: f64| -> Result<Generator, GeneratorError> {
        let mut sum = at(value + step)?;
        scale(&mut sum, 8.0 / (12.0 * step));
        for (steps, weight) in [(-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
            add(&mut sum, weight / (12.0 * step), &at(value + steps * step)?);
        }
        Ok(sum)
    };
    let mut step = FIRST_STEP * value.abs().max(LEAST);
    let mut best = difference(step).map(|first| (f64::INFINITY, first));
    for _ in 1..STEPS {
        step *= SHRINK;
        let next = difference(step);
        best = match (best, next) {
            (Ok((error, old)), Ok(next)) => {
                let change = distance(&old, &next);
                if change > error {
                    // Rounding has taken over.
                    return Ok(old);
                }
                if change <= ACCEPTED {
                    return Ok(next);
                }
                Ok((change, next))
            }
            // A step that left the parameter's range: a shorter one may not.
            (Err(_), next) => next.map(|next| (f64::INFINITY, next)),
            (Ok(found), Err(_)) => return Ok(found.1),
        };
    }
    best.map(|(_, derivative)| derivative)
}

fn scale(generator: &mut Generator, factor: f64) {
    generator.matrix.scale(factor);
    generator.escape.iter_mut().for_each(|rate| *rate *= factor);
}

/// Adds a multiple of a generator of the same pattern.
fn add(sum: &mut Generator, factor: f64, other: &Generator) {
    let pairs = sum.matrix.data_mut().iter_mut().zip(other.matrix.data());
    for (sum, other) in pairs {
        *sum += factor * other;
    }
    for (sum, other) in sum.escape.iter_mut().zip(&other.escape) {
        *sum += factor * other;
    }
}

/// Relative 1-norm of the difference of two matrices of the same pattern.
fn distance(a: &Generator, b: &Generator) -> f64 {
    let pairs = a.matrix.data().iter().zip(b.matrix.data());
    let (mut difference, mut size) = (0.0, 0.0);
    for (a, b) in pairs {
        difference += (a - b).abs();
        size += b.abs();
    }
    if size > 0.0 { difference / size } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::{Family, Path, registry};

    /// How far the integral of dQ/dθ over an interval is from the difference of Q between its ends.
    fn mismatch(family: &Family, ranges: &[(f64, f64)]) -> f64 {
        let axes = ranges
            .iter()
            .map(|&(from, to)| Axis::uniform(from, to, 10).unwrap());
        let space = CellSpace::new(axes.collect()).unwrap();
        let options = GeneratorOptions::default();
        let derivative =
            |value| assemble_derivative(|at| family.at(at), value, &space, &options).unwrap();
        let (from, to) = family.ends();
        let (value, half) = (0.5 * (from + to), 0.5 * (to - from));
        let at = |value: f64| {
            let system = family.at(value).unwrap();
            assemble_within(&*system, &*system, &space, &options).unwrap()
        };
        let gauss = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189),
            (-0.538_469_310_105_683, 0.478_628_670_499_366),
            (0.0, 0.568_888_888_888_889),
            (0.538_469_310_105_683, 0.478_628_670_499_366),
            (0.906_179_845_938_664, 0.236_926_885_056_189),
        ];
        let mut integral = derivative(value);
        scale(&mut integral, 0.0);
        for (place, weight) in gauss {
            add(
                &mut integral,
                half * weight,
                &derivative(value + half * place),
            );
        }
        let mut difference = at(to);
        add(&mut difference, -1.0, &at(from));
        distance(&difference, &integral)
    }

    #[test]
    fn the_derivative_integrates_to_the_difference() {
        let coulomb = [
            ("kappa", 0.1),
            ("f_c", 0.02),
            ("mu", 0.1),
            ("sigma2", 0.3),
            ("alpha", 1.0),
        ];
        let ranges = [(-2.0, 2.0), (-2.0, 2.0)];
        for (parameter, value) in coulomb {
            let fixed: Vec<_> = coulomb
                .into_iter()
                .filter(|one| one.0 != parameter)
                .collect();
            let path = Path::parameter(parameter, 0.9 * value, 1.1 * value);
            let model = registry::find("coulomb").unwrap();
            let family = Family::new(model, &fixed, path).unwrap();
            let error = mismatch(&family, &ranges);
            assert!(error < 1e-9, "{parameter}: {error:e}");
        }
        // Along a curve on which two parameters move at once.
        let path = Path::curve("s", "s", ["f_c", "sigma2"], (0.18, 0.22), |s: f64| {
            vec![s * s, 0.1 + s]
        });
        let model = registry::find("coulomb").unwrap();
        let family = Family::new(model, &[("kappa", 0.1)], path).unwrap();
        let error = mismatch(&family, &ranges);
        assert!(error < 1e-9, "{error:e}");
    }

    #[test]
    fn without_systems_beside_the_value_there_is_no_derivative() {
        let path = Path::parameter("sigma2", 0.1, 0.2);
        let model = registry::find("bistable").unwrap();
        let family = Family::new(model, &[("a", 0.0)], path).unwrap();
        let space = CellSpace::new(vec![Axis::uniform(-1.0, 1.0, 10).unwrap()]).unwrap();
        let options = GeneratorOptions::default();
        let result = assemble_derivative(|at| family.at(at), 0.0, &space, &options);
        assert!(matches!(result, Err(GeneratorError::System(_))));
    }
}
