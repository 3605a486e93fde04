//! The generator as a source of densities: assemble Q, solve Q u = 0 with the neighbour's factorisation, and state
//! the error of the grid as the difference to a second scheme.
//!
//! The slope du/dθ, which predicts the neighbour, and the difference to the second scheme come from the factorisation
//! that is there: Q du = -(dQ/dθ) u, and with the second scheme's Q' = Q + δQ to first order Q δu = -(δQ) u. After the
//! first point the secant through the neighbour replaces the tangent: it predicts as well and costs nothing.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::findings::{Findings, closed_ends};
use super::relaxation::relaxation_time;
use super::{GeneratorMethodOptions, MethodError, Setting, State};
use crate::continuation::{DensitySource, PointStatus, Solution, SolveReport, SourceError};
use crate::density::{EstimatedDensity, Moments, Observable, estimate_from_difference};
use crate::generator::{
    AdvectiveScheme, Generator, GeneratorOptions, assemble, assemble_derivative, cell_masses,
    resolution, unknown_moments,
};
use crate::space::CellSpace;
use crate::stationary::rates::{RateOptions, RateSolver, RateSteadyState};
use crate::system::{Model, ParameterValues, System};

/// Name of the method in tables.
const METHOD: &str = "generator";

/// Escape per unit time below which mass is said to stay in Ω, and relaxation is not looked at.
const NO_ESCAPE: f64 = 1e-12;

/// Relative error of slopes, which predict, and of differences between schemes, which estimate errors.
const ROUGH: f64 = 1e-2;

/// Share of the mass that may leave within one relaxation time without a word.
pub(super) const QUIET_ESCAPE: f64 = 1e-3;

/// Densities along one parameter by the generator.
pub struct GeneratorSource {
    model: &'static Model,
    values: ParameterValues,
    parameter: String,
    space: CellSpace,
    observables: Vec<Observable>,
    options: GeneratorMethodOptions,
    closed_ends: Vec<[bool; 2]>,
    solver: Mutex<RateSolver>,
    cancelled: Arc<AtomicBool>,
}

/// What was solved at one point.
struct Solved {
    values: ParameterValues,
    system: Arc<dyn System>,
    steady: RateSteadyState,
}

impl GeneratorSource {
    /// Prepares a source. Setting `cancelled` makes the next solve return [`SourceError::Interrupted`].
    ///
    /// # Errors
    /// [`MethodError`] when the ends of the range are not allowed or an observable names an axis that does not
    /// exist.
    pub fn new(
        setting: &Setting<'_>,
        options: &GeneratorMethodOptions,
        cancelled: Arc<AtomicBool>,
    ) -> Result<Self, MethodError> {
        for &observable in setting.observables {
            crate::density::Projection::new(setting.space, observable)?;
        }
        let systems = setting.systems_along()?;
        let rates = RateOptions {
            tolerance: options.solver_tolerance,
            memory_limit_bytes: (options.memory_limit * 1e9) as u64,
            ..RateOptions::default()
        };
        Ok(Self {
            model: setting.model,
            values: setting.values.clone(),
            parameter: setting.parameter.to_owned(),
            space: setting.space.clone(),
            observables: setting.observables.to_vec(),
            options: options.clone(),
            closed_ends: closed_ends(&systems, setting.space),
            solver: Mutex::new(RateSolver::new(setting.space.clone(), rates)),
            cancelled,
        })
    }

    fn assemble(
        &self,
        system: &dyn System,
        scheme: AdvectiveScheme,
    ) -> Result<Generator, MethodError> {
        Ok(assemble(system, &self.space, &GeneratorOptions { scheme })?)
    }

    fn try_solve(&self, value: f64, start: Option<&State>) -> Result<Solution<State>, MethodError> {
        let values = self.model.with(&self.values, &self.parameter, value)?;
        let system = self.model.system(&values);
        let generator = self.assemble(system.as_ref(), self.options.scheme)?;
        let guess = start.map(|state| state.predicted(value));
        // A panic elsewhere cannot leave a factorisation half-made that would be used: every solve checks its result.
        let mut solver = self.solver.lock().unwrap_or_else(PoisonError::into_inner);
        let steady = solver.solve(&generator.matrix, &generator.escape, guess.as_deref())?;
        let solved = Solved {
            values,
            system,
            steady,
        };
        let mut solution = self.report(&mut solver, value, &solved)?;
        if let Some(state) = &mut solution.state {
            state.slope = match start {
                Some(start) => Some(start.secant(state)),
                None => self.slope(&mut solver, &solved),
            };
        }
        Ok(solution)
    }

