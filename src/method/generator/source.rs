//! The generator as a source of densities: assemble Q, solve Q u = 0 with the neighbour's factorisation, and state
//! the error of the grid as the difference to a second scheme.
//!
//! The slope du/dθ, which predicts the neighbour, and the difference to the second scheme come from the factorisation
//! that is there: Q du = -(dQ/dθ) u, and with the second scheme's Q' = Q + δQ to first order Q δu = -(δQ) u. After the
//! first point a polynomial through the last few points replaces the tangent: it predicts better and costs nothing.
//! The difference is predicted likewise, and iterated only as far as the prediction is not good enough.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::GeneratorMethodOptions;
use super::one_axis;
use super::relaxation::Relaxation;
use super::trail::{self, Trail};
use crate::continuation::{DensitySource, Solution, SourceError, Subject};
use crate::density::{EstimatedDensity, Moments, Observable, estimate_from_difference};
use crate::generator::{
    AdvectiveScheme, Generator, GeneratorOptions, assemble, assemble_derivative, cell_masses,
    resolution, unknown_moments,
};
use crate::method::report::{QUIET_ESCAPE, Reporter};
use crate::method::structure::{closed_ends, kinked_surfaces, structure};
use crate::method::{MethodError, Problem, State, autonomous};
use crate::space::CellSpace;
use crate::stationary::generator::{RateInfo, RateOptions, RateSolver, RateSteadyState};
use crate::system::{SwitchingSurface, System};

/// Name of the method in tables.
const METHOD: &str = "generator";

/// Escape per unit time below which mass is said to stay in Ω, and relaxation is not looked at.
const NO_ESCAPE: f64 = 1e-12;

/// Relative error of slopes, which predict, and of differences between schemes, which estimate errors.
const ROUGH: f64 = 1e-2;

/// Cells an axis of the finer grid over those of this one, in up to two dimensions and in more.
const FINER: [f64; 2] = [1.5, 1.25];

/// Densities along one parameter by the generator.
pub struct GeneratorSource {
    problem: Problem,
    options: GeneratorMethodOptions,
    closed_ends: Vec<[bool; 2]>,
    kinked: Vec<SwitchingSurface>,
    solver: Mutex<RateSolver>,
    cancelled: Arc<AtomicBool>,
}

/// What was solved at one point.
struct Solved {
    value: f64,
    system: Arc<dyn System>,
    steady: RateSteadyState,
    /// The generator by the second scheme.
    second: Generator,
}

impl GeneratorSource {
    /// Prepares a source. Setting `cancelled` makes the next solve return [`SourceError::Interrupted`].
    ///
    /// # Errors
    /// [`MethodError`].
    pub fn new(
        problem: &Problem,
        options: &GeneratorMethodOptions,
        cancelled: Arc<AtomicBool>,
    ) -> Result<Self, MethodError> {
        let (systems, space) = (problem.family().along()?, problem.space());
        autonomous(&systems)?;
        let rates = RateOptions {
            tolerance: options.solver_tolerance,
            memory_limit_bytes: (options.memory_limit * 1e9) as u64,
            ..RateOptions::default()
        };
        Ok(Self {
            problem: problem.clone(),
            options: options.clone(),
            closed_ends: closed_ends(&systems, space),
            kinked: kinked_surfaces(&systems, space),
            solver: Mutex::new(RateSolver::new(space.clone(), rates)),
            cancelled,
        })
    }

    fn assemble(
        &self,
        system: &dyn System,
        scheme: AdvectiveScheme,
    ) -> Result<Generator, MethodError> {
        let options = GeneratorOptions { scheme };
        Ok(assemble(system, self.problem.space(), &options)?)
    }

    fn try_solve(&self, value: f64, start: Option<&State>) -> Result<Solution<State>, MethodError> {
        let system = self.problem.family().at(value)?;
        let known = (self.closed_ends.as_slice(), self.kinked.as_slice());
        if let Some(solution) =
            one_axis::solution(system.as_ref(), (value, METHOD), &self.problem, known)
        {
            return solution;
        }
        let generator = self.assemble(system.as_ref(), self.options.scheme)?;
        let trail = start.map(|state| &state.trail);
        let guess = trail.and_then(|trail| trail.mass_at(value));
        // A panic elsewhere cannot leave a factorisation half-made that would be used: every solve checks its result.
        let mut solver = self.solver.lock().unwrap_or_else(PoisonError::into_inner);
        let rates = &mut *solver;
        // The solve leaves a core idle most of the time.
        let (steady, second) = rayon::join(
            || rates.solve(&generator.matrix, &generator.escape, guess.as_deref()),
            || self.assemble(system.as_ref(), companion(self.options.scheme)),
        );
        let solved = Solved {
            value,
            system,
            steady: steady?,
            second: second?,
        };
        let mut solution = self.solution(&mut solver, &solved, trail)?;
        if let (Some(state), None) = (&mut solution.state, start) {
            state.trail.slope = self.slope(&mut solver, &solved).map(Arc::new);
        }
        Ok(solution)
    }

