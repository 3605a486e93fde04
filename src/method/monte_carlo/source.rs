//! Free trajectories as a source of densities: the reference that shares neither cells' transitions nor solver with the
//! other methods.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{Estimator, MonteCarloOptions, MonteCarloPlan};
use crate::continuation::{DensitySource, Finding, Solution, SourceError, Subject};
use crate::density::{EstimatedDensity, Moments, Observable, estimate};
use crate::method::generator::Trail;
use crate::method::report::Reporter;
use crate::method::structure::{closed_ends, kinked_surfaces, structure};
use crate::method::{MethodError, Problem, State, autonomous};
use crate::monte_carlo::{
    EnsembleRun, ErgodicRun, Estimate, MonteCarloError, Relaxation, ensemble, ergodic, relaxation,
};
use crate::system::{SwitchingSurface, System};

/// Name of the method in tables.
const METHOD: &str = "monte-carlo";

/// Densities along one parameter by free trajectories.
#[derive(Debug, Clone)]
pub struct MonteCarloSource {
    problem: Problem,
    options: MonteCarloOptions,
    plan: MonteCarloPlan,
    starts: Vec<Vec<f64>>,
    closed_ends: Vec<[bool; 2]>,
    kinked: Vec<SwitchingSurface>,
    cancelled: Arc<AtomicBool>,
}

impl MonteCarloSource {
    /// Prepares a source: measures relaxation and time step at both ends and in the middle of the sweep, and
    /// chooses what is left to the program. Setting `cancelled` makes a running solve return
    /// [`SourceError::Interrupted`].
    ///
    /// # Errors
    /// [`MethodError`].
    pub fn new(
        problem: &Problem,
        options: &MonteCarloOptions,
        cancelled: Arc<AtomicBool>,
    ) -> Result<Self, MethodError> {
        let (systems, space) = (problem.family().along()?, problem.space());
        autonomous(&systems)?;
        let relaxed: Vec<Relaxation> = systems
            .iter()
            .map(|system| relaxation(system.as_ref(), space, options.seed))
            .collect();
        // Where everything runs away there is nothing to be planned for, unless it does so all along the sweep.
        let stays = |relaxed: &Relaxation| !relaxed.settled().is_empty();
        let somewhere = relaxed.iter().any(stays);
        let (planned, relaxed): (Vec<_>, Vec<_>) = systems
            .iter()
            .cloned()
            .zip(relaxed)
            .filter(|(_, relaxed)| stays(relaxed) || !somewhere)
            .unzip();
        let plan = MonteCarloPlan::choose(&planned, space, &relaxed, options);
        Ok(Self {
            problem: problem.clone(),
            options: options.clone(),
            plan,
            starts: relaxed
                .iter()
                .flat_map(|relaxed| relaxed.settled().to_vec())
                .collect(),
            closed_ends: closed_ends(&systems, space),
            kinked: kinked_surfaces(&systems, space),
            cancelled,
        })
    }

    /// The same trajectories for a share of the time during which states are counted; what was measured is not measured again.
    pub fn shortened(&self, share: f64) -> Self {
        let mut source = self.clone();
        source.plan.length *= share;
        source.plan.error /= share.sqrt();
        source
    }

    /// What is done at every parameter value.
    pub fn plan(&self) -> &MonteCarloPlan {
        &self.plan
    }

    /// The plan in words.
    pub(in crate::method) fn describe(&self) -> String {
        self.plan.describe(self.options.estimator)
    }

