//! Times of first passage by a cell map whose paths end where they enter a region.
//!
//! The cell map of a density knows where a path is once a map step, and not when it has met a border. Here every cell
//! outside of the region has paths of its own, which are watched in every step of the integrator: they have entered the
//! region at a time, or are in another cell after the map step. What is left of the time from there is a function of
//! the state, linear in each cell.
//!
//! | part | file |
//! | --- | --- |
//! | sums over the paths of a cell | `moments.rs` |
//! | cells that are reached from the start, and their paths | `map.rs` |
//! | cells on which functions are linear | `layout.rs` |
//! | what a map step makes of functions | `operator.rs` |
//! | solving, and the largest eigenvalue | `krylov.rs` |
//! | probabilities at times, and quantiles | `survival.rs` |
//! | all numbers | `numbers.rs` |
//! | numbers with errors | `errors.rs` |

mod errors;
mod krylov;
mod layout;
mod map;
mod moments;
mod numbers;
mod operator;
mod survival;

use self::errors::{WithStep, with_errors};
use self::map::{PassageMap, Sampler};
use self::moments::Asked;
use self::survival::Times;
use super::SgcmSource;
use super::source::SampledPoint;
use crate::MAX_DIMENSION;
use crate::cancellation::Cancellation;
use crate::continuation::{Finding, PassageFault, SolveReport};
use crate::method::measures::measures_of_passage;
use crate::method::{MethodError, StepChoice};
use crate::monte_carlo::{CellPaths, CellRun, PassageTarget};
use crate::passage::{Passage, Start, WithError};
use crate::system::LANES;

/// Groups of paths that are left out one at a time. With so many an error is itself known to a fifth.
const GROUPS: usize = 16;

/// Batches of 64 paths in each group, from a cell at most, and from a state.
const MOST_BATCHES: usize = 16;

/// Paths from a cell, at least and at most.
pub(super) const CELL_PATHS: [usize; 2] = [GROUPS * LANES, GROUPS * MOST_BATCHES * LANES];

/// Cells over which noise spreads paths in a map step, as a standard deviation.
const SPREAD: f64 = 3.0;

/// Paths that enter the region at least.
const FEWEST: f64 = 10.0;

/// Times that the time step is halved.
const HALVINGS: usize = 3;

/// A steady state as a start is spread.
pub(super) struct SpreadAs<'a> {
    /// Of all cells of the space.
    pub(super) mass: &'a [f64],
    /// Without one group of samples each.
    pub(super) replicates: &'a [Vec<f64>],
    /// Whether the density is linear in each cell.
    pub(super) is_linear: bool,
}

type Answer<T> = Result<Result<T, PassageFault>, MethodError>;

impl SgcmSource {
    /// Adds the numbers of all passages at a value to a report, with findings.
    ///
    /// # Errors
    /// [`MethodError`] when the value is not allowed or the run was cancelled.
    pub(super) fn add_passages(
        &self,
        report: &mut SolveReport,
        point: &SampledPoint,
        steady: Option<&SpreadAs<'_>>,
        cancellation: &Cancellation,
    ) -> Result<(), MethodError> {
        let family = self.problem.family();
        let is_asked = !family.questions.passages.is_empty();
        if !is_asked || self.problem.subject().measures.is_empty() {
            return Ok(());
        }
        let values = family.values_at(point.value)?;
        for (passage, question) in family.questions.passages.iter().enumerate() {
            let asked = Passage::bind(question, &values)?;
            match self.numbers(point, &asked, steady, cancellation)? {
                Ok(numbers) => {
                    let measures = measures_of_passage(question, numbers.into_iter());
                    report.measures.extend(measures);
                }
                Err(fault) => report.findings.push(Finding::NoPassage { passage, fault }),
            }
        }
        Ok(())
    }

    /// The numbers of a passage. Where the time step is left to the program, it is halved as long as it changes the
    /// mean time by more than sampling may.
    fn numbers(
        &self,
        point: &SampledPoint,
        asked: &Passage,
        steady: Option<&SpreadAs<'_>>,
        cancellation: &Cancellation,
    ) -> Answer<Vec<WithError>> {
        let map_step = self.passage_step();
        let mut time_step = self.steps.time_step.min(map_step);
        for halving in 0.. {
            let run = CellRun {
                map_step,
                time_step,
                integrator: self.options.integrator,
                seed: self.options.seed,
                groups: GROUPS,
                batches: self.batches(map_step),
            };
            let found = self.numbers_with(point, asked, steady, &run, cancellation)?;
            let is_biased = found.as_ref().is_ok_and(WithStep::is_biased);
            let may_halve = self.options.time_step == StepChoice::Auto && halving < HALVINGS;
            if !(is_biased && may_halve) {
                return Ok(found.and_then(WithStep::numbers));
            }
            time_step *= 0.5;
        }
        Ok(Err(PassageFault::Unsolved))
    }

