//! How long it lasts: first passage from where a process starts into a region, with the error of each number.
//!
//! A passage is solved with the generator on the cells outside of its target (`generator::absorbing`). The times z that
//! a process which starts spread as p₀ occupies the cells, Q z = -p₀, sum to the mean time, and from there on every
//! moment is one more back substitution: E T² = 2 Σ w with Q w = -z. The share that ends by entering one part of the
//! target is Σ e z, with e the rates at which cells enter that part. The rate is that of the quasi-stationary density,
//! Q u = -r u: what a process has per unit of time that has lasted long.
//!
//! Every number is solved by the scheme, by the same scheme with half its dissipation, and both again on three quarters
//! of the cells. What is given is extrapolated to no dissipation, and its error is what the cells change.
//!
//! ```
//! use pbif::cancellation::Cancellation;
//! use pbif::passage::{Passage, Start, timed};
//! use pbif::space::{Axis, CellSpace};
//! use pbif::system::{regions, registry};
//!
//! // dx = (x - x³) dt + √0.2 dW from -1 until it is beyond 0.
//! let model = registry::find("bistable")?;
//! let given = [("a", 1.0), ("sigma2", 0.2)];
//! let until = regions(&model, &[("right", "x > 0")]).unwrap().remove(0);
//! let passage = Passage {
//!     until: until.level().bind(&model.values(&given)?)?,
//!     exits: Vec::new(),
//!     start: Start::State(vec![-1.0]),
//!     times: vec![10.0],
//!     quantiles: vec![0.5],
//! };
//! let space = CellSpace::new(vec![Axis::uniform(-2.5, 2.5, 200)?])?;
//! let (system, settings) = (model.system_with(&given)?, (&Default::default(), &Default::default()));
//! let found = timed(&system, &space, &passage, None, settings, &Cancellation::new())?;
//! // By quadrature 30.8213.
//! assert!((found.mean.0 - 30.8213).abs() < found.mean.1 + 5e-5);
//! assert!(found.survival[0].0 > 0.6 && found.quantiles[0].0 < found.mean.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | part | file |
//! | --- | --- |
//! | cells, graded toward a barrier of an oscillator | `cells.rs` |
//! | weights of a start | `start.rs` |
//! | what is known of the steady state, and what its errors do | `density_start.rs` |
//! | masses of a density in a region, over the cells of several grids | `spread.rs`, `masses.rs` |
//! | interpolation on all points of a grid | `tensor.rs` |
//! | numbers on one grid | `solve.rs`, `moments.rs` |
//! | shares of exits | `exits.rs` |
//! | the rate, from the vectors of moments | `quasi_stationary.rs` |
//! | its density, by vectors that are made for it | `rate.rs` |
//! | its density, from one grid to another | `lasting.rs` |
//! | probabilities at times, and quantiles | `survival.rs` |
//! | numbers with errors | `timed.rs` |
//! | the same on one axis, from a chain | `on_line.rs`, `bordered.rs` |
//! | places and rates for a start beside a border there | `near_border.rs` |
//! | what is handed from value to value | `memory.rs` |
//! | numbers as fields over the start | `field.rs` |
//! | the same beside a border | `rim.rs` |
//! | fields on one axis, from a chain | `line_fields.rs` |
//! | processes on their way from one region to another | `reactive.rs` |
//! | how they come into the cells | `source.rs` |
//! | their density and current on a grid | `on_way.rs`, `current.rs` |
//! | the steady state between nodes | `steady.rs` |
//! | how often a region is visited, and for how long | `visits.rs` |
//! | a steady state on cells along axes of modes | `laid_out.rs` |
//! | where the level of a region changes its sign | `crossing.rs` |
//! | parts of a region that are narrower than a cell | `dips.rs`, `pocket.rs` |

mod bordered;
mod cells;
mod crossing;
mod current;
mod density_start;
mod dips;
mod exits;
mod field;
mod laid_out;
mod lasting;
mod line_fields;
mod masses;
mod memory;
mod moments;
mod near_border;
mod on_line;
mod on_way;
mod pocket;
mod quasi_stationary;
mod rate;
mod reactive;
mod rim;
mod solve;
mod source;
mod spread;
mod start;
mod steady;
mod survival;
mod tensor;
mod timed;
mod times;
mod visits;

pub use density_start::KnownDensity;
pub use field::{FieldTarget, PassageField, field};
pub(crate) use line_fields::{field_on_line, reactive_on_line};
pub(crate) use memory::PassageMemory;
pub(crate) use on_line::{timed_on_line, transitions_on_line};
pub(crate) use reactive::are_apart;
pub use reactive::{Reactive, reactive};
pub(crate) use timed::timed_from;
pub use timed::{Timed, WithError, timed};
pub use visits::{Visits, visits};
pub(crate) use visits::{is_endless, visits_and};