    fn run(&self, system: &dyn System) -> Result<Estimate, MonteCarloError> {
        let cancelled = || self.cancelled.load(Ordering::Relaxed);
        let (plan, options) = (&self.plan, &self.options);
        match options.estimator {
            Estimator::Ergodic => {
                let run = ErgodicRun {
                    time_step: plan.time_step,
                    integrator: options.integrator,
                    seed: options.seed,
                    trajectories: plan.trajectories,
                    burn_in: plan.burn_in,
                    length: plan.length,
                    stride: plan.stride,
                };
                ergodic(system, self.problem.space(), &self.starts, &run, &cancelled)
            }
            Estimator::Ensemble => {
                let run = EnsembleRun {
                    time_step: plan.time_step,
                    integrator: options.integrator,
                    seed: options.seed,
                    trajectories: plan.trajectories,
                    time: plan.burn_in,
                    start: Vec::new(),
                };
                ensemble(system, self.problem.space(), &run, &cancelled)
            }
        }
    }

    /// Densities and everything else of one parameter value, with the masses of all cells and their replicates.
    ///
    /// # Errors
    /// [`MethodError`] when the value is not allowed or the run was cancelled.
    pub fn estimate(&self, value: f64) -> Result<(Solution<State>, Estimate), MethodError> {
        let system = self.problem.family().at(value)?;
        let found = self.run(system.as_ref())?;
        Ok((self.solution(system.as_ref(), &found)?, found))
    }

    fn densities(
        &self,
        system: &dyn System,
        found: &Estimate,
    ) -> Result<Vec<EstimatedDensity>, MethodError> {
        let (space, mass) = (self.problem.space(), found.mass.as_slice());
        let density = |&observable: &Observable| {
            let mut estimated = estimate(space, observable, mass, &found.replicates)?;
            estimated.structure = structure(system, space, mass, observable, &self.kinked);
            Ok(estimated)
        };
        self.problem.observables().iter().map(density).collect()
    }

    fn solution(
        &self,
        system: &dyn System,
        found: &Estimate,
    ) -> Result<Solution<State>, MethodError> {
        let plan = &self.plan;
        let mut reporter = Reporter::new(METHOD, self.problem.space());
        // Steps of one trajectory: the iterations of the integrator.
        let steps = (plan.burn_in + plan.length) / plan.time_step;
        reporter.report.iterations = steps.ceil() as usize;
        reporter.report.escape_rate = found.runaway_rate;
        reporter.report.own.time_step_bias = plan.bias.map(|bias| bias.relative.abs());
        let limit = self.options.escape_limit;
        let escaping = found.runaway_rate * plan.relaxation_time;
        let nothing = found.looks == 0 || found.replicates.len() < 2;
        if nothing || escaping > limit || found.share_outside > limit {
            reporter.no_steady_state(Finding::NothingStays {
                runaways: found.runaways,
                outside: found.share_outside,
                limit,
            });
            return Ok(Solution::without_density(reporter.report));
        }
        reporter.edge_mass(&found.mass, &self.closed_ends);
        reporter.escaping(escaping);
        reporter.outside(found.share_outside);
        reporter.time_step(plan.time_step, plan.bias.as_ref(), plan.error);
        reporter.burn_in(plan.burn_in, plan.relaxation_time, plan.relaxation_resolved);
        let moments = found.mean.iter().zip(&found.variance);
        Ok(Solution {
            report: reporter.report,
            moments: moments
                .map(|(&mean, variance)| Moments {
                    mean,
                    standard_deviation: variance.sqrt(),
                })
                .collect(),
            densities: self.densities(system, found)?,
            state: Some(State {
                mass: Arc::new(found.mass.clone()),
                trail: Trail::default(),
            }),
        })
    }
}

impl DensitySource for MonteCarloSource {
    type State = State;

    fn subject(&self) -> &Subject {
        self.problem.subject()
    }

    fn solve(&self, value: f64, _start: Option<&State>) -> Result<Solution<State>, SourceError> {
        match self.estimate(value) {
            Err(MethodError::MonteCarlo(MonteCarloError::Cancelled)) => {
                Err(SourceError::Interrupted)
            }
            Err(error) => Err(SourceError::Method(error.into())),
            Ok((solution, _)) => Ok(solution),
        }
    }

    fn state_bytes(&self, state: &State) -> usize {
        state.bytes()
    }
}
