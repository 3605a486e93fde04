//! One method at one parameter value: its density on the common cells, and what it cost.

use std::time::Instant;

use super::exact::common_axes;
use super::{CompareError, Method, PAPER_MAP_STEP, Task, overlap::rebin_density};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource, PointStatus, Solution, SolveReport, SourceError};
use crate::density::EstimatedDensity;
use crate::method::{
    Correction, GeneratorSource, MonteCarloOptions, MonteCarloSource, SgcmOptions, SgcmSource,
    StepChoice,
};
use crate::space::CellSpace;
use crate::system::Family;

/// What a solve took.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Work {
    /// Seconds before the first value, shared by all: choosing steps and lengths.
    pub preparation_seconds: f64,
    /// Seconds of running trajectories; of SGCM both corrections share them, and each counts them in full.
    pub sampling_seconds: f64,
    /// Seconds of solving, replicates and second scheme included.
    pub solve_seconds: f64,
    /// Integrator steps of all trajectories together.
    pub steps: u64,
    /// Samples a cell (SGCM), or trajectories (Monte Carlo).
    pub samples: usize,
    /// Bytes at work as the method predicts them, SGCM from the transitions that were counted; `None` where they exceed
    /// the method's limit.
    pub bytes: Option<f64>,
    /// Cells that were worked on.
    pub cells: usize,
}

impl Work {
    /// Seconds at this value.
    pub(crate) fn seconds(&self) -> f64 {
        self.sampling_seconds + self.solve_seconds
    }
}

/// A method's result at one parameter value.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Solved {
    /// The method.
    pub method: Method,
    /// How it ended.
    pub status: PointStatus,
    /// What it says of itself.
    pub report: SolveReport,
    /// What it took.
    pub work: Work,
    /// Step of the integrator; `None` for the generator.
    pub time_step: Option<f64>,
    /// Share of the time that Monte Carlo's trajectories spent outside Ω and were not counted; `None` for the others.
    pub share_outside: Option<f64>,
    /// The densities that are watched, on the common cells; empty without a density.
    pub densities: Vec<EstimatedDensity>,
}

/// The methods, prepared for all values.
pub(super) struct Sources<'a> {
    task: &'a Task<'a>,
    common: &'a CellSpace,
    cancellation: &'a Cancellation,
    sgcm: SgcmSource,
    sgcm_seconds: f64,
    monte_carlo: MonteCarloSource,
    monte_carlo_seconds: f64,
}

impl<'a> Sources<'a> {
    pub(super) fn new(
        task: &'a Task<'a>,
        common: &'a CellSpace,
        cancellation: &'a Cancellation,
    ) -> Result<Self, CompareError> {
        let clock = Instant::now();
        let sgcm = sgcm_on(task, common, cancellation)?;
        let sgcm_seconds = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        let problem = task.problem.on(common.clone())?;
        let monte_carlo = MonteCarloSource::new(&problem, &task.monte_carlo, cancellation)?;
        Ok(Self {
            task,
            common,
            cancellation,
            sgcm,
            sgcm_seconds,
            monte_carlo,
            monte_carlo_seconds: clock.elapsed().as_secs_f64(),
        })
    }

    pub(super) fn generator(&self, value: f64) -> Result<Solved, CompareError> {
        generator_on(
            self.task,
            self.task.problem.space(),
            self.common,
            value,
            self.cancellation,
        )
    }

    pub(super) fn sgcm(&self, value: f64) -> Result<Vec<Solved>, CompareError> {
        let mut both = sgcm_both(
            &self.sgcm,
            &self.task.sgcm,
            self.common,
            value,
            self.cancellation,
        )?;
        for solved in &mut both {
            solved.work.preparation_seconds = self.sgcm_seconds;
        }
        Ok(both)
    }

    pub(super) fn monte_carlo(&self, value: f64) -> Result<Solved, CompareError> {
        let mut solved = monte_carlo_by(
            &self.monte_carlo,
            &self.task.monte_carlo,
            self.common,
            value,
            self.cancellation,
        )?;
        solved.work.preparation_seconds = self.monte_carlo_seconds;
        Ok(solved)
    }

    /// Both cell maps on other cells.
    pub(super) fn sgcm_on(
        &self,
        space: &CellSpace,
        value: f64,
    ) -> Result<Vec<Solved>, CompareError> {
        sgcm_both(
            &self.sgcm.on(space)?,
            &self.task.sgcm,
            self.common,
            value,
            self.cancellation,
        )
    }

    /// Monte Carlo for a share of its time.
    pub(super) fn monte_carlo_for(&self, share: f64, value: f64) -> Result<Solved, CompareError> {
        monte_carlo_by(
            &self.monte_carlo.shortened(share),
            &self.task.monte_carlo,
            self.common,
            value,
            self.cancellation,
        )
    }
}

