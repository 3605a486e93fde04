//! Methods: sources of densities for a sweep, each made of the modules before it and each in a wing of its own.
//!
//! # Decisions
//!
//! **One choice of steps a sweep.** Steps left to the program are chosen once, from pilots at both ends and in the
//! middle: a step that changed along the sweep would make the matrix jump.
//!
//! **Sampling errors by leaving out groups of samples.** The samples of every cell are split into groups; how the
//! steady state changes without each group (delete-a-group jackknife) follows to first order from one linear
//! equation (`stationary`, `first_order.rs`), so that each density carries standard errors that include how
//! sampling noise travels through the solve.
//!
//! **Slopes inside cells are a fixed point.** The slope correction of SGCM weights samples by the density at their
//! starts, which depends on the density sought. Slopes and masses are found by turns (`method::solve_corrected`);
//! the support of the matrix never changes, so closed classes are those of the plain cell map, and slopes are
//! limited so that weights stay positive: it remains a Markov chain, for which all solvers hold. Replicates know of
//! the slopes too.
//!
//! **`method` stands alone.** Sources of densities need sampling, solving and density together, and neither
//! `continuation` nor `cli` is the place for that. Each method has a wing of its own: its settings with their defaults,
//! its cost, its source. What a solve says of itself is a report with findings, made by limits that are the same for
//! all methods.

mod any;
mod beside_ends;
mod bins;
mod cost;
mod ends;
mod exponents;
mod forcing;
mod generator;
mod lattice;
mod measures;
mod monte_carlo;
mod natural_ends;
mod neighbours;
mod options;
mod problem;
mod range;
mod report;
mod sgcm;
mod step_errors;
mod sticking;
mod structure;
mod swap;
mod tails;
mod time_step;
mod watched;

pub use any::MethodSource;
pub(crate) use bins::{BinsError, QuantityRange, automatic_bins, check_averaged};
pub(crate) use cost::Cost;
pub(crate) use generator::GeneratorCost;
pub use generator::{GeneratorMethodOptions, GeneratorSource};
pub(crate) use generator::{
    OneAxisFamily, automatic_modes, change_by_more_modes, cost_of_largest_exponent,
    highest_frequency,
};
pub use measures::DerivedMeasure;
#[cfg(feature = "store")]
pub(crate) use measures::{columns_of_family, passage_columns, questions_about};
pub(crate) use monte_carlo::MonteCarloCost;
pub use monte_carlo::{Estimator, MonteCarloOptions, MonteCarloSource};
pub use options::MethodOptions;
pub use problem::Problem;
pub(crate) use range::{KnownEnds, RangeError, automatic_ranges, pilot_box, repeats_along};
#[cfg(feature = "store")]
pub(crate) use sgcm::FEWEST_PHASES;
pub(crate) use sgcm::SgcmCost;
pub use sgcm::{Corrected, Correction, SgcmOptions, SgcmSource, solve_corrected};
pub(crate) use sticking::check_sticking;
pub(crate) use structure::{fixed_surfaces, wants_face};
pub use time_step::StepChoice;

use crate::cancellation::Cancelled;
use crate::continuation::SourceError;
use crate::monte_carlo::MonteCarloError;
use crate::sampling::{SamplingError, frequency_of_forcing};
use crate::stationary::StationaryError;
use crate::stationary::generator::RateError;
use crate::system::PassageStart;

/// Most even parts of a forcing's period at which trajectories are looked at.
const MOST_PHASES: usize = 120;