    /// Judges a solution and turns it into densities.
    fn solution(
        &self,
        solver: &mut RateSolver,
        solved: &Solved,
        before: Option<&Trail>,
    ) -> Result<Solution<State>, MethodError> {
        let space = self.problem.space();
        let info = &solved.steady.info;
        let unknowns = &solved.steady.mass;
        let mut reporter = self.reporter(info);
        let finite = unknowns.iter().all(|value| value.is_finite());
        if !info.converged || !finite {
            reporter.not_converged(info.error_estimate);
        }
        if !finite {
            return Ok(Solution::without_density(reporter.report));
        }
        let relaxation = relaxation(solver, solved, before);
        let time = relaxation.as_ref().map(|known| known.time);
        let Some(share) = reporter.escaping_share(time, self.options.escape_limit) else {
            return Ok(Solution::without_density(reporter.report));
        };
        reporter.escaping(share);
        let masses = cell_masses(solved.system.as_ref(), space, unknowns);
        reporter.edge_mass(&masses, &self.closed_ends);
        for judged in resolution(solved.system.as_ref(), space, &masses) {
            reporter.resolution(&judged);
        }
        let expected = before.and_then(|trail| trail.difference_at(solved.value));
        let (densities, difference) =
            self.densities(solver, solved, &masses, expected.as_deref())?;
        let watched = densities
            .iter()
            .map(|one| negative_mass(&one.density.masses()));
        reporter.negative_mass(negative_mass(&masses), watched.fold(0.0, f64::max));
        Ok(Solution {
            report: reporter.report,
            moments: moments_of(space, unknowns),
            densities,
            state: Some(state(solved, difference, relaxation, before)),
        })
    }

    /// The numbers of a solve.
    fn reporter(&self, info: &RateInfo) -> Reporter<'_> {
        let mut reporter = Reporter::new(METHOD, self.problem.space());
        let report = &mut reporter.report;
        report.iterations = info.iterations;
        report.residual = info.residual;
        report.solver_error = info.error_estimate;
        report.escape_rate = info.escape_rate.max(0.0);
        report.own.factorisations = info.factorisations;
        report.own.negative_mass = info.negative_mass;
        reporter
    }

    /// Densities with the difference to the second scheme as their error, and that difference of the unknowns.
    fn densities(
        &self,
        solver: &mut RateSolver,
        solved: &Solved,
        masses: &[f64],
        expected: Option<&[f64]>,
    ) -> Result<(Vec<EstimatedDensity>, Vec<f64>), MethodError> {
        let (system, space) = (solved.system.as_ref(), self.problem.space());
        let unknowns = &solved.steady.mass;
        let change = solver.sensitivity_within(&solved.second.matrix, unknowns, expected, ROUGH)?;
        let changed: Vec<f64> = unknowns.iter().zip(&change).map(|(u, du)| u + du).collect();
        let changed = cell_masses(system, space, &changed);
        let difference: Vec<f64> = changed.iter().zip(masses).map(|(b, a)| b - a).collect();
        let estimate = |&observable: &Observable| {
            let mut estimated = estimate_from_difference(space, observable, masses, &difference)?;
            estimated.structure = structure(system, space, masses, observable, &self.kinked);
            Ok::<_, MethodError>(estimated)
        };
        let densities: Result<Vec<_>, MethodError> =
            self.problem.observables().iter().map(estimate).collect();
        Ok((densities?, change))
    }

    /// du/dθ at the solution; `None` where Q cannot be varied (at an end of the parameter's range) or the
    /// solve fails: the neighbour then starts without a prediction.
    fn slope(&self, solver: &mut RateSolver, solved: &Solved) -> Option<Vec<f64>> {
        let options = GeneratorOptions {
            scheme: self.options.scheme,
        };
        let (family, space) = (self.problem.family(), self.problem.space());
        let derivative =
            assemble_derivative(|value| family.at(value), solved.value, space, &options).ok()?;
        let mass = &solved.steady.mass;
        solver
            .sensitivity_within(&derivative.matrix, mass, None, ROUGH)
            .ok()
    }
}

/// The time in which deviations die out, where mass escapes: a neighbour's where it will do.
fn relaxation(
    solver: &mut RateSolver,
    solved: &Solved,
    before: Option<&Trail>,
) -> Option<Relaxation> {
    let rate = solved.steady.info.escape_rate;
    let neighbour = before.and_then(|trail| trail.relaxation.as_deref());
    if rate <= NO_ESCAPE {
        return None;
    }
    neighbour
        .and_then(|known| Relaxation::carried(known, rate, QUIET_ESCAPE))
        .or_else(|| Relaxation::compute(solver, &solved.steady.mass, neighbour))
}

/// What a point leaves for its neighbour, with the points before.
fn state(
    solved: &Solved,
    difference: Vec<f64>,
    relaxation: Option<Relaxation>,
    before: Option<&Trail>,
) -> State {
    let mass = Arc::new(solved.steady.mass.clone());
    let point = trail::Solved {
        value: solved.value,
        mass: mass.clone(),
        difference,
    };
    // What has not converged is no start for an extrapolation.
    let trail = before.filter(|_| solved.steady.info.converged).cloned();
    State {
        mass,
        trail: trail
            .unwrap_or_default()
            .with(point, relaxation.map(Arc::new)),
    }
}

/// Σ |min(mass, 0)|.
fn negative_mass(masses: &[f64]) -> f64 {
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

    fn subject(&self) -> &Subject {
        self.problem.subject()
    }

    fn solve(&self, value: f64, start: Option<&State>) -> Result<Solution<State>, SourceError> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(SourceError::Interrupted);
        }
        self.try_solve(value, start)
            .map_err(|error| SourceError::Method(error.into()))
    }

    fn finer(&self) -> Option<Self> {
        let space = self.problem.space();
        let factor = FINER[usize::from(space.dimension() > 2)];
        let axes = space.axes().iter();
        let finer = CellSpace::new(axes.map(|axis| axis.refined(factor)).collect()).ok()?;
        let problem = self.problem.on(finer).ok()?;
        Self::new(&problem, &self.options, self.cancelled.clone()).ok()
    }

    fn state_bytes(&self, state: &State) -> usize {
        state.bytes()
    }
}
