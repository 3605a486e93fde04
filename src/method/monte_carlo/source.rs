//! Free trajectories as a source of densities: the reference that shares neither cells' transitions nor solver with the
//! other methods.

use super::answers::{at_phases, rotations_and_answers};
use super::passages::Setting;
use super::{Estimator, MonteCarloOptions, MonteCarloPlan};
use crate::cancellation::Cancellation;
use crate::continuation::measure::{ESCAPE_RATE, TIME_STEP_BIAS};
use crate::continuation::{DensitySource, Finding, Session, Solution, Subject, Want};
use crate::density::{EstimatedDensity, Moments};
use crate::method::forcing::on_even_turns;
use crate::method::measures::{Cells, Others};
use crate::method::problem::Maps;
use crate::method::report::Reporter;
use crate::method::step_errors::{add_layers, add_wider, widened};
use crate::method::structure::{closed_ends, kinked_surfaces};
use crate::method::watched::Masses;
use crate::method::{MethodError, Problem, has_densities};
use crate::monte_carlo::{
    EnsembleRun, ErgodicRun, Estimate, MonteCarloError, Relaxation, ensemble, ergodic, relaxation,
};
use crate::system::{SwitchingSurface, System};

/// Parts of a period at which a forced system is looked at, at least.
const FEWEST_PARTS: usize = 32;

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
}

impl MonteCarloSource {
    /// What it gives densities of.
    pub(in crate::method) fn problem(&self) -> &Problem {
        &self.problem
    }

    /// Prepares a source: measures relaxation and time step at both ends and in the middle of the sweep, and
    /// chooses what is left to the program.
    ///
    /// # Errors
    /// [`MethodError`].
    pub fn new(
        problem: &Problem,
        options: &MonteCarloOptions,
        cancellation: &Cancellation,
    ) -> Result<Self, MethodError> {
        let problem = &on_even_turns(problem, FEWEST_PARTS)?;
        let (systems, space) = (problem.family().along()?, problem.space());
        has_densities(problem)?;
        let is_forced = problem.family().model().phase_axis().is_some();
        if is_forced && options.estimator == Estimator::Ensemble {
            return Err(MonteCarloError::Ensemble.into());
        }
        if let Some(one) = problem
            .family()
            .questions
            .passages
            .iter()
            .find(|one| one.has_basins())
        {
            let passage = one.name.clone();
            return Err(MethodError::Basin { passage });
        }
        let mut relaxed: Vec<Relaxation> = Vec::new();
        for system in &systems {
            relaxed.push(relaxation(
                system.as_ref(),
                space,
                options.seed,
                cancellation,
            )?);
        }
        // Where everything runs away there is nothing to be planned for, unless it does so all along the sweep.
        let stays = |relaxed: &Relaxation| !relaxed.settled_states().is_empty();
        let somewhere = relaxed.iter().any(stays);
        let (planned, relaxed): (Vec<_>, Vec<_>) = systems
            .iter()
            .cloned()
            .zip(relaxed)
            .filter(|(_, relaxed)| stays(relaxed) || !somewhere)
            .unzip();
        let plan = MonteCarloPlan::choose(&planned, space, &relaxed, options, cancellation)?;
        Ok(Self {
            problem: problem.checked_by(MonteCarloOptions::CELL_CHECK),
            options: options.clone(),
            plan,
            starts: relaxed
                .iter()
                .flat_map(|relaxed| relaxed.settled_states().to_vec())
                .collect(),
            closed_ends: closed_ends(&systems, space),
            kinked: kinked_surfaces(&systems, space),
        })
    }

    /// The same trajectories for a share of the time during which states are counted, for densities alone; what was
    /// measured is not measured again.
    pub(crate) fn shortened(&self, share: f64) -> Self {
        let mut source = self.clone();
        source.problem = self
            .problem
            .wanting(&Want::densities(self.problem.observables()));
        source.plan.length *= share;
        source.plan.error /= share.sqrt();
        source
    }

    /// What is done at every parameter value.
    pub(crate) fn plan(&self) -> &MonteCarloPlan {
        &self.plan
    }

    /// The plan in words.
    pub(in crate::method) fn describe(&self) -> String {
        self.plan.describe(self.options.estimator)
    }