    /// Map step of a passage: the time in which noise spreads paths over some cells, and no longer than that of the
    /// density. Long steps forget how a path came over a barrier, which from cell to cell many do.
    fn passage_step(&self) -> f64 {
        let own = self.steps.map_step;
        let axes = self.problem.space().axes().iter().zip(&self.steps.noise);
        let spread = axes
            .filter(|(_, noise)| **noise > 0.0)
            .map(|(axis, noise)| {
                let width = (axis.to() - axis.from()) / axis.count() as f64;
                (SPREAD * width).powi(2) / (2.0 * noise)
            });
        spread.fold(own, f64::min).max(self.steps.time_step)
    }

    /// Batches in each group of a cell, so that its paths take as many steps as the samples of the density do.
    fn batches(&self, map_step: f64) -> usize {
        let steps = self.options.samples as f64 * self.steps.map_step;
        // A pair of paths takes three steps, a whole one and two halves.
        let batch = 3.0 * map_step * CELL_PATHS[0] as f64;
        ((steps / batch) as usize).clamp(1, MOST_BATCHES)
    }

    fn numbers_with(
        &self,
        point: &SampledPoint,
        asked: &Passage,
        steady: Option<&SpreadAs<'_>>,
        run: &CellRun,
        cancellation: &Cancellation,
    ) -> Answer<WithStep> {
        let space = self.problem.space();
        let times = Times::new(&asked.times, &asked.quantiles, run.map_step);
        let told = Asked {
            map_step: run.map_step,
            exits: asked.exits.len(),
            looks: times.looks.clone(),
        };
        let target = PassageTarget {
            until: &asked.until,
            exits: &asked.exits,
        };
        let region = match &asked.start {
            Start::Density(region) => region.as_ref(),
            Start::State(_) => None,
        };
        let paths = |run: &CellRun| {
            let system = point.system.as_ref();
            CellPaths::new(system, space, target, region, run.clone(), cancellation)
        };
        let of_cells = paths(run)?;
        let sampler = Sampler {
            paths: &of_cells,
            space,
            groups: GROUPS,
            asked: &told,
            has_region: region.is_some(),
        };
        let map = match &asked.start {
            Start::State(state) if asked.until.at(state) < 0.0 || space.find(state).is_none() => {
                return Ok(Err(PassageFault::Start));
            }
            Start::State(state) => {
                let of_state = CellRun {
                    batches: MOST_BATCHES,
                    ..run.clone()
                };
                sampler.starting_at(&paths(&of_state)?, state)?
            }
            Start::Density(_) => {
                let Some(steady) = steady else {
                    return Ok(Err(PassageFault::NoDensity));
                };
                let with_mass = (0..space.n_cells()).filter(|&cell| steady.mass[cell] > 0.0);
                sampler.starting_in(with_mass.collect())?
            }
        };
        if let Some(fault) = fault(&map) {
            return Ok(Err(fault));
        }
        // From a state weights do not matter.
        let flat = vec![vec![1.0; map.dimension + 1]; map.cells.len()];
        let (weights, others) = match steady.filter(|_| matches!(asked.start, Start::Density(_))) {
            Some(steady) => {
                let of_mass =
                    |mass: &[f64]| self.start_weights(point, &map, mass, steady.is_linear);
                let others = steady.replicates.iter().map(|mass| of_mass(mass)).collect();
                (of_mass(steady.mass), others)
            }
            None => (flat, Vec::new()),
        };
        with_errors(space, &map, &times, (&weights, &others), cancellation)
    }

    /// Mass and slopes of a density in each cell of a map.
    fn start_weights(
        &self,
        point: &SampledPoint,
        map: &PassageMap,
        mass: &[f64],
        is_linear: bool,
    ) -> Vec<Vec<f64>> {
        let transitions = &point.transitions;
        let mut slopes = vec![[0.0; MAX_DIMENSION]; mass.len()];
        if is_linear {
            let of_cells = transitions.slopes(self.problem.space(), mass);
            for (&cell, of_cell) in transitions.cells().iter().zip(of_cells) {
                slopes[cell] = of_cell;
            }
        }
        let weight = |&cell: &usize| {
            let slopes = slopes[cell].iter().take(map.dimension);
            [1.0]
                .iter()
                .chain(slopes)
                .map(|slope| mass[cell] * slope)
                .collect()
        };
        map.cells.iter().map(weight).collect()
    }
}

/// Why a map tells nothing.
fn fault(map: &PassageMap) -> Option<PassageFault> {
    if map.runaways > 0 {
        Some(PassageFault::RunsAway)
    } else if map.starts.is_empty() {
        Some(PassageFault::Start)
    } else if map.exits == 0.0 {
        Some(PassageFault::Never)
    } else if map.exits < FEWEST {
        Some(PassageFault::Rare)
    } else {
        None
    }
}
