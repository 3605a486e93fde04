//! Free trajectories as a source of densities: the reference that shares neither cells' transitions nor solver with the
//! other methods.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{Estimator, MonteCarloOptions};
use crate::continuation::{DensitySource, Finding, Solution, SourceError, Subject};
use crate::density::{EstimatedDensity, Moments, Observable, estimate};
use crate::method::generator::Trail;
use crate::method::report::Reporter;
use crate::method::structure::{closed_ends, kinked_surfaces, structure};
use crate::method::{MethodError, Problem, State, autonomous};
use crate::monte_carlo::{
    EnsembleRun, ErgodicRun, Estimate, MonteCarloError, Relaxation, StepBias, automatic_step,
    ensemble, ergodic, relaxation, step_bias,
};
use crate::space::CellSpace;
use crate::system::{LANES, SwitchingSurface, System};

/// Name of the method in tables.
const METHOD: &str = "monte-carlo";

/// Trajectories of a time average: every core has several batches, and burn-in stays a small part.
const TRAJECTORIES: f64 = 2048.0;

/// Burn-in in autocorrelation times: e⁻¹² = 6e-6 of the start is left.
const BURN_IN: f64 = 12.0;

/// Share of the wanted error that an automatic time step may add as bias.
const BIAS_SHARE: f64 = 0.5;

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

/// What is done at every parameter value: one plan serves a sweep, so that densities vary smoothly along it.
#[derive(Debug, Clone, PartialEq)]
pub struct MonteCarloPlan {
    /// Step of the integrator.
    pub time_step: f64,
    /// Its bias, the largest at both ends and in the middle of the sweep; `None` where nothing settles there.
    pub bias: Option<StepBias>,
    /// Longest autocorrelation time found there.
    pub relaxation_time: f64,
    /// Whether these times could be measured.
    pub relaxation_resolved: bool,
    /// Number of trajectories.
    pub trajectories: usize,
    /// Time before states are counted.
    pub burn_in: f64,
    /// Time during which the states of a trajectory are counted; zero for an ensemble.
    pub length: f64,
    /// Steps between two looks at a trajectory.
    pub stride: usize,
    /// Relative standard error of the variances to be expected.
    pub error: f64,
}

impl MonteCarloPlan {
    /// Integrator steps of all trajectories at one parameter value.
    pub fn steps(&self) -> f64 {
        self.trajectories as f64 * (self.burn_in + self.length) / self.time_step
    }
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
        let plan = plan(&planned, space, &relaxed, options);
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
        let plan = &self.plan;
        format!(
            "monte-carlo ({}), {} trajectories of {:.0} after {:.0}, time step {:.4}, a look every {} steps: {:.1e} steps a point",
            self.options.estimator.name(),
            plan.trajectories,
            plan.length,
            plan.burn_in,
            plan.time_step,
            plan.stride,
            plan.steps()
        )
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
        reporter.escaping(found.runaway_rate, escaping);
        reporter.outside(found.share_outside);
        reporter.time_step(plan.time_step, plan.bias.as_ref(), plan.error);
        reporter.burn_in(plan.burn_in, plan.relaxation_time, plan.relaxation_resolved);
        let density = |&observable: &Observable| {
            let mut estimated = estimate(
                self.problem.space(),
                observable,
                &found.mass,
                &found.replicates,
            )?;
            estimated.structure = structure(
                system,
                self.problem.space(),
                &found.mass,
                observable,
                &self.kinked,
            );
            Ok::<_, MethodError>(estimated)
        };
        let densities: Result<Vec<EstimatedDensity>, _> =
            self.problem.observables().iter().map(density).collect();
        let moments = found.mean.iter().zip(&found.variance);
        Ok(Solution {
            report: reporter.report,
            moments: moments
                .map(|(&mean, variance)| Moments {
                    mean,
                    standard_deviation: variance.sqrt(),
                })
                .collect(),
            densities: densities?,
            state: Some(State {
                mass: Arc::new(found.mass.clone()),
                trail: Trail::default(),
            }),
        })
    }
}

/// Chooses what is left to the program.
fn plan(
    systems: &[Arc<dyn System>],
    space: &CellSpace,
    relaxed: &[Relaxation],
    options: &MonteCarloOptions,
) -> MonteCarloPlan {
    let ends = || systems.iter().zip(relaxed);
    let time_step = options.time_step.or(|| {
        let wanted = BIAS_SHARE * options.error;
        let steps = ends().map(|(system, relaxed)| {
            let (integrator, seed) = (options.integrator, options.seed);
            automatic_step(system.as_ref(), space, relaxed, integrator, wanted, seed).0
        });
        steps.fold(f64::INFINITY, f64::min)
    });
    let step = (options.integrator, time_step);
    let biases = ends().filter_map(|(system, relaxed)| {
        step_bias(system.as_ref(), space, relaxed, step, options.seed)
    });
    let bias = biases.reduce(StepBias::worse);
    let relaxation_time = relaxed.iter().map(|one| one.time).fold(0.0, f64::max);
    let burn_in = options.burn_in.or(|| BURN_IN * relaxation_time);
    // Total time that makes the relative error of every variance one.
    let averaging = relaxed
        .iter()
        .flat_map(|one| &one.averaging_time)
        .copied()
        .fold(relaxation_time, f64::max);
    let squared = options.error * options.error;
    let stride = relaxed
        .iter()
        .map(|one| ErgodicRun::stride(one, time_step))
        .min()
        .unwrap_or(2);
    let (trajectories, length, error) = match options.estimator {
        Estimator::Ergodic => {
            let trajectories = whole_batches(options.trajectories.or(|| TRAJECTORIES));
            let length = options
                .length
                .or(|| (averaging / squared / trajectories).max(stride as f64 * time_step));
            let error = (averaging / (trajectories * length)).sqrt();
            (trajectories, length, error)
        }
        Estimator::Ensemble => {
            let kurtosis = relaxed
                .iter()
                .map(Relaxation::relative_square)
                .fold(1.0, f64::max);
            let trajectories = whole_batches(options.trajectories.or(|| kurtosis / squared));
            (trajectories, 0.0, (kurtosis / trajectories).sqrt())
        }
    };
    MonteCarloPlan {
        time_step,
        bias,
        relaxation_time,
        relaxation_resolved: relaxed.iter().all(|one| one.resolved),
        trajectories: trajectories as usize,
        burn_in,
        length,
        stride,
        error,
    }
}

fn whole_batches(trajectories: f64) -> f64 {
    let lanes = LANES as f64;
    (trajectories / lanes).ceil().clamp(1.0, 1e9) * lanes
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