    fn run(
        &self,
        system: &dyn System,
        cancellation: &Cancellation,
    ) -> Result<Estimate, MonteCarloError> {
        let (plan, options, space) = (&self.plan, &self.options, self.problem.space());
        match options.estimator {
            Estimator::Ergodic => {
                let run = ErgodicRun {
                    time_step: plan.step_of(system, space),
                    integrator: options.integrator,
                    seed: options.seed,
                    trajectories: plan.trajectories,
                    burn_in: plan.burn_in,
                    length: plan.length,
                    stride: plan.stride,
                };
                ergodic(system, space, &self.starts, &run, cancellation)
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
                ensemble(system, space, &run, cancellation)
            }
        }
    }

    /// Densities and everything else of one parameter value, with the masses of all cells and their replicates.
    ///
    /// # Errors
    /// [`MethodError`] when the value is not allowed or the run was cancelled.
    pub fn estimate(
        &self,
        value: f64,
        cancellation: &Cancellation,
    ) -> Result<(Solution<'static>, Estimate), MethodError> {
        let system = self.problem.family().at(value)?;
        let found = self.run(system.as_ref(), cancellation)?;
        let at = (value, system.as_ref());
        let mut solution = self.solution(at, &found)?;
        let setting = Setting {
            problem: &self.problem,
            options: &self.options,
            plan: &self.plan,
            states: &self.starts,
        };
        let is_steady = solution.report.status.is_resolved();
        setting.add_passages(&mut solution.report, at, is_steady, cancellation)?;
        setting.add_visits(&mut solution.report, at, is_steady, cancellation)?;
        Ok((solution, found))
    }

    fn densities(
        &self,
        maps: &Maps,
        system: &dyn System,
        found: &Estimate,
    ) -> Result<Vec<EstimatedDensity>, MethodError> {
        let (problem, mass) = (&self.problem, found.mass.as_slice());
        let mut densities = maps.sampled(problem, mass, &found.replicates)?;
        for one in &mut densities {
            one.structure = maps.structure(system, problem, mass, one.observable, &self.kinked);
        }
        let (space, plan) = (problem.space(), &self.plan);
        let steps = (self.options.integrator, plan.step_of(system, space));
        add_layers(&mut densities, (system, space), mass, &self.kinked, steps);
        add_wider(&mut densities, plan.bias.map_or(0.0, |bias| bias.certain()));
        Ok(densities)
    }

    fn solution(
        &self,
        (value, system): (f64, &dyn System),
        found: &Estimate,
    ) -> Result<Solution<'static>, MethodError> {
        let plan = &self.plan;
        let mut reporter = Reporter::new(METHOD, &self.problem);
        // Steps of one trajectory: the iterations of the integrator.
        let steps = (plan.burn_in + plan.length) / plan.time_step;
        reporter.report.iterations = steps.ceil() as usize;
        reporter.report.add(&ESCAPE_RATE, "", found.runaway_rate);
        if let Some(bias) = plan.bias {
            reporter
                .report
                .add(&TIME_STEP_BIAS, "", bias.relative.abs());
        }
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
        let maps = self.problem.maps(value, &self.kinked, Masses::Sampled)?;
        let of_axes = found.mean.iter().zip(&found.variance);
        let of_axes = of_axes.map(|(&mean, variance)| Moments {
            mean,
            standard_deviation: variance.sqrt(),
        });
        let of_axes: Vec<Moments> = of_axes.collect();
        let (space, replicates) = (self.problem.space(), &found.replicates);
        let certain = plan.bias.map_or(0.0, |bias| bias.certain());
        let none = vec![0.0; space.dimension()];
        let of_states = maps.all_sampled_moments(space, &of_axes, &found.mass, replicates)?;
        let mut moments = widened(of_states, &none, certain);
        moments.extend(widened(at_phases(&self.problem, found), &[], certain));
        reporter.moments(&moments);
        let more = rotations_and_answers(&self.problem, system, found, plan.bias);
        reporter.report.measures.extend(more);
        let cells = Cells {
            system,
            space,
            weights: &found.mass,
            others: Others::Replicates(replicates),
            closed: &self.closed_ends,
            escape_rate: found.runaway_rate,
            beyond: reporter.missing().beyond,
        };
        let densities = self.densities(&maps, system, found)?;
        Ok(reporter.solution(densities, Some(&cells)))
    }
}

impl DensitySource for MonteCarloSource {
    fn method(&self) -> &'static str {
        METHOD
    }

    fn subject(&self) -> &Subject {
        self.problem.subject()
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        let (source, cancellation) = (self.clone(), cancellation.clone());
        Box::new(move |value: f64| {
            let (solution, _) = source.estimate(value, &cancellation)?;
            Ok(solution)
        })
    }
}
