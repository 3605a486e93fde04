//! Stochastic generalized cell mapping as a source of densities: sample the transition matrix, solve for its
//! steady state from the neighbour's, estimate the sampling error by leaving out groups of samples.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::slope_correction::{Corrected, solve_by};
use super::steps::{Steps, choose_steps};
use super::{Correction, SgcmOptions};
use crate::MAX_DIMENSION;
use crate::continuation::{DensitySource, Finding, Solution, SourceError, Subject};
use crate::density::{EstimatedDensity, estimate, moments};
use crate::method::generator::Trail;
use crate::method::report::Reporter;
use crate::method::structure::structure;
use crate::method::{MethodError, Problem, State};
use crate::sampling::{
    SampledTransitions, SamplingError, SamplingOptions, TransitionMatrix, sample_transitions,
};
use crate::space::CellSpace;
use crate::stationary::{Options, Outcome, SteadyState, second_eigenvalue};
use crate::system::System;

/// Name of the method in tables.
const METHOD: &str = "sgcm";

/// L1 error to which replicates are solved: far below any sampling error, which is all they are for.
const REPLICATE_TOLERANCE: f64 = 1e-7;

/// L1 change by a turn of the slope correction at which it ends, and that of replicates.
const CHANGE: f64 = 1e-6;
const REPLICATE_CHANGE: f64 = 1e-4;

/// Escape per map step below which mass is said to stay in Ω, and relaxation is not looked at.
const NO_ESCAPE: f64 = 1e-12;

/// Densities along one parameter by SGCM.
#[derive(Debug)]
pub struct SgcmSource {
    problem: Problem,
    options: SgcmOptions,
    steps: Steps,
    cancelled: Arc<AtomicBool>,
}

/// The sampled cell map at one parameter value, to be solved with either [`Correction`].
pub struct SampledPoint {
    system: Arc<dyn System>,
    transitions: SampledTransitions,
}

impl SampledPoint {
    /// The samples.
    pub fn transitions(&self) -> &SampledTransitions {
        &self.transitions
    }
}

impl SgcmSource {
    /// Prepares a source; steps left to the program are chosen here, once, so that the transition matrix varies
    /// smoothly along the sweep. Setting `cancelled` makes a running solve return [`SourceError::Interrupted`].
    ///
    /// # Errors
    /// [`MethodError`].
    pub fn new(
        problem: &Problem,
        options: &SgcmOptions,
        cancelled: Arc<AtomicBool>,
    ) -> Result<Self, MethodError> {
        let steps = choose_steps(problem, options)?;
        Ok(Self {
            problem: problem.clone(),
            options: options.clone(),
            steps,
            cancelled,
        })
    }

    /// The same source on other cells over the same ranges, with the steps that were chosen.
    ///
    /// # Errors
    /// [`MethodError`] when the cells have another number of axes.
    pub fn on(&self, space: &CellSpace) -> Result<Self, MethodError> {
        let problem = self.problem.on(space.clone())?;
        let mut steps = self.steps.clone();
        // Cells to grow from; all others that hold mass are reached from them.
        let centres = steps
            .cells
            .iter()
            .map(|&cell| self.problem.space().centre(cell));
        let mut cells: Vec<usize> = centres.filter_map(|centre| space.find(&centre)).collect();
        cells.sort_unstable();
        cells.dedup();
        steps.cells = cells;
        Ok(Self {
            problem,
            options: self.options.clone(),
            steps,
            cancelled: self.cancelled.clone(),
        })
    }

    /// Time one transition spans.
    pub fn map_step(&self) -> f64 {
        self.steps.map_step
    }

    /// Step of the trajectory integrator.
    pub fn time_step(&self) -> f64 {
        self.steps.time_step
    }

