//! The steady state of a sampled cell map, from the neighbour's, with the sampling error that leaving out groups of
//! samples shows.

use std::sync::Arc;

use super::Correction;
use super::passages::SpreadAs;
use super::phases::amplitudes;
use super::replicates::Replicates;
use super::slope_correction::{Corrected, solve_by};
use super::source::{METHOD, SampledPoint, SgcmSource};
use super::velocities::velocities;
use super::widening::all_moments;
use crate::MAX_DIMENSION;
use crate::cancellation::Cancellation;
use crate::continuation::measure::{ESCAPE_RATE, MAP_STEP, TIME_STEP_BIAS};
use crate::continuation::{Finding, Solution};
use crate::density::{EstimatedDensity, moments};
use crate::method::MethodError;
use crate::method::measures::{Cells, Others};
use crate::method::problem::Maps;
use crate::method::report::Reporter;
use crate::method::step_errors::{add_layers, add_wider};
use crate::method::watched::Masses;
use crate::monte_carlo::StepBias;
use crate::sampling::{SampledTransitions, TransitionMatrix};
use crate::stationary::{Options, Outcome, SteadyState, second_eigenvalue};

/// L1 change by a turn of the slope correction at which it ends.
const CHANGE: f64 = 1e-6;

/// Escape per map step below which mass is said to stay in Ω, and relaxation is not looked at.
const NO_ESCAPE: f64 = 1e-12;

