//! Stochastic generalized cell mapping as a source of densities: its steps, chosen once, and the cell map that it
//! samples at a value.

use std::sync::Arc;

use super::phases::FEWEST_PHASES;
use super::steps::{Steps, choose_steps};
use super::{Correction, SgcmOptions};
use crate::cancellation::Cancellation;
use crate::continuation::Subject;
use crate::method::forcing::on_even_turns;
use crate::method::{MethodError, Problem};
use crate::sampling::{
    SampledTransitions, SamplingError, SamplingOptions, part_of_period, sample_transitions,
};
use crate::space::CellSpace;
use crate::system::System;

/// Name of the method in tables.
pub(super) const METHOD: &str = "sgcm";

/// Densities along one parameter by SGCM.
#[derive(Debug, Clone)]
pub struct SgcmSource {
    pub(super) problem: Problem,
    pub(super) options: SgcmOptions,
    pub(super) steps: Steps,
}

/// The sampled cell map at one parameter value, to be solved with either [`Correction`].
pub(crate) struct SampledPoint {
    pub(super) value: f64,
    pub(super) system: Arc<dyn System>,
    pub(super) transitions: SampledTransitions,
}

impl SampledPoint {
    /// The samples.
    pub(crate) fn transitions(&self) -> &SampledTransitions {
        &self.transitions
    }
}

impl SgcmSource {
    /// What it gives densities of.
    pub(in crate::method) fn problem(&self) -> &Problem {
        &self.problem
    }

    /// Prepares a source; steps left to the program are chosen here, once, so that the transition matrix varies
    /// smoothly along the sweep.
    ///
    /// # Errors
    /// [`MethodError`].
    pub fn new(
        problem: &Problem,
        options: &SgcmOptions,
        cancellation: &Cancellation,
    ) -> Result<Self, MethodError> {
        check_passages(problem)?;
        let problem = &on_even_turns(problem, FEWEST_PHASES)?;
        let steps = choose_steps(problem, options, cancellation)?;
        Ok(Self {
            problem: problem.checked_by(SgcmOptions::CELL_CHECK),
            options: options.clone(),
            steps,
        })
    }

    pub(super) fn subject(&self) -> &Subject {
        self.problem.subject()
    }

    /// Number of cells of the space.
    pub(super) fn cells(&self) -> usize {
        self.problem.space().n_cells()
    }

    /// The same source on other cells over the same ranges, with the steps that were chosen, and cells along phases and
    /// angles as they are.
    ///
    /// # Errors
    /// [`MethodError`] when the cells have another number of axes.
    pub(crate) fn on(&self, space: &CellSpace) -> Result<Self, MethodError> {
        let check = self.problem.subject().cell_check;
        let own = self.problem.space().axes();
        let axes = space.axes().iter().zip(own);
        let axes = axes.map(|(other, own)| if own.is_closed() { own } else { other });
        let space = &CellSpace::new(axes.cloned().collect())?;
        let problem = self.problem.on(space.clone())?.checked_by(check);
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
        })
    }

    /// What the density inside a cell is taken for.
    pub(super) fn correction(&self) -> Correction {
        self.options.correction
    }

    /// Time one transition spans.
    pub(crate) fn map_step(&self) -> f64 {
        self.steps.map_step
    }

    /// Step of the trajectory integrator.
    pub(crate) fn time_step(&self) -> f64 {
        self.steps.time_step
    }

    fn sample(
        &self,
        system: &dyn System,
        start: Option<&[f64]>,
        cancellation: &Cancellation,
    ) -> Result<SampledTransitions, SamplingError> {
        let part = part_of_period(system, self.problem.space());
        let passed = self.steps.phase.map(|phase| phase.passed as f64);
        let of_period = part.zip(passed).map(|(part, passed)| part * passed);
        let options = SamplingOptions {
            map_step: of_period.unwrap_or(self.steps.map_step),
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
        sample_transitions(system, self.problem.space(), &seeds, &options, cancellation)
    }

    /// Samples the cell map at a parameter value, to be solved by [`SgcmSource::solve_sampled`]. Where samples started
    /// is kept when the options ask for slope correction.
    ///
    /// # Errors
    /// [`MethodError`] when the value is not allowed, or sampling was cancelled.
    pub(crate) fn sample_at(
        &self,
        value: f64,
        start: Option<&[f64]>,
        cancellation: &Cancellation,
    ) -> Result<SampledPoint, MethodError> {
        let system = self.problem.family().at(value)?;
        let transitions = self.sample(system.as_ref(), start, cancellation)?;
        Ok(SampledPoint {
            value,
            system,
            transitions,
        })
    }
}

/// Nothing, if passages are between inequalities, of a system without a periodic force.
fn check_passages(problem: &Problem) -> Result<(), MethodError> {
    let family = problem.family();
    let passages = &family.questions.passages;
    if let Some(one) = passages.iter().find(|one| one.has_basins()) {
        let passage = one.name.clone();
        return Err(MethodError::Basin { passage });
    }
    if !passages.is_empty() && family.model().phase_axis().is_some() {
        return Err(MethodError::ForcedQuestion);
    }
    Ok(())
}