    fn sample(
        &self,
        system: &dyn System,
        start: Option<&[f64]>,
    ) -> Result<SampledTransitions, SamplingError> {
        let options = SamplingOptions {
            map_step: self.steps.map_step,
            time_step: self.steps.time_step,
            samples: self.options.samples,
            groups: self.options.replicates,
            seed: self.options.seed,
            integrator: self.options.integrator,
            keep_starts: self.options.correction == Correction::Slope,
        };
        // The pilot's cells are always among the seeds: a state that the neighbour did not have is then found too.
        let mut seeds = self.steps.cells.clone();
        if let Some(mass) = start {
            seeds.extend((0..mass.len()).filter(|&cell| mass[cell] > 0.0));
        }
        let cancelled = || self.cancelled.load(Ordering::Relaxed);
        sample_transitions(system, self.problem.space(), &seeds, &options, &cancelled)
    }

    /// Steady states without one group of samples each; fewer than asked for when one of them has none.
    fn replicates(
        &self,
        correction: Correction,
        transitions: &SampledTransitions,
        full: &SteadyState,
    ) -> Vec<Vec<f64>> {
        let options = Options::new(self.options.solver, REPLICATE_TOLERANCE);
        let replicate = |group: usize| {
            let start = Some(full.mass.as_slice());
            let solved = solve_by(
                correction,
                transitions,
                self.problem.space(),
                start,
                Some(group),
                (&options, REPLICATE_CHANGE),
            );
            match solved.map(|solved| solved.outcome) {
                Ok(Outcome::Steady(steady)) => Some(steady.mass),
                _ => None,
            }
        };
        (0..transitions.groups())
            .into_par_iter()
            .filter_map(replicate)
            .collect()
    }

    fn densities(
        &self,
        (system, transitions): (&dyn System, &SampledTransitions),
        correction: Correction,
        steady: &SteadyState,
    ) -> Result<(Vec<EstimatedDensity>, usize), MethodError> {
        let replicates = self.replicates(correction, transitions, steady);
        let usable: &[Vec<f64>] = if replicates.len() < 2 {
            &[]
        } else {
            &replicates
        };
        let densities: Result<Vec<_>, _> = self
            .problem
            .observables()
            .iter()
            .map(|&observable| {
                let mut estimated =
                    estimate(self.problem.space(), observable, &steady.mass, usable)?;
                let (mass, surfaces) = (&steady.mass, &self.steps.kinked);
                estimated.structure =
                    structure(system, self.problem.space(), mass, observable, surfaces);
                Ok::<_, MethodError>(estimated)
            })
            .collect();
        Ok((densities?, usable.len()))
    }

    fn solved(
        &self,
        (system, transitions): (&dyn System, &SampledTransitions),
        correction: Correction,
        matrix: &TransitionMatrix,
        slopes: &[[f64; MAX_DIMENSION]],
        steady: SteadyState,
    ) -> Result<Solution<State>, MethodError> {
        let info = &steady.info;
        let escape_rate = escape_rate(info.escape_per_step, self.steps.map_step);
        let relaxation_time = if info.escape_per_step > NO_ESCAPE {
            second_eigenvalue(matrix, &steady)?.relaxation_time
        } else {
            None
        };
        let mut reporter = self.reporter();
        reporter.report.iterations = info.iterations;
        reporter.report.residual = info.residual;
        reporter.report.escape_rate = escape_rate;
        reporter.report.solver_error = info.error_estimate;
        let limit = self.options.escape_limit;
        let Some(share) = reporter.escaping_share(relaxation_time, limit) else {
            return Ok(Solution::without_density(reporter.report));
        };
        let moments = moments(self.problem.space(), &steady.mass)?;
        reporter.edge_mass(&steady.mass, &self.steps.closed_ends);
        let diffusion = self.diffusion(transitions, correction, slopes, &steady.mass);
        reporter.numerical_diffusion(diffusion, &self.steps.noise, &moments);
        let (time_step, bias) = (self.steps.time_step, self.steps.bias.as_ref());
        reporter.time_step(time_step, bias, f64::INFINITY);
        reporter.escaping(share);
        if !info.converged {
            reporter.not_converged(info.error_estimate);
        }
        let (densities, replicates) = self.densities((system, transitions), correction, &steady)?;
        reporter.replicates(replicates, transitions.groups());
        Ok(Solution {
            report: reporter.report,
            moments,
            densities,
            state: Some(State {
                mass: Arc::new(steady.mass),
                trail: Trail::default(),
            }),
        })
    }

