//! Settings of the methods and their defaults, the only place where these defaults stand.

use crate::generator::AdvectiveScheme;
use crate::sampling::Integrator;
use crate::stationary::Solver;

/// Largest share of the mass that may leave Ω within one relaxation time, whatever the method.
const ESCAPE_LIMIT: f64 = 0.5;

/// A method with its settings.
#[derive(Debug, Clone, PartialEq)]
pub enum MethodOptions {
    /// The generator, solved directly.
    Generator(GeneratorMethodOptions),
    /// Stochastic generalized cell mapping.
    Sgcm(SgcmOptions),
    /// Free trajectories.
    MonteCarlo(MonteCarloOptions),
}

impl Default for MethodOptions {
    fn default() -> Self {
        Self::Generator(GeneratorMethodOptions::default())
    }
}

impl MethodOptions {
    /// Names used in files, the default first.
    pub const KINDS: [&'static str; 3] = ["generator", "sgcm", "monte-carlo"];

    /// Name used in files.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Generator(_) => Self::KINDS[0],
            Self::Sgcm(_) => Self::KINDS[1],
            Self::MonteCarlo(_) => Self::KINDS[2],
        }
    }

    /// Seed of the random streams; zero for a method without any.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Generator(_) => 0,
            Self::Sgcm(options) => options.seed,
            Self::MonteCarlo(options) => options.seed,
        }
    }
}

/// Settings of the generator method.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneratorMethodOptions {
    /// How advective fluxes are reconstructed.
    pub scheme: AdvectiveScheme,
    /// Gigabytes that factors may take; beyond, a smaller factorisation preconditions.
    pub memory_limit: f64,
    /// L1 error at which the solver stops.
    pub solver_tolerance: f64,
    /// Largest share of the mass that may leave Ω within one relaxation time before there is said to be no
    /// steady state.
    pub escape_limit: f64,
}

impl Default for GeneratorMethodOptions {
    fn default() -> Self {
        Self {
            scheme: AdvectiveScheme::default(),
            memory_limit: 8.0,
            // Far below the error of any grid; every digit costs iterations.
            solver_tolerance: 1e-8,
            escape_limit: ESCAPE_LIMIT,
        }
    }
}

/// A step (a time, a number of trajectories) that is given, or left to the program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepChoice {
    /// Chosen from the system, the cells and the noise.
    Auto,
    /// Given; times in the system's unit of time.
    Fixed(f64),
}

impl StepChoice {
    /// What is given, or else what is chosen.
    pub(super) fn or(self, chosen: impl FnOnce() -> f64) -> f64 {
        match self {
            Self::Auto => chosen(),
            Self::Fixed(value) => value,
        }
    }
}

/// What SGCM takes the density inside a cell for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Correction {
    /// Linear, with the slope that the neighbouring cells show.
    Slope,
    /// Flat: the paper's method.
    None,
}

impl Correction {
    /// All corrections.
    pub const ALL: [Self; 2] = [Self::Slope, Self::None];

    /// Name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slope => "slope",
            Self::None => "none",
        }
    }
}

/// Settings of stochastic generalized cell mapping.
#[derive(Debug, Clone, PartialEq)]
pub struct SgcmOptions {
    /// Time one transition spans.
    pub map_step: StepChoice,
    /// Step of the trajectory integrator.
    pub time_step: StepChoice,
    /// Trajectories started in each cell.
    pub samples: usize,
    /// Seed of the random streams.
    pub seed: u64,
    /// Integrator of the trajectories.
    pub integrator: Integrator,
    /// Groups the samples are split into to estimate the sampling error of the density (delete-a-group jackknife).
    pub replicates: usize,
    /// What the density inside a cell is taken for.
    pub correction: Correction,
    /// Solver of the steady state.
    pub solver: Solver,
    /// L1 error at which the solver stops.
    pub solver_tolerance: f64,
    /// Largest share of the mass that may leave Ω within one relaxation time before there is said to be no
    /// steady state.
    pub escape_limit: f64,
}

impl Default for SgcmOptions {
    fn default() -> Self {
        Self {
            map_step: StepChoice::Auto,
            time_step: StepChoice::Auto,
            samples: 2000,
            seed: 1,
            integrator: Integrator::StochasticHeun,
            replicates: 8,
            correction: Correction::Slope,
            solver: Solver::MultilevelAggregation,
            solver_tolerance: 1e-10,
            escape_limit: ESCAPE_LIMIT,
        }
    }
}

/// How free trajectories make a density.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// A fixed number of long trajectories, averaged over time.
    Ergodic,
    /// Many trajectories, counted at one time.
    Ensemble,
}

impl Estimator {
    /// All estimators.
    pub const ALL: [Self; 2] = [Self::Ergodic, Self::Ensemble];

    /// Name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ergodic => "ergodic",
            Self::Ensemble => "ensemble",
        }
    }
}

/// Settings of Monte Carlo.
#[derive(Debug, Clone, PartialEq)]
pub struct MonteCarloOptions {
    /// How the density is made.
    pub estimator: Estimator,
    /// Step of the trajectory integrator.
    pub time_step: StepChoice,
    /// Time before states are counted.
    pub burn_in: StepChoice,
    /// Time during which the states of one trajectory are counted (ergodic).
    pub length: StepChoice,
    /// Wanted relative standard error of the variance of every axis; what is left to the program is chosen for it.
    pub error: f64,
    /// Number of trajectories.
    pub trajectories: StepChoice,
    /// Seed of the random streams.
    pub seed: u64,
    /// Integrator of the trajectories.
    pub integrator: Integrator,
    /// Largest share of the time outside Ω, or of the trajectories that run away within one autocorrelation time, before
    /// there is said to be no steady state.
    pub escape_limit: f64,
}

impl Default for MonteCarloOptions {
    fn default() -> Self {
        Self {
            estimator: Estimator::Ergodic,
            time_step: StepChoice::Auto,
            burn_in: StepChoice::Auto,
            length: StepChoice::Auto,
            // About ten seconds for the paper's first example on two cores.
            error: 0.002,
            trajectories: StepChoice::Auto,
            seed: 1,
            integrator: Integrator::StochasticHeun,
            escape_limit: ESCAPE_LIMIT,
        }
    }
}