    /// Judges a solution and turns it into densities.
    fn report(
        &self,
        solver: &mut RateSolver,
        value: f64,
        solved: &Solved,
    ) -> Result<Solution<State>, MethodError> {
        let info = &solved.steady.info;
        let unknowns = &solved.steady.mass;
        let mut report = SolveReport {
            status: PointStatus::Solved,
            method: METHOD,
            iterations: info.iterations,
            factorisations: info.factorisations,
            residual: info.residual,
            escape_rate: info.escape_rate.max(0.0),
            negative_mass: info.negative_mass,
            edge_mass: Vec::new(),
            numerical_diffusion: Vec::new(),
            map_step: None,
            time_step_bias: None,
            warnings: Vec::new(),
        };
        let mut findings = Findings::new(self.model, &self.space);
        let finite = unknowns.iter().all(|value| value.is_finite());
        if !info.converged || !finite {
            report.status = PointStatus::NotConverged;
            findings.not_converged(info.error_estimate);
        }
        let relaxation = if report.escape_rate > NO_ESCAPE && finite {
            relaxation_time(solver, unknowns)
        } else {
            None
        };
        let escaping_share = relaxation.map_or(0.0, |time| report.escape_rate * time);
        let leaves = escaping_share > self.options.escape_limit;
        if leaves {
            findings.no_steady_state(report.escape_rate, relaxation, self.options.escape_limit);
            report.status = PointStatus::NoSteadyState;
        }
        if leaves || !finite {
            report.warnings = findings.into_sentences();
            return Ok(Solution {
                report,
                moments: Vec::new(),
                densities: Vec::new(),
                state: None,
            });
        }
        if escaping_share > QUIET_ESCAPE {
            if report.status == PointStatus::Solved {
                report.status = PointStatus::Escaping;
            }
            findings.escaping(report.escape_rate, escaping_share);
        }
        let masses = cell_masses(solved.system.as_ref(), &self.space, unknowns);
        report.negative_mass = masses.iter().map(|mass| (-mass).max(0.0)).sum();
        report.edge_mass = findings.edge_mass(&masses, &self.closed_ends);
        for judged in resolution(solved.system.as_ref(), &self.space, &masses) {
            findings.resolution(&judged);
        }
        let densities = self.densities(solver, solved, &masses)?;
        let watched = densities.iter().map(negative_mass).fold(0.0, f64::max);
        findings.negative_mass(report.negative_mass, watched);
        report.warnings = findings.into_sentences();
        Ok(Solution {
            report,
            moments: moments_of(&self.space, unknowns),
            densities,
            state: Some(State {
                value,
                slope: None,
                mass: unknowns.clone(),
            }),
        })
    }

    /// Densities with the difference to the second scheme as their error.
    fn densities(
        &self,
        solver: &mut RateSolver,
        solved: &Solved,
        masses: &[f64],
    ) -> Result<Vec<EstimatedDensity>, MethodError> {
        let system = solved.system.as_ref();
        let second = self.assemble(system, companion(self.options.scheme))?;
        let unknowns = &solved.steady.mass;
        let change = solver.sensitivity_within(&second.matrix, unknowns, ROUGH)?;
        let changed: Vec<f64> = unknowns.iter().zip(&change).map(|(u, du)| u + du).collect();
        let changed = cell_masses(system, &self.space, &changed);
        let difference: Vec<f64> = changed.iter().zip(masses).map(|(b, a)| b - a).collect();
        let estimate = |&observable: &Observable| {
            estimate_from_difference(&self.space, observable, masses, &difference)
        };
        let densities: Result<Vec<_>, _> = self.observables.iter().map(estimate).collect();
        Ok(densities?)
    }

    /// du/dθ at the solution; `None` where Q cannot be varied (at an end of the parameter's range) or the
    /// solve fails: the neighbour then starts without a prediction.
    fn slope(&self, solver: &mut RateSolver, solved: &Solved) -> Option<Vec<f64>> {
        let options = GeneratorOptions {
            scheme: self.options.scheme,
        };
        let (values, parameter) = (&solved.values, self.parameter.as_str());
        let derivative =
            assemble_derivative(self.model, values, parameter, &self.space, &options).ok()?;
        let mass = &solved.steady.mass;
        solver
            .sensitivity_within(&derivative.matrix, mass, ROUGH)
            .ok()
    }
}

/// Σ |min(mass, 0)| of a watched density.
fn negative_mass(estimate: &EstimatedDensity) -> f64 {
    let masses = estimate.density.masses();
    masses.iter().map(|mass| (-mass).max(0.0)).sum()
}

/// Moments from the unknowns, which are free of the h²/6 that moments of cell masses have.
fn moments_of(space: &CellSpace, unknowns: &[f64]) -> Vec<Moments> {
    unknown_moments(space, unknowns)
        .into_iter()
        .map(|(mean, variance)| Moments {
            mean,
            standard_deviation: variance.max(0.0).sqrt(),
        })
        .collect()
}

/// The scheme whose difference to the given one stands for its error.
fn companion(scheme: AdvectiveScheme) -> AdvectiveScheme {
    match scheme {
        AdvectiveScheme::Upwind5 | AdvectiveScheme::Central6 => AdvectiveScheme::Central4,
        AdvectiveScheme::Central4 => AdvectiveScheme::Central6,
    }
}

impl DensitySource for GeneratorSource {
    type State = State;

    fn solve(&self, value: f64, start: Option<&State>) -> Result<Solution<State>, SourceError> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(SourceError::Interrupted);
        }
        self.try_solve(value, start)
            .map_err(|error| SourceError::Method(error.into()))
    }
}
