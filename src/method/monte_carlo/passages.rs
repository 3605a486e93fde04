//! Times of first passage at the values of a sweep by free trajectories, and findings where there are none.

use super::{MonteCarloOptions, MonteCarloPlan};
use crate::cancellation::Cancellation;
use crate::continuation::{Finding, PassageFault, SolveReport};
use crate::method::measures::{measures_of_passage, transition_measures};
use crate::method::{MethodError, Problem, StepChoice};
use crate::monte_carlo::{
    ExitNumber, ExitTimes, MonteCarloError, PassageRun, PassageStart, PassageTarget, SteadyStart,
    first_passages,
};
use crate::passage::{Passage, Start};
use crate::system::{BoundQuantity, System};

/// Exits, or transitions, from which numbers are made, at least.
pub(super) const FEWEST: usize = 10;

/// Autocorrelation times between two looks in search of states to start from.
const SPACING: f64 = 3.0;

/// What paths are followed with.
pub(super) struct Setting<'a> {
    pub(super) problem: &'a Problem,
    pub(super) options: &'a MonteCarloOptions,
    pub(super) plan: &'a MonteCarloPlan,
    /// Settled states.
    pub(super) states: &'a [Vec<f64>],
}

/// Part of a turn that an angle makes within a time step, at most.
const PART_OF_A_TURN: f64 = 1.0 / 32.0;

impl Setting<'_> {
    /// Adds the numbers of all passages at a value to a report, with findings.
    ///
    /// # Errors
    /// [`MethodError`] when the value is not allowed or the run was cancelled.
    pub(super) fn add_passages(
        &self,
        report: &mut SolveReport,
        (value, system): (f64, &dyn System),
        is_steady: bool,
        cancellation: &Cancellation,
    ) -> Result<(), MethodError> {
        let family = self.problem.family();
        if family.questions.passages.is_empty() || self.problem.subject().measures.is_empty() {
            return Ok(());
        }
        let values = family.values_at(value)?;
        for (passage, question) in family.questions.passages.iter().enumerate() {
            let asked = Passage::bind(question, &values)?;
            let mut faults = Vec::new();
            let found = self.follow(system, &asked, is_steady, cancellation)?;
            match found {
                Ok((times, numbers)) => {
                    let all = numbers.iter().map(|one| (one.value, one.error()));
                    report.measures.extend(measures_of_passage(question, all));
                    let share = 1.0 - times.exits() as f64 / times.paths() as f64;
                    if share > 0.0 {
                        report.findings.push(Finding::PassageCut {
                            passage,
                            share,
                            longest: times.longest(),
                        });
                    }
                }
                Err(fault) => faults.push(fault),
            }
            if question.transitions.is_some() {
                match self.transitions(system, &asked, is_steady, cancellation)? {
                    Ok(numbers) => {
                        let numbers = numbers.map(|one| (one.value, one.error()));
                        let measures = transition_measures(question, numbers);
                        report.measures.extend(measures);
                    }
                    Err(fault) => faults.push(fault),
                }
            }
            faults.dedup();
            let findings = faults.into_iter();
            let findings = findings.map(|fault| Finding::NoPassage { passage, fault });
            report.findings.extend(findings);
        }
        Ok(())
    }

    /// Follows the paths of a passage, with shorter steps as long as the step is left to the program, shifts the mean
    /// time, and may be halved within the budget.
    fn follow(
        &self,
        system: &dyn System,
        asked: &Passage,
        is_steady: bool,
        cancellation: &Cancellation,
    ) -> Result<Result<(ExitTimes, Vec<ExitNumber>), PassageFault>, MethodError> {
        let (options, plan, space) = (self.options, self.plan, self.problem.space());
        let start = match &asked.start {
            Start::State(state) => PassageStart::State(state),
            Start::Density(_) if !is_steady => return Ok(Err(PassageFault::NoDensity)),
            Start::Density(region) => PassageStart::Steady(SteadyStart {
                region: region.as_ref(),
                states: self.states,
                time_step: plan.time_step,
                burn_in: plan.burn_in,
                spacing: SPACING * plan.relaxation_time,
            }),
        };
        let budget = MonteCarloOptions::PASSAGE_STEPS;
        // A pair of paths takes three steps, a whole one and two halves.
        let time_step = self.time_step(system, [&asked.until]);
        let affordable = budget / (3 * options.passages) as f64 * time_step;
        let mut run = PassageRun {
            time_step,
            integrator: options.integrator,
            seed: options.seed,
            paths: options.passages,
            longest: options.longest_passage.or(|| affordable),
        };
        loop {
            let target = PassageTarget {
                until: &asked.until,
                exits: &asked.exits,
            };
            let found = first_passages(system, space, target, &start, &run, cancellation);
            let times = match found {
                Err(MonteCarloError::NoStart) => return Ok(Err(PassageFault::Start)),
                found => found?,
            };
            if times.runaways() > 0 {
                return Ok(Err(PassageFault::RunsAway));
            }
            if times.exits() < FEWEST {
                return Ok(Err(PassageFault::Rare));
            }
            let numbers = times.numbers(&asked.times, &asked.quantiles);
            let is_biased = numbers.first().is_some_and(ExitNumber::is_biased);
            let may_halve = options.time_step == StepChoice::Auto && is_biased;
            if !may_halve || 2.0 * times.steps() as f64 > budget {
                return Ok(Ok((times, numbers)));
            }
            run.time_step *= 0.5;
        }
    }

    /// The time step with which it is looked for whether regions are met: where it is left to the program, one in which
    /// an angle on which a region depends turns little. A drift that is the same everywhere allows any step otherwise.
    pub(super) fn time_step<const N: usize>(
        &self,
        system: &dyn System,
        regions: [&BoundQuantity; N],
    ) -> f64 {
        let (space, own) = (self.problem.space(), self.plan.time_step);
        if self.options.time_step != StepChoice::Auto {
            return own;
        }
        let turns = system.facts().turns.iter();
        let looked_at = turns.filter(|(axis, _)| regions.iter().any(|one| one.states()[**axis]));
        looked_at.fold(own, |step, (&axis, &(from, to))| {
            let speeds = (0..space.n_cells())
                .map(|cell| system.drift_at(0.0, &space.node(cell))[axis].abs());
            let fastest = speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
            step.min(PART_OF_A_TURN * (to - from) / fastest.max(f64::MIN_POSITIVE))
        })
    }
}
