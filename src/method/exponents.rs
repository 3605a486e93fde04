//! Largest Lyapunov exponents that need no cells, at every value of a session that is asked for them: that of a fixed
//! point, and that along the stationary density by free trajectories.
//!
//! Below its D-bifurcation the fixed point attracts almost every path beside it, and what noise brings there stays: no
//! cells hold such a steady state, so that none is looked for.

use super::{MethodError, Problem};
use crate::cancellation::Cancellation;
use crate::continuation::measure::{DIVERGENCE, EXPONENT};
use crate::continuation::{
    Finding, Measure, PointStatus, Session, Solution, SolveReport, SourceError,
};
use crate::exponent::{Exponent, ExponentError, largest, of_family};
use crate::monte_carlo::{TangentRun, exponent_along_trajectories, relaxation};
use crate::system::{ExponentMethod, FixedPointFault};

/// A session whose reports have the exponent.
pub(super) struct WithExponents {
    pub(super) session: Box<dyn Session>,
    pub(super) problem: Problem,
    pub(super) cancellation: Cancellation,
    pub(super) method: &'static str,
    /// Whether the last value was handed on to the session.
    pub(super) was_solved: bool,
}

impl Session for WithExponents {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        self.was_solved = false;
        let Some(found) = of_family(self.problem.family(), value) else {
            return self.along_trajectories(value);
        };
        if let Ok(exponent) = &found
            && exponent.attracts()
        {
            let mut report = SolveReport::solved(self.method);
            report.status = PointStatus::NoSteadyState;
            report.findings.push(Finding::PointMass {
                exponent: exponent.value,
                error: exponent.error,
            });
            report.put(measure(*exponent));
            return Ok(Solution::without_density(report));
        }
        self.was_solved = true;
        let mut solution = self.session.solve(value)?;
        match found {
            Ok(exponent) => solution.report.put(measure(exponent)),
            Err(error) => solution.report.findings.push(finding(&error)),
        }
        Ok(solution)
    }

    fn seconds(&self) -> Option<f64> {
        self.was_solved.then(|| self.session.seconds()).flatten()
    }

    fn memory(&self) -> Vec<u8> {
        match self.was_solved {
            true => self.session.memory(),
            false => Vec::new(),
        }
    }

    fn recall(&mut self, left: &[(f64, &[u8])]) -> Result<(), SourceError> {
        self.session.recall(left)
    }
}

impl WithExponents {
    /// Solves, and follows trajectories where there is a steady state.
    fn along_trajectories(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        self.was_solved = true;
        let mut solution = self.session.solve(value)?;
        let report = &mut solution.report;
        if report.status.is_resolved() && !self.problem.subject().measures.is_empty() {
            match by_trajectories(&self.problem, value, &self.cancellation)? {
                Some([exponent, divergence]) => {
                    report.put(measure(exponent));
                    report.put(Measure {
                        error: Some(divergence.error),
                        ..DIVERGENCE.measure("", divergence.value)
                    });
                }
                None => report.findings.push(Finding::NoExponent),
            }
        }
        Ok(solution)
    }
}

/// Seed of the trajectories: the same at all values, so that exponents of neighbours differ by less than by chance.
const SEED: u64 = 1;

/// Exponent and divergence along the stationary density; `None` where trajectories do not stay.
fn by_trajectories(
    problem: &Problem,
    value: f64,
    cancellation: &Cancellation,
) -> Result<Option<[Exponent; 2]>, MethodError> {
    let (family, space) = (problem.family(), problem.space());
    let system = family.at(value)?;
    let units = vec![1.0; system.dimension()];
    let by = ExponentMethod::Trajectories;
    let Ok(tangent) = family.tangent(value, &system, (&units, by)) else {
        return Ok(None);
    };
    let relaxed = relaxation(system.as_ref(), space, SEED, cancellation)?;
    if relaxed.settled_states().is_empty() {
        return Ok(None);
    }
    let run = TangentRun::of_steps(family.questions.exponent_steps, &relaxed, SEED);
    let both = (system.as_ref(), &tangent);
    let starts = relaxed.settled_states();
    let found = exponent_along_trajectories(both, space, starts, &run, cancellation)?;
    let exact = tangent.linear().and_then(|linear| largest(&linear).ok());
    Ok(found.map(|rates| {
        let [exponent, divergence] = rates.map(|rate| Exponent {
            value: rate.value,
            error: rate.error(),
        });
        [exact.unwrap_or(exponent), divergence]
    }))
}

fn measure(exponent: Exponent) -> Measure {
    Measure {
        error: Some(exponent.error),
        ..EXPONENT.measure("", exponent.value)
    }
}

fn finding(error: &ExponentError) -> Finding {
    match *error {
        ExponentError::FixedPoint(FixedPointFault::Moves { axis, drift, noise }) => {
            Finding::NoFixedPoint { axis, drift, noise }
        }
        ExponentError::FixedPoint(_) | ExponentError::Axes { .. } => Finding::NoExponent,
    }
}
