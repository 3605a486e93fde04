//! The methods side by side: the same densities by the generator, by SGCM as the paper has it and slope-corrected, and
//! by Monte Carlo; times and work, distances with their uncertainties, and the error against time.
//!
//! All densities are compared on *common cells*, the paper's: 50 cells of equal width along the first two axes, as many
//! as the file has along the others (16 where the generator has modes). SGCM and Monte Carlo work on these cells; what
//! others give is brought there by `rebin()`.

mod accuracy;
mod agreement;
mod distance;
mod exact;
mod measures;
mod method;
mod observer;
mod overlap;
mod solve;
#[cfg(test)]
mod turns_tests;

pub use accuracy::{Accuracy, AccuracyPoint, Reference};
pub use agreement::Agreement;
pub use distance::{Distance, Distances, distances};
pub(crate) use exact::exact_density;
pub use exact::exact_masses;
pub(crate) use measures::ComparedMeasure;
pub use method::Method;
pub use observer::CompareObserver;
pub use solve::{Solved, Work};

use crate::cancellation::Cancellation;
use crate::continuation::Subject;
use crate::density::{BINS_OF_A_TURN, EstimatedDensity, Observable};
use crate::method::{GeneratorMethodOptions, MethodError, MonteCarloOptions, Problem, SgcmOptions};
use crate::space::{Axis, CellSpace};
use observer::Steps;
use solve::Sources;

/// Cells of equal width along the first two axes of the paper's cell space.
pub(crate) const PAPER_CELLS: usize = 50;

/// Cells along an axis that the generator carries by modes.
const MODE_CELLS: usize = 16;

/// Time one transition of the paper's cell map spans.
pub(crate) const PAPER_MAP_STEP: f64 = 1.0;

/// What is compared.
#[derive(Debug, Clone)]
pub struct Task<'a> {
    /// The systems, the cells of the generator, and what is watched.
    pub problem: &'a Problem,
    /// Parameter values to compare at, inside the range.
    pub at: &'a [f64],
    /// Settings of the generator.
    pub generator: GeneratorMethodOptions,
    /// Settings of SGCM; map step and correction are replaced by those of the comparison.
    pub sgcm: SgcmOptions,
    /// Settings of Monte Carlo.
    pub monte_carlo: MonteCarloOptions,
}

/// Two methods at one parameter value.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The one.
    pub first: Method,
    /// The other; `None` is the exact density.
    pub second: Option<Method>,
    /// The density that is compared.
    pub observable: Observable,
    /// How far they are apart.
    pub distances: Distances,
}

/// Everything at one parameter value.
#[derive(Debug, Clone)]
pub struct ComparedValue {
    /// The value.
    pub value: f64,
    /// The methods in the order of [`Method::ALL`].
    pub solved: Vec<Solved>,
    /// Every two methods with a density, and every method with the exact density where it is known, a row an
    /// observable.
    pub pairs: Vec<Pair>,
    /// Generator and Monte Carlo bin by bin, a row a marginal; empty unless both have densities.
    pub agreement: Vec<Agreement>,
}

impl ComparedValue {
    /// The distances of two methods.
    pub(crate) fn pair(
        &self,
        first: Method,
        second: Option<Method>,
        observable: Observable,
    ) -> Option<&Distances> {
        let mut pairs = self.pairs.iter();
        pairs
            .find(|pair| (pair.first, pair.second, pair.observable) == (first, second, observable))
            .map(|pair| &pair.distances)
    }

    /// Marginals on which generator and Monte Carlo disagree beyond their stated uncertainties: in more than 1 % of the
    /// bins (two are let pass), and as a whole by total variation. Bins err together, so that one fluctuation may put
    /// many of them outside; the replicates of the distance know that.
    pub(crate) fn disagreements(&self) -> Vec<Observable> {
        let disagrees = |one: &&Agreement| {
            let both = (Method::Generator, Some(Method::MonteCarlo));
            let whole = self.pair(both.0, both.1, one.observable);
            one.beyond > (one.bins / 100).max(2)
                && whole.is_some_and(|whole| whole.total_variation.is_significant())
        };
        let found = self.agreement.iter().filter(disagrees);
        found.map(|one| one.observable).collect()
    }

