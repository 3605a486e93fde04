//! Systems with one axis: the steady state by quadrature, which has all its digits in every cell.

use std::sync::Arc;

use super::trail::{self, Trail};
use crate::continuation::Solution;
use crate::density::{Moments, estimate_from_difference};
use crate::generator::one_axis;
use crate::method::report::Reporter;
use crate::method::structure::structure;
use crate::method::{MethodError, Problem, State};
use crate::system::{SwitchingSurface, System};

/// Largest relative error of a cell that the quadrature may have; where noise nearly vanishes, or the drift jumps inside a cell,
/// the generator serves better.
const LARGEST_ERROR: f64 = 1e-6;

/// The solution at a value; `None` where the system has more axes, or pushes mass out of the range.
pub(super) fn solution(
    system: &dyn System,
    (value, method): (f64, &'static str),
    problem: &Problem,
    (closed_ends, kinked): (&[[bool; 2]], &[SwitchingSurface]),
) -> Option<Result<Solution<State>, MethodError>> {
    let space = problem.space();
    let [axis] = space.axes() else {
        return None;
    };
    let pushes_in = |at: f64, sign: f64| sign * system.drift_at(0.0, &[at])[0] > 0.0;
    let [low, high] = closed_ends.first().copied()?;
    if !((low || pushes_in(axis.from(), 1.0)) && (high || pushes_in(axis.to(), -1.0))) {
        return None;
    }
    let found = one_axis(system, axis).filter(|found| found.error < LARGEST_ERROR)?;
    let masses = &found.masses;
    let mut reporter = Reporter::new(method, space);
    reporter.report.residual = 0.0;
    reporter.report.solver_error = found.error;
    reporter.edge_mass(masses, closed_ends);
    let difference: Vec<f64> = masses.iter().map(|mass| mass * found.error).collect();
    let densities = problem.observables().iter().map(|&observable| {
        let mut estimated = estimate_from_difference(space, observable, masses, &difference)?;
        estimated.structure = structure(system, space, masses, observable, kinked);
        estimated.negligible = 0.0;
        Ok(estimated)
    });
    let densities: Result<Vec<_>, MethodError> = densities.collect();
    let mass = Arc::new(masses.clone());
    let point = trail::Solved {
        value,
        mass: mass.clone(),
        difference,
    };
    let moments = Moments {
        mean: found.moments.0,
        standard_deviation: found.moments.1.max(0.0).sqrt(),
    };
    Some(densities.map(|densities| Solution {
        report: reporter.report,
        moments: vec![moments],
        densities,
        state: Some(State {
            mass,
            trail: Trail::default().with(point, None),
        }),
    }))
}