/// Why a method cannot give a solution at all. Failed solves are data, see
/// [`PointStatus`](crate::continuation::PointStatus).
#[derive(Debug, thiserror::Error)]
pub enum MethodError {
    /// The cells have another number of axes than the model.
    #[error("the model has {axes} axes, the cells have {cells}")]
    Dimension {
        /// Axes of the model.
        axes: usize,
        /// Axes of the cells.
        cells: usize,
    },
    /// A parameter value is not allowed.
    #[error(transparent)]
    System(#[from] crate::system::SystemError),
    /// The drift depends on time.
    #[error(transparent)]
    Periodic(#[from] crate::system::PeriodicDrift),
    /// Cell maps and Monte Carlo, at phases of a forcing that are not parts of one division of the period.
    #[error(
        "the phases that are watched are no parts of a period divided evenly by at most {MOST_PHASES}, at which trajectories are looked at: give fractions of a common denominator up to there"
    )]
    Phases,
    /// Times of first passage, or slow modes, of a system under a periodic force.
    #[error(
        "times of first passage and slow modes are not worked out under a periodic force: leave `[passage]` and `[relaxation]` out"
    )]
    ForcedQuestion,
    /// A passage with a region whose border runs through an axis of modes: what ends there has no smooth density.
    #[error(
        "passage `{passage}` has a region that depends on `{axis}`, which modes carry: give {}",
        if *.is_turn { "`method.kind = \"monte-carlo\"`, or a region of other states".to_owned() }
        else { format!("`cells.{axis}.count` in place of modes") }
    )]
    RegionOfModes {
        /// Name of the passage.
        passage: String,
        /// Name of the axis.
        axis: String,
        /// Whether it closes on itself, so that it has no cells.
        is_turn: bool,
    },
    /// Fields of passages over more than two axes, or fields or transitions over one that is no axis of cells.
    #[error(
        "transitions of passages are worked out over axes of cells, fields over one or two axes of cells, and this system has {axes} axes{}; leave `fields` and `transitions` out of `[passage]`",
        if *.has_series { ", one of them a series" } else { "" }
    )]
    FieldAxes {
        /// Number of axes.
        axes: usize,
        /// Whether one carries a series.
        has_series: bool,
    },
    /// Monte Carlo and SGCM, of a passage with a region that is found in a density.
    #[error(
        "passage `{passage}` has a region that is found in a density, which the generator does alone: give an inequality in its place"
    )]
    Basin {
        /// Name of the passage.
        passage: String,
    },
    /// A forcing whose phase does not move, or runs backwards.
    #[error(
        "the frequency of the forcing is {frequency} periods per unit of time at {parameter} = {value}; it must be positive"
    )]
    Standing {
        /// Periods per unit of time.
        frequency: f64,
        /// The swept parameter.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// States stay on a switching surface for a time, so that there is no density.
    #[error(
        "friction sticks: beside {axis} = {at} the drift of `{axis}` points toward {axis} = {at} from both sides (as at {state}), and no \
         white noise acts on `{axis}`; a part of the probability then lies on {axis} = {at} itself, which no density holds"
    )]
    Sticks {
        /// Name of the axis across which nothing moves.
        axis: String,
        /// Value of its coordinate there.
        at: f64,
        /// A state that stays, with the parameter's value.
        state: String,
    },
    /// The cells cannot be laid out.
    #[error(transparent)]
    Space(#[from] crate::space::SpaceError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Transitions could not be sampled.
    #[error(transparent)]
    Sampling(SamplingError),
    /// Free trajectories could not be run.
    #[error(transparent)]
    MonteCarlo(MonteCarloError),
    /// The generator could not be assembled.
    #[error("{words}")]
    Generator {
        /// Why.
        #[source]
        error: crate::generator::GeneratorError,
        /// The same with the names of the axes.
        words: String,
    },
    /// The generator cannot be solved.
    #[error(transparent)]
    Rates(RateError),
    /// The transition matrix cannot be solved.
    #[error(transparent)]
    Stationary(StationaryError),
    /// Beside the solved value there is no steady state to compare with.
    #[error(
        "there is no steady state on both sides of the value, so no derivative by the parameter"
    )]
    NoSensitivity,
    /// A density could not be computed.
    #[error(transparent)]
    Density(#[from] crate::density::DensityError),
}