    /// Where generator and Monte Carlo disagree and mass leaves Ω: the escape rate and the share of the time outside.
    /// The one is conditioned on never having left, the other on being inside.
    pub(crate) fn leaves(&self) -> Option<(f64, f64)> {
        let by = |method| self.solved.iter().find(|solved| solved.method == method);
        let rate = by(Method::Generator)?.report.measure("escape_rate")?;
        let outside = by(Method::MonteCarlo)?.share_outside?;
        let leaves = rate > 0.0 && outside > 0.0;
        (leaves && !self.disagreements().is_empty()).then_some((rate, outside))
    }

    /// The density of an observable by one method, on the common cells.
    pub fn density(&self, method: Method, observable: Observable) -> Option<&EstimatedDensity> {
        let solved = self.solved.iter().find(|solved| solved.method == method)?;
        let mut densities = solved.densities.iter();
        densities.find(|density| density.observable == observable)
    }
}

/// A finished comparison.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// The common cells.
    pub common: CellSpace,
    /// What was compared.
    pub subject: Subject,
    /// The values, in the order that was given.
    pub values: Vec<ComparedValue>,
    /// Error against time at one of the values; `None` where there was nothing to measure it by.
    pub accuracy: Option<Accuracy>,
    /// Whether it was ended early: values, or the error against time, are missing.
    pub interrupted: bool,
}

impl Comparison {
    /// Whether every method gave a density at every value that may be relied on.
    pub(crate) fn is_complete(&self) -> bool {
        let mut all = self.values.iter().flat_map(|value| &value.solved);
        all.all(|solved| solved.status.is_resolved())
    }

    /// Bins of all marginals at all values, and those in which generator and Monte Carlo differ by more than three
    /// standard errors and the generator's own error together.
    pub(crate) fn bins(&self) -> (usize, usize) {
        let all = self.values.iter().flat_map(|value| &value.agreement);
        all.fold((0, 0), |(bins, beyond), one| {
            (bins + one.bins, beyond + one.beyond)
        })
    }

    /// Whether generator and Monte Carlo agree within their stated uncertainties on every marginal at every value.
    pub fn agrees(&self) -> bool {
        let mut values = self.values.iter();
        values.all(|value| value.disagreements().is_empty())
    }
}

/// How far a comparison is.
#[derive(Debug, Clone, PartialEq)]
pub struct CompareStep {
    /// Steps that are done.
    pub done: usize,
    /// Steps in all.
    pub total: usize,
    /// What is done next.
    pub next: String,
}