    /// Diffusion that the cells add, one value an axis.
    fn diffusion(
        &self,
        transitions: &SampledTransitions,
        correction: Correction,
        slopes: &[[f64; MAX_DIMENSION]],
        mass: &[f64],
    ) -> Vec<f64> {
        let cells = transitions.cells().iter();
        let mass: Vec<f64> = cells.map(|&cell| mass[cell]).collect();
        match correction {
            Correction::Slope => {
                transitions.remaining_diffusion(self.problem.space(), &mass, slopes)
            }
            Correction::None => transitions.numerical_diffusion(&mass),
        }
    }

    fn reporter(&self) -> Reporter<'_> {
        let mut reporter = Reporter::new(METHOD, self.problem.space());
        let own = &mut reporter.report.own;
        own.map_step = Some(self.steps.map_step);
        own.time_step_bias = self.steps.bias.map(|bias| bias.relative.abs());
        reporter
    }

    /// Samples the cell map at a parameter value, to be solved by [`SgcmSource::solve_sampled`]. Where samples started is
    /// kept when the options ask for slope correction.
    ///
    /// # Errors
    /// [`MethodError`] when the value is not allowed, or sampling was cancelled.
    pub fn sample_at(
        &self,
        value: f64,
        start: Option<&[f64]>,
    ) -> Result<SampledPoint, MethodError> {
        let system = self.problem.family().at(value)?;
        let transitions = self.sample(system.as_ref(), start)?;
        Ok(SampledPoint {
            system,
            transitions,
        })
    }

    /// Solves a sampled cell map, with the correction of one's choice: the same samples serve both. `start` has one mass a cell.
    ///
    /// # Errors
    /// [`MethodError`] when the samples cannot be solved.
    pub fn solve_sampled(
        &self,
        point: &SampledPoint,
        correction: Correction,
        start: Option<&[f64]>,
    ) -> Result<Solution<State>, MethodError> {
        let (system, transitions) = (point.system.as_ref(), &point.transitions);
        let options = Options::new(self.options.solver, self.options.solver_tolerance);
        let Corrected {
            outcome,
            matrix,
            slopes,
            ..
        } = solve_by(
            correction,
            transitions,
            self.problem.space(),
            start,
            None,
            (&options, CHANGE),
        )?;
        match outcome {
            Outcome::Steady(steady) => {
                let sampled = (system, transitions);
                self.solved(sampled, correction, &matrix, &slopes, steady)
            }
            Outcome::SeveralClasses { classes, .. } => {
                let mut reporter = self.reporter();
                reporter.several_classes(&classes);
                Ok(Solution::without_density(reporter.report))
            }
            Outcome::NoneInside { escape_per_step } => {
                let mut reporter = self.reporter();
                let rate = escape_rate(escape_per_step, self.steps.map_step);
                reporter.report.escape_rate = rate;
                reporter.no_steady_state(Finding::LeavesAtOnce { rate });
                Ok(Solution::without_density(reporter.report))
            }
        }
    }
}

impl DensitySource for SgcmSource {
    type State = State;

    fn subject(&self) -> &Subject {
        self.problem.subject()
    }

    fn solve(&self, value: f64, start: Option<&State>) -> Result<Solution<State>, SourceError> {
        let start = start.map(|state| state.mass.as_slice());
        let solved = self
            .sample_at(value, start)
            .and_then(|point| self.solve_sampled(&point, self.options.correction, start));
        match solved {
            Err(MethodError::Sampling(SamplingError::Cancelled)) => Err(SourceError::Interrupted),
            other => other.map_err(|error| SourceError::Method(error.into())),
        }
    }

    fn state_bytes(&self, state: &State) -> usize {
        state.bytes()
    }
}

/// Rate r with 1 - exp(-r Δt) = escape per step; where everything leaves in one step, the rate of losing all but a
/// rounding unit of it.
fn escape_rate(escape_per_step: f64, map_step: f64) -> f64 {
    -(1.0 - escape_per_step).max(f64::EPSILON).ln() / map_step
}