/// Nothing, if all along its path a problem has densities that do not change with time: no system depends on time, and
/// nothing sticks to a surface.
fn has_densities(problem: &Problem) -> Result<(), MethodError> {
    for system in problem.family().along()? {
        system.facts().autonomous()?;
    }
    check_questions(problem)?;
    let family = problem.family();
    let (from, to) = family.ends();
    for value in [from, 0.5 * (from + to), to] {
        let system = family.at(value)?;
        let Some((_, frequency)) = frequency_of_forcing(system.as_ref()) else {
            break;
        };
        if !(frequency.is_finite() && frequency > 0.0) {
            let parameter = family.parameter().to_owned();
            return Err(MethodError::Standing {
                frequency,
                parameter,
                value,
            });
        }
    }
    let axes = problem.space().axes().iter();
    let ranges: Vec<(f64, f64)> = axes.map(|axis| (axis.from(), axis.to())).collect();
    check_sticking(problem.family(), &ranges)
}

/// Nothing, if what is asked beside densities is worked out for such a system on such cells.
///
/// # Errors
/// [`MethodError::ForcedQuestion`], [`MethodError::RegionOfModes`] or [`MethodError::FieldAxes`].
pub(crate) fn check_questions(problem: &Problem) -> Result<(), MethodError> {
    let family = problem.family();
    let asks = !family.questions.passages.is_empty() || family.questions.slow_modes > 0;
    if asks && family.model().phase_axis().is_some() {
        return Err(MethodError::ForcedQuestion);
    }
    let space = problem.space();
    check_regions(problem)?;
    let has_series = space.axes().iter().any(crate::space::Axis::is_modes);
    let has_fields = family.fields().next().is_some();
    let passages = &family.questions.passages;
    let has_transitions = passages.iter().any(|one| one.transitions.is_some());
    if has_fields && space.dimension() > 2 || (has_fields || has_transitions) && has_series {
        let axes = space.dimension();
        return Err(MethodError::FieldAxes { axes, has_series });
    }
    Ok(())
}

/// Nothing, if no border of a region of a passage runs through an axis of modes.
fn check_regions(problem: &Problem) -> Result<(), MethodError> {
    let (family, space) = (problem.family(), problem.space());
    for passage in &family.questions.passages {
        let start = match &passage.start {
            PassageStart::Region(region) => Some(region),
            PassageStart::State(_) | PassageStart::Density => None,
        };
        let regions = [&passage.until].into_iter().chain(&passage.exits);
        for region in regions.chain(start) {
            let depends = region.level().states().iter();
            let axes = space.axes().iter().zip(depends).enumerate();
            let mut carried = axes.filter(|(_, (axis, depends))| **depends && axis.is_modes());
            if let Some((number, (axis, _))) = carried.next() {
                return Err(MethodError::RegionOfModes {
                    passage: passage.name.clone(),
                    axis: family.axis(number).to_owned(),
                    is_turn: axis.is_closed(),
                });
            }
        }
    }
    Ok(())
}

// Whatever part of a method was asked to stop, the method was.

impl From<SamplingError> for MethodError {
    fn from(error: SamplingError) -> Self {
        match error {
            SamplingError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Sampling(error),
        }
    }
}

impl From<MonteCarloError> for MethodError {
    fn from(error: MonteCarloError) -> Self {
        match error {
            MonteCarloError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::MonteCarlo(error),
        }
    }
}

impl From<RateError> for MethodError {
    fn from(error: RateError) -> Self {
        match error {
            RateError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Rates(error),
        }
    }
}

impl From<StationaryError> for MethodError {
    fn from(error: StationaryError) -> Self {
        match error {
            StationaryError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Stationary(error),
        }
    }
}

impl From<MethodError> for SourceError {
    fn from(error: MethodError) -> Self {
        match error {
            MethodError::Cancelled(_) => Self::Interrupted,
            error => Self::Method(Box::new(error)),
        }
    }
}

#[cfg(test)]
mod tests;