/// The cell map on some cells, with the paper's map step, or a single time step where that is longer.
fn sgcm_on(
    task: &Task<'_>,
    space: &CellSpace,
    cancellation: &Cancellation,
) -> Result<SgcmSource, CompareError> {
    let problem = task.problem.on(space.clone())?;
    let source = |map_step: f64| {
        let options = SgcmOptions {
            map_step: StepChoice::Fixed(map_step),
            correction: Correction::Slope,
            ..task.sgcm.clone()
        };
        SgcmSource::new(&problem, &options, cancellation)
    };
    let paper = source(PAPER_MAP_STEP)?;
    Ok(if paper.time_step() > PAPER_MAP_STEP {
        source(paper.time_step())?
    } else {
        paper
    })
}

/// The generator on some cells, from nothing: every value pays for its factorisation.
pub(super) fn generator_on(
    task: &Task<'_>,
    space: &CellSpace,
    common: &CellSpace,
    value: f64,
    cancellation: &Cancellation,
) -> Result<Solved, CompareError> {
    let clock = Instant::now();
    let problem = task.problem.on(space.clone())?;
    let source = GeneratorSource::new(&problem, &task.generator)?;
    let mut session = source.open(cancellation);
    let solution = session.solve(value).map_err(|error| match error {
        SourceError::Interrupted => CompareError::Interrupted,
        SourceError::Method(error) => CompareError::Source(error),
    })?;
    let solution = solution.detached();
    let work = Work {
        solve_seconds: clock.elapsed().as_secs_f64(),
        bytes: task.generator.cost(space).ok().map(|cost| cost.bytes),
        cells: space.n_cells(),
        ..Work::default()
    };
    let on = (task.problem.family(), common);
    solved(Method::Generator, solution, work, None, on)
}

/// The cell map plain and slope-corrected, from the same samples.
fn sgcm_both(
    source: &SgcmSource,
    options: &SgcmOptions,
    common: &CellSpace,
    value: f64,
    cancellation: &Cancellation,
) -> Result<Vec<Solved>, CompareError> {
    let clock = Instant::now();
    let point = source.sample_at(value, None, cancellation)?;
    let sampling_seconds = clock.elapsed().as_secs_f64();
    let transitions = point.transitions();
    // Both corrections work on samples that keep their starts.
    let sampled = SgcmOptions {
        correction: Correction::Slope,
        ..options.clone()
    };
    let (entries, cells) = (transitions.matrix().matrix.nnz(), transitions.cells().len());
    let bytes = sampled.bytes(entries as f64, cells as f64, common.dimension());
    let work = Work {
        sampling_seconds,
        steps: transitions.n_steps(),
        samples: options.samples,
        bytes: Some(bytes),
        cells,
        ..Work::default()
    };
    [
        (Method::Sgcm, Correction::None),
        (Method::SgcmSlope, Correction::Slope),
    ]
    .into_iter()
    .map(|(method, correction)| {
        let clock = Instant::now();
        let (solution, _) = source.solve_sampled(&point, correction, None, cancellation)?;
        let work = Work {
            solve_seconds: clock.elapsed().as_secs_f64(),
            ..work.clone()
        };
        let step = Some(transitions.time_step());
        let on = (&source.subject().family, common);
        solved(method, solution, work, step, on)
    })
    .collect()
}

fn monte_carlo_by(
    source: &MonteCarloSource,
    options: &MonteCarloOptions,
    common: &CellSpace,
    value: f64,
    cancellation: &Cancellation,
) -> Result<Solved, CompareError> {
    let clock = Instant::now();
    let (solution, estimate) = source.estimate(value, cancellation)?;
    let work = Work {
        sampling_seconds: clock.elapsed().as_secs_f64(),
        steps: estimate.steps,
        samples: source.plan().trajectories,
        bytes: Some(options.cost(common.n_cells() as f64).bytes),
        cells: common.n_cells(),
        ..Work::default()
    };
    let step = Some(source.plan().time_step);
    let on = (&source.subject().family, common);
    Ok(Solved {
        share_outside: Some(estimate.share_outside),
        ..solved(Method::MonteCarlo, solution, work, step, on)?
    })
}

/// Brings the densities to the common cells.
fn solved(
    method: Method,
    solution: Solution<'_>,
    work: Work,
    time_step: Option<f64>,
    (family, common): (&Family, &CellSpace),
) -> Result<Solved, CompareError> {
    let densities = solution.densities.iter();
    let densities: Result<Vec<EstimatedDensity>, CompareError> = densities
        .map(|density| {
            let axes = common_axes(family, common, density);
            Ok(rebin_density(density, &axes)?)
        })
        .collect();
    Ok(Solved {
        method,
        status: solution.report.status,
        report: solution.report,
        work,
        time_step,
        share_outside: None,
        densities: densities?,
    })
}