use crate::generator::{GeneratorError, levels};
use crate::space::{CellSpace, SpaceError};
use crate::stationary::generator::{RateError, dot};
use crate::system::{BoundQuantity, ParameterValues, PassageQuestion, PassageStart, SystemError};

/// A question with values of all parameters: from where, until where.
#[derive(Debug, Clone)]
pub struct Passage {
    /// Negative in the region at whose border the process ends, as a region's level is.
    pub until: BoundQuantity,
    /// Parts of that region, negative inside each: the shares of the processes are wanted that end by entering each.
    pub exits: Vec<BoundQuantity>,
    /// Where it starts.
    pub start: Start,
    /// Times at which the probability is wanted that it still goes on.
    pub times: Vec<f64>,
    /// Shares of the processes, between 0 and 1: the times by which so many have ended are wanted.
    pub quantiles: Vec<f64>,
}

impl Passage {
    /// A question with values of all parameters.
    ///
    /// # Errors
    /// [`SystemError`] for values of another model.
    pub fn bind(question: &PassageQuestion, values: &ParameterValues) -> Result<Self, SystemError> {
        Ok(Self {
            until: question.until.level().bind(values)?,
            exits: (question.exits.iter())
                .map(|part| part.level().bind(values))
                .collect::<Result<_, _>>()?,
            start: match &question.start {
                PassageStart::State(state) => Start::State(state.clone()),
                PassageStart::Region(region) => Start::Density(Some(region.level().bind(values)?)),
                PassageStart::Density => Start::Density(None),
            },
            times: question.times.clone(),
            quantiles: question.quantiles.clone(),
        })
    }
}

impl Passage {
    /// [`Passage::start_level`] at the nodes of cells.
    fn start_levels(&self, space: &CellSpace) -> Result<Vec<f64>, GeneratorError> {
        let mut all = levels(space, &self.until)?;
        all.iter_mut().for_each(|level| *level = -*level);
        if let Start::Density(Some(region)) = &self.start {
            let of_region = levels(space, region)?;
            let pairs = all.iter_mut().zip(of_region);
            pairs.for_each(|(level, other)| *level = level.max(other));
        }
        Ok(all)
    }

    /// Negative where a process that is spread as the steady state is starts: in the region of the start and outside of
    /// the target.
    fn start_level(&self, state: &[f64]) -> f64 {
        let outside = -self.until.at(state);
        match &self.start {
            Start::Density(Some(region)) => outside.max(region.at(state)),
            _ => outside,
        }
    }
}

/// Where a process starts.
#[derive(Debug, Clone)]
pub enum Start {
    /// At a state: one number an axis.
    State(Vec<f64>),
    /// As the steady state has it, in the region where this is negative; all over without one.
    Density(Option<BoundQuantity>),
}

/// Why a passage has no numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PassageError {
    /// No cell is inside the target.
    #[error(
        "no cell is inside the region that is waited for: it lies outside of the cells, or is thinner than one"
    )]
    Nowhere,
    /// A part of the target lies between the nodes of the cells.
    #[error("a part of the region that is waited for lies between the nodes of the cells")]
    Between,
    /// All cells are inside the target.
    #[error("all cells are inside the region that is waited for")]
    Everywhere,
    /// The start is inside the target or outside of the cells, or has no mass.
    #[error(
        "the start is inside the region that is waited for, outside of the cells, or never visited"
    )]
    Start,
    /// The process never enters the target.
    #[error("the region that is waited for is never entered from the start")]
    Never,
    /// Cells and rounding leave an error as large as the time itself.
    #[error("the mean time is not known to its own size")]
    Rounding,
    /// Transitions are between two regions that have cells in common.
    #[error("the two regions of the transitions have states in common")]
    Overlap,
    /// The steady state is not known, and the start is weighted by it.
    #[error("the start is weighted by a steady state, and there is none")]
    NoDensity,
    /// The generator could not be assembled.
    #[error(transparent)]
    Generator(#[from] GeneratorError),
    /// The cells could not be laid out.
    #[error(transparent)]
    Space(#[from] SpaceError),
    /// The generator could not be solved.
    #[error(transparent)]
    Rate(#[from] RateError),
}

/// A probability, which extrapolation may have taken beyond zero or one.
fn probability((value, error): WithError) -> WithError {
    (value.clamp(0.0, 1.0), error)
}