/// A solution, and the masses of all cells where there is a steady state.
type SolvedMasses = (Solution<'static>, Option<Vec<f64>>);

impl SgcmSource {
    /// Solves a sampled cell map, with the correction of one's choice: the same samples serve both. `start` has one
    /// mass a cell, and so has what is found beside the solution, where there is a steady state.
    ///
    /// # Errors
    /// [`MethodError`] when the samples cannot be solved, or the solve was cancelled.
    pub(crate) fn solve_sampled(
        &self,
        point: &SampledPoint,
        correction: Correction,
        start: Option<&[f64]>,
        cancellation: &Cancellation,
    ) -> Result<SolvedMasses, MethodError> {
        let options = Options::new(self.options.solver, self.options.solver_tolerance);
        let options = options.cancelled_by(cancellation);
        let Corrected {
            outcome,
            matrix,
            slopes,
            ..
        } = solve_by(
            correction,
            &point.transitions,
            self.problem.space(),
            start,
            None,
            (&options, CHANGE),
        )?;
        match outcome {
            Outcome::Steady(steady) => {
                let solved = (&matrix, slopes.as_slice());
                self.solved(point, correction, solved, steady, cancellation)
            }
            Outcome::SeveralClasses { classes, .. } => {
                let mut reporter = self.reporter(point);
                reporter.several_classes(&classes);
                self.without_density(point, reporter, cancellation)
            }
            Outcome::NoneInside { escape_per_step } => {
                let mut reporter = self.reporter(point);
                let rate = escape_rate(escape_per_step, point.transitions.map_step());
                reporter.report.add(&ESCAPE_RATE, "", rate);
                reporter.no_steady_state(Finding::LeavesAtOnce { rate });
                self.without_density(point, reporter, cancellation)
            }
        }
    }

    fn densities(
        &self,
        point: &SampledPoint,
        steady: &SteadyState,
        replicates: &[Vec<f64>],
        wider: f64,
    ) -> Result<Vec<EstimatedDensity>, MethodError> {
        let system = point.system.as_ref();
        let (problem, surfaces) = (&self.problem, &self.steps.kinked);
        let maps = self.maps(point.value)?;
        let mut densities = maps.sampled(problem, &steady.mass, replicates)?;
        for one in &mut densities {
            let observable = one.observable;
            one.structure = maps.structure(system, problem, &steady.mass, observable, surfaces);
        }
        let (of, steps) = (
            (system, problem.space()),
            (self.options.integrator, self.steps.time_step),
        );
        add_layers(&mut densities, of, &steady.mass, surfaces, steps);
        add_wider(&mut densities, wider);
        Ok(densities)
    }

    fn solved(
        &self,
        point: &SampledPoint,
        correction: Correction,
        (matrix, slopes): (&TransitionMatrix, &[[f64; MAX_DIMENSION]]),
        steady: SteadyState,
        cancellation: &Cancellation,
    ) -> Result<SolvedMasses, MethodError> {
        let transitions = &point.transitions;
        let info = &steady.info;
        let escape_rate = escape_rate(info.escape_per_step, transitions.map_step());
        let relaxation_time = if info.escape_per_step > NO_ESCAPE {
            second_eigenvalue(matrix, self.problem.space(), &steady, cancellation)?.relaxation_time
        } else {
            None
        };
        let mut reporter = self.reporter(point);
        reporter.report.iterations = info.iterations;
        reporter.report.residual = info.residual;
        reporter.report.add(&ESCAPE_RATE, "", escape_rate);
        reporter.report.solver_error = info.error_estimate;
        let limit = self.options.escape_limit;
        let Some(share) = reporter.escaping_share(relaxation_time, limit) else {
            return self.without_density(point, reporter, cancellation);
        };
        let of_axes = moments(self.problem.space(), &steady.mass)?;
        reporter.edge_mass(&steady.mass, &self.steps.closed_ends);
        let diffusion = self.diffusion(transitions, correction, slopes, &steady.mass);
        let widening = reporter.numerical_diffusion(diffusion, &self.steps.noise, &of_axes);
        let (time_step, bias) = (self.steps.time_step, self.steps.bias.as_ref());
        reporter.time_step(time_step, bias, f64::INFINITY);
        reporter.escaping(share);
        if !info.converged {
            reporter.not_converged(info.error_estimate);
        }
        let Replicates {
            masses: replicates, ..
        } = self.replicates(point, correction, slopes, &steady, cancellation)?;
        let wider = widening.abs() + bias.map_or(0.0, StepBias::certain);
        let densities = self.densities(point, &steady, &replicates, wider)?;
        let space = self.problem.space();
        let maps = self.maps(point.value)?;
        let masses = (steady.mass.as_slice(), replicates.as_slice());
        reporter.moments(&all_moments(&self.problem, &maps, &of_axes, masses, wider)?);
        let system = point.system.as_ref();
        let doubts = (wider, reporter.missing());
        let answers = amplitudes(&self.problem, system, masses, doubts);
        reporter.report.measures.extend(answers);
        let turning = velocities(&self.problem, system, masses, doubts);
        reporter.report.measures.extend(turning);
        reporter.replicates(replicates.len(), transitions.groups());
        let spread = SpreadAs {
            mass: &steady.mass,
            replicates: &replicates,
            is_linear: correction == Correction::Slope,
        };
        // A comparison solves the same samples with both corrections; passages have paths of their own.
        if correction == self.correction() {
            self.add_passages(&mut reporter.report, point, Some(&spread), cancellation)?;
            self.add_visits(&mut reporter.report, point, masses, doubts)?;
        }
        let solution = reporter.solution(
            densities,
            Some(&Cells {
                system,
                space,
                weights: &steady.mass,
                others: Others::Replicates(&replicates),
                closed: &self.steps.closed_ends,
                escape_rate,
                beyond: doubts.1.beyond,
            }),
        );
        Ok((solution, Some(steady.mass)))
    }

    /// What there is without a steady state: passages from a state.
    fn without_density(
        &self,
        point: &SampledPoint,
        mut reporter: Reporter<'_>,
        cancellation: &Cancellation,
    ) -> Result<SolvedMasses, MethodError> {
        self.add_passages(&mut reporter.report, point, None, cancellation)?;
        Ok((Solution::without_density(reporter.report), None))
    }

    /// What turns masses into what is watched at a value of the path.
    fn maps(&self, value: f64) -> Result<Arc<Maps>, MethodError> {
        self.problem
            .maps(value, &self.steps.kinked, Masses::Sampled)
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

    fn reporter(&self, point: &SampledPoint) -> Reporter<'_> {
        let mut reporter = Reporter::new(METHOD, &self.problem);
        let report = &mut reporter.report;
        report.add(&MAP_STEP, "", point.transitions.map_step());
        if let Some(bias) = self.steps.bias {
            report.add(&TIME_STEP_BIAS, "", bias.relative.abs());
        }
        reporter
    }
}

/// Rate r with 1 - exp(-r Δt) = escape per step; where everything leaves in one step, the rate of losing all but a
/// rounding unit of it.
fn escape_rate(escape_per_step: f64, map_step: f64) -> f64 {
    -(1.0 - escape_per_step).max(f64::EPSILON).ln() / map_step
}
