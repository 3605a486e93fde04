//! Sample paths that a live page draws over a joint density.

use std::sync::{Mutex, MutexGuard, PoisonError};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::ask::{AskPaths, Start};
use super::bound::Bound;
use super::{Live, Stop, answer, read};
use crate::cancellation::Cancellation;
use crate::monte_carlo::{MonteCarloError, PathRun, sample_path};
use crate::space::CellSpace;
use crate::system::{Family, System};

/// Paths of one request.
const MOST_PATHS: usize = 8;
/// States of one path that are sent.
const MOST_STATES: usize = 3000;
/// Steps of one path.
const MOST_STEPS: usize = 200_000;
/// Turns that can be asked for: 3000 states then show each of them round.
const MOST_TURNS: f64 = 140.0;
/// Runs that are kept: those of the values between which one goes back and forth.
const MOST_KEPT: usize = 32;
/// Seed of the trajectories that tell how long a turn takes.
const SEED: u64 = 1;

/// How paths are followed, by what they are paths of: the used last at the end.
#[derive(Debug, Default)]
pub(super) struct Runs {
    kept: Mutex<Vec<(Vec<u64>, PathRun)>>,
}

impl Runs {
    fn lock(&self) -> MutexGuard<'_, Vec<(Vec<u64>, PathRun)>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn find(&self, key: &[u64]) -> Option<PathRun> {
        let mut kept = self.lock();
        let at = kept.iter().position(|one| one.0 == key)?;
        let one = kept.remove(at);
        let found = one.1.clone();
        kept.push(one);
        Some(found)
    }

    fn keep(&self, key: Vec<u64>, found: &PathRun) {
        let mut kept = self.lock();
        let surplus = (kept.len() + 1).saturating_sub(MOST_KEPT);
        kept.drain(..surplus);
        kept.push((key, found.clone()));
    }
}

impl Live {
    /// Paths of the system at some values of the parameters, from the states that are asked for.
    pub(in crate::explore) fn paths(&self, body: &[u8]) -> Vec<u8> {
        answer(|| {
            let ask: AskPaths = read(body)?;
            let bound = self.base.bind_swept(&ask.values).map_err(Stop::Refused)?;
            let family = &bound.sweep.settings.family;
            let space = bound.sweep.problem.space();
            check(&ask, family, space).map_err(Stop::Refused)?;
            let (lane, cancellation) = self.begin(&ask.lane, ask.ticket)?;
            let system = family.at(bound.value);
            let system = system.map_err(|error| Stop::Refused(error.to_string()))?;
            let found = self.follow(&ask, &bound, &*system, &cancellation);
            lane.end();
            found.map_err(|error| match error {
                MonteCarloError::Cancelled(_) => Stop::Stale,
                error => Stop::Refused(error.to_string()),
            })
        })
    }

    fn follow(
        &self,
        ask: &AskPaths,
        bound: &Bound,
        system: &dyn System,
        cancellation: &Cancellation,
    ) -> Result<Value, MonteCarloError> {
        let space = bound.sweep.problem.space();
        let mut key = bound.key.clone();
        key.extend([bound.value.to_bits(), ask.turns.to_bits()]);
        let run = match self.runs.find(&key) {
            Some(run) => run,
            None => {
                let bounds = (MOST_STATES, MOST_STEPS);
                let run =
                    PathRun::over_turns(system, space, ask.turns, bounds, SEED, cancellation)?;
                self.runs.keep(key, &run);
                run
            }
        };
        let starts = ask.starts.par_iter();
        let paths: Result<Vec<Value>, MonteCarloError> = starts
            .map(|Start { state, seed }| {
                let path = sample_path(system, space, state, *seed, &run, cancellation)?;
                // Single precision is finer than any screen.
                let states = singles(path.states.iter().flatten());
                Ok(json!({ "states": states, "ran_away": path.ran_away }))
            })
            .collect();
        Ok(json!({
            "ticket": ask.ticket,
            // The time that each path covers, unless it ran away.
            "time": run.time(),
            "time_step": run.time_step,
            "steps": run.steps,
            // Coordinates of a state, which follow one another.
            "dimension": space.dimension(),
            "paths": paths?,
        }))
    }
}

/// Whether a request can be followed; otherwise why not, for people.
fn check(ask: &AskPaths, family: &Family, space: &CellSpace) -> Result<(), String> {
    let count = ask.starts.len();
    if count == 0 || count > MOST_PATHS {
        return Err(format!(
            "{count} paths are asked for; it can be 1 to {MOST_PATHS} at a time"
        ));
    }
    let turns = ask.turns;
    if !(turns > 0.0 && turns <= MOST_TURNS) {
        return Err(format!(
            "a path of {turns} turns is asked for; it can be more than 0 and at most {MOST_TURNS}"
        ));
    }
    let axes = &family.model().axes;
    for (number, Start { state, .. }) in (1..).zip(&ask.starts) {
        if state.len() != space.dimension() {
            return Err(format!(
                "path {number} starts at {} coordinates; a state has {}",
                state.len(),
                space.dimension()
            ));
        }
        for ((value, cells), axis) in state.iter().zip(space.axes()).zip(axes) {
            let (from, to) = (cells.from(), cells.to());
            if !(from..=to).contains(value) {
                return Err(format!(
                    "path {number} starts at {} = {value}, which lies outside of the domain from {from} to {to}",
                    axis.name
                ));
            }
        }
    }
    Ok(())
}

fn singles<'v>(values: impl Iterator<Item = &'v f64>) -> String {
    let bytes: Vec<u8> = values
        .flat_map(|&value| (value as f32).to_le_bytes())
        .collect();
    STANDARD.encode(bytes)
}
