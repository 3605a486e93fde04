//! Transitions between two regions at the values of a sweep, counted on free trajectories, or why there are none.

use super::MonteCarloOptions;
use super::passages::{FEWEST, Setting};
use crate::cancellation::Cancellation;
use crate::continuation::PassageFault;
use crate::method::{MethodError, StepChoice};
use crate::monte_carlo::{ExitNumber, TransitionRun, Transitions, transitions};
use crate::passage::{Passage, PassageError, Start, are_apart};
use crate::system::{BoundQuantity, System};

/// Flux, rate and mean time on the way, or why there are none.
pub(super) type Counted = Result<[ExitNumber; 3], PassageFault>;

impl Setting<'_> {
    /// Counts as many transitions as a passage has paths, within the steps of a passage; with shorter steps as long as
    /// the step is left to the program, certainly changes a number, and may be halved.
    pub(super) fn transitions(
        &self,
        system: &dyn System,
        asked: &Passage,
        is_steady: bool,
        cancellation: &Cancellation,
    ) -> Result<Counted, MethodError> {
        let Start::Density(Some(from)) = &asked.start else {
            return Ok(Err(PassageFault::NoDensity));
        };
        if !is_steady {
            return Ok(Err(PassageFault::NoDensity));
        }
        let regions = [from, &asked.until];
        // Trajectories see regions that no cell is in as well.
        if let Err(PassageError::Overlap) = are_apart(self.problem.space(), regions) {
            return Ok(Err(PassageFault::Overlap));
        }
        self.counted(system, regions, Transitions::numbers, cancellation)
    }

    /// Numbers of the transitions from the first of two regions to the second.
    pub(super) fn counted(
        &self,
        system: &dyn System,
        regions: [&BoundQuantity; 2],
        numbers: impl Fn(&Transitions) -> [ExitNumber; 3],
        cancellation: &Cancellation,
    ) -> Result<Counted, MethodError> {
        let (options, plan, space) = (self.options, self.plan, self.problem.space());
        let time_step = self.time_step(system, regions);
        // All pairs of trajectories together last as long as the paths of a passage may.
        let steps = |longest: f64| (3 * options.passages) as f64 * longest / time_step;
        let most_steps = match options.longest_passage {
            StepChoice::Fixed(longest) => steps(longest),
            StepChoice::Auto => MonteCarloOptions::PASSAGE_STEPS,
        };
        let mut run = TransitionRun {
            time_step,
            integrator: options.integrator,
            seed: options.seed,
            burn_in: plan.burn_in,
            transitions: options.passages,
            most_steps,
        };
        loop {
            let on = (system, space);
            let found = transitions(on, regions, self.states, &run, cancellation)?;
            if found.runaways() > 0 {
                return Ok(Err(PassageFault::RunsAway));
            }
            let numbers = numbers(&found);
            let errors = numbers.iter().map(ExitNumber::error);
            if found.count() < FEWEST || errors.into_iter().any(|error| !error.is_finite()) {
                return Ok(Err(PassageFault::Rare));
            }
            let is_biased = numbers.iter().any(ExitNumber::is_biased);
            let may_halve = options.time_step == StepChoice::Auto && is_biased;
            if !may_halve || 2.0 * found.steps() > most_steps {
                return Ok(Ok(numbers));
            }
            run.time_step *= 0.5;
        }
    }
}