/// Why a comparison was not made. Failed solves are data.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// A method refuses.
    #[error(transparent)]
    Method(MethodError),
    /// The common cells cannot be laid out.
    #[error(transparent)]
    Space(#[from] crate::space::SpaceError),
    /// Densities cannot be compared.
    #[error(transparent)]
    Density(#[from] crate::density::DensityError),
    /// A source of densities refuses.
    #[error(transparent)]
    Source(Box<dyn std::error::Error + Send + Sync>),
    /// Whoever observes cannot go on.
    #[error(transparent)]
    Observer(Box<dyn std::error::Error + Send + Sync>),
}

impl From<MethodError> for CompareError {
    fn from(error: MethodError) -> Self {
        match error {
            MethodError::Cancelled(_) => Self::Interrupted,
            error => Self::Method(error),
        }
    }
}

/// The common cells of a sweep on `space`: the same ranges, `PAPER_CELLS` cells of equal width along the first two
/// axes and as many as `space` has along the others.
///
/// # Errors
/// [`crate::space::SpaceError`].
pub fn common_cells(space: &CellSpace) -> Result<CellSpace, crate::space::SpaceError> {
    uniform_cells(space, PAPER_CELLS)
}

/// Cells of equal width over the ranges of `space`: `count` along the first two axes.
fn uniform_cells(space: &CellSpace, count: usize) -> Result<CellSpace, crate::space::SpaceError> {
    let axes = space.axes().iter().enumerate();
    let axes: Result<Vec<Axis>, _> = axes
        .map(|(index, axis)| {
            if axis.is_closed() {
                // Two bins of those that densities along an angle are laid out on.
                return Axis::turn(axis.from(), axis.to(), BINS_OF_A_TURN / 2);
            }
            let count = match (index < 2, axis.is_modes()) {
                (true, _) => count,
                (false, true) => MODE_CELLS,
                (false, false) => axis.count(),
            };
            Axis::uniform(axis.from(), axis.to(), count)
        })
        .collect();
    CellSpace::new(axes?)
}

/// Solves by every method at every value and compares. `observer` is told before every step, and may know what a step
/// gives from a comparison that was ended early; a closure is only told. Cancelled, it ends early and says so, in
/// [`CompareError::Interrupted`] before there is a value. Everything but the times is the same for any number of
/// threads.
///
/// # Errors
/// [`CompareError`].
pub fn compare(
    task: &Task<'_>,
    cancellation: &Cancellation,
    observer: &mut dyn CompareObserver,
) -> Result<Comparison, CompareError> {
    let common = common_cells(task.problem.space())?;
    // Preparation, the generator, SGCM by both corrections, Monte Carlo; and the error against time.
    let total = 2 + 3 * task.at.len();
    let mut steps = Steps::new(observer, total, cancellation);
    steps.next("choosing steps".to_owned())?;
    let sources = Sources::new(task, &common, cancellation)?;
    let mut comparison = Comparison {
        common: common.clone(),
        subject: task.problem.subject().clone(),
        values: Vec::new(),
        accuracy: None,
        interrupted: false,
    };
    match comparison.fill(task, &sources, &mut steps) {
        Err(CompareError::Interrupted) if !comparison.values.is_empty() => {
            comparison.interrupted = true;
        }
        filled => filled?,
    }
    Ok(comparison)
}

impl Comparison {
    /// Solves at every value, and measures the error against time.
    fn fill(
        &mut self,
        task: &Task<'_>,
        sources: &Sources<'_>,
        steps: &mut Steps<'_>,
    ) -> Result<(), CompareError> {
        let parameter = task.problem.family().parameter();
        for &value in task.at {
            let at = |method: &str| format!("{parameter} = {value}: {method}");
            steps.next(at("generator"))?;
            let mut solved = steps.solved(&mut || Ok(vec![sources.generator(value)?]))?;
            steps.next(at("SGCM"))?;
            solved.extend(steps.solved(&mut || sources.sgcm(value))?);
            steps.next(at("Monte Carlo"))?;
            solved.extend(steps.solved(&mut || Ok(vec![sources.monte_carlo(value)?]))?);
            let pairs = pairs(task, &self.common, value, &solved)?;
            let agreement = agreement::of_marginals(&solved);
            self.values.push(ComparedValue {
                value,
                solved,
                pairs,
                agreement,
            });
        }
        steps.next("error against time".to_owned())?;
        self.accuracy = accuracy::measure(task, &self.common, sources, &self.values, steps)?;
        Ok(())
    }
}

/// All pairs of methods, and methods with the exact density.
fn pairs(
    task: &Task<'_>,
    common: &CellSpace,
    value: f64,
    solved: &[Solved],
) -> Result<Vec<Pair>, CompareError> {
    let mut pairs = Vec::new();
    for (index, one) in solved.iter().enumerate() {
        for other in &solved[index + 1..] {
            let shared = one.method.shares_samples(other.method);
            for (a, b) in one.densities.iter().zip(&other.densities) {
                pairs.push(Pair {
                    first: one.method,
                    second: Some(other.method),
                    observable: a.observable,
                    distances: distances(a, b, shared)?,
                });
            }
        }
        for density in &one.densities {
            // The truth is taken through the same cells, so that what rebinning does to it does not count as an error.
            let space = match one.method {
                Method::Generator => task.problem.space(),
                _ => common,
            };
            let exact = exact_density(
                task.problem.family(),
                value,
                space,
                common,
                density.observable,
            )?;
            if let Some(exact) = exact {
                pairs.push(Pair {
                    first: one.method,
                    second: None,
                    observable: density.observable,
                    distances: distances(density, &exact, false)?,
                });
            }
        }
    }
    Ok(pairs)
}
